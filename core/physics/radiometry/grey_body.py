"""Radiance of surfaces of an emissivity, and the temperature of a radiance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.radiometry.constants import STEFAN_BOLTZMANN_W_M2_K4
from core.physics.radiometry.planck import (
    band_radiance,
    band_radiance_derivative,
    brightness_temperature_of_samples,
)
from core.physics.radiometry.spectra import SUN_SHARE

FloatArray = NDArray[np.float64]
_OFFSETS_K = {"K": 0.0, "kelvin": 0.0, "°C": 273.15, "C": 273.15, "degC": 273.15}


def in_kelvin(samples: NDArray[Any], *, unit: str) -> FloatArray:
    """Temperatures in a unit as kelvin."""
    values, unit = np.asarray(samples, np.float64), unit.strip()
    if unit == "mK":
        return values * 1e-3
    if unit == "°F":
        return (values + 459.67) / 1.8
    if unit not in _OFFSETS_K:
        raise DataError(f"{unit!r:.40} is not a unit of temperature; allowed: K, °C, °F or mK")
    return values + _OFFSETS_K[unit]


def grey_radiance(
    *,
    temperature_K: ArrayLike,
    emissivity: ArrayLike,
    surroundings_K: float | None,
    cut_on_um: float,
    cut_off_um: float,
) -> FloatArray:
    """Band radiance of opaque surfaces: emitted, and reflected from the surroundings.

    Parameters
    ----------
    temperature_K : array_like
        Of the surfaces.
    emissivity : array_like
        0 to 1, the same over the band; what it lacks is reflected. Broadcasts.
    surroundings_K : float or None
        Temperature of what is reflected, a black body all round; None for none.

    Returns
    -------
    ndarray
        ε·L(T) + (1 − ε)·L(surroundings), W/m²/sr.

    Source: Kirchhoff's law; Holst 2000, Common Sense Approach to Thermal Imaging, chapter 3.
    """
    band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    share = _emissivity(emissivity)
    radiance = share * band_radiance(temperature_K=np.asarray(temperature_K, float), **band)
    if surroundings_K is not None:
        radiance = radiance + (1.0 - share) * band_radiance(temperature_K=surroundings_K, **band)
    return np.asarray(radiance)


def grey_temperature(
    *,
    radiance: ArrayLike,
    emissivity: ArrayLike,
    surroundings_K: float | None,
    cut_on_um: float,
    cut_off_um: float,
) -> FloatArray:
    """Temperature of opaque surfaces that give a band radiance: the inverse of `grey_radiance`."""
    band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    share = _emissivity(emissivity)
    if not np.all(share > 0.0):
        raise DataError(
            "a surface with an emissivity of 0 emits nothing, so its temperature cannot be "
            "determined: give an emissivity above 0"
        )
    emitted = np.asarray(radiance, np.float64)
    if surroundings_K is not None:
        emitted = emitted - (1.0 - share) * band_radiance(temperature_K=surroundings_K, **band)
    return np.asarray(brightness_temperature_of_samples(radiance=emitted / share, **band))


def grey_radiance_slope(
    *, temperature_K: float, emissivity: float, cut_on_um: float, cut_off_um: float
) -> float:
    """Derivative of `grey_radiance` by the temperature, W/m²/sr/K."""
    band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    return emissivity * float(band_radiance_derivative(temperature_K=temperature_K, **band))


def _emissivity(values: ArrayLike) -> FloatArray:
    share = np.asarray(values, np.float64)
    wrong = ~((share >= 0.0) & (share <= 1.0))
    if np.any(wrong):
        first = float(share[wrong].flat[0])
        raise DataError(
            f"emissivity: {np.count_nonzero(wrong)} of {share.size} samples are outside 0 to 1 "
            f"(the first is {first:g})"
        )
    return share


# How bright the surfaces of the Earth can be: what radiance of a scene is beyond nature.

COLDEST_SURFACE_K = 162.25
HOTTEST_SURFACE_K = 353.95
"""−110.9 °C in Antarctica and 80.8 °C in the Lut and Sonoran deserts: the extremes of land surface
temperature in 18 years of MODIS. Source: Zhao, Norouzi, Azarderakhsh, AghaKouchak 2021, Bulletin of
the American Meteorological Society 102 (9)."""

_SUN_K = 5772.0
"""Nominal effective temperature: IAU 2015, resolution B3."""


def brightest_surface_radiance(*, band_um: tuple[float, float] | None) -> float:
    """Radiance, W m⁻² sr⁻¹, that no natural surface of the Earth exceeds in a band.

    A blackbody at the hottest land surface, and on top of it a white matt surface in overhead sun
    without an atmosphere. Either alone is more than any surface gives. Flames, lamps, engines,
    glints and the Sun itself may be brighter. A band of None is all wavelengths together.

    Source: Planck's law; the Sun as a blackbody of its nominal effective temperature.
    """
    return _radiance(band_um, HOTTEST_SURFACE_K) + SUN_SHARE * _radiance(band_um, _SUN_K)


def coldest_for_radiance(*, radiance: float) -> float:
    """Temperature below which no blackbody has that radiance in any band, K.

    It is the one that has it over all wavelengths together: (π·L/σ)^¼, after Stefan and Boltzmann.
    `radiance` is in W m⁻² sr⁻¹, 0 or above.
    """
    return float((math.pi * radiance / STEFAN_BOLTZMANN_W_M2_K4) ** 0.25)


def _radiance(band_um: tuple[float, float] | None, temperature_K: float) -> float:
    if band_um is None:
        return float(STEFAN_BOLTZMANN_W_M2_K4 * temperature_K**4 / math.pi)
    return float(
        band_radiance(cut_on_um=band_um[0], cut_off_um=band_um[1], temperature_K=temperature_K)
    )
