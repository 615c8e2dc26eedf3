"""Means of a scene over footprints of any shape that a projection gives.

Lines and columns of the frame are straight on the scene. The integral over a footprint is taken in
two passes of sums: along each of the scene's rows between the borders of a column, then over the
rows between the borders of a line. Where footprints lie square to the rows that is exact. Where
they lie askew, each is cut into strips along its column, with ends along the rows: steps in place
of a slanted border, whose error falls with their number. A footprint however large costs the same.

Source: Catmull and Smith 1980, 3-D transformations of images in scanline order, for the two passes;
sums as Crow 1984.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array, Vector
from core.machine import Empty, ForEach, in_turn
from core.physics.sampling.detector_sampling import cubic_weights
from core.records import dataclass, replace

Between = Literal["area", "bilinear", "cubic"]
PAD = 2  # samples beyond those between two places that `between` looks at
BLOCK_STRIPS = 64
BLOCK_LINES = 128
UPRIGHT = 0.1  # samples that a border leans aside in a row


def footprint_means(
    *,
    scene: Array,
    laid: Footprints,
    between_samples: Between,
    dtype: Any,
    coverage: Array | None = None,
    fill: float = 0.0,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Array:
    """Mean of the scene over each footprint; a uniform scene stays as it is, to the bit.

    `between_samples` is what the scene is between its samples (see `running_sums`). Sums are in
    double, the result in `dtype`. Where footprints leave the scene there is a `coverage`, from
    `footprint_coverage`, and `fill` is seen beyond. `for_each` takes some columns at a time,
    perhaps in threads; `empty` makes the arrays to be filled in, perhaps on disk.
    """
    seen = empty((laid.lines, laid.columns), np.dtype(dtype))
    middle = 0.5 * (float(scene.min()) + float(scene.max()))
    share = None if coverage is None else (coverage.T if laid.turned else coverage)

    def fill_in(columns: slice) -> None:
        means = _block(laid, columns, scene, middle, between_samples)
        if share is None:
            seen[:, columns] = means + middle
        else:
            seen[:, columns] = means + middle * share[:, columns] + fill * (1 - share[:, columns])

    for_each(fill_in, _blocks(laid))
    return _upright(seen, laid, empty)


def footprint_coverage(
    *, laid: Footprints, dtype: Any, for_each: ForEach = in_turn, empty: Empty = np.empty
) -> Array:
    """Share of each footprint that lies on the scene, exactly 1 where all of it does."""
    seen = empty((laid.lines, laid.columns), np.dtype(dtype))
    seen.fill(1.0)

    def fill_in(columns: slice) -> None:
        within = _within(laid, columns)
        if not within.all():
            share = np.clip(_block(laid, columns, None, 0.0, "area"), 0.0, 1.0)
            seen[:, columns] = np.where(within, 1.0, share)

    for_each(fill_in, _blocks(laid))
    return _upright(seen, laid, empty)


def _upright(seen: Array, laid: Footprints, empty: Empty) -> Array:
    if not laid.turned:
        return seen
    upright = empty(seen.T.shape, seen.dtype)
    upright[...] = seen.T
    return upright


def _blocks(laid: Footprints) -> list[slice]:
    step = max(1, BLOCK_STRIPS // laid.strips)
    return [slice(k, min(k + step, laid.columns)) for k in range(0, laid.columns, step)]


@dataclass(frozen=True, eq=False)
class _Borders:
    """Of the strips of some columns: x = x0 + slope·y aside, and y at the ends.

    In the scene's samples, with x and y exchanged if `swapped`; ends of the shape (lines, 1) or
    (lines, strips).
    """

    swapped: bool
    x0: Vector
    slope: Vector
    low: Vector
    high: Vector

    def x_at(self, y: Vector) -> Vector:
        return self.x0 + self.slope * y

    def sides_at(self, y: Vector) -> tuple[Vector, Vector]:
        """The borders on both sides of each strip, at rows of its own."""
        return self.x0[:-1] + self.slope[:-1] * y, self.x0[1:] + self.slope[1:] * y


def _borders(laid: Footprints, columns: slice) -> _Borders:
    first, last = columns.start * laid.strips, columns.stop * laid.strips
    edges = laid.edges[first : last + 1]
    inverse = np.linalg.inv(laid.matrix)
    # The projection keeps straight lines straight: a = constant is border·(x, y, 1) = 0.
    border = inverse[0] - edges[:, np.newaxis] * inverse[2]
    swapped = laid.swapped
    if not laid.level:
        swapped = bool(np.sum(np.abs(border[:, 0])) < np.sum(np.abs(border[:, 1])))
    if swapped:
        border = border[:, [1, 0, 2]]
    x0, slope = -border[:, 2] / border[:, 0], -border[:, 1] / border[:, 0]
    if np.abs(slope).max() * max(laid.scene) < SQUARE:
        slope = np.zeros_like(slope)
    matrix = arranged(laid.matrix, False, swapped)
    middles = 0.5 * (edges[1:] + edges[:-1])
    ends = laid.ends[:, np.newaxis]
    if laid.widths is None:
        y = _y_at(matrix, middles[:1] if laid.level else middles, ends)
        return _Borders(swapped, x0, slope, y[:-1], y[1:])
    reach = 0.5 * np.repeat(laid.widths[columns], laid.strips)
    low, high = (_y_at(matrix, middles, ends + side * reach) for side in (-1.0, 1.0))
    return _Borders(swapped, x0, slope, low, high)


def _y_at(matrix: Vector, a: Vector, b: Vector) -> Vector:
    top, low = (row[0] * a + row[1] * b + row[2] for row in matrix[1:])
    return np.asarray(top / low)


def _block(
    laid: Footprints, columns: slice, scene: Array | None, middle: float, kind: Between
) -> Vector:
    """Mean of the scene less `middle` over footprints, or of 1 on it."""
    borders = _borders(laid, columns)
    lines = laid.lines
    step = BLOCK_LINES if np.any(borders.slope) else lines  # part of a leaning column is narrow
    means = []
    for first in range(0, lines, step):
        few = replace(
            borders, low=borders.low[first : first + step], high=borders.high[first : first + step]
        )
        total = _integrals(laid, few, scene, middle, kind)
        left, right = few.sides_at(0.5 * (few.high + few.low))
        areas = (few.high - few.low) * (right - left)
        if laid.strips > 1:
            total, areas = (
                sums.reshape(len(sums), -1, laid.strips).sum(axis=2) for sums in (total, areas)
            )
        means.append(total / areas)
    return np.concatenate(means) if len(means) > 1 else means[0]


def _integrals(
    laid: Footprints, borders: _Borders, scene: Array | None, middle: float, kind: Between
) -> Vector:
    """Integral of the scene less `middle` over strips, or of 1 on it."""
    rows, wide = laid.scene[::-1] if borders.swapped else laid.scene
    low, high = (np.clip(y, 0.0, rows) for y in (borders.low, borders.high))
    top = min(int(min(low.min(), high.min())), rows - 1)
    bottom = max(int(np.ceil(max(low.max(), high.max()))), top + 1)
    reach = np.clip(borders.x_at(np.array([[top], [bottom]], np.float64)), 0.0, wide)
    if not np.all(np.isfinite(reach)):
        raise FloatingPointError("the borders of a footprint are invalid")
    left = min(int(reach.min()), wide - 1) - PAD
    right = max(int(np.ceil(reach.max())) + PAD, left + PAD + 1)
    if scene is None:
        part = np.ones((bottom - top + 2 * PAD, right - left))
    else:
        field = scene.T if borders.swapped else scene
        part = _cut(field, slice(top - PAD, bottom + PAD), slice(left, right)) - middle
    if not np.any(borders.slope):
        rowed = np.diff(between(running_sums(part, 1), reach[:1] - left, kind, 1), axis=1)
        sums, start = running_sums(rowed, 0), top - PAD
        return between(sums, high - start, kind, 0) - between(sums, low - start, kind, 0)
    height, part = _halved(part, kind, float(np.abs(borders.slope).max()))
    y = top + height * np.arange(len(part) + 1.0)[:, np.newaxis]
    x = np.clip(borders.x_at(y), 0.0, wide) - left
    ends = [(side - top) / height for side in (low, high)]
    return height * _between_ends(part, x, ends, kind)


def _halved(part: Vector, kind: Between, lean: float) -> tuple[float, Vector]:
    """Rows without their pads, cut in halves unless borders lean little; and their height."""
    if kind == "area" and lean < UPRIGHT:
        return 1.0, part[PAD:-PAD]
    places = np.arange(PAD, len(part) - PAD + 0.25, 0.5)[:, np.newaxis]
    return 0.5, 2.0 * np.diff(between(running_sums(part, 0), places, kind, 0), axis=0)


def _between_ends(part: Vector, x: Vector, ends: Sequence[Vector], kind: Between) -> Vector:
    """Integral between borders that lean and the ends of strips, counted in rows.

    A row's integral is that at its top, going over straight to that at its bottom.
    """
    across = running_sums(part, 1)
    base, weights = taps(x, kind, part.shape[1])
    at_top, at_bottom = (
        np.diff(weighted(across, base[of], [(k, w[of]) for k, w in weights], 1), axis=1)
        for of in (slice(None, -1), slice(1, None))
    )
    at_bottom -= at_top
    sums = running_sums(at_top + 0.5 * at_bottom, 0)
    low, high = (_up_to(end, sums, at_top, at_bottom) for end in ends)
    return high - low


def _up_to(end: Vector, sums: Vector, at_top: Vector, more: Vector) -> Vector:
    row = np.minimum(end.astype(np.intp), len(at_top) - 1)
    t = end - row
    integral = picked(sums, row, 0)
    integral += t * picked(at_top, row, 0)
    integral += 0.5 * t * t * picked(more, row, 0)
    return integral


def _within(laid: Footprints, columns: slice) -> NDArray[np.bool_]:
    """Which footprints do not leave the scene, but for rounding."""
    borders = _borders(laid, columns)
    rows, wide = laid.scene[::-1] if borders.swapped else laid.scene
    slack = 1e-9 * max(rows, wide)
    inside: Any = True
    for y in (borders.low, borders.high):
        inside = inside & (y >= -slack) & (y <= rows + slack)
        for x in borders.sides_at(y):
            inside = inside & (x >= -slack) & (x <= wide + slack)
    return np.asarray(inside.reshape(laid.lines, -1, laid.strips).all(axis=2))


def _cut(field: Array, rows: slice, columns: slice) -> Vector:
    """Part of a scene in double, whose outermost samples go on beyond it."""
    high, wide = field.shape
    inner = field[max(rows.start, 0) : rows.stop, max(columns.start, 0) : columns.stop]
    part = np.asarray(inner, np.float64)
    beyond = (
        (max(-rows.start, 0), max(rows.stop - high, 0)),
        (max(-columns.start, 0), max(columns.stop - wide, 0)),
    )
    return np.pad(part, beyond, mode="edge") if np.any(beyond) else part


def strips_error(
    *, scene: Array, laid: Footprints, finer: Footprints, between_samples: Between
) -> float:
    """Largest change that finer strips make, as a share of the scene's range, in some columns.

    `finer` is the same with more strips; 0 where nothing lies askew: there are no strips then.
    """
    span = float(scene.max()) - float(scene.min())
    if laid.level or span == 0.0:
        return 0.0
    most = 0.0
    wide = min(8, laid.columns)
    for first in sorted({0, (laid.columns - wide) // 2, laid.columns - wide}):
        columns = slice(first, first + wide)
        coarse, fine = (
            _block(footprints, columns, scene, float(scene.min()), between_samples)
            for footprints in (laid, finer)
        )
        most = max(most, float(np.max(np.abs(coarse - fine))))
    return most / span


# Footprints of a frame's samples, which a projection lays on a scene.
#
# The rays of a frame's columns a and lines b meet the scene at M·(a, b, 1), so that lines of equal
# a, and of equal b, are straight on it.

SQUARE = 1e-7  # samples by which a border may leave the scene's rows, too few to matter


@dataclass(frozen=True, eq=False)
class Footprints:
    """Footprints of a frame on a scene of (rows, columns), counted in its samples.

    `turned`: what follows holds with lines and columns of the frame exchanged. `level`: all strips
    of a line end at the same rows of the scene, or columns if `swapped`, where its rows and columns
    are exchanged; of those not level, as is best for each strip. The 3 × 3 `matrix` leads from (a,
    b, 1) to the scene's x and y, before they are exchanged. `edges` are a at the borders of strips,
    shape (columns·strips + 1,); `ends` are b at the borders of lines or, with `widths`, the extent
    of each column's samples in b, at their middles. A footprint is cut into `strips`, 1 where they
    are level.
    """

    scene: tuple[int, int]
    turned: bool
    level: bool
    swapped: bool
    matrix: Vector
    edges: Vector
    ends: Vector
    widths: Vector | None
    strips: int

    @property
    def columns(self) -> int:
        """Columns, or lines where they are exchanged."""
        return (len(self.edges) - 1) // self.strips

    @property
    def lines(self) -> int:
        """Lines, or columns where they are exchanged."""
        return len(self.ends) - (self.widths is None)


def footprints(
    *,
    matrix: Vector,
    across: Vector,
    along: Vector,
    middles: Vector,
    widths: Vector,
    scene: tuple[int, int],
    strips: int,
) -> Footprints:
    """Lay footprints on a scene.

    The matrix leads from (a, b, 1) to the scene's x and y, counted in its samples. a is known at
    the borders of columns, b at those of lines and at their middles; `widths` is the extent of each
    column's samples, in lines. Where a footprint lies askew it is cut into strips.
    """
    even = bool(np.all(np.abs(widths - 1.0) < 1e-12))
    ways = [way for way in product((False, True), (False, True)) if even or not way[0]]
    slopes = [_slope(arranged(matrix, *way), across, along, way[0]) for way in ways]
    best = int(np.argmin(slopes))
    level = slopes[best] < SQUARE
    turned, swapped = ways[best] if level else (False, False)
    first, second = (along, across) if turned else (across, along)
    cuts = 1 if level else strips
    places = np.arange((len(first) - 1) * cuts + 1) / cuts
    height = (along[-1] - along[0]) / (len(along) - 1)
    return Footprints(
        scene=scene,
        turned=turned,
        level=level,
        swapped=swapped,
        matrix=arranged(matrix, turned, False),
        edges=first if cuts == 1 else np.interp(places, np.arange(len(first)), first),
        ends=second if even else middles,
        widths=None if even else widths * height,
        strips=cuts,
    )


def arranged(matrix: Vector, turned: bool, swapped: bool) -> Vector:
    """With a and b exchanged, and x and y."""
    own = matrix[:, [1, 0, 2]] if turned else matrix
    return own[[1, 0, 2]] if swapped else own


def _slope(matrix: Vector, across: Vector, along: Vector, turned: bool) -> float:
    """How many rows of the scene a sample's end rises in its width, over its own height."""
    first, second = (along, across) if turned else (across, along)
    steps = [(borders[-1] - borders[0]) / (len(borders) - 1) for borders in (first, second)]
    worst = 0.0
    for a, b in product((first[0], 0.5 * (first[0] + first[-1]), first[-1]), second[[0, -1]]):
        _, y, z = matrix @ (a, b, 1.0)
        rise = np.abs((matrix[1, :2] * z - matrix[2, :2] * y) * steps)
        worst = max(worst, float(rise[0]) / max(float(rise[1]), 1e-300))
    return worst


# Integrals of sampled values between any two places, by their running sums.
#
# What lies between samples is taken as `area`: each holds all over its extent, as block means have
# it, and nothing overshoots; `bilinear`: straight from centre to centre; `cubic`: parabolas that
# join, and keep each sample's mean. The last two have a straight ramp exactly.


def running_sums(samples: Array, axis: int) -> Vector:
    """Sums of all samples before each border: one more along the axis than samples."""
    shape = list(samples.shape)
    shape[axis] += 1
    sums = np.zeros(shape)
    after = (slice(None),) * axis + (slice(1, None),)
    np.cumsum(samples, axis=axis, out=sums[after])
    return sums


def between(sums: Vector, places: Vector, kind: Between, axis: int) -> Vector:
    """Integral from the first border up to places along one axis of (rows, columns).

    The running sums are along that axis. Places count in samples from the first border, `PAD`
    within the first and last; of length 1 along the other axis where they are the same there.
    """
    base, weights = taps(places, kind, sums.shape[axis] - 1)
    return weighted(sums, base, weights, axis)


def weighted(
    sums: Vector, base: NDArray[np.intp], weights: Iterable[tuple[int, Vector]], axis: int
) -> Vector:
    """Weighted sum of values near a base along an axis, as `taps` gives them."""
    total: Vector | None = None
    for index, weight in weights:
        term = picked(sums, base + index, axis)
        term *= weight
        total = term if total is None else np.add(total, term, out=total)
    assert total is not None
    return total


def picked(values: Vector, index: NDArray[np.intp], axis: int) -> Vector:
    """Values at an index along an axis: one for all rows, or columns, or one for each."""
    if index.shape[1 - axis] == 1:
        return np.asarray(np.take(values, index.ravel(), axis=axis))
    columns = values.shape[1]
    if axis == 1:
        flat = index + np.arange(len(index))[:, np.newaxis] * columns
    else:
        flat = index * columns + np.arange(columns)
    return np.asarray(np.take(values, flat))


def taps(
    places: Vector, kind: Between, samples: int
) -> tuple[NDArray[np.intp], list[tuple[int, Vector]]]:
    """The running sums, counted from a base, whose weighted sum is the integral up to a place.

    `bilinear`: the mean over a sample's width of the sums joined straight. `cubic`: Catmull and
    Rom's curve through the sums.
    """
    if kind == "bilinear":
        base = np.rint(places).astype(np.intp)
        t = places - base
        return base, [(-1, 0.5 * (0.5 - t) ** 2), (0, 0.75 - t * t), (1, 0.5 * (0.5 + t) ** 2)]
    base = np.minimum(places.astype(np.intp), samples - 1)
    t = places - base
    if kind == "area":
        return base, [(0, 1.0 - t), (1, t)]
    return base, list(cubic_weights(t))
