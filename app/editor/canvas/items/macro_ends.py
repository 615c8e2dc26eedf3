"""Inside a macro: its inputs and outputs, with their names, beside the nodes they lead to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from app.editor.canvas.items.canvas_style import INPUT, OUTPUT, PORT_RADIUS, CanvasStyle, Side
from app.editor.canvas.items.node_item import NodeItem, NodePort
from app.editor.canvas.items.routing import Ground, course_of, wire_path
from core.network.macro import face_of_macro
from core.network.network import Network

_AWAY = 60.0  # of the plates from the nodes, for their wires
_HIGH, _PITCH, _PADDING = 32.0, 38.0, 12.0
_LETTERS = 21  # units: larger than a port's name, which nobody reads in the overview
_BEHIND = -1.5  # wires of the inside


class End(NamedTuple):
    """An input or output of the macro as it is drawn: its plate, and the wires at it."""

    name: str
    side: Side
    plate: QRectF
    wires: tuple[QPainterPath, ...]
    types: tuple[str, ...]


class MacroEnds(QGraphicsItem):
    """Draws what `follow` is told of; nothing of it can be clicked."""

    def __init__(self, style: CanvasStyle) -> None:
        super().__init__()
        self.style = style
        self.ends: tuple[End, ...] = ()
        self._bounds = QRectF()
        self.setZValue(_BEHIND)
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)

    def follow(self, body: Network, nodes: Mapping[str, NodeItem], ground: Ground) -> None:
        """Stand left and right of the nodes, at the height of those they lead to."""
        face, found = face_of_macro(body), []
        if not (face.inputs or face.outputs or self.ends):
            return
        inputs = {name: tuple(ends) for name, ends in face.inputs.items()}
        outputs = {name: (end,) for name, end in face.outputs.items()}
        for side, named in ((INPUT, inputs), (OUTPUT, outputs)):
            for name, ends in named.items():
                there = (
                    nodes[node].ports.get((side, port)) for node, port in ends if node in nodes
                )
                if ports := [port for port in there if port is not None]:
                    found.append((name, side, ports))
        frames = [node.frame() for node in nodes.values()]
        left = min((frame.left() for frame in frames), default=0.0) - _AWAY
        right = max((frame.right() for frame in frames), default=0.0) + _AWAY
        self.prepareGeometryChange()
        self.ends = (
            *self._column([one for one in found if one[1] == INPUT], left, ground),
            *self._column([one for one in found if one[1] == OUTPUT], right, ground),
        )
        self._bounds = QRectF()
        for end in self.ends:
            for part in (end.plate, *(wire.controlPointRect() for wire in end.wires)):
                self._bounds |= part.adjusted(-4, -4, 4, 4)
        self.update()

    def _column(
        self, found: Sequence[tuple[str, Side, list[NodePort]]], x: float, ground: Ground
    ) -> list[End]:
        """One below another, each as near to the height of its first port as it can be."""
        made: list[End] = []
        for name, side, ports in sorted(found, key=lambda one: one[2][0].centre().y()):
            y = ports[0].centre().y()
            if made:
                y = max(y, made[-1].plate.center().y() + _PITCH)
            wide = self.style.metrics(_LETTERS).horizontalAdvance(name) + 2 * _PADDING
            corner = QPointF(x - wide if side == INPUT else x, y - _HIGH / 2)
            at, wires = QPointF(x, y), []
            for port in ports:
                start, end = (at, port.centre()) if side == INPUT else (port.centre(), at)
                beside = self.style.lane(port.types)
                course = course_of((start.x(), start.y()), (end.x(), end.y()), ground, beside)
                wires.append(wire_path(start, end, course.lane))
            plate = QRectF(corner.x(), corner.y(), wide, _HIGH)
            made.append(End(name, side, plate, tuple(wires), ports[0].types))
        return made

    def boundingRect(self) -> QRectF:
        return self._bounds

    def paint(
        self,
        painter: QPainter,
        _option: QStyleOptionGraphicsItem,
        _widget: QWidget | None = None,
    ) -> None:
        style = self.style
        painter.setFont(style.sized(_LETTERS))
        for end in self.ends:
            colour = style.port(end.types)
            painter.setPen(QPen(colour, 1.7, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            for wire in end.wires:
                painter.drawPath(wire)
            painter.setPen(QPen(colour, 1.4))
            painter.setBrush(style.node)
            painter.drawRoundedRect(end.plate, _HIGH / 2, _HIGH / 2)
            painter.setPen(style.text)
            painter.drawText(end.plate, Qt.AlignmentFlag.AlignCenter, end.name)
            x = end.plate.right() if end.side == INPUT else end.plate.left()
            painter.setBrush(colour)
            painter.drawEllipse(QPointF(x, end.plate.center().y()), PORT_RADIUS, PORT_RADIUS)
