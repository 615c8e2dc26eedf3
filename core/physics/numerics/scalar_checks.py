"""Cheap checks of scalar parameters: each gives the value as a float or raises `ParameterError`."""

from __future__ import annotations

import math

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
