"""Overlap area of an annulus crossed by opaque strips with itself moved by a lag.

The area is the boundary integral of (p - lag/2)·N/2 over the pieces of the pupil's boundary
that lie in the moved pupil and the other way round. Pieces are found as the gaps that opaque
intervals leave on each straight edge and each circle. The second kind of piece is the first
kind for the opposite lag.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.physics.optics.overlap_area import arc_half_angle, half_chord
from core.records import dataclass

_FAR = 1e300
_POINTS_PER_BLOCK = 4096  # keeps a block's rows in the processor's cache


@dataclass(frozen=True)
class Strip:
    """Opaque band low <= n·p <= high with n = (-sin, cos) of its direction u = (cos, sin).

    `half` keeps only the side u·p >= 0: a vane rather than a bar.
    """

    cos: float
    sin: float
    low: float
    high: float
    half: bool

    def along(self, x: Floats, y: Floats) -> Floats:
        """Component along the strip."""
        return self.cos * x + self.sin * y

    def across(self, x: Floats, y: Floats) -> Floats:
        """Component across the strip."""
        return self.cos * y - self.sin * x


@dataclass(frozen=True)
class StripPupil:
    """Annulus with strips, bars only if it is point-symmetric.

    Strips differ in direction, or have no edge in common and cover none of the other's.
    """

    radius: float
    inner_radius: float
    strips: tuple[Strip, ...]

    @property
    def symmetric(self) -> bool:
        """Whether p and -p are always alike."""
        return not any(strip.half for strip in self.strips)


@dataclass(frozen=True)
class _Moved:
    """The moved pupil for one block of lags, of the same circles.

    `leaning` is the side a lag on a tie is taken to lie on.
    """

    pupil: StripPupil
    x: Floats
    y: Floats
    leaning: int


def strip_pupil_area(*, pupil: StripPupil) -> float:
    """Transparent area of the pupil, in its length unit squared."""
    return float(_half_moment(pupil, None)[0])


def strip_overlap_area(
    *, pupil: StripPupil, lag_x: Floats, lag_y: Floats, other: StripPupil | None = None
) -> Floats:
    """Overlap area of the pupil with itself, or with another one, moved; for nonzero lags.

    Lags are in the pupil's length unit. Another pupil has the same circles, and none of its strips
    has the direction of any of this one's. The absolute error is about 1e-15 of a disc's.
    """
    x, y = lag_x.ravel(), lag_y.ravel()
    partner = pupil if other is None else other
    area = np.empty(x.size)
    for start in range(0, x.size, _POINTS_PER_BLOCK):
        block = slice(start, start + _POINTS_PER_BLOCK)
        ahead = _half_moment(pupil, _Moved(partner, x[block], y[block], 1))
        if pupil.symmetric and other is None:
            area[block] = 2.0 * ahead
        else:
            area[block] = ahead + _half_moment(partner, _Moved(pupil, -x[block], -y[block], -1))
    return np.maximum(area, 0.0).reshape(lag_x.shape)


def _half_moment(pupil: StripPupil, moved: _Moved | None) -> Floats:
    """Half the integral of (p - lag/2)·N over the pupil's boundary inside the moved pupil."""
    total = _circle_moment(pupil, pupil.radius, moved)
    if pupil.inner_radius > 0.0:
        total = total - _circle_moment(pupil, pupil.inner_radius, moved)
    for index, strip in enumerate(pupil.strips):
        for offset, side in ((strip.high, 1), (strip.low, -1)):
            if abs(offset) < pupil.radius:
                total = total + _edge_moment(pupil, index, offset, side, moved)
    if len(pupil.strips) == 1 and pupil.strips[0].half:
        total = total + _end_moment(pupil, moved)
    return 0.5 * total


def _circle_moment(pupil: StripPupil, radius: float, moved: _Moved | None) -> Floats:
    """Moment of one circle; angles count from the lag's direction."""
    none = np.zeros(1)
    zero = none if moved is None else np.zeros_like(moved.x)
    opaque: list[Interval] = []
    if moved is None:
        direction, apart, window = none, none, np.full(1, np.pi)
    else:
        direction, apart = np.arctan2(moved.y, moved.x), np.hypot(moved.x, moved.y)
        window = arc_half_angle(radius=radius, disc_radius=pupil.radius, distance=apart)
        if pupil.inner_radius > 0.0:
            hidden = arc_half_angle(radius=radius, disc_radius=pupil.inner_radius, distance=apart)
            opaque.append((-hidden, hidden))
    # Seen from outside, half of the rim at least is cut off: no arc can come round to the front.
    wraps = moved is None or radius < pupil.radius
    placed = [(strip, zero, zero) for strip in pupil.strips]
    if moved is not None:
        for strip in moved.pupil.strips:
            along, across = strip.along(moved.x, moved.y), strip.across(moved.x, moved.y)
            placed.append((strip, along, across))
    for strip, begin, across in placed:
        turn = math.atan2(strip.sin, strip.cos) - direction
        for low, high, base in _strip_arcs(strip, radius, begin, across):
            middle = 0.5 * (low + high) + turn + base
            turns = np.round(middle / (2.0 * np.pi))
            place = turn + base - 2.0 * np.pi * turns
            opaque.append((low + place, high + place))
            if wraps:
                place = place - np.copysign(2.0 * np.pi, middle - 2.0 * np.pi * turns)
                opaque.append((low + place, high + place))
    start, end = open_gaps(window=(-window, window), opaque=opaque)
    moment = radius**2 * np.sum(end - start, axis=0)
    if moved is not None:
        moment -= 0.5 * radius * apart * np.sum(np.sin(end) - np.sin(start), axis=0)
    return np.asarray(moment)


def _strip_arcs(
    strip: Strip, radius: float, begin: Floats, across: Floats
) -> list[tuple[Floats, Floats, float]]:
    """Arcs of a circle inside a strip moved by (begin, across): low, high, from which base angle.

    Angles count from the strip's direction plus the base.
    """
    low, high = (_arcsine(edge + across, radius) for edge in (strip.low, strip.high))
    if not strip.half:
        return [(low, high, 0.0), (-high, -low, np.pi)]
    reach = np.pi / 2.0 - _arcsine(begin, radius)
    behind = np.pi - reach
    return [
        (np.maximum(low, -reach), np.minimum(high, reach), 0.0),
        (-high, np.minimum(-low, -behind), np.pi),
        (np.maximum(-high, behind), -low, np.pi),
    ]


def _arcsine(length: Floats, radius: float) -> Floats:
    x = np.clip(length, -radius, radius)
    return np.asarray(np.arctan2(x, np.sqrt((radius - x) * (radius + x))))


def _edge_moment(
    pupil: StripPupil, index: int, offset: float, side: int, moved: _Moved | None
) -> Floats:
    """Moment of the straight edge n·p = offset of one strip; N points into the strip."""
    strip = pupil.strips[index]
    reach = math.sqrt((pupil.radius - offset) * (pupil.radius + offset))
    low = np.full(1 if moved is None else moved.x.size, 0.0 if strip.half else -reach)
    high = np.full_like(low, reach)
    opaque: list[Interval] = []
    if pupil.inner_radius > abs(offset):
        hidden = math.sqrt((pupil.inner_radius - offset) * (pupil.inner_radius + offset))
        opaque.append((-hidden, hidden))
    zero = np.zeros(1)
    opaque += [_strip_on_line(other, strip, offset, zero, zero) for other in _turned(pupil, strip)]
    arm = -side * np.full_like(low, offset)
    if moved is not None:
        along, across = strip.along(moved.x, moved.y), strip.across(moved.x, moved.y)
        low, high = _add_discs(pupil, along, offset - across, (low, high), opaque)
        for other in _turned(moved.pupil, strip):
            opaque.append(_strip_on_line(other, strip, offset, moved.x, moved.y))
        if moved.pupil is pupil:
            covered = _same_strip_covers(
                side * across, strip.high - strip.low, side * moved.leaning
            )
            begin = along if strip.half else np.full_like(along, -_FAR)
            opaque.append((np.where(covered, begin, _FAR), _FAR))
        arm = -side * (offset - 0.5 * across)
    start, end = open_gaps(window=(low, high), opaque=opaque)
    return np.asarray(arm * np.sum(end - start, axis=0))


def _turned(pupil: StripPupil, strip: Strip) -> list[Strip]:
    """Strips of another direction; those of the same one meet no edge of this one."""
    direction = strip.cos, strip.sin
    return [other for other in pupil.strips if (other.cos, other.sin) != direction]


def _end_moment(pupil: StripPupil, moved: _Moved | None) -> Floats:
    """Moment of the blunt end u·p = 0 of a single vane; with more vanes the others cover it."""
    if moved is None:
        return np.zeros(1)  # the edge passes through the origin
    strip = pupil.strips[0]
    along, across = strip.along(moved.x, moved.y), strip.across(moved.x, moved.y)
    low = np.full_like(along, max(strip.low, -pupil.radius))
    high = np.full_like(along, min(strip.high, pupil.radius))
    opaque: list[Interval] = [(-pupil.inner_radius, pupil.inner_radius)]
    low, high = _add_discs(pupil, across, -along, (low, high), opaque)
    covered = along < 0.0 if moved.leaning > 0 else along <= 0.0
    opaque.append((np.where(covered, strip.low + across, _FAR), strip.high + across))
    start, end = open_gaps(window=(low, high), opaque=opaque)
    return np.asarray(-0.5 * along * np.sum(end - start, axis=0))


def _add_discs(
    pupil: StripPupil,
    centre: Floats,
    distance: Floats,
    window: tuple[Floats, Floats],
    opaque: "list[Interval]",
) -> tuple[Floats, Floats]:
    """Narrow a line's window to the moved outer disc and add the moved inner one."""
    # Not the differences of squares: where an edge touches a circle half the digits would be lost.
    half = half_chord(pupil.radius, distance)
    if pupil.inner_radius > 0.0:
        hidden = half_chord(pupil.inner_radius, distance)
        opaque.append((centre - hidden, centre + hidden))
    low = np.maximum(window[0], centre - half)
    return low, np.maximum(low, np.minimum(window[1], centre + half))


def _strip_on_line(
    other: Strip, strip: Strip, offset: float, lag_x: Floats, lag_y: Floats
) -> tuple[Floats, Floats]:
    """Interval of the line n·p = offset of `strip` inside `other` moved by the lag."""
    rise = other.cos * strip.sin - other.sin * strip.cos
    run = other.cos * strip.cos + other.sin * strip.sin
    # The line is p = offset·n + t·u; in the other strip's axes n is (-rise, run), u (run, rise).
    across = offset * run - other.across(lag_x, lag_y)
    first, second = (other.low - across) / rise, (other.high - across) / rise
    low, high = np.minimum(first, second), np.maximum(first, second)
    if other.half and run != 0.0:
        begin = (offset * rise + other.along(lag_x, lag_y)) / run
        low, high = (np.maximum(low, begin), high) if run > 0 else (low, np.minimum(high, begin))
    return low, high


def _same_strip_covers(inward: Floats, width: float, leaning: int) -> NDArray[np.bool_]:
    """Whether a strip moved by `inward` from an edge's outside covers that edge.

    Edges that coincide must count once: a tie is decided as if the lag leaned to one side.
    """
    if leaning > 0:
        covered: NDArray[np.bool_] = (inward >= 0.0) & (inward < width)
    else:
        covered = (inward > 0.0) & (inward <= width)
    return covered


# What a set of opaque intervals leaves open of a window, for many points at once.

Interval = tuple["Floats | float", "Floats | float"]


def open_gaps(
    *, window: tuple[Floats, Floats], opaque: Sequence[Interval]
) -> tuple[Floats, Floats]:
    """Start and end of each gap that a union of intervals leaves in a window.

    The window's ends are of shape (points,), as are those of the m intervals, or scalars; an empty
    interval has high <= low. Start and end are of shape (m + 1, points); a gap that does not exist
    has end == start. The k-th gap lies between the k-th smallest end and the (k+1)-th smallest
    start, each sorted by itself: at a point left open, as many intervals have ended as have begun.
    """
    low, high = window
    starts = np.empty((len(opaque) + 1, low.size))
    ends = np.empty_like(starts)
    starts[-1], ends[-1] = high, low
    for row, (begin, end) in enumerate(opaque):
        np.clip(begin, low, high, out=starts[row])
        np.clip(end, low, high, out=ends[row])
        np.maximum(ends[row], starts[row], out=ends[row])
    _sort_columns(starts)
    _sort_columns(ends)
    return ends, np.maximum(starts, ends)


def _sort_columns(rows: Floats) -> None:
    """Sort a few long rows column by column: a network of whole-row minima and maxima."""
    count = len(rows)
    for turn in range(count):
        first = rows[turn % 2 : count - 1 : 2]
        second = rows[turn % 2 + 1 : count : 2]
        smaller = np.minimum(first, second)
        np.maximum(first, second, out=second)
        first[...] = smaller
