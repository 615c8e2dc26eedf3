"""Checks of parameters and arrays: the value as a float or an array, or a `ParameterError`.

Every function of `core.physics` refuses values out of range, names that it does not know and shapes
that do not fit by a `ParameterError`; its docstring says so only where there is more to it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError


def finite(parameter: str, value: float, *, unit: str = "") -> float:
    """Any finite number."""
    return _checked(parameter, value, (-math.inf, math.inf), "a finite number", unit)


def non_negative(parameter: str, value: float, *, unit: str = "") -> float:
    """A finite number, zero or above."""
    return _checked(parameter, value, (0.0, math.inf), "a finite number, zero or above", unit)


def positive(parameter: str, value: float, *, unit: str = "") -> float:
    """A finite number above zero."""
    smallest = math.ulp(0.0)
    return _checked(parameter, value, (smallest, math.inf), "a finite number above zero", unit)


def within(parameter: str, value: float, low: float, high: float, *, unit: str = "") -> float:
    """A number from `low` to `high`, both included."""
    return _checked(parameter, value, (low, high), f"{low:g} to {high:g}", unit)


def _checked(
    parameter: str, value: float, bounds: tuple[float, float], allowed: str, unit: str
) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError) as cause:
        raise ParameterError(parameter, value, allowed, unit=unit) from cause
    if not math.isfinite(number) or not bounds[0] <= number <= bounds[1]:
        raise ParameterError(parameter, value, allowed, unit=unit)
    return number


# Checks of numbers or arrays of them: each gives float64 or raises `ParameterError`.

Values = NDArray[np.float64]


def all_finite(parameter: str, values: ArrayLike, *, unit: str = "") -> Values:
    """Finite numbers."""
    numbers = _numbers(parameter, values, "finite numbers", unit)
    return _all_of(parameter, numbers, np.isfinite(numbers), "finite numbers", unit)


def all_from_zero(
    parameter: str, values: ArrayLike, *, unit: str = "", infinite: bool = False
) -> Values:
    """Numbers of zero or above; `infinite` lets infinity pass, never NaN."""
    allowed = "zero or above" if infinite else "finite, zero or above"
    numbers = _numbers(parameter, values, allowed, unit)
    fit = (numbers >= 0.0) & (infinite | (numbers < np.inf))
    return _all_of(parameter, numbers, fit, allowed, unit)


def all_above_zero(parameter: str, values: ArrayLike, *, unit: str = "") -> Values:
    """Finite numbers above zero."""
    numbers = _numbers(parameter, values, "finite, above zero", unit)
    fit = (numbers > 0.0) & (numbers < np.inf)
    return _all_of(parameter, numbers, fit, "finite, above zero", unit)


def rising(parameter: str, values: ArrayLike, *, unit: str = "") -> Values:
    """One row of at least two finite numbers, zero or above, each above the one before."""
    numbers = all_from_zero(parameter, values, unit=unit)
    if numbers.ndim != 1 or len(numbers) < 2:
        allowed = "one row of at least 2 numbers"
        raise ParameterError(parameter, f"an array of shape {numbers.shape}", allowed, unit=unit)
    falling = np.flatnonzero(np.diff(numbers) <= 0.0)
    if len(falling):
        first = int(falling[0])
        allowed = f"above the previous value, {numbers[first]:g}"
        raise ParameterError(
            f"{parameter}[{first + 1}]", float(numbers[first + 1]), allowed, unit=unit
        )
    return numbers


def broadcast(**named: Values) -> tuple[Values, ...]:
    """The arrays at one common shape."""
    try:
        return tuple(np.broadcast_arrays(*named.values()))
    except ValueError as cause:
        shapes = ", ".join(str(array.shape) for array in named.values())
        allowed = "shapes that broadcast against one another"
        raise ParameterError(", ".join(named), shapes, allowed) from cause


def _numbers(parameter: str, values: ArrayLike, allowed: str, unit: str) -> Values:
    try:
        given = np.asarray(values)
        if given.dtype.kind in "biuf":
            return np.asarray(given, np.float64)
    except (TypeError, ValueError, OverflowError) as cause:
        raise ParameterError(parameter, values, allowed, unit=unit) from cause
    raise ParameterError(parameter, values, allowed, unit=unit)


def _all_of(
    parameter: str, numbers: Values, fit: NDArray[np.bool_], allowed: str, unit: str
) -> Values:
    if not fit.all():
        first = np.unravel_index(int(np.argmin(fit)), numbers.shape)
        where = f"[{', '.join(str(int(k)) for k in first)}]" if numbers.ndim else ""
        raise ParameterError(f"{parameter}{where}", float(numbers[first]), allowed, unit=unit)
    return numbers
