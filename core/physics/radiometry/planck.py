"""Planck's law: spectral and band radiance, its slope, and the temperature of a radiance."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.radiometry.band_integral import BandIntegral, reduced, temperature_from_log
from core.physics.radiometry.constants import (
    FIRST_RADIATION_CONSTANT_W_M2_SR,
    SECOND_RADIATION_CONSTANT_M_K,
    SPEED_OF_LIGHT_M_S,
)

FloatArray = NDArray[np.float64]
FloatOrArray = TypeVar("FloatOrArray", float, NDArray[np.float64])

_SHORTEST_UM, _LONGEST_UM = 1e-30, 1e30  # keeps λ⁻⁵ a finite number
_HOTTEST_K = 1e30  # keeps T⁴ a finite number


def spectral_radiance(wavelength_um: ArrayLike, temperature_K: ArrayLike) -> FloatArray:
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

    Raises
    ------
    ParameterError
        For a value out of range.

    Source: Planck 1900; Tantalo 1996, eq. 4.66 (exitance there, with rounded constants and the
    exponent of c1 misprinted).
    """
    wavelength = np.asarray(wavelength_um, dtype=float)
    _require_wavelengths(wavelength, "wavelength_um")
    x = reduced(wavelength, _temperatures(temperature_K))
    with np.errstate(under="ignore"):
        front = FIRST_RADIATION_CONSTANT_W_M2_SR * 1e24 / wavelength**5
        return np.asarray(front * (np.exp(-x) / -np.expm1(-x)))


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

    Raises
    ------
    ParameterError
        For a band or temperature out of range.

    Source: Tantalo 1996, eq. 4.65 (its exitance divided by π).
    """
    return _evaluated(_radiance(cut_on_um, cut_off_um), temperature_K)


def band_radiance_derivative(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Slope dL/dT of `band_radiance`, W m⁻² sr⁻¹ K⁻¹; parameters and errors as there.

    Source: Tantalo 1996, eqs. 4.63-4.64 (a difference quotient there, the derivative here).
    """
    _require_band(cut_on_um, cut_off_um)
    scale = FIRST_RADIATION_CONSTANT_W_M2_SR / SECOND_RADIATION_CONSTANT_M_K**4
    return _evaluated(BandIntegral(cut_on_um, cut_off_um, scale, 3, 4, 2), temperature_K)


def band_photon_radiance(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Photon radiance of a blackbody in a band, s⁻¹ m⁻² sr⁻¹; otherwise as `band_radiance`.

    Source: Planck's law divided by the energy hc/λ of a photon.
    """
    _require_band(cut_on_um, cut_off_um)
    scale = 2.0 * SPEED_OF_LIGHT_M_S / SECOND_RADIATION_CONSTANT_M_K**3
    return _evaluated(BandIntegral(cut_on_um, cut_off_um, scale, 3, 2, 1), temperature_K)


def band_photon_radiance_derivative(
    *, cut_on_um: float, cut_off_um: float, temperature_K: FloatOrArray
) -> FloatOrArray:
    """Slope dL_q/dT of `band_photon_radiance`, s⁻¹ m⁻² sr⁻¹ K⁻¹; otherwise as there."""
    _require_band(cut_on_um, cut_off_um)
    scale = 2.0 * SPEED_OF_LIGHT_M_S / SECOND_RADIATION_CONSTANT_M_K**3
    return _evaluated(BandIntegral(cut_on_um, cut_off_um, scale, 2, 3, 2), temperature_K)


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
    band = _radiance(cut_on_um, cut_off_um)
    values = np.asarray(radiance, dtype=float)
    brightest = float(band(np.array([_HOTTEST_K]))[0])
    faulty = ~((values >= 0.0) & (values <= brightest))
    if np.any(faulty):
        first = float(values[faulty].flat[0])
        raise DataError(
            f"radiance: {np.count_nonzero(faulty)} of {values.size} samples have no brightness"
            f" temperature, the first is {first!r} W/m²/sr: must be 0 to {brightest:.3g}"
        )
    temperature = np.zeros(values.size)
    lit = np.flatnonzero(values)
    if lit.size:
        temperature[lit] = temperature_from_log(band, np.log(values.ravel()[lit]), fitted=fitted)
    result: FloatOrArray = _as_given(temperature.reshape(values.shape))
    return result


def _radiance(cut_on_um: float, cut_off_um: float) -> BandIntegral:
    _require_band(cut_on_um, cut_off_um)
    scale = FIRST_RADIATION_CONSTANT_W_M2_SR / SECOND_RADIATION_CONSTANT_M_K**4
    return BandIntegral(cut_on_um, cut_off_um, scale, 4, 3, 1)


def _evaluated(integral: BandIntegral, temperature_K: FloatOrArray) -> FloatOrArray:
    result: FloatOrArray = _as_given(integral(_temperatures(temperature_K)))
    return result


def _as_given(values: FloatArray) -> Any:
    """A float for a 0-d array: what a scalar argument became."""
    return values[()]


def _temperatures(temperature_K: ArrayLike) -> FloatArray:
    values = np.asarray(temperature_K, dtype=float)
    allowed = (values >= 0.0) & (values <= _HOTTEST_K)
    if not np.all(allowed):
        first = float(values[~allowed].flat[0])
        raise ParameterError("temperature_K", first, f"must be 0 to {_HOTTEST_K:g}", unit="K")
    return values


def _require_wavelengths(values: FloatArray, name: str) -> None:
    allowed = (values >= _SHORTEST_UM) & (values <= _LONGEST_UM)
    if not np.all(allowed):
        first = float(values[~allowed].flat[0])
        raise ParameterError(name, first, f"must be above 0 and at most {_LONGEST_UM:g}", unit="µm")


def _require_band(cut_on_um: float, cut_off_um: float) -> None:
    _require_wavelengths(np.asarray(cut_on_um, dtype=float), "cut_on_um")
    _require_wavelengths(np.asarray(cut_off_um, dtype=float), "cut_off_um")
    if not cut_on_um < cut_off_um:
        allowed = f"must be above cut_on_um = {cut_on_um!r} µm"
        raise ParameterError("cut_off_um", cut_off_um, allowed, unit="µm")
