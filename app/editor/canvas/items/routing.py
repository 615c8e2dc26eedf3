"""The course of wires: straight to their end, or along a lane past the nodes in between."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

from PySide6.QtCore import QPointF
from PySide6.QtGui import QPainterPath

from core.editing.layout import Box, hull

Spot = tuple[float, float]

_LEAVE = 32.0  # units across in which a wire changes to its lane: less than the gap of columns
_TURN = 40.0  # units aside in which a wire turns back
_BELOW = 16.0  # a lane back is this much further below nodes than others are beside them
_TRIES = 5
_CELL = 512.0  # units: about two nodes by three
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
        _go_back(path, start, end, lane)
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
    """Where a wire goes at one of its points, of that length."""
    if place in (0, len(points) - 1):
        return QPointF(long, 0)
    way = points[place + 1] - points[place - 1]
    return way * (long / max(length(way), 1e-6))


def length(way: QPointF) -> float:
    return math.hypot(way.x(), way.y())


def _go_back(path: QPainterPath, start: QPointF, end: QPointF, lane: float) -> None:
    """Turn round to the lane, go left along it, and turn into the end."""
    turn = QPointF(_TURN, 0)
    at_lane, from_lane = QPointF(start.x(), lane), QPointF(end.x(), lane)
    path.cubicTo(start + turn, at_lane + turn, at_lane)
    path.lineTo(from_lane)
    path.cubicTo(from_lane - turn, end - turn, end)


class Ground:
    """Where nodes stand, found by place: a wire looks only at the nodes near its course.

    `changed` is the hull of all places where nodes came, stood or went since it was last None.
    """

    def __init__(self, boxes: Iterable[Box] = ()) -> None:
        self.changed: Box | None = None
        self.boxes: dict[str, Box] = {}
        self._cells: dict[tuple[int, int], dict[str, Box]] = {}
        for number, box in enumerate(boxes):
            self.put(str(number), box)

    def put(self, name: str, box: Box) -> None:
        if self.boxes.get(name) == box:
            return
        self.drop(name)
        self.boxes[name] = box
        for cell in _cells(box):
            self._cells.setdefault(cell, {})[name] = box
        self._change(box)

    def drop(self, name: str) -> None:
        box = self.boxes.pop(name, None)
        if box is not None:
            for cell in _cells(box):
                del self._cells[cell][name]
            self._change(box)

    def within(self, area: Box) -> set[Box]:
        columns, rows = _cell_ranges(area)
        if len(columns) * len(rows) > len(self.boxes):
            near: Iterable[Box] = self.boxes.values()
        else:
            cells = (self._cells.get((x, y)) for x in columns for y in rows)
            near = (box for cell in cells if cell for box in cell.values())
        return {box for box in near if overlap(box, area)}

    def span(self, area: Box) -> tuple[float, float]:
        """The least top and the greatest bottom of the nodes that overlap an area; some do."""
        columns, rows = _cell_ranges(area)
        if len(columns) * len(rows) > len(self.boxes):
            every = self.within(area)
            return min(box[1] for box in every), max(box[3] for box in every)

        def first(order: Iterable[int]) -> list[Box]:
            """The nodes in the first row of cells that has one: none beyond reaches further."""
            for y in order:
                cells = (self._cells.get((x, y), {}) for x in columns)
                if row := [b for cell in cells for b in cell.values() if overlap(b, area)]:
                    return row
            raise AssertionError

        upper, lower = first(rows), first(reversed(rows))
        return min(box[1] for box in upper), max(box[3] for box in lower)

    def meets(self, points: Iterable[Spot], area: Box) -> bool:
        """Whether one of the points lies in a node that overlaps an area."""
        return any(
            box[0] < x < box[2] and box[1] < y < box[3] and overlap(box, area)
            for x, y in points
            for box in self._cells.get((math.floor(x / _CELL), math.floor(y / _CELL)), {}).values()
        )

    def _change(self, box: Box) -> None:
        self.changed = hull([self.changed or box, box])


def overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and one[2] > other[0] and one[1] < other[3] and one[3] > other[1]


def _cell_ranges(area: Box) -> tuple[range, range]:
    left, top, right, bottom = (math.floor(side / _CELL) for side in area)
    return range(left, right + 1), range(top, bottom + 1)


def _cells(box: Box) -> Iterable[tuple[int, int]]:
    columns, rows = _cell_ranges(box)
    return ((x, y) for x in columns for y in rows)


class Course(NamedTuple):
    """The height at which a wire gets past nodes, None for straight, and what that depends on.

    A node that comes or goes outside of `reach` does not change the lane.
    """

    lane: float | None
    reach: Box


def course_of(start: Spot, end: Spot, ground: Ground, beside: float) -> Course:
    """The course of a wire past the boxes in its way.

    The lane is the free height above the boxes, `beside` away from them, or the one below where
    that is much nearer: so that wires from one port run along one lane. A wire that goes back to
    the left, as to the next row, has its lane between the two rows.
    """
    left, right = start[0] + _LEAVE, end[0] - _LEAVE
    if right - left < _LEAVE:
        return _course_back(start, end, ground, beside)
    top, bottom = min(start[1], end[1]), max(start[1], end[1])
    # A cubic with level ends stays near its ends' heights: that of the end met first.
    in_way = left, top - 4, right, bottom + 4
    if not ground.meets(_points(start, end), in_way):
        return Course(None, in_way)
    upper, lower = ground.span(in_way)
    above, highest = _free(upper - beside, left, right, ground, -beside)
    below, lowest = _free(lower + beside, left, right, ground, beside)
    reach = left, min(top, highest) - 4, right, max(bottom, lowest) + 4
    lanes = [
        (lane, favour) for lane, favour in ((above, _FAVOUR), (below, 0.0)) if lane is not None
    ]
    if not lanes:
        return Course(None, reach)
    return Course(
        min(lanes, key=lambda option: _detour(option[0], start, end) - option[1])[0], reach
    )


def _course_back(start: Spot, end: Spot, ground: Ground, beside: float) -> Course:
    """The height between two ends where nothing stands: below the row of the one further up.

    There no title of a backdrop is in the way.
    """
    low, high = min(start[1], end[1]) + _LEAVE, max(start[1], end[1])
    highest = min(start[1], end[1]) - _BELOW - beside
    reach = end[0] - _TURN, highest, start[0] + _TURN, max(low, high) + 4
    if not ground.meets(_points(start, end), reach):
        return Course(None, reach)
    between = ground.within(reach)
    lanes = {box[3] + _BELOW + beside for box in between}
    spans = sorted({(box[1], box[3]) for box in between}, reverse=True)
    reached = -math.inf  # the lower end of all spans that begin above the lane
    for lane in sorted(lane for lane in lanes if low < lane < high):
        while spans and spans[-1][0] - 3 < lane:
            reached = max(reached, spans.pop()[1] + 3)
        if reached <= lane:
            return Course(lane, reach)
    return Course(None, reach)


def _detour(lane: float, start: Spot, end: Spot) -> float:
    return abs(lane - start[1]) + abs(lane - end[1])


def _free(
    lane: float, left: float, right: float, ground: Ground, step: float
) -> tuple[float | None, float]:
    """The first height from `lane` on, away by `step`, with no box; and the last one tried."""
    for _ in range(_TRIES):
        near = ground.within((left, lane - 4, right, lane + 4))
        hit = [box for box in near if box[1] - 3 < lane < box[3] + 3]
        if not hit:
            return lane, lane
        last = lane
        lane = (min(box[1] for box in hit) if step < 0 else max(box[3] for box in hit)) + step
    return None, last


def _weights(t: float) -> tuple[float, float, float, float]:
    u = 1 - t
    return u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t


_CUBIC = [_weights(n / 20) for n in range(1, 20)]


def _points(start: Spot, end: Spot) -> list[Spot]:
    reach = _reach(end[0] - start[0], abs(end[1] - start[1]))
    xs = start[0], start[0] + reach, end[0] - reach, end[0]
    ys = start[1], start[1], end[1], end[1]
    return [
        (
            a * xs[0] + b * xs[1] + c * xs[2] + d * xs[3],
            a * ys[0] + b * ys[1] + c * ys[2] + d * ys[3],
        )
        for a, b, c, d in _CUBIC
    ]


def _reach(across: float, along: float) -> float:
    """How far a wire runs level from its ends; far out where it runs backwards."""
    reach = max(0.5 * across, 24.0) if across > 0 else 48.0 + 0.25 * (along - across)
    return min(reach, 120.0)
