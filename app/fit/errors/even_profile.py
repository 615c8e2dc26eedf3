"""Errors beside a parameter of even effect near 0, by a profile (Bates and Watts 1988, section 6).

The derivative of such a parameter, a defocus or a width, vanishes at 0: the linearized model takes
the others' errors for those with it at its value. So it is held at several values, as far as the
sum of squares allows, and the others are fitted anew beside each.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Refit = Callable[[int, float], tuple[Vector, float]]

_TRIALS, _EVALUATIONS = 6, 8
_FARTHEST = 4.0  # of the sum of squares: two standard errors


def refit_beside(
    *,
    residual: Callable[[Vector], Vector],
    jacobian: Callable[[Vector], Matrix],
    values: Vector,
    lows: Vector,
    highs: Vector,
) -> Refit:
    """What fits all others beside one that is held: its place and value give values and cost."""
    from scipy.optimize import least_squares

    def refit(index: int, held: float) -> tuple[Vector, float]:
        others = [i for i in range(len(values)) if i != index]

        def whole(part: Vector) -> Vector:
            made = values.copy()
            made[index], made[others] = held, part
            return made

        margin = 1e-9 * (np.abs(values) + 1e-300)
        begin = np.clip(values, lows + margin, highs - margin)[others]
        done = least_squares(
            lambda part: residual(whole(part)),
            begin,
            jac=lambda part: jacobian(whole(part))[:, others],
            bounds=(lows[others], highs[others]),
            x_scale="jac",
            max_nfev=_EVALUATIONS,
        )
        return whole(np.asarray(done.x, np.float64)), 2.0 * float(done.cost)

    return refit


def profiled_spread(
    *,
    refit: Refit,
    index: int,
    values: Vector,
    least: float,
    unit: float,
    first: float,
    high: float,
) -> Vector | None:
    """How far parameters go as one goes from 0 to where the sum of squares lets it be.

    Parameters
    ----------
    refit : callable
        Fits the others beside one that is held.
    index : int
        Which one is held.
    values : ndarray
        The best ones.
    least, unit : float
        The sum of squares there, and how much of it counts as 1.
    first, high : float
        How far above its value the parameter is tried first, and the end of its range.

    Returns
    -------
    ndarray or None
        For each parameter the largest change, over as many standard errors as its sum of squares
        is more by, at least one. None where that is more by 4 at 0: the parameter is known to
        differ from 0.
    """
    spread = np.zeros(len(values))

    def seen(held: float) -> float:
        other, cost = refit(index, held)
        rise = max(0.0, cost - least) / unit
        if rise < _FARTHEST:
            errors = max(1.0, rise) ** 0.5
            change = np.abs(other - values) / errors
            # The sum of squares goes with the fourth power of a parameter of even effect at 0.
            change[index] *= errors**0.5
            np.maximum(spread, change, out=spread)
        return rise

    if not seen(0.0) < _FARTHEST:
        return None
    near, far = 0.0, float("inf")
    step = first
    for _ in range(_TRIALS):
        trial = min(float(values[index]) + step, high)
        rise = seen(trial)
        if 1.0 <= rise < _FARTHEST or (rise < 1.0 and trial == high):
            break
        near, far = (step, far) if rise < 1.0 else (near, step)
        step = 2.0 * near if far == float("inf") else 0.5 * (near + far)
    return spread
