"""The course of wires: straight to their end, or along a lane past the nodes in between."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

from PySide6.QtCore import QPointF
from PySide6.QtGui import QPainterPath

Box = tuple[float, float, float, float]  # left, top, right, bottom
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
        length = _length(other - one)
        ways = [_way(points, place, _SHARE * length) for place in (number, number + 1)]
        path.cubicTo(one + ways[0], other - ways[1], other)
    return path


def _way(points: Sequence[QPointF], place: int, length: float) -> QPointF:
    """Where a wire goes at one of its points, of that length."""
    if place in (0, len(points) - 1):
        return QPointF(length, 0)
    way = points[place + 1] - points[place - 1]
    return way * (length / max(_length(way), 1e-6))


def _length(way: QPointF) -> float:
    return math.hypot(way.x(), way.y())


def _go_back(path: QPainterPath, start: QPointF, end: QPointF, lane: float) -> None:
    """Turn round to the lane, go left along it, and turn into the end."""
    turn = QPointF(_TURN, 0)
    at_lane, from_lane = QPointF(start.x(), lane), QPointF(end.x(), lane)
    path.cubicTo(start + turn, at_lane + turn, at_lane)
    path.lineTo(from_lane)
    path.cubicTo(from_lane - turn, end - turn, end)


def lane_for(start: Spot, end: Spot, boxes: Sequence[Box], beside: float) -> float | None:
    """The height at which a wire gets past the boxes in its way; None if nothing is.

    The free height above the boxes, `beside` away from them, or the one below where that is much
    nearer: so that wires from one port run along one lane. A wire that goes back to the left, as to
    the next row, has its lane between the two rows.
    """
    left, right = start[0] + _LEAVE, end[0] - _LEAVE
    if right - left < _LEAVE:
        return _lane_back(start, end, boxes, beside)
    top, bottom = min(start[1], end[1]), max(start[1], end[1])
    between = [box for box in boxes if box[0] < right and box[2] > left]
    # A cubic with level ends stays near its ends' heights: that of the end met first.
    in_way = [box for box in between if box[1] - 4 < bottom and box[3] + 4 > top]
    if not any(_crosses(box, start, end) for box in in_way):
        return None
    above = _free(min(box[1] for box in in_way) - beside, between, -beside)
    below = _free(max(box[3] for box in in_way) + beside, between, beside)
    lanes = [
        (lane, favour) for lane, favour in ((above, _FAVOUR), (below, 0.0)) if lane is not None
    ]
    if not lanes:
        return None
    return min(lanes, key=lambda option: _detour(option[0], start, end) - option[1])[0]


def _lane_back(start: Spot, end: Spot, boxes: Sequence[Box], beside: float) -> float | None:
    """The height between two ends where nothing stands: below the row of the one further up.

    There no title of a backdrop is in the way.
    """
    left, right = end[0] - _TURN, start[0] + _TURN
    between = [box for box in boxes if box[0] < right and box[2] > left]
    if not any(_crosses(box, start, end) for box in between):
        return None
    low, high = min(start[1], end[1]) + _LEAVE, max(start[1], end[1])
    for lane in sorted(box[3] + _BELOW + beside for box in between):
        free = not any(box[1] - 3 < lane < box[3] + 3 for box in between)
        if low < lane < high and free:
            return lane
    return None


def _detour(lane: float, start: Spot, end: Spot) -> float:
    return abs(lane - start[1]) + abs(lane - end[1])


def _free(lane: float, boxes: Iterable[Box], step: float) -> float | None:
    """The first height from `lane` on, away by `step`, at which no box is met."""
    for _ in range(_TRIES):
        hit = [box for box in boxes if box[1] - 3 < lane < box[3] + 3]
        if not hit:
            return lane
        lane = (min(box[1] for box in hit) if step < 0 else max(box[3] for box in hit)) + step
    return None


def _crosses(box: Box, start: Spot, end: Spot) -> bool:
    """Whether the plain curve meets the box."""
    reach = _reach(end[0] - start[0], abs(end[1] - start[1]))
    xs = start[0], start[0] + reach, end[0] - reach, end[0]
    ys = start[1], start[1], end[1], end[1]
    for n in range(1, 20):
        t = n / 20
        x, y = _cubic(xs, t), _cubic(ys, t)
        if box[0] < x < box[2] and box[1] < y < box[3]:
            return True
    return False


def _cubic(p: tuple[float, float, float, float], t: float) -> float:
    u = 1 - t
    return u * u * u * p[0] + 3 * u * u * t * p[1] + 3 * u * t * t * p[2] + t * t * t * p[3]


def _reach(across: float, along: float) -> float:
    """How far a wire runs level from its ends; far out where it runs backwards."""
    reach = max(0.5 * across, 24.0) if across > 0 else 48.0 + 0.25 * (along - across)
    return min(reach, 120.0)
