"""How much of the power of blocks is structure, and which waves show the noise best.

White noise has equal power in all waves; what a scene leaves after the optics falls with the
frequency. What coarse waves have more than the others shows how much structure there is; how it
falls from there is known of scenes in general, with an error. Middle and fine waves are weighted by
what they are worth: by their own scatter and by that error, which both share.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

# Power of structure in middle and in fine waves over what the coarse ones show of it: means and
# covariance of 1/f² texture, discs, bars and polygons behind random optics. Wide, since structure
# of a few strong blocks shows less in the coarse waves, by which they were chosen.
_FALL = 0.11, 0.037
_MIDDLE_SPREAD, _FINE_SPREAD, _SHARED = 0.12, 0.05, 0.97
FINE_DOUBT = math.hypot(_FALL[1], _FINE_SPREAD)  # where none is taken off
_STEP = 0.02  # of structure, by which the slope of the truncated mean is taken
_NARROWEST, _WIDEST = 0.3, 8.0


@dataclass(frozen=True)
class StructureShare:
    """Power of structure over that of noise, and what to take for the noise of a block.

    Parameters
    ----------
    coarse, coarse_error : float
        Structure in the coarse waves before the choice cut them, and its standard error by chance.
    weight : float
        Of the middle waves in a block's variance; the fine ones have the rest.
    removal : float
        Of a block's coarse excess over its variance, what is taken off the variance.
    shown : float
        By how much the chosen blocks' coarse power, over that of noise alone, rises with structure.
    doubt : float
        Standard error of what is left in the variance, over the structure in the coarse waves.
    middle, middle_error : float
        Excess of the middle waves over the fine ones, and its standard error.
    """

    coarse: float
    coarse_error: float
    weight: float
    removal: float
    shown: float
    doubt: float
    middle: float
    middle_error: float

    def variance(self, *, coarse: Vector, middle: Vector, fine: Vector, cut: float) -> Vector:
        """Of blocks, from the mean power of their waves.

        `cut` is the mean of the chosen blocks' coarse power, over the noise's, of noise alone.
        """
        power = self.weight * middle + (1.0 - self.weight) * fine
        return np.asarray(power - self.removal * (coarse / cut - power), np.float64)

    def doubtful(self, *, coarse: Vector, middle: Vector, fine: Vector, cut: float) -> Vector:
        """What may be left in the blocks' variances, all together one standard error too much."""
        power = self.weight * middle + (1.0 - self.weight) * fine
        return np.asarray(self.doubt / self.shown * (coarse / cut - power), np.float64)


def structure_share(
    *, coarse: Vector, middle: Vector, fine: Vector, limit: float, freedom: tuple[int, int, int]
) -> StructureShare:
    """Power of structure in blocks that were chosen by their coarse power.

    Parameters
    ----------
    coarse, middle, fine : ndarray, shape (blocks,)
        Mean power of the waves over the variance of the noise at the block's level.
    limit : float
        Largest coarse power that was chosen.
    freedom : tuple of int
        Numbers of coarse, middle and fine waves.

    Notes
    -----
    Generalized least squares: middle and fine power are the noise's plus structure of the fall that
    scenes have in the mean; their errors are those of χ² and the fall's, by the structure's square.
    No test decides which waves are used, as that would choose by how the noise came out. What is
    taken off shrinks by its own chance, as of an amplitude whose variance is measured too.
    """
    many = len(fine)
    level = float(middle.mean()) * freedom[1] + float(fine.mean()) * freedom[2]
    level /= freedom[1] + freedom[2]
    excess = float(middle.mean() / fine.mean()) - 1.0
    error = float(np.std(middle - (1.0 + excess) * fine)) / (math.sqrt(many) * level)
    mean, limit = float(coarse.mean()) / level, limit / level
    seen = _width(mean, limit, freedom[0]) - 1.0
    cut = mean_below(limit=limit, freedom=freedom[0])
    slope = (_mean_of(1.0 + _STEP, limit, freedom[0]) / cut - 1.0) / _STEP
    chance = float(coarse.std()) / (math.sqrt(many) * level * cut * slope)
    share = seen**2 / (seen**2 + chance**2) if seen > 0.0 else 0.0
    covariance = _fall_covariance()
    own = np.diag([2.0 / (many * freedom[1]), 2.0 / (many * freedom[2])])
    square = share * (share * seen**2 + chance**2)
    weights = np.linalg.solve(own + square * covariance, np.ones(2))
    weights /= weights.sum()
    fall = float(weights @ _FALL)
    doubt = math.hypot(math.sqrt(float(weights @ covariance @ weights)), (1.0 - share) * fall)
    known = max(seen, _STEP)
    shown = (_mean_of(1.0 + known, limit, freedom[0]) / cut - 1.0) / known
    removal = share * fall / (shown - fall)
    return StructureShare(seen, chance, float(weights[0]), removal, shown, doubt, excess, error)


def _fall_covariance() -> Matrix:
    """Of the structure's power in middle and fine waves, over that in the coarse."""
    both = _SHARED * _MIDDLE_SPREAD * _FINE_SPREAD
    return np.array([[_MIDDLE_SPREAD**2, both], [both, _FINE_SPREAD**2]])


def mean_below(*, limit: float, freedom: int) -> float:
    """Mean of χ²/freedom where it is below a limit."""
    half = freedom / 2.0
    below = float(special.gammainc(half, limit * half))
    return float(special.gammainc(half + 1.0, limit * half)) / below


def _mean_of(width: float, limit: float, freedom: int) -> float:
    """Mean below the limit of a χ²/freedom that is wider by a factor."""
    return width * mean_below(limit=limit / width, freedom=freedom)


def _width(mean: float, limit: float, freedom: int) -> float:
    """Factor of a χ² that has this mean below the limit."""
    low, high = _NARROWEST, _WIDEST
    for _ in range(50):
        middle = 0.5 * (low + high)
        if _mean_of(middle, limit, freedom) < mean:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
