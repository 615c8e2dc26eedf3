"""Light of sun and sky on a horizontal matt surface, and what that reflects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.atmosphere.air_path import Points, require_covered
from core.physics.checks import non_negative, within
from core.physics.radiometry.planck import band_nodes, spectral_radiance
from core.physics.radiometry.spectra import SUN_SHARE, SUNLIGHT_K

FloatArray = NDArray[np.float64]

SUN_SR = math.pi * SUN_SHARE
"""Solid angle of the Sun at its mean distance."""


@lru_cache(maxsize=1)
def standard_sun() -> tuple[FloatArray, FloatArray]:
    """Wavelengths of the standard solar spectrum, 0.28 to 4 µm, and its irradiance, W/m²/µm.

    Source: ASTM G173-03, extraterrestrial column (Gueymard 2004, Solar Energy 76, 423), as
    distributed by NREL with SMARTS 2.9.2.
    """
    path = Path(__file__).with_name("astm_g173_extraterrestrial.csv")
    wavelength, irradiance = np.loadtxt(path, delimiter=",", unpack=True)
    return wavelength, irradiance


def standard_sun_irradiance(wavelength_um: ArrayLike) -> FloatArray:
    """Irradiance of the Sun above the air, at one astronomical unit, by the standard spectrum.

    Parameters
    ----------
    wavelength_um : array_like
        From 0.28 µm on. Beyond 4 µm, where the table ends, a black body of 5800 K continues it.

    Returns
    -------
    ndarray
        W/m²/µm, straight between the points of the table.

    Raises
    ------
    ParameterError
        For a wavelength below the table.

    Source: ASTM G173-03, as of `standard_sun`.
    """
    wavelength = np.asarray(wavelength_um, np.float64)
    known, values = standard_sun()
    shortest = float(wavelength.min(initial=math.inf))
    if not shortest >= known[0]:
        allowed = f"at least {known[0]:g}, where the standard solar spectrum begins"
        raise ParameterError("cut_on_um", shortest, allowed, unit="µm")
    inside = np.interp(wavelength, known, values)
    if not np.any(wavelength > known[-1]):
        return np.asarray(inside)
    end = float(spectral_radiance(known[-1], SUNLIGHT_K))
    beyond = values[-1] / end * spectral_radiance(wavelength, SUNLIGHT_K)
    return np.asarray(np.where(wavelength > known[-1], beyond, inside))


def relative_air_mass(*, elevation_deg: float) -> float:
    """Length of the sun's way through the air over that from the zenith.

    Parameters
    ----------
    elevation_deg : float
        Of the sun above the horizon, 0 to 90.

    Returns
    -------
    float
        1 at the zenith within 0.03 %, 38 at the horizon.

    Source: F. Kasten and A. T. Young, Appl. Opt. 28, 4735 (1989).
    """
    height = within("sun_elevation_deg", elevation_deg, 0.0, 90.0, unit="deg")
    below = 0.50572 * (height + 6.07995) ** -1.6364
    return float(1.0 / (math.sin(math.radians(height)) + below))


@dataclass(frozen=True)
class Sunlight:
    """Sun and sky over a horizontal surface.

    Parameters
    ----------
    elevation_deg : float
        Of the sun, 0 to 90.
    irradiance : float, optional
        Of the sun above the air, W/m²/µm, on a surface that faces it; at all wavelengths.
    points : tuple of (float, float)
        Wavelength in µm, rising, and that irradiance, straight between them.
    standard : bool
        Without both, the standard spectrum, or a black body of 5800 K at the sun's distance.
    sky : float
        Radiance of the sky, the same all over, W/m²/sr/µm.
    optical_depth : float
        Of the air from the zenith, in the way of the sun alone.

    Source: Lambert 1760: L = ρ·(E_sun·e^{−τm}·sin h + E_sky)/π, E_sky = π·L_sky of an even sky.
    """

    elevation_deg: float
    irradiance: float | None = None
    points: Points = ()
    standard: bool = True
    sky: float = 0.0
    optical_depth: float = 0.0

    def __post_init__(self) -> None:
        within("sun_elevation_deg", self.elevation_deg, 0.0, 90.0, unit="deg")
        non_negative("sky", self.sky, unit="W/m²/sr/µm")
        non_negative("optical_depth", self.optical_depth)
        if self.irradiance is not None:
            non_negative("solar_irradiance", self.irradiance, unit="W/m²/µm")
        for _, value in self.points:
            non_negative("solar_irradiance", value, unit="W/m²/µm")

    def on_surface(self, wavelength_um: ArrayLike) -> FloatArray:
        """Irradiance of a horizontal surface at wavelengths, W/m²/µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.points:
            known, values = np.array(self.points).T
            sun = np.interp(wavelength, known, values)
        elif self.irradiance is not None:
            sun = np.full(wavelength.shape, self.irradiance)
        elif self.standard:
            sun = standard_sun_irradiance(wavelength)
        else:
            sun = SUN_SR * spectral_radiance(wavelength, SUNLIGHT_K)
        way = relative_air_mass(elevation_deg=self.elevation_deg)
        passed = math.exp(-self.optical_depth * way)
        share = passed * math.sin(math.radians(self.elevation_deg))
        return np.asarray(share * sun + math.pi * self.sky)

    def over_band(self, cut_on_um: float, cut_off_um: float) -> float:
        """Irradiance of a horizontal surface in a band, W/m².

        Raises
        ------
        ParameterError
            For a table, or a standard spectrum, that does not cover the band.
        """
        require_covered(self.points, cut_on_um, cut_off_um)
        places: Sequence[float] = [place for place, _ in self.points]
        if self.standard and self.irradiance is None and not self.points:
            places = standard_sun()[0].tolist()
        wavelength, width = band_nodes(cut_on_um, cut_off_um, places)
        return float(width @ self.on_surface(wavelength))
