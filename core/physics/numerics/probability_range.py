"""The range up to which a probability that falls with the range is at least the one wanted."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from core.errors import ParameterError
from core.physics.numerics.array_checks import Values
from core.physics.numerics.scalar_checks import positive

NEAREST_M, FARTHEST_M = 1e-3, 1e9  # between which ranges are looked for
_RANGE_ERROR = 1e-13  # relative
# Of 17 parts 12 rounds of 16 ranges leave what 48 halvings do; arrays of 16 cost little more than
# single ranges.
_PARTS = 17


def range_for_probability(
    *, probability_at: Callable[[Values], ArrayLike], probability: float
) -> float | None:
    """Range up to which a probability is at least the one wanted.

    Parameters
    ----------
    probability_at
        Probabilities at an array of ranges in m; must nowhere rise with the range.
    probability
        The one wanted, above 0 and below 1.

    Returns
    -------
    float or None
        m, to 1e-13 relative; None if it is not reached at any range (looked at from 1 mm),
        infinity if it never falls below (looked at up to 1e9 m).

    Raises
    ------
    ParameterError
        For a probability out of range, or one that is no number at some range.

    Notes
    -----
    The logarithm of the range is divided into 17 parts, and the part in which the probability
    falls past the wanted one into 17 again, as bisection does with two: where the probability
    jumps, past the wanted one, the range of the jump is given.
    """
    wanted = positive("probability", probability)
    if not wanted < 1.0:
        raise ParameterError("probability", probability, "above 0 and below 1")

    def reached(ranges_m: Values) -> int:
        """How many of these ranges, in order, come before the first that is too far."""
        values = np.broadcast_to(np.asarray(probability_at(ranges_m), np.float64), ranges_m.shape)
        wrong = np.flatnonzero(~((values >= 0.0) & (values <= 1.0)))
        if len(wrong):
            where = f"probability_at({ranges_m[wrong[0]]:g})"
            raise ParameterError(where, float(values[wrong[0]]), "0 to 1")
        return int(np.argmin(np.append(values >= wanted, False)))

    within = reached(np.array([NEAREST_M, FARTHEST_M]))
    if within != 1:
        return math.inf if within else None
    near, far = math.log(NEAREST_M), math.log(FARTHEST_M)
    while far - near > _RANGE_ERROR:
        bounds = np.linspace(near, far, _PARTS + 1)
        inside = bounds[(bounds > near) & (bounds < far)]
        if not len(inside):
            break
        count = reached(np.exp(inside))
        bounds = np.concatenate([[near], inside, [far]])
        near, far = float(bounds[count]), float(bounds[count + 1])
    return math.exp((near + far) / 2.0)
