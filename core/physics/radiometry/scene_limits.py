"""How bright the surfaces of the Earth can be: what radiance of a scene is beyond nature."""

from __future__ import annotations

import math

from core.physics.radiometry.constants import STEFAN_BOLTZMANN_W_M2_K4
from core.physics.radiometry.planck import band_radiance
from core.physics.radiometry.sunlight import SUN_SHARE

COLDEST_SURFACE_K = 162.25
HOTTEST_SURFACE_K = 353.95
"""−110.9 °C in Antarctica and 80.8 °C in the Lut and Sonoran deserts: the extremes of land surface
temperature in 18 years of MODIS. Source: Zhao, Norouzi, Azarderakhsh, AghaKouchak 2021, Bulletin of
the American Meteorological Society 102 (9)."""

_SUN_K = 5772.0
"""Nominal effective temperature: IAU 2015, resolution B3."""


def brightest_surface_radiance(*, band_um: tuple[float, float] | None) -> float:
    """Radiance that no natural surface of the Earth exceeds in a band.

    Parameters
    ----------
    band_um
        The band, µm; None for all wavelengths together.

    Returns
    -------
    W m⁻² sr⁻¹: a blackbody at the hottest land surface, and on top of it a white matt surface in
    overhead sun without an atmosphere. Either alone is more than any surface gives. Flames, lamps,
    engines, glints and the Sun itself may be brighter.

    Raises
    ------
    ParameterError
        For a band out of range.

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
