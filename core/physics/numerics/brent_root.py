"""A zero of a function between two places where it has opposite signs."""

from __future__ import annotations

import math
from collections.abc import Callable

from core.errors import ParameterError

_ROUNDING = 2.220446049250313e-16


def brent_root(
    function: Callable[[float], float],
    *,
    low: float,
    high: float,
    tolerance: float = 1e-13,
    most_steps: int = 200,
) -> float:
    """A zero by inverse quadratic interpolation, secants and halving.

    Parameters
    ----------
    function : callable
        Takes and gives a number.
    low, high : float
        Two places where it has opposite signs, or is zero.
    tolerance : float
        Of the place, relative to the larger of its size and that of the interval.
    most_steps : int
        Evaluations after which the best place so far is taken.

    Returns
    -------
    float
        The place.

    Raises
    ------
    ParameterError
        If the function has one sign at both ends.

    Notes
    -----
    Source: Brent 1973, Algorithms for Minimization without Derivatives, chapter 4.
    """
    before, best = low, high
    at_before, at_best = function(before), function(best)
    if at_before == 0.0:
        return before
    if at_best != 0.0 and (at_before > 0.0) == (at_best > 0.0):
        allowed = f"two places with a zero between; it is {at_before:g} and {at_best:g} there"
        raise ParameterError("low, high", (low, high), allowed)
    other, at_other = before, at_before  # the zero lies between `best` and `other`
    step = last_step = best - before
    floor = tolerance * abs(high - low) * 1e-3
    for _ in range(most_steps):
        if abs(at_other) < abs(at_best):
            before, best, other = best, other, best
            at_before, at_best, at_other = at_best, at_other, at_best
        near = 2.0 * _ROUNDING * abs(best) + 0.5 * max(tolerance * abs(best), floor)
        half = 0.5 * (other - best)
        if abs(half) <= near or at_best == 0.0:
            break
        if abs(last_step) < near or abs(at_before) <= abs(at_best):
            step = last_step = half
        else:
            step, last_step = _interpolated(
                (before, best, other), (at_before, at_best, at_other), half, (near, last_step, step)
            )
        before, at_before = best, at_best
        best += step if abs(step) > near else math.copysign(near, half)
        at_best = function(best)
        if (at_best > 0.0) == (at_other > 0.0):
            other, at_other = before, at_before
            step = last_step = best - before
    return best


def _interpolated(
    places: tuple[float, float, float],
    values: tuple[float, float, float],
    half: float,
    steps: tuple[float, float, float],
) -> tuple[float, float]:
    """The next step and the one that it is compared with; half the interval where that is safer."""
    (before, best, other), (at_before, at_best, at_other) = places, values
    near, last_step, step = steps
    ratio = at_best / at_before
    if before == other:
        p, q = 2.0 * half * ratio, 1.0 - ratio
    else:
        a, b = at_before / at_other, at_best / at_other
        p = ratio * (2.0 * half * a * (a - b) - (best - before) * (b - 1.0))
        q = (a - 1.0) * (b - 1.0) * (ratio - 1.0)
    if p > 0.0:
        q = -q
    p = abs(p)
    if 2.0 * p < min(3.0 * half * q - abs(near * q), abs(last_step * q)):
        return p / q, step
    return half, half
