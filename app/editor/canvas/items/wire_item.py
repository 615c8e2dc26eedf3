"""A wire on the canvas."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import (
    QGraphicsPathItem,
    QStyleOptionGraphicsItem,
    QWidget,
)

from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.canvas.items.node_item import NodePort
from app.editor.canvas.items.routing import Ground, course_of, dotted_path, wire_path
from core.editing.layout import Box
from core.network.network import Link

Z_WIRE, Z_LIT, Z_LIVE = -1.0, -0.5, 5.0
_WIDTH, _LIT, _STRONG = 1.7, 2.4, 3.2
_LEAST_PX = 1.1  # on the screen, however small the picture
_SAMPLES = 24
DOT_RADIUS = 5.0
_LEAST_DOT_PX, _LARGEST_DOT = 2.0, 12.0


class WireItem(QGraphicsPathItem):
    """A wire between two ports, in the colour of what it carries.

    `lit` wires belong to a selected node, `chosen` is the selected wire, `target` the one a node
    would be inserted in. `reach` is where nodes decide about its course; None before it has one,
    and where dots give it.
    """

    def __init__(self, link: Link, output: NodePort, entry: NodePort, style: CanvasStyle) -> None:
        super().__init__()
        self.link = link
        self.style_of_canvas = style
        self.lit = self.chosen = self.hovered = self.target = False
        self.dots: tuple[QPointF, ...] = ()
        self.chosen_dot: int | None = None
        self.reach: Box | None = None
        self._line: list[QPointF] = []
        self._bounds = QRectF()
        self.output_port, self.input_port = output, entry
        for port in (output, entry):
            port.wires += 1
        self.restyle()

    def lead(self, dots: Sequence[QPointF], ground: Ground) -> None:
        """Follow the ports, through these dots or else past the nodes on the ground."""
        if (led := tuple(dots)) != self.dots:  # else all that is drawn would be drawn anew
            self.prepareGeometryChange()  # dots reach beyond the curve
            self.dots = led
        start, end = self.output_port.centre(), self.input_port.centre()
        self._line = []
        if self.dots:
            self.reach = None
            self._follow(dotted_path(start, end, self.dots))
            return
        ends = (start.x(), start.y()), (end.x(), end.y())
        beside = self.style_of_canvas.lane(self.output_port.types)
        lane, self.reach = course_of(*ends, ground, beside)
        self._follow(wire_path(start, end, lane))

    def _follow(self, path: QPainterPath) -> None:
        self.setPath(path)
        reach = _LARGEST_DOT + 2 if self.dots else 6.0
        self._bounds = path.controlPointRect().adjusted(-reach, -reach, reach, reach)

    def restyle(self) -> None:
        style = self.style_of_canvas
        types = self.output_port.types or self.input_port.types
        self.colour = colour = style.port(types)
        marked = self.chosen or self.target
        self._pen_colour = style.accent if marked else colour
        self._pen_width = _STRONG if marked or self.hovered else _LIT if self.lit else _WIDTH
        self.setZValue(Z_LIT if self.lit or marked or self.hovered else Z_WIRE)
        carried = types[0] if types else "unknown type"
        self.setToolTip(f"{self.link} ({carried})")
        self.update()

    def set_state(self, **changes: bool) -> None:
        if any(getattr(self, name) != on for name, on in changes.items()):
            vars(self).update(changes)
            self.restyle()

    def set_style(self, style: CanvasStyle) -> None:
        self.style_of_canvas = style
        self.restyle()

    def line(self) -> list[QPointF]:
        if not self._line:
            path, samples = self.path(), _SAMPLES * (len(self.dots) + 1)
            self._line = [path.pointAtPercent(n / samples) for n in range(samples + 1)]
        return self._line

    def boundingRect(self) -> QRectF:
        return self._bounds

    def shape(self) -> QPainterPath:
        """The line itself, for the pointer: Qt's own would be the area under it."""
        path = QPainterPath(self.line()[0])
        for point in self.line()[1:]:
            path.lineTo(point)
        for point in reversed(self.line()):
            path.lineTo(point + QPointF(0, 4))
        return path

    def paint(
        self,
        painter: QPainter,
        _option: QStyleOptionGraphicsItem,
        _widget: QWidget | None = None,
    ) -> None:
        zoom = max(painter.worldTransform().m11(), 1e-3)
        pen = QPen(self._pen_colour, max(self._pen_width, _LEAST_PX / zoom))
        if self.output_port.node.disabled or self.input_port.node.disabled:
            pen.setStyle(Qt.PenStyle.DashLine)
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPath(self.path())
        radius = min(max(DOT_RADIUS, _LEAST_DOT_PX / zoom), _LARGEST_DOT)
        for index, dot in enumerate(self.dots):
            chosen = index == self.chosen_dot
            colour = self.style_of_canvas.accent if chosen else self._pen_colour
            painter.setPen(QPen(self.style_of_canvas.text, 1.6 / zoom) if chosen else colour)
            painter.setBrush(colour)
            painter.drawEllipse(dot, radius, radius)

    def forget(self) -> None:
        for port in (self.output_port, self.input_port):
            port.wires -= 1
            port.node.update()
        self.scene().removeItem(self)


class LiveWire(QGraphicsPathItem):
    """The wire that is being drawn, or the line that cuts wires."""

    def __init__(self) -> None:
        super().__init__()
        self.setZValue(Z_LIVE)
        self.setVisible(False)

    def show_wire(self, start: QPointF, end: QPointF, colour: QColor) -> None:
        self.setPen(_cosmetic(colour, 2.2, Qt.PenStyle.DashLine))
        self.setPath(wire_path(start, end))
        self.setVisible(True)

    def show_cut(self, start: QPointF, end: QPointF, colour: QColor) -> None:
        self.setPen(_cosmetic(colour, 1.6, Qt.PenStyle.DashDotLine))
        path = QPainterPath(start)
        path.lineTo(end)
        self.setPath(path)
        self.setVisible(True)


def _cosmetic(colour: QColor, width: float, line: Qt.PenStyle) -> QPen:
    pen = QPen(colour, width, line)
    pen.setCosmetic(True)
    return pen
