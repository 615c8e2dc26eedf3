"""How much of the fine power of blocks is structure, from their coarse and middle power.

White noise has equal power in all waves; what a scene leaves after the optics falls with the
frequency. What coarse and middle waves have more than fine ones shows how steeply, and so how much
of it is left in the fine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

Vector = NDArray[np.float64]

# Middle over coarse power of a scene, before it is measured: of 1/f² texture and edges behind the
# optics of cameras, drawn at random; and how the fall goes on from middle to fine.
_FALL, _FALL_ERROR = 0.11, 0.04
_FALLS_ON = 0.43
_STEEPEST, _SHALLOWEST = 0.01, 0.35
_DOUBT = 0.7
_WIDEST = 8.0


@dataclass(frozen=True)
class StructureShare:
    """Power of structure over that of noise.

    Parameters
    ----------
    coarse, fine : float
        In the coarse waves before the choice cut them, and in the fine ones.
    fall : float
        What middle waves have of the structure's coarse power.
    beyond : float
        By how much the chosen blocks' coarse power exceeds what noise alone leaves below the limit;
        0 where that is no more than chance, and nothing is taken off.
    middle, middle_error : float
        Excess of the middle waves over the fine ones, and its standard error.
    """

    coarse: float
    fine: float
    fall: float
    beyond: float
    middle: float
    middle_error: float

    def removal(self, middle: float) -> tuple[float, float]:
        """What to take off a block's power, as a part of its coarse excess, and the doubt of it.

        Of waves of which `middle` is the share of middle ones, the others fine. The doubt is a
        standard error over the variance of the noise.
        """
        fine = self.fall ** (_FALLS_ON + 1.0)
        own = self.coarse * (middle * self.fall + (1.0 - middle) * fine) / (1.0 - fine)
        share = own / (1.0 + own)
        return (share / self.beyond if self.beyond > 0.0 else 0.0), _DOUBT * share


def structure_share(
    *, coarse: Vector, middle: Vector, fine: Vector, limit: float, freedom: int
) -> StructureShare:
    """Power of structure in blocks that were chosen by their coarse power.

    Parameters
    ----------
    coarse, middle, fine : ndarray, shape (blocks,)
        Mean power of the waves over the variance of the noise at the block's level.
    limit : float
        Largest coarse power that was chosen.
    freedom : int
        Number of coarse waves.
    """
    many = len(fine)
    level = float(fine.mean())
    excess = float(middle.mean()) / level - 1.0
    error = float(np.std(middle - (1.0 + excess) * fine)) / (math.sqrt(many) * level)
    mean = float(coarse.mean()) / level
    cut = mean_below(limit=limit / level, freedom=freedom)
    chance = float(coarse.std()) / (math.sqrt(many) * level)
    width = _width(mean, limit / level, freedom)
    steep = _FALLS_ON + 1.0
    power = max(width - 1.0, 0.0)
    if power <= 3.0 * chance or mean <= cut:
        return StructureShare(max(power, chance), 0.0, _FALL, 0.0, excess, error)
    # The fall from coarse to middle, measured and as scenes have it, by weight.
    measured = min(max(excess / power, _STEEPEST), _SHALLOWEST)
    doubt = max(error / power, 1e-3)
    weights = 1.0 / doubt**2, 1.0 / _FALL_ERROR**2
    fall = (measured * weights[0] + _FALL * weights[1]) / sum(weights)
    for _ in range(20):  # what is seen is the excess over fine waves that have structure too
        left = fall**steep
        seen = (measured * (1.0 - left) + left, _FALL)
        fall = (seen[0] * weights[0] + seen[1] * weights[1]) / sum(weights)
    left = fall**steep
    return StructureShare(power, power * left / (1.0 - left), fall, mean / cut - 1.0, excess, error)


def mean_below(*, limit: float, freedom: int) -> float:
    """Mean of χ²/freedom where it is below a limit."""
    half = freedom / 2.0
    below = float(special.gammainc(half, limit * half))
    return float(special.gammainc(half + 1.0, limit * half)) / below


def _width(mean: float, limit: float, freedom: int) -> float:
    """Factor of a χ² that has this mean below the limit."""
    low, high = 1e-3, _WIDEST
    for _ in range(50):
        middle = 0.5 * (low + high)
        if middle * mean_below(limit=limit / middle, freedom=freedom) < mean:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
