"""Wires: the way each takes past the nodes, and how it is drawn."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPainterPathStroker, QPen
from PySide6.QtWidgets import QGraphicsPathItem

from app.editor.canvas.canvas_style import CanvasStyle
from app.editor.canvas.node_item import NodePort
from core.arrays import Floats
from core.editing.layout import Box, hull
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

    def stroke(self, width: float) -> QPainterPath:
        stroker = QPainterPathStroker()
        stroker.setWidth(width)
        return stroker.createStroke(self.path())

    def shape(self) -> QPainterPath:
        """The line itself, for the pointer: Qt's own would be the area under it."""
        return self.stroke(6.0)

    def paint(self, painter: QPainter, *_: Any) -> None:
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
        self._show(wire_path(start, end), QPen(colour, 2.2, Qt.PenStyle.DashLine))

    def show_cut(self, start: QPointF, end: QPointF, colour: QColor) -> None:
        self._show(straight(start, end), QPen(colour, 1.6, Qt.PenStyle.DashDotLine))

    def _show(self, path: QPainterPath, pen: QPen) -> None:
        pen.setCosmetic(True)
        self.setPen(pen)
        self.setPath(path)
        self.setVisible(True)


def straight(start: QPointF, end: QPointF) -> QPainterPath:
    path = QPainterPath(start)
    path.lineTo(end)
    return path


Spot = tuple[float, float]

_LEAVE = 32.0  # units across in which a wire changes to its lane: less than the gap of columns
_TURN = 40.0  # units aside in which a wire turns back
_BELOW = 16.0  # a lane back is this much further below nodes than others are beside them
_TRIES = 5
_SHARE = 0.35  # of the way to the next dot that a wire keeps its direction
_FAVOUR = 80.0  # for the lane above


def wire_path(start: QPointF, end: QPointF, lane: float | None = None) -> QPainterPath:
    """A wire from an output to an input; through the height `lane` if there is one."""
    path = QPainterPath(start)
    if lane is None:
        reach = _reach(end.x() - start.x(), abs(end.y() - start.y()))
        path.cubicTo(start + QPointF(reach, 0), end - QPointF(reach, 0), end)
        return path
    if end.x() < start.x() + 2 * _LEAVE:
        turn = QPointF(_TURN, 0)
        at_lane, from_lane = QPointF(start.x(), lane), QPointF(end.x(), lane)
        path.cubicTo(start + turn, at_lane + turn, at_lane)
        path.lineTo(from_lane)
        path.cubicTo(from_lane - turn, end - turn, end)
        return path
    half = QPointF(_LEAVE / 2, 0)
    up, down = QPointF(start.x() + _LEAVE, lane), QPointF(end.x() - _LEAVE, lane)
    path.cubicTo(start + half, up - half, up)
    path.lineTo(down)
    path.cubicTo(down + half, end - half, end)
    return path


def dotted_path(start: QPointF, end: QPointF, dots: Sequence[QPointF]) -> QPainterPath:
    """A wire that is bent through dots: level at its ends, and without a corner at the dots."""
    points = [start, *dots, end]
    path = QPainterPath(start)
    for number, (one, other) in enumerate(pairwise(points)):
        share = _SHARE * length(other - one)
        ways = [_way(points, place, share) for place in (number, number + 1)]
        path.cubicTo(one + ways[0], other - ways[1], other)
    return path


def _way(points: Sequence[QPointF], place: int, long: float) -> QPointF:
    if place in (0, len(points) - 1):
        return QPointF(long, 0)
    way = points[place + 1] - points[place - 1]
    return way * (long / max(length(way), 1e-6))


def length(way: QPointF) -> float:
    return math.hypot(way.x(), way.y())


class Ground:
    """Where nodes stand.

    `changed` is the hull of all places where nodes came, stood or went since it was last None.
    """

    def __init__(self, boxes: Iterable[Box] = ()) -> None:
        self.changed: Box | None = None
        self.boxes: dict[str, Box] = {str(number): box for number, box in enumerate(boxes)}
        self._rows: Floats | None = None

    def put(self, name: str, box: Box) -> None:
        if self.boxes.get(name) != box:
            self.drop(name)
            self.boxes[name] = box
            self._change(box)

    def drop(self, name: str) -> None:
        if name in self.boxes:
            self._change(self.boxes.pop(name))

    def within(self, area: Box) -> Floats:
        """The boxes of nodes that overlap an area, in rows as in `Box`."""
        if self._rows is None:
            self._rows = np.array([*self.boxes.values()], np.float64).reshape(-1, 4)
        left, top, right, bottom = self._rows.T
        there = (left < area[2]) & (right > area[0]) & (top < area[3]) & (bottom > area[1])
        inside: Floats = self._rows[there]
        return inside

    def _change(self, box: Box) -> None:
        self.changed = hull([self.changed or box, box])
        self._rows = None


def overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and one[2] > other[0] and one[1] < other[3] and one[3] > other[1]


def course_of(start: Spot, end: Spot, ground: Ground, beside: float) -> tuple[float | None, Box]:
    """The lane of a wire past the boxes in its way, None for straight; and its reach.

    What comes or goes outside of the reach leaves the lane: the free height above the boxes,
    `beside` away from them, or the one below where that is much nearer, so that wires from one port
    run along one lane. A wire that goes back to the left, as to the next row, has its lane between
    the two rows: below the row of the end further up, where no title of a backdrop is in the way.
    """
    left, right = start[0] + _LEAVE, end[0] - _LEAVE
    top, bottom = min(start[1], end[1]), max(start[1], end[1])
    if right - left < _LEAVE:
        low = top + _LEAVE
        reach = end[0] - _TURN, top - _BELOW - beside, start[0] + _TURN, max(low, bottom) + 4
        near = ground.within(reach)
        below_rows = np.unique(near[:, 3]) + _BELOW + beside if _meets(start, end, near) else ()
        free = (lane for lane in below_rows if low < lane < bottom and not _on(near, lane).size)
        return next(free, None), reach
    # A cubic with level ends stays near its ends' heights: that of the end met first.
    reach = left, top - 4, right, bottom + 4
    near = ground.within(reach)
    if not _meets(start, end, near):
        return None, reach
    above, highest = _free(near[:, 1].min() - beside, left, right, ground, -beside)
    below, lowest = _free(near[:, 3].max() + beside, left, right, ground, beside)
    reach = left, min(top, highest) - 4, right, max(bottom, lowest) + 4
    lanes = [lane for lane in (above, below) if lane is not None]

    def cost(lane: float) -> float:
        return abs(lane - start[1]) + abs(lane - end[1]) - _FAVOUR * (lane == above)

    return min(lanes, key=cost, default=None), reach


def _free(
    lane: float, left: float, right: float, ground: Ground, step: float
) -> tuple[float | None, float]:
    """The first height from `lane` on, away by `step`, with no box; and the last one tried."""
    last = lane
    for _ in range(_TRIES):
        hit = _on(ground.within((left, lane - 4, right, lane + 4)), lane)
        last = lane
        if not hit.size:
            return lane, lane
        lane = (hit[:, 1].min() if step < 0 else hit[:, 3].max()) + step
    return None, last


def _on(boxes: Floats, lane: float) -> Floats:
    return boxes[(boxes[:, 1] - 3 < lane) & (lane < boxes[:, 3] + 3)]


_SHARES = np.arange(1, 20)[:, np.newaxis] / 20
_CUBIC = (1 - _SHARES) ** [3, 2, 1, 0] * _SHARES ** [0, 1, 2, 3] * [1, 3, 3, 1]


def _meets(start: Spot, end: Spot, boxes: Floats) -> bool:
    """Whether a wire without a lane goes through one of the boxes."""
    reach = _reach(end[0] - start[0], abs(end[1] - start[1]))
    ends = [start, (start[0] + reach, start[1]), (end[0] - reach, end[1]), end]
    x, y = (_CUBIC @ np.array(ends)).T[:, :, np.newaxis]
    left, top, right, bottom = boxes.T
    return bool(np.any((left < x) & (x < right) & (top < y) & (y < bottom)))


def _reach(across: float, along: float) -> float:
    """How far a wire runs level from its ends; far out where it runs backwards."""
    reach = max(0.5 * across, 24.0) if across > 0 else 48.0 + 0.25 * (along - across)
    return min(reach, 120.0)
