"""Edges' samples against their spreads: what is an edge's own is fitted to each by itself.

Variable projection (Golub and Pereyra 1973, with Kaufman's (1975) form of the derivatives), all
edges at once in rows of arrays; what is too many in a row has no weight.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core import kernels
from core.arrays import Complex, Matrix, Vector
from core.physics.measurement.found_edge import EdgeSamples, FoundEdge, edge_samples
from core.records import dataclass, replace

# The samples about one edge, as the fit takes them, and the part of the picture about it.

MARGIN = 32  # samples about an edge, beyond which nothing is looked at


def window_about(*, picture: Matrix, edge: FoundEdge) -> tuple[Matrix, int, int]:
    """The picture about an edge, a margin wide, and the row and column where it begins.

    Its shape is good to transform; beyond the picture's frame the nearest samples stand.
    """
    (x1, y1), (x2, y2) = edge.ends
    wide = edge.reach + MARGIN
    first, count = [], []
    for one, other in ((y1, y2), (x1, x2)):
        start = math.floor(min(one, other) - wide)
        first.append(start)
        count.append(kernels.next_fast_len(math.ceil(max(one, other) + wide) + 1 - start, True))
    rows, columns = (
        np.clip(start + np.arange(many), 0, length - 1)
        for start, many, length in zip(first, count, picture.shape, strict=True)
    )
    return np.asarray(picture[np.ix_(rows, columns)], np.float64), first[0], first[1]


_NARROW, _WIDTHS = 5.0, 2.5  # samples, and widths of the step: the fit's reach on both sides
_LEAST_REACH = 8.0  # samples
_ENDS, _END_SHARE = 6.0, 0.15  # samples, or of the length: what is left off where corners round it
_OUTER = 0.6  # of the reach, beyond which a side counts as level
_SHADED = 4.0  # standard errors, from which on a slope of a side counts
_LEAST_OUTER = 12  # samples on a level side
_FAINT = 1e-4  # of the contrast: a noise that is less is that of rounding in a file


@dataclass(frozen=True)
class Patch(EdgeSamples):
    name: str  # for people: where the edge is
    edge: FoundEdge
    window: Matrix  # the picture about the edge, and the row and column of its first sample
    top: int
    left: int
    low_variance: float  # of a sample's noise on each side
    high_variance: float
    low: float  # levels of the sides
    high: float
    shaded: bool  # whether the sides are not level
    least_variance: float  # what rounding in the file alone makes

    @property
    def reach(self) -> float:
        return float(np.abs(self.distance).max())

    def thinned(self, most: int) -> "Patch":
        """With no more samples than that, taken evenly over their distances."""
        if len(self.value) <= most:
            return self
        order = np.argsort(self.distance, kind="stable")
        some = order[np.linspace(0, len(order) - 1, most).astype(np.intp)]
        return replace(self, **vars(self.taken(some)))


def patch_of(*, picture: Matrix, edge: FoundEdge, name: str) -> Patch | str:
    """The patch of an edge's samples; or why they are no use.

    The noise is that of the sides far from the edge, about a plane of their own. Of the rest what
    lies near the edge counts, without its ends.
    """
    samples = edge_samples(picture=picture, edge=edge)
    distance, along, value = samples.distance, samples.along, samples.value
    reach = float(np.abs(distance).max(initial=0.0))
    half = float(np.abs(along).max(initial=0.0))
    middle = np.abs(along) <= half - min(_ENDS, 2.0 * half * _END_SHARE)
    sides = [middle & (distance < -_OUTER * reach), middle & (distance > _OUTER * reach)]
    if min(int(np.count_nonzero(side)) for side in sides) < _LEAST_OUTER:
        return "too few samples on one side of the edge"
    levels, variances, shaded = [], [], False
    for side in sides:
        d, s, v = distance[side], along[side], value[side]
        plane = np.column_stack([np.ones(len(v)), d - d.mean(), s - s.mean()])
        solution, *_ = np.linalg.lstsq(plane, v, rcond=None)
        rest = v - plane @ solution
        variance = float(rest @ rest) / max(1, len(v) - 3)
        levels.append(float(solution[0]))
        variances.append(variance)
        errors = np.sqrt(variance / np.maximum((plane**2).sum(axis=0), 1e-300))
        shaded = shaded or bool(np.any(np.abs(solution[1:]) > _SHADED * errors[1:] + 1e-300))
    contrast = levels[1] - levels[0]
    if contrast <= 0.0:
        return "no contrast"
    # In a file of whole numbers a level side may have no noise at all, and rounds to one number.
    rounded = np.array_equal(value, np.rint(value))
    least = max((_FAINT * contrast) ** 2, 1.0 / 12.0 if rounded else 0.0)
    width = _width(distance, value, (levels[0], levels[1]))
    near = middle & (np.abs(distance) <= max(_LEAST_REACH, _NARROW + _WIDTHS * width))
    window, top, left = window_about(picture=picture, edge=edge)
    return Patch(
        **vars(samples.taken(near)), name=name, edge=edge, window=window, top=top, left=left,
        low_variance=max(variances[0], least), high_variance=max(variances[1], least),
        low=levels[0], high=levels[1], shaded=shaded and min(variances) > least,
        least_variance=least,
    )  # fmt: skip


def curvature(edge: FoundEdge) -> float:
    """Samples by which an edge is off its tangent, over the square of the place along it."""
    return edge.bend / (edge.length / 2.0) ** 2


def _width(distance: Vector, value: Vector, levels: tuple[float, float]) -> float:
    """Samples from a tenth to nine tenths of the step, of means over a sample's distance."""
    place = np.floor(distance).astype(np.intp)
    first = int(place.min())
    count = np.bincount(place - first)
    mean = np.bincount(place - first, value) / np.maximum(count, 1)
    share = (mean - levels[0]) / (levels[1] - levels[0])
    inside = np.flatnonzero((share > 0.1) & (share < 0.9) & (count > 0))
    return float(inside[-1] - inside[0] + 1) if len(inside) else 1.0


# All edges, with spreads of their own.

LEAST_PERIOD = 128  # samples
_REACHES = 8  # of an edge's reach in a period, at least
HIGHEST = 16  # cycles per sample, beyond which nothing counts
_LEAST_HIGHEST = 8  # cycles per sample: a table's steps are half of its inverse

_PASSES = 12
_SETTLED = 1e-4  # samples: what that leaves of the residuals is of second order
_MOST_MOVE = 0.5  # samples in one pass
_MOST_AWAY = 0.4  # of the reach
_OWN, _LINEAR, _SIDES = 3, 4, 2  # place, turn and bend; levels and slopes; slopes of each side
_LEVEL = 0.005  # of the step: what is nearer to a level counts as that
_LEAST_LEVEL = 50  # samples of a side, of which its noise is taken
_RIDGE = 1e-12
# After the first: at a frequency that the chain passes to a share t, (1 − t)³ is left, and of what
# comes back into the edge at most a tenth; further ones raise noise for little.
_PASSES_BEYOND = 2
_IN_PERIOD = 0.45  # of a spread's period, to which its table is used


@dataclass(frozen=True)
class SpreadTable:
    period: int  # samples from the first distance, −period/2, to where the table begins anew
    spread: NDArray[np.float64]  # ESF, from 0 to 1, and its derivative; shape (edges, distances)
    slope: NDArray[np.float64]

    def at(self, number: int, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Spread of one edge at distances in any shape, by straight lines between the table's."""
        count = self.spread.shape[1]
        place = distance.ravel() * (count / self.period) + 0.5 * count
        values = np.interp(place, np.arange(count), self.spread[number])
        return np.asarray(values.reshape(distance.shape), np.float64)

    def at_all(self, distance: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Spread and slope at any distances, a row for each edge, by cubic Hermite polynomials."""
        edges, count = self.spread.shape
        step = self.period / count
        place = distance * (1.0 / step) + 0.5 * count
        below = place.astype(np.intp)
        np.clip(below, 0, count - 2, out=below)
        t = place - below
        below += np.arange(edges)[:, np.newaxis] * count
        spread, slopes = self.spread.ravel(), self.slope.ravel() * step
        f0, f1, g0, g1 = spread[below], spread[below + 1], slopes[below], slopes[below + 1]
        rise = f1 - f0
        a, b = g0 + g1 - 2.0 * rise, 3.0 * rise - 2.0 * g0 - g1
        value = f0 + t * (g0 + t * (b + t * a))
        slope = (g0 + t * (2.0 * b + t * 3.0 * a)) / step
        return value, slope


def period_for(*, reach: float) -> int:
    """Samples of a period for edges of that reach: a power of 2."""
    return max(LEAST_PERIOD, 1 << math.ceil(math.log2(_REACHES * max(reach, 1.0))))


def frequencies(*, period: int, first: int, end: int) -> Vector:
    """From `first` to below `end`, cycles per sample, as a period has them."""
    return np.asarray(np.arange(first * period, end * period) / period, np.float64)


def spread_table(*, transfer: Complex, period: int) -> SpreadTable:
    """Sum up the spreads of ideal straight edges, from transfer functions along their normals.

    ESF(d) = 1/2 + ∫ H(f)·exp(2πifd) / (2πif) df (Goodman 2005, Fourier Optics, section 2): the
    integral becomes a sum over a period much longer than the edge's reach, so that what
    neighbouring steps of the period leave is next to nothing, and the sum one transform. `transfer`
    is H at `frequencies` from 0 on, 1 at zero frequency, shape (edges, frequencies); the table has
    steps of 1/16 of a sample or finer.
    """
    edges, given = transfer.shape
    highest = max(_LEAST_HIGHEST, -(-given // period))
    count = 2 * highest * period
    frequency = np.arange(1, given) / period
    distance = (np.arange(count) - count // 2) * (period / count)
    # From −period/2 on: each wave has turned by half a turn a cycle more.
    turned = np.where(np.arange(given) % 2 == 0, 1.0, -1.0)
    lines = np.zeros((edges, count // 2 + 1), np.complex128)
    lines[:, :given] = transfer * turned
    slope = kernels.irfft(lines, count, axis=1) * (count / period)
    lines[:, 0] = 0.0
    lines[:, 1:given] /= 2j * math.pi * frequency
    waves = kernels.irfft(lines, count, axis=1) * (count / period)
    spread = 0.5 + distance / period * transfer[:, :1].real + waves
    return SpreadTable(period, spread, slope)


@dataclass(frozen=True)
class EdgesAt:
    """All edges fitted with given spreads; a row of each array for an edge."""

    residual: Matrix  # samples less the model, in standard deviations of their noise
    model: Matrix  # in the picture's unit
    weight: Matrix  # inverse standard deviation of each sample; 0 where there is none
    distance: Matrix  # from the edge as fitted
    spread: Matrix  # there, from 0 to 1
    levels: Matrix  # low level, step, and inclines of each edge
    own: Matrix  # place (samples), turn and bend (samples at the ends) of each edge
    columns: NDArray[np.float64]  # what edges' own parameters do to the samples
    gram: NDArray[np.float64]

    @property
    def step(self) -> Vector:
        return np.asarray(self.levels[:, 1], np.float64)

    @property
    def cost(self) -> float:
        return float(np.vdot(self.residual, self.residual))

    def profile(self, row: int, patch: Patch) -> tuple[Vector, Vector, Vector]:
        """Of an edge's samples: distance, the chain's spread there, and what they are beside it.

        The last two from 0 to 1, as the step.
        """
        own = np.s_[row, : len(patch.value)]
        with np.errstate(all="ignore"):
            rest = self.residual[own] / self.weight[own] / self.step[row]
        return self.distance[own], self.spread[own], rest

    def without_own(self, change: Matrix) -> Matrix:
        """A change of the weighted samples less what edges' own parameters can undo."""
        along = np.matmul(self.columns, change[..., np.newaxis])
        factors = np.linalg.solve(self.gram, along)
        undone = np.matmul(np.swapaxes(self.columns, 1, 2), factors)[..., 0]
        return np.asarray(change - undone, np.float64)


class EdgeFits:
    """Patches together; each begins from where it was last."""

    def __init__(self, patches: Sequence[Patch]) -> None:
        self.patches = tuple(patches)
        longest = max(len(patch.value) for patch in patches)

        def rows(arrays: Sequence[Vector]) -> Matrix:
            made = np.zeros((len(arrays), longest))
            for row, array in zip(made, arrays, strict=True):
                row[: len(array)] = array
            return made

        self._inside = rows([np.ones(len(patch.value)) for patch in patches])
        self._distance = rows([patch.distance for patch in patches])
        self._seen = self._value = rows([patch.value for patch in patches])
        reach = np.array([patch.reach for patch in patches])[:, np.newaxis]
        half = np.array([np.abs(patch.along).max() or 1.0 for patch in patches])[:, np.newaxis]
        along = rows([patch.along for patch in patches]) / half
        self._moves = np.stack([np.ones_like(along), along, along**2 - 1.0 / 3.0], axis=1)
        self._slope = self._distance / reach
        self._limit = _MOST_AWAY * reach
        self._shaded = np.array([float(patch.shaded) for patch in patches])[:, np.newaxis]
        self._own = np.zeros((len(patches), _OWN))
        self._step = np.array([patch.high - patch.low for patch in patches])
        self._variances = np.array([(p.low_variance, p.high_variance) for p in patches])
        self._frozen: Matrix | None = None

    def at(self, table: SpreadTable) -> EdgesAt:
        own, step = self._own, self._step
        for last in range(_PASSES, -1, -1):
            moved = np.matmul(own[:, np.newaxis, :], self._moves)[:, 0]
            distance = self._distance - moved
            spread, slope = table.at_all(distance)
            weight = self._weight(spread)
            columns = self._columns(spread, slope) * weight[:, np.newaxis, :]
            value = self._value * weight
            solution, gram, length = _least_squares(columns, value)
            change = np.clip(solution[:, -_OWN:] / -step[:, np.newaxis], -_MOST_MOVE, _MOST_MOVE)
            change = np.where(np.isfinite(change), change, 0.0)
            if not last or float(np.abs(change).max()) < _SETTLED:
                break
            own = np.clip(own + change, -self._limit, self._limit)
            step = np.where(solution[:, 1] == 0.0, step, solution[:, 1])
        levels, *_ = _least_squares(columns[:, :-_OWN], value)
        self._own, self._step = own, np.where(levels[:, 1] == 0.0, step, levels[:, 1])
        fitted = np.matmul(levels[:, np.newaxis, :], columns[:, :-_OWN])[:, 0]
        with np.errstate(all="ignore"):
            model = np.where(weight > 0.0, fitted / weight, 0.0)
        columns = columns / length[..., np.newaxis]
        return EdgesAt(value - fitted, model, weight, distance, spread, levels, own, columns, gram)

    def derivative(self, fitted: EdgesAt, other: SpreadTable) -> Vector:
        after, _ = other.at_all(fitted.distance)
        change = (fitted.spread - after) * fitted.weight * fitted.step[:, np.newaxis]
        return fitted.without_own(change).ravel()

    def leave_out(self, beyond: Sequence[Vector], weight: Matrix) -> float:
        """Take from each edge's samples what is not of the edge.

        Returns the sum of squares, with these weights, by which that differs from what was left
        out before.
        """
        before, self._value = self._value, self._seen.copy()
        for row, array in zip(self._value, beyond, strict=True):
            row[: len(array)] -= array
        return float(np.sum(((self._value - before) * weight) ** 2))

    def freeze(self, fitted: EdgesAt) -> None:
        """Take the noise of the residuals on the level sides, and weights that stay."""
        with np.errstate(all="ignore"):
            left = np.where(fitted.weight > 0.0, fitted.residual / fitted.weight, 0.0)
        variances = self._variances.copy()
        sides = (fitted.spread < _LEVEL, fitted.spread > 1.0 - _LEVEL)
        for number, patch in enumerate(self.patches):
            inside = self._inside[number] > 0.0
            for place, side in enumerate(sides):
                far = left[number][side[number] & inside]
                if len(far) >= _LEAST_LEVEL:
                    seen = float(far @ far) / (len(far) - _LINEAR / 2.0)
                    variances[number, place] = max(seen, patch.least_variance)
        self._variances, self._frozen = variances, None
        self._frozen = self._weight(fitted.spread)

    @property
    def degrees(self) -> int:
        own = (_OWN + _LINEAR + (_SIDES if patch.shaded else 0) for patch in self.patches)
        return sum(len(patch.value) for patch in self.patches) - sum(own)

    def _columns(self, spread: Matrix, slope: Matrix) -> NDArray[np.float64]:
        moves, incline = self._moves, self._slope
        along = moves[:, 1]
        shaded = self._shaded * spread
        return np.stack(
            [
                moves[:, 0], spread, incline, along, shaded * incline, shaded * along,
                slope, slope * along, slope * moves[:, 2],
            ],
            axis=1,
        )  # fmt: skip

    def _weight(self, spread: Matrix) -> Matrix:
        if self._frozen is not None:
            return self._frozen
        low, high = self._variances[:, :1], self._variances[:, 1:]
        variance = low + (high - low) * np.clip(spread, 0.0, 1.0)
        return np.asarray(self._inside / np.sqrt(variance), np.float64)


def _least_squares(
    columns: NDArray[np.float64], value: Matrix
) -> tuple[Matrix, NDArray[np.float64], Matrix]:
    """Factors of the columns for each edge; products of columns of length 1; their lengths."""
    length = np.sqrt(np.einsum("ekn,ekn->ek", columns, columns)) + 1e-300
    scaled = columns / length[..., np.newaxis]
    gram = np.matmul(scaled, np.swapaxes(scaled, 1, 2))
    index = np.arange(gram.shape[1])
    gram[:, index, index] += _RIDGE  # columns that are alike share; those of nothing get nothing
    products = np.matmul(scaled, value[..., np.newaxis])
    solution = np.linalg.solve(gram, products)[..., 0] / length
    return solution, gram, length


def reaching_in(
    *, patch: Patch, edges: EdgesAt, number: int, table: SpreadTable, spread: Matrix
) -> Vector:
    """What lies beyond an edge and reaches into its samples, in their order, through the spread.

    The scene's difference from the ideal edge, alone and endless, is sought by the method of
    Landweber (1951), with no difference where the edge's samples are. What of it the chain spreads
    into them is no part of the edge. `spread` is what a point leaves in the samples about it.
    """
    inside = patch.row - patch.top, patch.column - patch.left
    beside = patch.window - _alone(patch, edges, number, table)

    about = np.zeros(beside.shape)
    about[: spread.shape[0], : spread.shape[1]] = spread
    transfer = kernels.rfft2(np.roll(about, (-MARGIN, -MARGIN), (0, 1)))

    def seen(scene: Matrix) -> Matrix:
        lines = kernels.rfft2(scene) * transfer
        return np.asarray(kernels.irfft2(lines, scene.shape), np.float64)

    scene = beside.copy()
    scene[inside] = 0.0
    for _ in range(_PASSES_BEYOND):
        more = beside - seen(scene)
        more[inside] = 0.0
        scene += more
    return seen(scene)[inside]


def _alone(patch: Patch, edges: EdgesAt, number: int, table: SpreadTable) -> Matrix:
    """The edge as fitted, alone and endless, over the window."""
    rows, columns = patch.window.shape
    x = np.arange(patch.left, patch.left + columns) - patch.edge.x
    y = (np.arange(patch.top, patch.top + rows) - patch.edge.y)[:, np.newaxis]
    across, down = patch.edge.normal
    half = float(np.abs(patch.along).max()) or 1.0
    along = np.clip((across * y - down * x) / half, -1.0, 1.0)
    distance = across * x + down * y - curvature(patch.edge) * (along * half) ** 2
    incline = np.clip(distance / patch.reach, -1.0, 1.0)
    place, turn, bend = edges.own[number]
    distance = distance - place - turn * along - bend * (along**2 - 1.0 / 3.0)
    limit = _IN_PERIOD * table.period
    spread = table.at(number, np.clip(distance, -limit, limit))
    low, step, slope, tilt, *shaded = edges.levels[number]
    model = low + step * spread + slope * incline + tilt * along
    if patch.shaded:
        model += spread * (shaded[0] * incline + shaded[1] * along)
    return np.asarray(model, np.float64)
