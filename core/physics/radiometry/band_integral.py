"""Planck's law integrated over a band, for many temperatures at once, and its inverse.

With x = c2/(λT) a band's radiance is C·T⁴ ∫ x³/(eˣ − 1) dx. The integrand is analytic up to ±2πi
and falls like e⁻ˣ, so one Gauss-Legendre rule over at most 50 units of x reaches rounding for any
band: narrow ones without cancellation, wide ones without a series, cold ones without overflow,
because e^(−x_off) is taken out of the integral. What is left varies slowly with temperature: for
large arrays one Chebyshev fit per octave replaces the integrals.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.numerics.chebyshev import chebyshev_fit, chebyshev_sum
from core.physics.numerics.quadrature import gauss_legendre
from core.physics.radiometry.constants import SECOND_RADIATION_CONSTANT_UM_K

FloatArray = NDArray[np.float64]

NODES = 48
WIDEST_X = 50.0
"""What lies beyond x_off + 50 is below 1e-15 of the integral."""

DIRECT_SIZE = 2048
"""Arrays up to this size are integrated one by one."""

_LARGEST_X = 1e5  # e^-x is zero long before; keeps powers of x finite
_ZERO_X = 800.0  # e^-x is zero
_BLOCK = 32768
_STEPS = 200


@dataclass(frozen=True)
class BandIntegral:
    """scale · T^temperature_power · ∫ x^power · e⁻ˣ / (1 − e⁻ˣ)^order dx between two wavelengths.

    Power 3, order 1 is the radiance; 4 and 2 its slope; 2 and 1 the photon radiance.
    """

    cut_on_um: float
    cut_off_um: float
    scale: float
    temperature_power: int
    power: int
    order: int

    def __call__(self, temperature_K: FloatArray) -> FloatArray:
        """Values for temperatures of any shape, 0 K included."""
        flat = temperature_K.ravel()
        if flat.size <= DIRECT_SIZE:
            logs = np.log(self.scaled(flat))
        else:
            logs = self._logs_by_octaves(flat)
        x_off = reduced(self.cut_off_um, flat)
        with np.errstate(under="ignore"):
            values = self.scale * flat**self.temperature_power * np.exp(logs - x_off)
        return cast(FloatArray, values.reshape(temperature_K.shape))

    def scaled(self, temperature_K: FloatArray) -> FloatArray:
        """The integral times e^(x_off): neither zero nor infinite at any temperature."""
        x_off = reduced(self.cut_off_um, temperature_K)
        # from the difference of the wavelengths, which is exact where the band is narrow
        relative_width = (self.cut_off_um - self.cut_on_um) / self.cut_on_um
        width = np.minimum(x_off * relative_width, WIDEST_X)
        places, weights = unit_rule()
        step = width[..., np.newaxis] * places
        x = x_off[..., np.newaxis] + step
        ratio = x / -np.expm1(-x)
        with np.errstate(under="ignore"):
            values = np.exp(-step) * x ** (self.power - self.order) * ratio**self.order
        return cast(FloatArray, width * (values @ weights))

    def log(self, temperature_K: FloatArray, scaled: FloatArray | None = None) -> FloatArray:
        """Natural logarithm of the value, also where the value itself would be zero.

        `scaled`: what the method of that name gives there, where it is known.
        """
        scaled = self.scaled(temperature_K) if scaled is None else scaled
        front = np.log(self.scale) + self.temperature_power * np.log(temperature_K)
        x_off = reduced(self.cut_off_um, temperature_K)
        return cast(FloatArray, front + (np.log(scaled) - x_off))

    def _logs_by_octaves(self, temperature_K: FloatArray) -> FloatArray:
        coldest = SECOND_RADIATION_CONSTANT_UM_K / (self.cut_off_um * _ZERO_X)
        warm = np.maximum(temperature_K, coldest)
        fits: dict[int, FloatArray] = {}
        result = np.empty(warm.size)
        for start in range(0, warm.size, _BLOCK):
            fractions, octaves = np.frexp(warm[start : start + _BLOCK])
            part = result[start : start + _BLOCK]
            for octave in range(int(octaves.min()), int(octaves.max()) + 1):
                chosen = np.flatnonzero(octaves == octave)
                if not chosen.size:
                    continue
                if octave not in fits:
                    fits[octave] = chebyshev_fit(self._log_over(octave))
                part[chosen] = chebyshev_sum(fits[octave], 4.0 * fractions[chosen] - 3.0)
        return result

    def _log_over(self, octave: int) -> Callable[[FloatArray], FloatArray]:
        def log_scaled(places: FloatArray) -> FloatArray:
            return cast(FloatArray, np.log(self.scaled(np.ldexp((places + 3.0) / 4.0, octave))))

        return log_scaled


def reduced(wavelength_um: ArrayLike, temperature_K: ArrayLike) -> FloatArray:
    """X = c2/(λT), capped where e⁻ˣ is zero anyway, so that 0 K is no special case."""
    product = np.multiply(wavelength_um, temperature_K)
    smallest = SECOND_RADIATION_CONSTANT_UM_K / _LARGEST_X
    return np.asarray(SECOND_RADIATION_CONSTANT_UM_K / np.maximum(product, smallest))


@lru_cache(maxsize=1)
def unit_rule() -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre nodes and weights on [0, 1]."""
    places, weights = gauss_legendre(NODES)
    return (places + 1.0) / 2.0, weights / 2.0


def temperature_from_log(
    radiance: BandIntegral, logs: FloatArray, *, fitted: bool = False
) -> FloatArray:
    """Temperatures at which ln `radiance` takes the values of a flat array.

    `fitted`: by the fits of large arrays in any case, so that each value's temperature is the same
    to the bit whatever else is in the array.
    """
    if logs.size <= DIRECT_SIZE and not fitted:
        return _solve(radiance, logs)
    lowest, highest = _solve(radiance, np.array([logs.min(), logs.max()]))
    octaves = np.arange(np.floor(np.log2(lowest)) - 1.0, np.ceil(np.log2(highest)) + 2.0)
    edges = radiance.log(np.exp2(octaves))
    fits: dict[int, FloatArray] = {}
    result = np.empty(logs.size)
    for start in range(0, logs.size, _BLOCK):
        block = logs[start : start + _BLOCK]
        part = result[start : start + _BLOCK]
        pieces = np.searchsorted(edges, block, side="right") - 1
        for piece in range(int(pieces.min()), int(pieces.max()) + 1):
            chosen = np.flatnonzero(pieces == piece)
            if not chosen.size:
                continue
            middle = (edges[piece] + edges[piece + 1]) / 2.0
            half = (edges[piece + 1] - edges[piece]) / 2.0
            if piece not in fits:
                fits[piece] = chebyshev_fit(_log_temperature_over(radiance, middle, half))
            part[chosen] = np.exp(chebyshev_sum(fits[piece], (block[chosen] - middle) / half))
    return result


def _log_temperature_over(
    radiance: BandIntegral, middle: float, half: float
) -> Callable[[FloatArray], FloatArray]:
    def log_temperature(places: FloatArray) -> FloatArray:
        return cast(FloatArray, np.log(_solve(radiance, middle + half * places)))

    return log_temperature


def _solve(radiance: BandIntegral, logs: FloatArray) -> FloatArray:
    """Newton in 1/T, where ln L is convex: from the hot side it never passes the root."""
    slope = BandIntegral(
        radiance.cut_on_um,
        radiance.cut_off_um,
        radiance.scale,
        radiance.temperature_power - 1,
        radiance.power + 1,
        radiance.order + 1,
    )
    inverse = _first_guess(radiance, logs)
    for _ in range(_STEPS):
        temperature = 1.0 / inverse
        scaled = radiance.scaled(temperature)
        excess = radiance.log(temperature, scaled) - logs
        # d ln L / d(1/T), both integrals carrying the same e^(x_off)
        steepness = slope.scaled(temperature) / scaled * temperature
        change = excess / steepness
        moved = np.maximum(inverse + change, inverse / 8.0)
        settled = np.abs(moved - inverse) <= 1e-9 * inverse
        inverse = moved
        if np.all(settled):  # quadratic: the step just made left about 1e-18
            break
    else:
        raise ArithmeticError("brightness temperature: Newton's iteration did not settle")
    return 1.0 / inverse


def _first_guess(radiance: BandIntegral, logs: FloatArray) -> FloatArray:
    """1/T of the radiance taken as monochromatic at the band's long end."""
    span = radiance.cut_off_um - radiance.cut_on_um
    c2 = SECOND_RADIATION_CONSTANT_UM_K
    # L = scale · c2⁴ · λ⁻⁵ · Δλ / (eˣ − 1)
    front = np.log(radiance.scale) + 4.0 * np.log(c2) - 5.0 * np.log(radiance.cut_off_um)
    ratio = front + np.log(span) - logs
    x = np.logaddexp(0.0, ratio)  # ln(1 + e^ratio)
    return cast(FloatArray, np.maximum(x, 1e-300) * radiance.cut_off_um / c2)
