"""Which blocks of a picture show noise alone, and the variance of the noise over the level.

Flat is a block whose coarse waves carry no more than the noise of its level; where noise differs
from place to place, no more than its own finest waves, and that choice's bias is taken off.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Mask, Matrix, Vector
from core.kernels import special
from core.records import dataclass, replace

# Noise variance over level: a straight line through blocks, its gain and its read noise.
#
# Shot noise adds an electron of variance for each electron: σ² = σ_read² + (level − offset)/K in
# digital numbers, K electrons of one.

_LINE_ROUNDS = 6
_SURE = 0.04  # standard error over slope
_LEAST = 0.05  # of the mean variance, below which no level counts for more


@dataclass(frozen=True)
class VarianceLine:
    """Variance = `middle` + `slope` · (level − `centre`), and the covariance of both."""

    centre: float  # mean level of the blocks, by weight
    # variance there, and by how much it rises with the level
    middle: float
    slope: float
    # standard errors, from the scatter of the blocks themselves
    middle_error: float
    slope_error: float
    covariance: float

    def at(self, level: float) -> tuple[float, float]:
        """Variance at a level, and its standard error."""
        away = level - self.centre
        variance = (
            self.middle_error**2 + 2.0 * away * self.covariance + (away * self.slope_error) ** 2
        )
        return self.middle + self.slope * away, math.sqrt(max(variance, 0.0))

    def doubted(self, *, level: Vector, left: Vector) -> "VarianceLine":
        """The line, with what may be left of structure in the variance of the blocks it is of.

        `left` is one standard error, of all blocks together: few blocks with structure, at levels
        that the line leans on, make its slope uncertain more than its middle.
        """
        weight = 1.0 / self.over(level) ** 2
        away = level - self.centre
        middle = float(weight @ left / weight.sum())
        spread = float(weight @ (away * away))
        slope = float(weight @ (away * left)) / spread if spread > 0.0 else 0.0
        return self._widened(middle, slope, middle * slope)

    def rounded(self, *, level: Vector, step: float) -> "VarianceLine":
        """The line, with what rounding adds beyond 1/12 of its step's square.

        Of normal noise of s steps it is up to (4 s² + 1/π²) · exp(−2π² s²) squares of a step, by a
        cosine of where between two steps the level lies (Widrow and Kollár 2008).
        """
        weight = 1.0 / self.over(level) ** 2
        away = level - self.centre
        noise = np.maximum(self.over(level) / step**2 - 1.0 / 12.0, 0.0)
        wave = step**2 * (4.0 * noise + 1.0 / math.pi**2) * np.exp(-2.0 * math.pi**2 * noise)
        # The areas of a picture have few levels: that of one is that of all its blocks.
        total, spread = 2.0 * float(weight.sum()), float(weight @ (away * away))
        middle = math.sqrt(float(weight @ wave**2) / total)
        slope = middle / math.sqrt(2.0 * spread / total) if spread > 0.0 else 0.0
        return self._widened(middle, slope, 0.0)

    def _widened(self, middle: float, slope: float, both: float) -> "VarianceLine":
        """The line, with further errors of its two numbers, and their covariance."""
        return replace(
            self,
            middle_error=math.hypot(self.middle_error, middle),
            slope_error=math.hypot(self.slope_error, slope),
            covariance=self.covariance + both,
        )

    def bounded(self, offset: float) -> "VarianceLine":
        """The line with what physics knows of its slope, for levels it was not measured at.

        From none to all of the variance is shot noise of the light above `offset`. A slope that is
        known well stays as it is.
        """
        light = self.centre - offset
        sure = self.slope_error <= _SURE * abs(self.slope)
        if light <= 0.0 or self.slope_error <= 0.0 or sure:
            return self
        half = 0.5 * self.middle / light
        weights = 1.0 / self.slope_error**2, 1.0 / half**2
        slope = (self.slope * weights[0] + half * weights[1]) / sum(weights)
        # A few blocks with structure, brighter than the others, make it steeper than light can.
        slope = min(max(slope, 0.0), 2.0 * half)
        share = weights[0] / sum(weights)
        error = math.sqrt(1.0 / sum(weights))
        return replace(self, slope=slope, slope_error=error, covariance=share * self.covariance)

    def over(self, level: Vector) -> Vector:
        """Variance at levels, never below a small share of the mean."""
        return np.maximum(self.middle + self.slope * (level - self.centre), _LEAST * self.middle)


def variance_line(*, level: Vector, variance: Vector) -> VarianceLine:
    """Fit the line to the variance of blocks.

    Notes
    -----
    Weights are those of normal noise of the line's own variance, iterated (a weight from a block's
    own estimate would favour those that came out low). The errors are those that hold whatever the
    blocks' scatter (White 1980; MacKinnon and White 1985, HC3).
    """
    mean = float(variance.mean())
    if not mean > 0.0:
        return VarianceLine(float(level.mean()), 0.0, 0.0, 0.0, 0.0, 0.0)
    model = np.full(len(level), mean)
    for _ in range(_LINE_ROUNDS):
        weight = 1.0 / model**2
        total = weight.sum()
        centre = float(weight @ level / total)
        away = level - centre
        spread = float(weight @ (away * away))
        middle = float(weight @ variance / total)
        slope = float(weight @ (away * variance)) / spread if spread > 0.0 else 0.0
        line = middle + slope * away
        model = np.maximum(line, _LEAST * mean)
    # A block that the line leans on lies nearer to it than to the truth.
    lever = weight / total + (weight * away * away / spread if spread > 0.0 else 0.0)
    off = weight * (variance - line) / np.maximum(1.0 - lever, _LEAST)
    middle_error = math.sqrt(float(off @ off)) / total
    turned = off * away
    slope_error = covariance = 0.0
    if spread > 0.0:
        slope_error = math.sqrt(float(turned @ turned)) / spread
        covariance = float(off @ turned) / (total * spread)
    return VarianceLine(centre, middle, slope, middle_error, slope_error, covariance)


# A picture in blocks of 8 × 8 samples: the level of a block, and its power by frequency.
#
# White noise has the same variance in all coefficients of an orthonormal cosine transform, and
# those of normal noise are independent. So the blocks can be chosen by some coefficients, and the
# noise measured in others: the choice leaves no bias (Ponomarenko et al. 2007).


SIDE = 8
_STRIP = 64  # rows of blocks at a time
_ORDER = np.arange(SIDE)
_DOWN, _ACROSS = (order.ravel() for order in np.meshgrid(_ORDER, _ORDER, indexing="ij"))
_BOTH = (_DOWN > 0) & (_ACROSS > 0)  # neither a row's nor a column's own offset
FINE = (_DOWN >= SIDE // 2) & (_ACROSS >= SIDE // 2)  # where the scene's power is least
COARSE = _BOTH & (_DOWN + _ACROSS >= 3) & (_DOWN + _ACROSS <= 6)
MIDDLE = _BOTH & (_DOWN + _ACROSS >= 7) & ~FINE
MIDDLE_DOWN = MIDDLE & (_DOWN > _ACROSS)  # as many as the others, those finer across
_WAVES_DOWN = (_ACROSS == 0) & (_DOWN >= 1)
_WAVES_ACROSS = (_DOWN == 0) & (_ACROSS >= 1)
_FINE, _COARSE, _MIDDLE = (int(waves.sum()) for waves in (FINE, COARSE, MIDDLE))
WAVES = SIDE - 2  # of rows or columns; the first one is mostly shading


@dataclass(frozen=True)
class PictureBlocks:
    """Blocks without bad samples, in the order of the picture's rows."""

    level: Vector  # mean of the samples, shape (blocks,)
    # squares of the coefficients, by frequency down and across; the first is 0, shape (blocks, 64)
    power: NDArray[np.float32]
    # coefficients of the waves down, and across, with their signs, less a ramp through the block,
    # shape (blocks, 6)
    rows: NDArray[np.float32]
    columns: NDArray[np.float32]
    # which block of the picture: row of blocks times blocks in a row, plus column, shape (blocks,)
    place: NDArray[np.intp]
    grid: tuple[int, int]  # rows and columns of blocks of the picture

    def mean_power(self, coefficients: Mask) -> Vector:
        """Mean square of these coefficients of a block."""
        chosen = np.flatnonzero(coefficients)
        weight = np.zeros(SIDE * SIDE, np.float32)
        weight[chosen] = 1.0 / len(chosen)
        return np.asarray(self.power @ weight, np.float64)


def picture_blocks(
    *, picture: Matrix, good: Mask | None = None, check: Callable[[], None] = lambda: None
) -> PictureBlocks:
    """Level and power of the blocks whose samples are all good.

    What is left of whole blocks at the right and below is not looked at.
    """
    grid = picture.shape[0] // SIDE, picture.shape[1] // SIDE
    one = _cosines()
    # Of a whole block, to be multiplied from the right.
    transform = np.kron(one, one).T.astype(np.float32)
    level, power, rows, columns, place = [], [], [], [], []
    for first in range(0, max(grid[0], 1), _STRIP):
        check()
        last = min(first + _STRIP, grid[0])
        samples = _in_blocks(picture, first, last, grid[1])
        at = np.arange(first * grid[1], last * grid[1])
        if good is not None:
            whole = _in_blocks(good, first, last, grid[1]).all(axis=1)
            samples, at = samples[whole], at[whole]
        mean = samples.mean(axis=1)
        residual = (samples - mean[:, np.newaxis]).astype(np.float32)
        coefficients = residual @ transform
        rows.append(_level_waves(coefficients[:, _WAVES_DOWN]))
        columns.append(_level_waves(coefficients[:, _WAVES_ACROSS]))
        level.append(mean)
        power.append(np.square(coefficients, out=coefficients))
        place.append(at)
    return PictureBlocks(
        np.concatenate(level), np.concatenate(power), np.concatenate(rows),
        np.concatenate(columns), np.concatenate(place), grid,
    )  # fmt: skip


def _in_blocks(picture: NDArray[Any], first: int, last: int, across: int) -> NDArray[Any]:
    """Rows of blocks, samples of a block in a row."""
    strip = picture[first * SIDE : last * SIDE, : across * SIDE]
    blocks = strip.reshape(last - first, SIDE, across, SIDE).transpose(0, 2, 1, 3)
    return blocks.reshape(-1, SIDE * SIDE)


def _level_waves(waves: NDArray[np.float32]) -> NDArray[np.float32]:
    """Waves from the second on, less those of the ramp that the first one shows."""
    ramp = (_cosines()[1:] @ (_ORDER - _ORDER.mean())).astype(np.float32)
    return np.asarray(waves[:, 1:] - waves[:, :1] * (ramp[1:] / ramp[0]), np.float32)


def _cosines() -> Matrix:
    """The waves of a line of samples (type II), orthonormal."""
    angle = math.pi * np.outer(_ORDER, _ORDER + 0.5) / SIDE
    one = math.sqrt(2.0 / SIDE) * np.cos(angle)
    one[0] = math.sqrt(1.0 / SIDE)
    return one


# How much of the power of blocks is structure, and which waves show the noise best.
#
# White noise has equal power in all waves; what a scene leaves after the optics falls with the
# frequency. What coarse waves have more than the others shows how much structure there is; how it
# falls from there is known of scenes in general, with an error. Middle and fine waves are weighted
# by what they are worth: by their own scatter and by that error, which both share.


# Power of structure in middle and in fine waves over what the coarse ones show of it: means and
# covariance of 1/f² texture, discs, bars and polygons behind random optics. Wide, since structure
# of a few strong blocks shows less in the coarse waves, by which they were chosen.
_FALL = 0.11, 0.037
_MIDDLE_SPREAD, _FINE_SPREAD, _SHARED = 0.12, 0.05, 0.97
_BOTH_SPREAD = _SHARED * _MIDDLE_SPREAD * _FINE_SPREAD
_FALL_COVARIANCE = np.array([[_MIDDLE_SPREAD**2, _BOTH_SPREAD], [_BOTH_SPREAD, _FINE_SPREAD**2]])
FINE_DOUBT = math.hypot(_FALL[1], _FINE_SPREAD)  # where none is taken off
_STEP = 0.02  # of structure, by which the slope of the truncated mean is taken
_NARROWEST, _WIDEST = 0.3, 8.0


@dataclass(frozen=True)
class StructureShare:
    """Power of structure over that of noise, and what to take for the noise of a block."""

    # structure in the coarse waves before the choice cut them, and its standard error by chance
    coarse: float
    coarse_error: float
    weight: float  # of the middle waves in a block's variance; the fine ones have the rest
    removal: float  # of a block's coarse excess over its variance, what is taken off the variance
    # by how much the chosen blocks' coarse power, over that of noise alone, rises with structure
    shown: float
    # standard error of what is left in the variance, over the structure in the coarse waves
    doubt: float
    # excess of the middle waves over the fine ones, and its standard error
    middle: float
    middle_error: float

    def parted(self, waves: "_Waves", cut: float) -> tuple[Vector, Vector]:
        """Variance of blocks, from the mean power of their waves, and what may be left in it.

        All together that is one standard error too much. `cut` is the mean of the chosen blocks'
        coarse power, over the noise's, of noise alone.
        """
        power = self.weight * waves.middle + (1.0 - self.weight) * waves.fine
        more = waves.coarse / cut - power
        return power - self.removal * more, self.doubt / self.shown * more


def structure_share(
    *, coarse: Vector, middle: Vector, fine: Vector, limit: float
) -> StructureShare:
    """Power of structure in blocks that were chosen by their coarse power.

    Parameters
    ----------
    coarse, middle, fine : ndarray, shape (blocks,)
        Mean power of the waves over the variance of the noise at the block's level.
    limit : float
        Largest coarse power that was chosen.

    Generalized least squares: middle and fine power are the noise's plus structure of the fall that
    scenes have in the mean; their errors are those of χ² and the fall's, by the structure's square.
    No test decides which waves are used, as that would choose by how the noise came out. What is
    taken off shrinks by its own chance, as of an amplitude whose variance is measured too.
    """
    many = len(fine)
    level = float(middle.mean()) * _MIDDLE + float(fine.mean()) * _FINE
    level /= _MIDDLE + _FINE
    excess = float(middle.mean() / fine.mean()) - 1.0
    error = float(np.std(middle - (1.0 + excess) * fine)) / (math.sqrt(many) * level)
    mean, limit = float(coarse.mean()) / level, limit / level
    seen = _width(mean, limit) - 1.0
    cut = mean_below(limit)
    slope = (_mean_of(1.0 + _STEP, limit) / cut - 1.0) / _STEP
    chance = float(coarse.std()) / (math.sqrt(many) * level * cut * slope)
    share = seen**2 / (seen**2 + chance**2) if seen > 0.0 else 0.0
    own = np.diag([2.0 / (many * _MIDDLE), 2.0 / (many * _FINE)])
    square = share * (share * seen**2 + chance**2)
    weights = np.linalg.solve(own + square * _FALL_COVARIANCE, np.ones(2))
    weights /= weights.sum()
    fall = float(weights @ _FALL)
    doubt = math.hypot(math.sqrt(float(weights @ _FALL_COVARIANCE @ weights)), (1.0 - share) * fall)
    known = max(seen, _STEP)
    shown = (_mean_of(1.0 + known, limit) / cut - 1.0) / known
    removal = share * fall / (shown - fall)
    return StructureShare(seen, chance, float(weights[0]), removal, shown, doubt, excess, error)


def mean_below(limit: float) -> float:
    """Mean of the coarse waves' χ² over its degrees of freedom where it is below a limit."""
    half = _COARSE / 2.0
    below = float(special("gammainc")(half, limit * half))
    return float(special("gammainc")(half + 1.0, limit * half)) / below


def _mean_of(width: float, limit: float) -> float:
    """Mean below the limit where it is wider by a factor."""
    return width * mean_below(limit / width)


def _width(mean: float, limit: float) -> float:
    """Factor of one that has this mean below the limit."""
    low, high = _NARROWEST, _WIDEST
    for _ in range(50):
        middle = 0.5 * (low + high)
        if _mean_of(middle, limit) < mean:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


_SHARES = 0.98, 0.8, 0.5  # of the blocks with nothing but noise that are chosen
_QUIETEST = 0.3  # of the blocks at a level, to begin with
_BINS = 12
_LEAST_BLOCKS = 8
_ROUNDS = 12
_UNEVEN = 1.25  # scatter of blocks beyond which the noise is not of one kind
_LOUDER_SHARE, _MANY_LOUDER = 0.8, 0.3  # of the louder blocks that are seen; of the chosen
_NEIGHBOURS, _LEAST_USUAL = 16, 0.4  # on either side in level; of those that noise alone leaves
_FROM_END = 5.0  # deviations from a clipped end within which noise is cut


@dataclass(frozen=True)
class FlatBlocks:
    """The choice, and the noise in it."""

    chosen: Mask  # blocks of noise alone, shape (blocks,)
    # of each block, chosen or not, less what its coarse power lets expect of structure, shape
    # (blocks,)
    variance: Vector
    line: VarianceLine  # variance over the level of the chosen
    structure: StructureShare  # what of the power is no noise
    # by how much middle waves that are finer down have more power than those finer across, over
    # that of the fine ones, and its standard error: 0 of white noise
    lean: float
    lean_error: float
    even: bool  # whether the noise is of one kind, but for the level

    def mean(self) -> tuple[float, float]:
        """Mean variance of the chosen blocks where it differs among them, and its standard error.

        Each is of its own place: how they differ is no error, how χ² scatters is.
        """
        variance = self.variance[self.chosen]
        mean, many = float(variance.mean()), len(variance)
        chance = math.sqrt(2.0 / (_FINE + 2.0) * float(np.mean(variance**2)) / many)
        return mean, math.hypot(chance, self.structure.doubt * self.structure.coarse * mean)


@dataclass(frozen=True)
class _Waves:
    """Level of blocks, power of their waves, the least variance that shows, the clipped ends."""

    level: Vector
    coarse: Vector
    middle: Vector
    middle_down: Vector
    fine: Vector
    least: float
    low: float | None
    high: float | None

    def clear(self, variance: Vector) -> Mask:
        return clear_of_ends(level=self.level, variance=variance, low=self.low, high=self.high)

    def usual(self, chosen: Mask, least: float) -> Mask:
        """The chosen blocks of whose neighbours in level at least this share is chosen.

        Where most blocks of a level have structure, the few that seem to have none have a little:
        they are the ends of edges, and at levels of their own, on which a line leans.
        """
        order = np.argsort(self.level)
        many = np.concatenate(([0], np.cumsum(chosen[order])))
        place = np.arange(len(order))
        first = np.maximum(place - _NEIGHBOURS, 0)
        last = np.minimum(place + _NEIGHBOURS + 1, len(order))
        usual = chosen.copy()
        usual[order] &= many[last] - many[first] >= least * (last - first)
        return usual


def clear_of_ends(
    *, level: Vector, variance: Vector, low: float | None, high: float | None
) -> Mask:
    """Blocks whose noise does not reach a clipped end."""
    free = np.ones(len(level), bool)
    if low is not None:
        free &= level - _FROM_END * np.sqrt(variance) > low
    if high is not None:
        free &= level + _FROM_END * np.sqrt(variance) < high
    return free


def flat_blocks(
    *,
    blocks: PictureBlocks,
    at: float,
    least: float = 0.0,
    low: float | None = None,
    high: float | None = None,
) -> FlatBlocks | None:
    """Choose the flat blocks; None where there are too few to begin with.

    The noise is to be known best `at` a level; rounding hides a variance of `least`, and samples
    are clipped at `low` and `high`. A narrower choice has fewer blocks, and less structure in them.
    Of those whose blocks scatter as noise of one kind does, the one is taken whose error, of both,
    is the least: errors do not depend on how the noise came out.
    """
    waves = _Waves(
        blocks.level,
        blocks.mean_power(COARSE),
        blocks.mean_power(MIDDLE),
        blocks.mean_power(MIDDLE_DOWN),
        blocks.mean_power(FINE),
        least,
        low,
        high,
    )
    first = best = None
    for share in _SHARES:
        even = _by_level(waves, share)
        if even is not None and _scatter(waves, even) < _UNEVEN:
            if best is None and _louder(waves, even):
                break
            if best is not None and _error(even, at) >= _error(best, at):
                return best
            best = even
        first = first or even
    return best or _by_itself(waves) or first


def _error(flat: FlatBlocks, level: float) -> float:
    variance, error = flat.line.at(level)
    return error / variance if variance > 0.0 else math.inf


def _louder(waves: _Waves, flat: FlatBlocks) -> bool:
    """Whether many blocks have noise alone, by their own fine waves, yet more than their level."""
    limit = float(special("fdtri")(_COARSE, _FINE, _LOUDER_SHARE))
    model = flat.line.over(waves.level)
    others = ~flat.chosen & waves.clear(model) & (model >= waves.least)
    many = np.count_nonzero(others & (waves.coarse <= limit * waves.fine)) / _LOUDER_SHARE
    return bool(many > _MANY_LOUDER * np.count_nonzero(flat.chosen))


def _scatter(waves: _Waves, flat: FlatBlocks) -> float:
    """Variance among the chosen blocks' fine powers over that of normal noise of their level."""
    model = flat.line.over(waves.level[flat.chosen])
    relative = waves.fine[flat.chosen] / model
    return float(np.var(relative / relative.mean())) * _FINE / 2.0


def _by_level(waves: _Waves, share: float) -> FlatBlocks | None:
    """Blocks whose coarse power is no more than that of the noise at their level."""
    chosen = _quietest(waves)
    limit = 2.0 * float(special("gammaincinv")(_COARSE / 2.0, share)) / _COARSE
    cut = mean_below(limit)
    variance = left = waves.fine
    relative = waves.level
    structure = None
    for _ in range(_ROUNDS):
        if np.count_nonzero(chosen) < _LEAST_BLOCKS:
            return None
        line = variance_line(level=waves.level[chosen], variance=variance[chosen])
        if not line.middle > 0.0:
            return None
        before, model = chosen, line.over(waves.level)
        shown = waves.clear(model) & (model >= waves.least)
        chosen = waves.usual(shown & (waves.coarse <= limit * model), _LEAST_USUAL * share)
        if np.count_nonzero(chosen) < _LEAST_BLOCKS:
            return None
        relative = model[chosen]
        structure = structure_share(
            coarse=waves.coarse[chosen] / relative,
            middle=waves.middle[chosen] / relative,
            fine=waves.fine[chosen] / relative,
            limit=limit,
        )
        variance, left = structure.parted(waves, cut)
        if np.array_equal(chosen, before):
            break
    assert structure is not None
    line = variance_line(level=waves.level[chosen], variance=variance[chosen])
    return FlatBlocks(
        chosen,
        variance,
        line.doubted(level=waves.level[chosen], left=left[chosen]),
        structure,
        *_lean(waves, chosen, relative),
        even=True,
    )


def _lean(waves: _Waves, chosen: Mask, model: Vector) -> tuple[float, float]:
    """Power of middle waves finer down less that of those finer across, over the noise's."""
    more = 2.0 * (waves.middle_down[chosen] - waves.middle[chosen]) / model
    return float(more.mean()), float(more.std()) / math.sqrt(len(more))


def _quietest(waves: _Waves) -> Mask:
    """The blocks of the least coarse power, of all levels."""
    clear = np.flatnonzero(waves.clear(waves.fine))
    chosen = np.zeros(len(waves.level), bool)
    order = clear[np.argsort(waves.level[clear])]
    for part in np.array_split(order, _BINS):
        many = math.ceil(_QUIETEST * len(part))
        if many:
            chosen[part[np.argpartition(waves.coarse[part], many - 1)[:many]]] = True
    return chosen


def _by_itself(waves: _Waves) -> FlatBlocks | None:
    """Blocks whose coarse power is no more than their own fine waves' noise explains."""
    limit = float(special("fdtri")(_COARSE, _FINE, _SHARES[0]))
    chosen = (waves.coarse <= limit * waves.fine) & (waves.fine > 0.0) & waves.clear(waves.fine)
    if np.count_nonzero(chosen) < _LEAST_BLOCKS:
        return None
    # Mean fine power of the blocks below the limit, by two more degrees of freedom.
    ratio = limit * _COARSE / _FINE
    share = ratio / (1.0 + ratio)
    cut = float(special("betainc")(_COARSE / 2.0, _FINE / 2.0 + 1.0, share)) / _SHARES[0]
    variance = waves.fine / cut
    line = variance_line(level=waves.level[chosen], variance=variance[chosen])
    # Middle waves are not chosen by, fine ones came out higher by the choice.
    mean = float(variance[chosen].mean())
    excess = float(waves.middle[chosen].mean()) / mean - 1.0
    off = waves.middle[chosen] - (1.0 + excess) * variance[chosen]
    error = float(np.std(off)) / (math.sqrt(len(off)) * mean)
    coarse = float(waves.coarse[chosen].mean()) / mean - 1.0
    structure = StructureShare(max(coarse, 0.0), 0.0, 0.0, 0.0, 1.0, FINE_DOUBT, excess, error)
    lean = _lean(waves, chosen, np.full(len(off), mean))
    return FlatBlocks(chosen, variance, line, structure, *lean, even=False)
