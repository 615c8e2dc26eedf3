"""MTF and PTF of a table of points: monotone between them, nothing beyond the last."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError

Array = NDArray[Any]
Column = tuple[float, ...]
ROUNDED = 1e-3  # by which a table's MTF(0) may differ from 1: three decimals, as tables have
_SLACK = 1e-12  # of the last frequency: one in another unit is the last one too


def tabulated_mtf(*, frequency: ArrayLike, frequencies: Column, values: Column) -> Array:
    """MTF of a table: monotone cubic between its points, 0 beyond the last.

    Parameters
    ----------
    frequency : array_like
        Frequencies of either sign, in the unit of the table.
    frequencies, values : tuple of float
        Those of the table, from 0, rising, and the MTF at them.

    Notes
    -----
    Piecewise cubic Hermite interpolation (PCHIP) with the slopes of Fritsch and Butland 1984, SIAM
    J. Sci. Stat. Comput. 5, 300: no overshoot, and monotone where the table is. Even in frequency.
    """
    place = np.abs(np.asarray(frequency, np.float64))
    return _interpolated(place, frequencies, values)


def radial_tabulated_mtf(*, rho: ArrayLike, frequencies: Column, values: Column) -> Array:
    """MTF of a table against the radial frequency; arguments and errors of `tabulated_mtf`."""
    return tabulated_mtf(frequency=rho, frequencies=frequencies, values=values)


def tabulated_ptf(*, frequency: ArrayLike, frequencies: Column, values: Column) -> Array:
    """PTF of a table in radians, odd in frequency as that of every real spread function.

    Parameters, interpolation and errors as of `tabulated_mtf`, the first value 0.
    """
    signed = np.asarray(frequency, np.float64)
    phase = np.sign(signed) * _interpolated(np.abs(signed), frequencies, values)
    return np.asarray(phase, np.float64)


def from_zero(
    frequencies: Column, values: Column, *, at_zero: float, normalised: bool = False
) -> tuple[Column, Column]:
    """A table, rising in frequency, of which the first point is at frequency 0.

    `at_zero` is what the function is there by its definition: 1 of an MTF, 0 of a PTF. A table that
    begins above 0 gets that point; one that is within 0.001 of it there, it exactly. `normalised`
    divides by the first value, which has to be at frequency 0.
    """
    if frequencies[0] > 0.0:
        if normalised:
            raise DataError(
                f"the table begins at frequency {frequencies[0]:g}, so there is no value at 0 "
                "to normalise by"
            )
        return (0.0, *frequencies), (at_zero, *values)
    if normalised:
        if not values[0] > 0.0:
            raise DataError(
                f"the table has {values[0]:g} at frequency 0, so it cannot be normalised"
            )
        values = tuple(value / values[0] for value in values)
    if abs(values[0] - at_zero) > ROUNDED:
        advice = ", or normalise = at_zero" if at_zero else ""
        raise DataError(
            f"the table has {values[0]:g} at frequency 0; allowed: {at_zero:g} within "
            f"{ROUNDED:g}{advice}"
        )
    return frequencies, (at_zero, *values[1:])


def _interpolated(place: Array, frequencies: Column, values: Column) -> Array:
    knots, heights, slopes = _table(frequencies, values)
    inside = np.minimum(place, knots[-1])
    index = np.clip(np.searchsorted(knots, inside, side="right") - 1, 0, len(knots) - 2)
    width = knots[index + 1] - knots[index]
    share = (inside - knots[index]) / width
    rest = 1.0 - share
    result = heights[index] * (1.0 + 2.0 * share) * rest * rest
    result += heights[index + 1] * share * share * (3.0 - 2.0 * share)
    result += width * share * rest * (slopes[index] * rest - slopes[index + 1] * share)
    result = np.where(place > knots[-1] * (1.0 + _SLACK), 0.0, result)
    return np.asarray(np.where(place == 0.0, heights[0], result), np.float64)


@lru_cache(maxsize=64)
def _table(frequencies: Column, values: Column) -> tuple[Array, Array, Array]:
    """Knots, heights and slopes of a table."""
    knots, heights = np.array(frequencies, np.float64), np.array(values, np.float64)
    steps = np.diff(knots)
    if len(knots) != len(heights) or len(knots) < 2 or knots[0] != 0.0 or not np.all(steps > 0.0):
        raise DataError(
            "an MTF table needs two or more frequencies that rise from 0, each with a value"
        )
    return knots, heights, monotone_slopes(steps, np.diff(heights) / steps)


def monotone_slopes(steps: Array, secants: Array) -> Array:
    """Slopes at the knots of a monotone cubic, from the intervals' widths and secants.

    Within: the harmonic mean of the secants on both sides, weighted by the widths, and 0 at an
    extremum. At an end: the parabola's of three points, limited so that nothing overshoots.
    """
    if len(secants) == 1:
        return np.repeat(secants, 2)
    before, after = secants[:-1], secants[1:]
    one, other = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
    alike = (np.sign(before) == np.sign(after)) & (before != 0.0)
    safe = np.where(alike, before, 1.0), np.where(alike, after, 1.0)
    within = np.where(alike, (one + other) / (one / safe[0] + other / safe[1]), 0.0)
    first = _end_slope(steps[0], steps[1], secants[0], secants[1])
    last = _end_slope(steps[-1], steps[-2], secants[-1], secants[-2])
    return np.concatenate([[first], within, [last]])


def _end_slope(step: float, next_step: float, secant: float, next_secant: float) -> float:
    slope = ((2.0 * step + next_step) * secant - step * next_secant) / (step + next_step)
    if np.sign(slope) != np.sign(secant):
        return 0.0
    if np.sign(secant) != np.sign(next_secant) and abs(slope) > 3.0 * abs(secant):
        return 3.0 * secant
    return float(slope)
