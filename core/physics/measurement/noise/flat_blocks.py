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

from core.physics.measurement.noise.picture_blocks import COARSE, FINE, PictureBlocks
from core.physics.measurement.noise.variance_line import VarianceLine, variance_line

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]

FREEDOM = int(FINE.sum())  # of a block's variance
_COARSE = int(COARSE.sum())
_SHARE = 0.98  # of the blocks with nothing but noise that are chosen
_QUIETEST = 0.3  # of the blocks at a level, to begin with
_BINS = 12
_LEAST_IN_BIN = 8
_ROUNDS = 12
_UNEVEN = 1.25  # scatter of blocks beyond which the noise is not of one kind


@dataclass(frozen=True)
class FlatBlocks:
    """The choice, and the noise in it.

    Parameters
    ----------
    chosen : ndarray of bool, shape (blocks,)
        Blocks of noise alone.
    variance : ndarray, shape (blocks,)
        Of each block, chosen or not.
    line : VarianceLine
        Variance over the level of the chosen.
    coarse_ratio, coarse_error : float
        Power of the coarse waves of the chosen over that of the fine ones, less what the choice
        does, and its standard error: 1 of white noise.
    even : bool
        Whether the noise is of one kind, but for the level.
    """

    chosen: Mask
    variance: Vector
    line: VarianceLine
    coarse_ratio: float
    coarse_error: float
    even: bool


def flat_blocks(*, blocks: PictureBlocks) -> FlatBlocks | None:
    """Choose the flat blocks; None where there are too few to begin with."""
    fine = blocks.mean_power(FINE)
    coarse = blocks.mean_power(COARSE)
    even = _by_level(blocks.level, fine, coarse)
    if even is not None and even.line.scatter < _UNEVEN:
        return even
    return _by_itself(blocks.level, fine, coarse) or even


def _by_level(level: Vector, fine: Vector, coarse: Vector) -> FlatBlocks | None:
    """Blocks whose coarse power is no more than that of the noise at their level."""
    chosen = _quietest(level, coarse)
    if np.count_nonzero(chosen) < _LEAST_IN_BIN:
        return None
    limit = 2.0 * float(special.gammaincinv(_COARSE / 2.0, _SHARE)) / _COARSE
    line = variance_line(level=level[chosen], variance=fine[chosen], freedom=FREEDOM)
    for _ in range(_ROUNDS):
        before = chosen
        chosen = coarse <= limit * line.over(level)
        if np.count_nonzero(chosen) < _LEAST_IN_BIN:
            return None
        line = variance_line(level=level[chosen], variance=fine[chosen], freedom=FREEDOM)
        if np.array_equal(chosen, before):
            break
    # The mean of a χ² cut at its quantile.
    cut = float(special.gammainc(_COARSE / 2.0 + 1.0, limit * _COARSE / 2.0)) / _SHARE
    return _measured(level, fine, coarse, chosen, line, cut, even=True)


def _quietest(level: Vector, coarse: Vector) -> Mask:
    """The blocks of the least coarse power, of all levels."""
    chosen = np.zeros(len(level), bool)
    order = np.argsort(level)
    for part in np.array_split(order, _BINS):
        many = math.ceil(_QUIETEST * len(part))
        if many:
            chosen[part[np.argpartition(coarse[part], many - 1)[:many]]] = True
    return chosen


def _by_itself(level: Vector, fine: Vector, coarse: Vector) -> FlatBlocks | None:
    """Blocks whose coarse power is no more than their own fine waves' noise explains."""
    limit = float(special.fdtri(_COARSE, FREEDOM, _SHARE))
    chosen = (coarse <= limit * fine) & (fine > 0.0)
    if np.count_nonzero(chosen) < _LEAST_IN_BIN:
        return None
    # Mean of the fine, and of the coarse, power of the blocks below the limit, by two more degrees.
    ratio = limit * _COARSE / FREEDOM
    share = ratio / (1.0 + ratio)
    fine_cut = float(special.betainc(_COARSE / 2.0, FREEDOM / 2.0 + 1.0, share)) / _SHARE
    coarse_cut = float(special.betainc(_COARSE / 2.0 + 1.0, FREEDOM / 2.0, share)) / _SHARE
    variance = fine / fine_cut
    line = variance_line(level=level[chosen], variance=variance[chosen], freedom=FREEDOM)
    cut = coarse_cut / fine_cut
    return _measured(level, variance, coarse / fine_cut, chosen, line, cut, even=False)


def _measured(
    level: Vector,
    fine: Vector,
    coarse: Vector,
    chosen: Mask,
    line: VarianceLine,
    cut: float,
    *,
    even: bool,
) -> FlatBlocks:
    """The ratio of coarse and fine power, at levels alike."""
    many = int(np.count_nonzero(chosen))
    model = line.over(level[chosen])
    up, down = coarse[chosen] / model / cut, fine[chosen] / model
    ratio = float(up.mean() / down.mean()) if down.any() else 1.0
    error = float(np.std(up - ratio * down)) / math.sqrt(many) if many > 1 else math.inf
    return FlatBlocks(chosen, fine, line, ratio, error, even)
