"""Inside a macro: its inputs and outputs, with their names, beside the nodes they lead to."""

from __future__ import annotations

import math
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
        self.setZValue(-1.5)  # behind the wires of the inside
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)

    def follow(self, body: Network, nodes: Mapping[str, NodeItem], ground: Ground) -> None:
        """Stand left and right of the nodes, at the height of those they lead to."""
        face = face_of_macro(body)
        if not (face.inputs or face.outputs or self.ends):
            return
        frames = [node.frame() for node in nodes.values()]
        left = min((frame.left() for frame in frames), default=0.0) - _AWAY
        right = max((frame.right() for frame in frames), default=0.0) + _AWAY
        outputs = {name: (end,) for name, end in face.outputs.items()}
        self.prepareGeometryChange()
        self.ends, self._bounds = (), QRectF()
        for side, named, x in ((INPUT, face.inputs, left), (OUTPUT, outputs, right)):
            lowest = -math.inf
            for name, ports in _in_order(side, named, nodes):
                y = max(ports[0].centre().y(), lowest + _PITCH)
                end = self._end(name, side, QPointF(x, y), ports, ground)
                self.ends, lowest = (*self.ends, end), y
                for part in (end.plate, *(wire.controlPointRect() for wire in end.wires)):
                    self._bounds |= part.adjusted(-4, -4, 4, 4)
        self.update()

    def _end(
        self, name: str, side: Side, at: QPointF, ports: Sequence[NodePort], ground: Ground
    ) -> End:
        wide = self.style.metrics(_LETTERS).horizontalAdvance(name) + 2 * _PADDING
        plate = QRectF(at.x() - (wide if side == INPUT else 0), at.y() - _HIGH / 2, wide, _HIGH)
        wires = []
        for port in ports:
            start, end = (at, port.centre()) if side == INPUT else (port.centre(), at)
            course = course_of(start.toTuple(), end.toTuple(), ground, self.style.lane(port.types))
            wires.append(wire_path(start, end, course.lane))
        return End(name, side, plate, tuple(wires), ports[0].types)

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


def _in_order(
    side: Side, named: Mapping[str, Sequence[tuple[str, str]]], nodes: Mapping[str, NodeItem]
) -> list[tuple[str, list[NodePort]]]:
    """The macro's ends with the ports they lead to, from the highest port down."""
    found = []
    for name, ends in named.items():
        ports = [nodes[node].ports.get((side, port)) for node, port in ends if node in nodes]
        found.append((name, [port for port in ports if port is not None]))
    there = [(name, ports) for name, ports in found if ports]
    return sorted(there, key=lambda one: one[1][0].centre().y())
