"""Checks of parameters and arrays, quadrature, Chebyshev series, sinc.

A check gives the value as a float or an array, or raises a `ParameterError`.

Every function of `core.physics` refuses values out of range, names that it does not know and shapes
that do not fit by a `ParameterError`; its docstring says so only where there is more to it.
"""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats
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


def all_finite(parameter: str, values: ArrayLike, *, unit: str = "") -> Floats:
    """Finite numbers."""
    numbers = _numbers(parameter, values, "finite numbers", unit)
    return _all_of(parameter, numbers, np.isfinite(numbers), "finite", unit)


def all_from_zero(
    parameter: str, values: ArrayLike, *, unit: str = "", infinite: bool = False
) -> Floats:
    """Numbers of zero or above; `infinite` lets infinity pass, never NaN."""
    allowed = "at least 0" if infinite else "finite, zero or above"
    numbers = _numbers(parameter, values, allowed, unit)
    fit = (numbers >= 0.0) & (infinite | (numbers < np.inf))
    return _all_of(parameter, numbers, fit, allowed, unit)


def all_above_zero(parameter: str, values: ArrayLike, *, unit: str = "") -> Floats:
    """Finite numbers above zero."""
    numbers = _numbers(parameter, values, "finite, above zero", unit)
    fit = (numbers > 0.0) & (numbers < np.inf)
    return _all_of(parameter, numbers, fit, "finite, above zero", unit)


def rising(parameter: str, values: ArrayLike, *, unit: str = "") -> Floats:
    """One row of at least two finite numbers, zero or above, each above the one before."""
    numbers = all_from_zero(parameter, values, unit=unit)
    if numbers.ndim != 1 or len(numbers) < 2:
        allowed = "one row of at least 2 numbers"
        raise ParameterError(f"{parameter}.shape", numbers.shape, allowed)
    falling = np.flatnonzero(np.diff(numbers) <= 0.0)
    if len(falling):
        first = int(falling[0])
        allowed = f"above the previous value, {numbers[first]:g}"
        raise ParameterError(
            f"{parameter}[{first + 1}]", float(numbers[first + 1]), allowed, unit=unit
        )
    return numbers


def broadcast(**named: Floats) -> tuple[Floats, ...]:
    """The arrays at one common shape."""
    try:
        return tuple(np.broadcast_arrays(*named.values()))
    except ValueError as cause:
        shapes = ", ".join(str(array.shape) for array in named.values())
        allowed = "must have shapes that broadcast together"
        raise ParameterError(", ".join(named), shapes, allowed) from cause


def along(places: Floats, parameter: str, values: Floats) -> Floats:
    """The values at places that are called frequency, one at each."""
    if values.shape != places.shape:
        allowed = f"{places.shape}, the shape of frequency"
        raise ParameterError(f"{parameter}.shape", values.shape, allowed)
    return values


def _numbers(parameter: str, values: ArrayLike, allowed: str, unit: str) -> Floats:
    try:
        given = np.asarray(values)
        if given.dtype.kind in "biuf":
            return np.asarray(given, np.float64)
    except (TypeError, ValueError, OverflowError) as cause:
        raise ParameterError(parameter, values, allowed, unit=unit) from cause
    raise ParameterError(parameter, values, allowed, unit=unit)


def _all_of(
    parameter: str, numbers: Floats, fit: NDArray[np.bool_], allowed: str, unit: str
) -> Floats:
    if not fit.all():
        first = np.unravel_index(int(np.argmin(fit)), numbers.shape)
        where = f"[{', '.join(str(int(k)) for k in first)}]" if numbers.ndim else ""
        raise ParameterError(f"{parameter}{where}", float(numbers[first]), allowed, unit=unit)
    return numbers


# Small numerics: quadrature, Chebyshev series, sinc, probability ranges.


@lru_cache(maxsize=128)
def gauss_legendre(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes in (−1, 1) and weights, read-only: finding them takes 0.1 to 0.7 ms.

    Source: Golub and Welsch 1969, as in numpy.polynomial.legendre.leggauss.
    """
    nodes, weights = np.polynomial.legendre.leggauss(count)
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights


# Chebyshev fits of smooth functions, for arrays too large for the direct formula.


_FIT_SIZES = (24, 48, 96)
_FIT_TOLERANCE = 4e-16


def chebyshev_fit(
    function: Callable[[Floats], Floats], *, middle: float = 0.0, half: float = 1.0
) -> Floats:
    """Coefficients of a smooth function on middle ± half, as many as double precision can use.

    Source: Trefethen 2013, Approximation Theory and Approximation Practice, chapters 3 and 8.
    """
    for size in _FIT_SIZES:
        coefficients = chebyshev_coefficients(lambda x: function(middle + half * x), size)
        floor = _FIT_TOLERANCE * max(np.max(np.abs(coefficients)), np.finfo(float).tiny)
        used = np.flatnonzero(np.abs(coefficients) > floor)
        length = int(used[-1]) + 1 if used.size else 1
        if length <= size - 4:
            break
    return coefficients[:length]


def chebyshev_coefficients(function: Callable[[Floats], Floats], size: int) -> Floats:
    """So many coefficients, from as many values at the Chebyshev nodes."""
    angles = np.pi * (np.arange(size) + 0.5) / size
    values = function(np.cos(angles))
    coefficients: Floats = 2.0 / size * (np.cos(np.outer(np.arange(size), angles)) @ values)
    coefficients[0] /= 2.0
    return coefficients


def chebyshev_sum(coefficients: Floats, places: Floats) -> Floats:
    """Sum of Chebyshev polynomials at `places` in [-1, 1], by Clenshaw's recurrence.

    Source: Clenshaw 1955, Mathematics of Computation 9, 118.
    """
    doubled = places + places
    later, latest = np.zeros_like(places), np.zeros_like(places)
    scratch = np.empty_like(places)
    for coefficient in coefficients[:0:-1]:
        np.multiply(doubled, latest, out=scratch)
        scratch -= later
        scratch += coefficient
        later, latest, scratch = latest, scratch, later
    np.multiply(places, latest, out=scratch)
    scratch -= later
    scratch += coefficients[0]
    return scratch


# sin(πx)/(πx), exactly zero at the integers.

# Beyond this every float64 is an even integer, and the sinc is zero.
_LARGEST = 2.0**60


def sinc(x: ArrayLike) -> NDArray[np.float64]:
    """Normalised sinc sin(πx)/(πx), signed: 1 at x = 0, 0 at every other integer and at infinity.

    The nearest integer is taken off before the sine (an exact subtraction), so the relative
    accuracy holds next to the zeros, where sin(π·x) of the whole argument has none left.
    """
    argument = np.clip(np.asarray(x, dtype=np.float64), -_LARGEST, _LARGEST)
    turns = np.rint(argument)
    sign = 1.0 - 2.0 * np.abs(np.fmod(turns, 2.0))
    scale = np.where(argument == 0.0, 1.0, np.pi * argument)
    wave = sign * np.sin(np.pi * (argument - turns))
    return np.asarray(np.where(argument == 0.0, 1.0, wave / scale), dtype=np.float64)


def mean_of_waves(turns: Floats, count: int) -> Floats:
    """Mean of a wave at `count` places `turns` apart, about their middle: sin(πnt)/(n·sin(πt)).

    Signed, with all digits where sin(πt) is next to 0.
    """
    whole = np.rint(turns)
    rest = turns - whole
    odd = (count % 2 == 0) & (whole % 2 != 0)
    return np.where(odd, -1.0, 1.0) * sinc(count * rest) / sinc(rest)


# The range up to which a probability that falls with the range is at least the one wanted.

NEAREST_M, FARTHEST_M = 1e-3, 1e9  # between which ranges are looked for
_RANGE_ERROR = 1e-13  # relative
# Of 17 parts 12 rounds of 16 ranges leave what 48 halvings do; arrays of 16 cost little more than
# single ranges.
_PARTS = 17


def range_for_probability(
    *, probability_at: Callable[[Floats], ArrayLike], probability: float
) -> float | None:
    """Range up to which a probability is at least the one wanted, in m, to 1e-13 relative.

    `probability_at` gives probabilities at an array of ranges in m and must nowhere rise with them.
    None if the one wanted is not reached at any range (looked at from 1 mm), infinity if it never
    falls below (looked at up to 1e9 m).

    The logarithm of the range is divided into 17 parts, and the part in which the probability
    falls past the wanted one into 17 again, as bisection does with two: where the probability
    jumps, past the wanted one, the range of the jump is given.
    """
    wanted = positive("probability", probability)
    if not wanted < 1.0:
        raise ParameterError("probability", probability, "above 0 and below 1")

    def reached(ranges_m: Floats) -> int:
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
