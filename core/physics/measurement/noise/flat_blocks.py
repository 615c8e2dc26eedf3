"""Which blocks of a picture show noise alone, and the variance of the noise over the level.

Flat is a block whose coarse waves carry no more than its noise. Where the noise is of one kind all
over, it is compared with the noise at its level, and the choice leaves the noise unbiased. Where it
differs from place to place, as a camera's own noise filter leaves it, a block is compared with its
own finest waves, and the bias of that choice is known and taken off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

from core.physics.measurement.noise.picture_blocks import (
    COARSE,
    FINE,
    MIDDLE,
    MIDDLE_DOWN,
    PictureBlocks,
)
from core.physics.measurement.noise.structure_share import (
    FINE_DOUBT,
    StructureShare,
    mean_below,
    structure_share,
)
from core.physics.measurement.noise.variance_line import VarianceLine, variance_line

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FINE, _COARSE, _MIDDLE = (int(waves.sum()) for waves in (FINE, COARSE, MIDDLE))
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
    """The choice, and the noise in it.

    Parameters
    ----------
    chosen : ndarray of bool, shape (blocks,)
        Blocks of noise alone.
    variance : ndarray, shape (blocks,)
        Of each block, chosen or not, less what its coarse power lets expect of structure.
    line : VarianceLine
        Variance over the level of the chosen.
    structure : StructureShare
        What of the power is no noise.
    lean, lean_error : float
        By how much middle waves that are finer down have more power than those finer across, over
        that of the fine ones, and its standard error: 0 of white noise.
    even : bool
        Whether the noise is of one kind, but for the level.
    """

    chosen: Mask
    variance: Vector
    line: VarianceLine
    structure: StructureShare
    lean: float
    lean_error: float
    even: bool

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
        """Blocks whose noise does not reach a clipped end."""
        reach = _FROM_END * np.sqrt(variance)
        free = np.ones(len(self.level), bool)
        if self.low is not None:
            free &= self.level - reach > self.low
        if self.high is not None:
            free &= self.level + reach < self.high
        return free

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


def flat_blocks(
    *,
    blocks: PictureBlocks,
    at: float,
    least: float = 0.0,
    low: float | None = None,
    high: float | None = None,
) -> FlatBlocks | None:
    """Choose the flat blocks; None where there are too few to begin with.

    Parameters
    ----------
    blocks
        Of the picture.
    at : float
        Level at which the noise is to be known best.
    least : float
        Variance that rounding hides.
    low, high : float, optional
        Where samples are clipped.

    Notes
    -----
    A narrower choice has fewer blocks, and less structure in them. Of those whose blocks scatter as
    noise of one kind does, the one is taken whose error, of both, is the least: errors do not
    depend on how the noise came out.
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
    """Standard error of the variance at a level, over it."""
    variance, error = flat.line.at(level)
    return error / variance if variance > 0.0 else math.inf


def _louder(waves: _Waves, flat: FlatBlocks) -> bool:
    """Whether many blocks have noise alone, by their own fine waves, yet more than their level."""
    limit = float(special.fdtri(_COARSE, _FINE, _LOUDER_SHARE))
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
    limit = 2.0 * float(special.gammaincinv(_COARSE / 2.0, share)) / _COARSE
    cut = mean_below(limit=limit, freedom=_COARSE)
    variance, relative = waves.fine, waves.level
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
            freedom=(_COARSE, _MIDDLE, _FINE),
        )
        variance = structure.variance(
            coarse=waves.coarse, middle=waves.middle, fine=waves.fine, cut=cut
        )
        if np.array_equal(chosen, before):
            break
    assert structure is not None
    line = variance_line(level=waves.level[chosen], variance=variance[chosen])
    left = structure.doubtful(coarse=waves.coarse, middle=waves.middle, fine=waves.fine, cut=cut)
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
    limit = float(special.fdtri(_COARSE, _FINE, _SHARES[0]))
    chosen = (waves.coarse <= limit * waves.fine) & (waves.fine > 0.0) & waves.clear(waves.fine)
    if np.count_nonzero(chosen) < _LEAST_BLOCKS:
        return None
    # Mean fine power of the blocks below the limit, by two more degrees of freedom.
    ratio = limit * _COARSE / _FINE
    share = ratio / (1.0 + ratio)
    cut = float(special.betainc(_COARSE / 2.0, _FINE / 2.0 + 1.0, share)) / _SHARES[0]
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
