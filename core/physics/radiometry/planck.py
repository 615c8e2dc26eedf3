"""Physical constants, and Planck's law: radiance of a wavelength, of a band, and temperature.

Source of the constants: CODATA 2018 recommended values (Tiesinga, Mohr, Newell, Taylor 2021); h, c,
k and e are exact by definition of the SI since 2019.
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from math import pi
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats
from core.errors import DataError, ParameterError, several
from core.physics.numerics import chebyshev_fit, chebyshev_sum, gauss_legendre, positive
from core.records import dataclass, replace

PLANCK_J_S = 6.62607015e-34
SPEED_OF_LIGHT_M_S = 299792458.0
BOLTZMANN_J_K = 1.380649e-23
ELEMENTARY_CHARGE_C = 1.602176634e-19
PHOTON_ENERGY_J_UM = PLANCK_J_S * SPEED_OF_LIGHT_M_S * 1e6
"""Energy of a photon times its wavelength, J µm."""

FIRST_RADIATION_CONSTANT_W_M2_SR = 2.0 * PLANCK_J_S * SPEED_OF_LIGHT_M_S**2
"""c1L = 2 h c**2, of spectral radiance, W m2 sr-1."""

# written out because h * c / k in floating point is one unit in the last place off,
# which e^(-c2/(λT)) multiplies by its exponent
SECOND_RADIATION_CONSTANT_M_K = 0.014387768775039338021
"""c2 = h c / k, m K."""

SECOND_RADIATION_CONSTANT_UM_K = 14387.768775039338021
"""c2 in µm K."""

STEFAN_BOLTZMANN_W_M2_K4 = (
    2.0 * pi**5 * BOLTZMANN_J_K**4 / (15.0 * PLANCK_J_S**3 * SPEED_OF_LIGHT_M_S**2)
)


# Planck's law: spectral and band radiance, its slope, and the temperature of a radiance.

FloatOrArray = TypeVar("FloatOrArray", float, NDArray[np.float64])

_SHORTEST_UM, _LONGEST_UM = 1e-30, 1e30  # keeps λ⁻⁵ a finite number
_HOTTEST_K = 1e30  # keeps T⁴ a finite number
_LARGEST_SLOPE_X = 700.0
_ENERGY = FIRST_RADIATION_CONSTANT_W_M2_SR / SECOND_RADIATION_CONSTANT_M_K**4
_PHOTONS = 2.0 * SPEED_OF_LIGHT_M_S / SECOND_RADIATION_CONSTANT_M_K**3


def spectral_radiance(wavelength_um: ArrayLike, temperature_K: ArrayLike) -> Floats:
    """Spectral radiance of a blackbody.

    Parameters
    ----------
    wavelength_um
        Wavelength, µm, above 0; broadcasts against `temperature_K`.
    temperature_K
        Temperature, K, 0 or above.

    Returns
    -------
    W m⁻² sr⁻¹ µm⁻¹, of the broadcast shape (0-d for two scalars).

    Source: Planck 1900; Tantalo 1996, eq. 4.66 (exitance there, with rounded constants and the
    exponent of c1 misprinted).
    """
    wavelength = np.asarray(wavelength_um, dtype=float)
    _require_wavelengths(wavelength, "wavelength_um")
    x = reduced(wavelength, _temperatures(temperature_K))
    with np.errstate(under="ignore"):
        front = FIRST_RADIATION_CONSTANT_W_M2_SR * 1e24 / wavelength**5
        return np.asarray(front * (np.exp(-x) / -np.expm1(-x)))


def spectral_radiance_slope(wavelength_um: ArrayLike, temperature_K: ArrayLike) -> Floats:
    """Slope dL/dT of `spectral_radiance`, W m⁻² sr⁻¹ µm⁻¹ K⁻¹; above 0 K, otherwise as there."""
    kelvin = np.asarray(temperature_K, float)
    x = SECOND_RADIATION_CONSTANT_UM_K / (np.asarray(wavelength_um, float) * kelvin)
    x = np.minimum(x, _LARGEST_SLOPE_X)  # beyond, the radiance is zero anyway
    return np.asarray(spectral_radiance(wavelength_um, kelvin) * x / -np.expm1(-x) / kelvin)


def band_radiance(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Radiance of a blackbody between two wavelengths.

    Parameters
    ----------
    cut_on_um, cut_off_um
        The band, µm, 0 < cut_on_um < cut_off_um.
    temperature_K
        K, 0 or above, scalar or any shape.

    Returns
    -------
    W m⁻² sr⁻¹, float or array as `temperature_K`, to 1e-12 relative; 0 where it is below the
    smallest number.

    Source: Tantalo 1996, eq. 4.65 (its exitance divided by π).
    """
    return _evaluated(_integral(cut_on_um, cut_off_um, _ENERGY, 4, 3, 1), temperature_K)


def band_radiance_derivative(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Slope dL/dT of `band_radiance`, W m⁻² sr⁻¹ K⁻¹; parameters and errors as there.

    Source: Tantalo 1996, eqs. 4.63-4.64 (a difference quotient there, the derivative here).
    """
    return _evaluated(_integral(cut_on_um, cut_off_um, _ENERGY, 3, 4, 2), temperature_K)


def band_photon_radiance(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Photon radiance of a blackbody in a band, s⁻¹ m⁻² sr⁻¹; otherwise as `band_radiance`.

    Source: Planck's law divided by the energy hc/λ of a photon.
    """
    return _evaluated(_integral(cut_on_um, cut_off_um, _PHOTONS, 3, 2, 1), temperature_K)


def band_photon_radiance_derivative(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Slope dL_q/dT of `band_photon_radiance`, s⁻¹ m⁻² sr⁻¹ K⁻¹; otherwise as there."""
    return _evaluated(_integral(cut_on_um, cut_off_um, _PHOTONS, 2, 3, 2), temperature_K)


def brightness_temperature(
    *, radiance: FloatOrArray, cut_on_um: float, cut_off_um: float
) -> FloatOrArray:
    """Temperature of the blackbody that has a given band radiance: inverse of `band_radiance`.

    Parameters
    ----------
    radiance
        W m⁻² sr⁻¹, 0 or above (0 gives 0 K), scalar or any shape.
    cut_on_um, cut_off_um
        The band, µm, 0 < cut_on_um < cut_off_um.

    Returns
    -------
    K, float or array as `radiance`, to 1e-12 relative.

    Raises
    ------
    DataError
        For negative or non-finite radiance, which no temperature has, and for one that only more
        than 1e30 K would give.
    ParameterError
        For a band out of range.

    Source: the inverse of Planck's integral, by bracketed Newton steps.
    """
    return _brightness(radiance, cut_on_um, cut_off_um, fitted=False)


def brightness_temperature_of_samples(
    *, radiance: FloatOrArray, cut_on_um: float, cut_off_um: float
) -> FloatOrArray:
    """As `brightness_temperature`, by the fits of large arrays also where there are few samples.

    A part of a picture then has what the whole picture has there, to the bit.
    """
    return _brightness(radiance, cut_on_um, cut_off_um, fitted=True)


def _brightness(
    radiance: FloatOrArray, cut_on_um: float, cut_off_um: float, *, fitted: bool
) -> FloatOrArray:
    band = _integral(cut_on_um, cut_off_um, _ENERGY, 4, 3, 1)
    values = np.asarray(radiance, dtype=float)
    brightest = float(band(np.array([_HOTTEST_K]))[0])
    faulty = ~((values >= 0.0) & (values <= brightest))
    if np.any(faulty):
        first = float(values[faulty].flat[0])
        raise DataError(
            f"radiance: no brightness temperature for {np.count_nonzero(faulty)} of"
            f" {several(values.size, 'sample')} (the first is {first!r} W/m²/sr);"
            f" allowed: 0 to {brightest:.3g}"
        )
    temperature: Any = np.zeros(values.size)
    lit = np.flatnonzero(values)
    if lit.size:
        temperature[lit] = temperature_from_log(band, np.log(values.ravel()[lit]), fitted=fitted)
    result: FloatOrArray = temperature.reshape(values.shape)[()]
    return result


def _integral(
    cut_on_um: float,
    cut_off_um: float,
    scale: float,
    temperature_power: int,
    power: int,
    order: int,
) -> "BandIntegral":
    _require_wavelengths(np.asarray(cut_on_um, dtype=float), "cut_on_um")
    _require_wavelengths(np.asarray(cut_off_um, dtype=float), "cut_off_um")
    if not cut_on_um < cut_off_um:
        allowed = f"must be above cut_on_um = {cut_on_um!r} µm"
        raise ParameterError("cut_off_um", cut_off_um, allowed, unit="µm")
    return BandIntegral(cut_on_um, cut_off_um, scale, temperature_power, power, order)


def _evaluated(integral: "BandIntegral", temperature_K: FloatOrArray) -> FloatOrArray:
    values: Any = integral(_temperatures(temperature_K))
    result: FloatOrArray = values[()]  # a float for a 0-d array: what a scalar became
    return result


def _temperatures(temperature_K: ArrayLike) -> Floats:
    values = np.asarray(temperature_K, dtype=float)
    allowed = (values >= 0.0) & (values <= _HOTTEST_K)
    if not np.all(allowed):
        first = float(values[~allowed].flat[0])
        raise ParameterError("temperature_K", first, f"must be 0 to {_HOTTEST_K:g}", unit="K")
    return values


def _require_wavelengths(values: Floats, name: str) -> None:
    allowed = (values >= _SHORTEST_UM) & (values <= _LONGEST_UM)
    if not np.all(allowed):
        first = float(values[~allowed].flat[0])
        raise ParameterError(name, first, f"must be above 0 and at most {_LONGEST_UM:g}", unit="µm")


# Wavelengths at which a band is integrated, in pieces on which Planck's law is smooth.

_WIDEST_RATIO = 1.06  # of the ends of a piece: Planck's law is a polynomial of low degree on it
_NODES, _FEW_NODES, _MANY_PIECES = 24, 8, 100


def band_nodes(low: float, high: float, places: Sequence[float]) -> tuple[Floats, Floats]:
    """Wavelengths and widths of a quadrature over a band, which breaks at the places in it."""
    positive("cut_on_um", low, unit="µm")
    if not low < high < math.inf:
        raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}", unit="µm")
    inner = [place for place in places if low < place < high]
    pieces = [low]
    for left, right in pairwise([low, *inner, high]):
        count = math.ceil(math.log(right / left) / math.log(_WIDEST_RATIO))
        pieces += np.geomspace(left, right, max(count, 1) + 1)[1:].tolist()
    ends = np.array(pieces)
    nodes, weights = gauss_legendre(_NODES if len(ends) < _MANY_PIECES else _FEW_NODES)
    half, middle = np.diff(ends) / 2.0, (ends[1:] + ends[:-1]) / 2.0
    wavelength = middle[:, np.newaxis] + half[:, np.newaxis] * nodes
    return wavelength.ravel(), (half[:, np.newaxis] * weights).ravel()


# Planck's law integrated over a band, for many temperatures at once, and its inverse.
#
# With x = c2/(λT) a band's radiance is C·T⁴ ∫ x³/(eˣ − 1) dx. The integrand is analytic up to ±2πi
# and falls like e⁻ˣ, so one Gauss-Legendre rule over at most 50 units of x reaches rounding for any
# band: narrow ones without cancellation, wide ones without a series, cold ones without overflow,
# because e^(−x_off) is taken out of the integral. What is left varies slowly with temperature: for
# large arrays one Chebyshev fit per octave replaces the integrals.

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

    def __call__(self, temperature_K: Floats) -> Floats:
        """Values for temperatures of any shape, 0 K included."""
        flat = temperature_K.ravel()
        if flat.size <= DIRECT_SIZE:
            logs = np.log(self.scaled(flat))
        else:
            logs = self._logs_by_octaves(flat)
        x_off = reduced(self.cut_off_um, flat)
        with np.errstate(under="ignore"):
            values = self.scale * flat**self.temperature_power * np.exp(logs - x_off)
        return cast(Floats, values.reshape(temperature_K.shape))

    def scaled(self, temperature_K: Floats) -> Floats:
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
        return cast(Floats, width * (values @ weights))

    def log(self, temperature_K: Floats, scaled: Floats | None = None) -> Floats:
        """Natural logarithm of the value, also where the value itself would be zero.

        `scaled`: what the method of that name gives there, where it is known.
        """
        scaled = self.scaled(temperature_K) if scaled is None else scaled
        front = np.log(self.scale) + self.temperature_power * np.log(temperature_K)
        x_off = reduced(self.cut_off_um, temperature_K)
        return cast(Floats, front + (np.log(scaled) - x_off))

    def _logs_by_octaves(self, temperature_K: Floats) -> Floats:
        coldest = SECOND_RADIATION_CONSTANT_UM_K / (self.cut_off_um * _ZERO_X)
        warm = np.maximum(temperature_K, coldest)
        _, (first, last) = np.frexp([warm.min(), warm.max()])
        edges = np.ldexp(1.0, np.arange(first - 1, last + 1))
        return _by_fits(
            lambda kelvin: np.log(self.scaled(kelvin)),
            warm,
            edges,
            lambda kelvin: np.frexp(kelvin)[1] - first,
        )


def _by_fits(
    function: Callable[[Floats], Floats],
    values: Floats,
    edges: Floats,
    piece_of: Callable[[Floats], NDArray[np.intp]],
) -> Floats:
    """A smooth function of many values, by one Chebyshev fit between every two edges."""
    fits: dict[int, Floats] = {}
    result = np.empty(values.size)
    for start in range(0, values.size, _BLOCK):
        block, part = values[start : start + _BLOCK], result[start : start + _BLOCK]
        pieces = piece_of(block)
        for piece in range(int(pieces.min()), int(pieces.max()) + 1):
            chosen = np.flatnonzero(pieces == piece)
            if not chosen.size:
                continue
            middle = float(edges[piece] + edges[piece + 1]) / 2.0
            half = float(edges[piece + 1] - edges[piece]) / 2.0
            if piece not in fits:
                fits[piece] = chebyshev_fit(function, middle=middle, half=half)
            part[chosen] = chebyshev_sum(fits[piece], (block[chosen] - middle) / half)
    return result


def reduced(wavelength_um: ArrayLike, temperature_K: ArrayLike) -> Floats:
    """X = c2/(λT), capped where e⁻ˣ is zero anyway, so that 0 K is no special case."""
    product = np.multiply(wavelength_um, temperature_K)
    smallest = SECOND_RADIATION_CONSTANT_UM_K / _LARGEST_X
    return np.asarray(SECOND_RADIATION_CONSTANT_UM_K / np.maximum(product, smallest))


@lru_cache(maxsize=1)
def unit_rule() -> tuple[Floats, Floats]:
    """Gauss-Legendre nodes and weights on [0, 1]."""
    places, weights = gauss_legendre(NODES)
    return (places + 1.0) / 2.0, weights / 2.0


def temperature_from_log(radiance: BandIntegral, logs: Floats, *, fitted: bool = False) -> Floats:
    """Temperatures at which ln `radiance` takes the values of a flat array.

    `fitted`: by the fits of large arrays in any case, so that each value's temperature is the same
    to the bit whatever else is in the array.
    """
    if logs.size <= DIRECT_SIZE and not fitted:
        return _solve(radiance, logs)
    lowest, highest = _solve(radiance, np.array([logs.min(), logs.max()]))
    octaves = np.arange(np.floor(np.log2(lowest)) - 1.0, np.ceil(np.log2(highest)) + 2.0)
    edges = radiance.log(np.exp2(octaves))
    log_temperatures = _by_fits(
        lambda places: np.log(_solve(radiance, places)),
        logs,
        edges,
        lambda places: np.searchsorted(edges, places, side="right") - 1,
    )
    return np.exp(log_temperatures)


def _solve(radiance: BandIntegral, logs: Floats) -> Floats:
    """Newton in 1/T, where ln L is convex: from the hot side it never passes the root."""
    slope = replace(
        radiance,
        temperature_power=radiance.temperature_power - 1,
        power=radiance.power + 1,
        order=radiance.order + 1,
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
        raise ArithmeticError("brightness temperature: Newton's iteration did not converge")
    return 1.0 / inverse


def _first_guess(radiance: BandIntegral, logs: Floats) -> Floats:
    """1/T of the radiance taken as monochromatic at the band's long end."""
    span = radiance.cut_off_um - radiance.cut_on_um
    c2 = SECOND_RADIATION_CONSTANT_UM_K
    # L = scale · c2⁴ · λ⁻⁵ · Δλ / (eˣ − 1)
    front = np.log(radiance.scale) + 4.0 * np.log(c2) - 5.0 * np.log(radiance.cut_off_um)
    ratio = front + np.log(span) - logs
    x = np.logaddexp(0.0, ratio)  # ln(1 + e^ratio)
    return cast(Floats, np.maximum(x, 1e-300) * radiance.cut_off_um / c2)
