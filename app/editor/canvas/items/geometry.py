"""Where the parts of a node lie, in units of the scene."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF

from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.canvas.items.faces import NodeFace, PortFace, Side

# A network's grid is 240 by 160: the gaps are for wires, and seven ports have to fit.
NARROWEST, WIDEST = 168.0, 200.0
HEAD, HEAD_WITH_ID = 24.0, 39.0
PORT_ROW = 15.0
PORT_RADIUS = 4.5
_PADDING = 9.0
_FOOT = 6.0
BADGE_ROOM = 20.0


@dataclass(frozen=True)
class NodeGeometry:
    """Size of a node, height of its head, and the centres of its ports."""

    width: float
    height: float
    head: float
    ports: dict[tuple[Side, str], QPointF]

    @property
    def frame(self) -> QRectF:
        """The node without its ports' outer halves."""
        return QRectF(0, 0, self.width, self.height)


def geometry_of(face: NodeFace, style: CanvasStyle) -> NodeGeometry:
    """Lay a node out, as narrow as its texts allow."""
    head = HEAD_WITH_ID if face.subtitle else HEAD
    title = style.width("title", face.id) + 2 * _PADDING + BADGE_ROOM
    rows = max(len(face.inputs), len(face.outputs))
    labels = [_row_width(face, row, style) for row in range(rows)]
    width = min(max([NARROWEST, title, *labels]), WIDEST)
    height = head + rows * PORT_ROW + 2 * _FOOT
    ports = {}
    for x, faces in ((0.0, face.inputs), (width, face.outputs)):
        for row, port in enumerate(faces):
            y = head + _FOOT + (row + 0.5) * PORT_ROW
            ports[port.side, port.name] = QPointF(x, y)
    return NodeGeometry(width, height, head, ports)


def _row_width(face: NodeFace, row: int, style: CanvasStyle) -> float:
    texts = [ports[row].name for ports in (face.inputs, face.outputs) if row < len(ports)]
    return sum(style.width("port", text) + _PADDING for text in texts) + _PADDING


def label_room(geometry: NodeGeometry, port: PortFace, face: NodeFace) -> float:
    """How wide a port's label may be; more where nothing stands on the other side of its row."""
    own, others = (
        (face.inputs, face.outputs) if port.side == "input" else (face.outputs, face.inputs)
    )
    alone = own.index(port) >= len(others)
    return geometry.width * (1.0 if alone else 0.62) - 2 * _PADDING
