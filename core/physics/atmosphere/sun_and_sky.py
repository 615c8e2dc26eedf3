"""Light of sun and sky on a horizontal matt surface, and what that reflects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
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


LUMENS_PER_WATT = 683.0
EYE_UM = 0.38, 0.78
"""Wavelengths that the photopic eye sees."""

# Times 10⁻⁶, every 5 nm from 380 nm.
_EYE = (
    39, 64, 120, 217, 396, 640, 1210, 2180, 4000, 7300, 11600, 16840, 23000, 29800, 38000, 48000,
    60000, 73900, 90980, 112600, 139020, 169300, 208020, 258600, 323000, 407300, 503000, 608200,
    710000, 793200, 862000, 914850, 954000, 980300, 994950, 1000000, 995000, 978600, 952000,
    915400, 870000, 816300, 757000, 694900, 631000, 566800, 503000, 441200, 381000, 321000, 265000,
    217000, 175000, 138200, 107000, 81600, 61000, 44580, 32000, 23200, 17000, 11920, 8210, 5723,
    4102, 2929, 2091, 1484, 1047, 740, 520, 361, 249, 172, 120, 85, 60, 42, 30, 21, 15,
)  # fmt: skip


def luminous_efficiency(wavelength_um: ArrayLike) -> FloatArray:
    """V(λ): sensitivity of the light-adapted eye, 1 at 0.555 µm, 0 outside 0.38 to 0.78 µm.

    Source: CIE 018 (2019), table of V(λ), straight between its points.
    """
    known = np.linspace(*EYE_UM, len(_EYE))
    wavelength = np.asarray(wavelength_um, np.float64)
    values = np.interp(wavelength, known, np.array(_EYE) * 1e-6, left=0.0, right=0.0)
    return np.asarray(values)


def relative_air_mass(*, elevation_deg: float) -> float:
    """Length of the sun's way through the air over that from the zenith.

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
    illuminance_lux : float, optional
        To which all this light is scaled: 683 lm/W·∫V(λ)·E(λ) dλ.

    Source: Lambert 1760: L = ρ·(E_sun·e^{−τm}·sin h + E_sky)/π, E_sky = π·L_sky of an even sky.
    """

    elevation_deg: float
    irradiance: float | None = None
    points: Points = ()
    standard: bool = True
    sky: float = 0.0
    optical_depth: float = 0.0
    illuminance_lux: float | None = None

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
        scale = 1.0
        if self.illuminance_lux is not None:
            if not self.unscaled_lux:
                allowed = "the spectrum has no light from 0.38 to 0.78 µm to scale"
                if self.unscaled_lux is None:
                    allowed = "the spectrum must cover 0.38 to 0.78 µm"
                elif not (self.elevation_deg or self.sky):
                    allowed = "the sun is on the horizon and sky is 0; raise sun_elevation_deg"
                raise ParameterError("illuminance_lux", self.illuminance_lux, allowed, unit="lx")
            scale = self.illuminance_lux / self.unscaled_lux
        return scale * self._unscaled(wavelength_um)

    @cached_property
    def unscaled_lux(self) -> float | None:
        """Illuminance before it is scaled; None if the table does not cover what the eye sees."""
        places = [place for place, _ in self.points]
        if places and (places[0] > EYE_UM[0] or places[-1] < EYE_UM[1]):
            return None
        places = [*np.linspace(*EYE_UM, len(_EYE)).tolist(), *self._places()]
        wavelength, width = band_nodes(*EYE_UM, sorted(set(places)))
        seen = luminous_efficiency(wavelength) * self._unscaled(wavelength)
        return LUMENS_PER_WATT * float(width @ seen)

    def _unscaled(self, wavelength_um: ArrayLike) -> FloatArray:
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
        """Irradiance of a horizontal surface in a band, W/m², which the spectrum must cover."""
        require_covered(self.points, cut_on_um, cut_off_um)
        wavelength, width = band_nodes(cut_on_um, cut_off_um, self._places())
        return float(width @ self.on_surface(wavelength))

    def _places(self) -> Sequence[float]:
        """Where the spectrum may bend."""
        if self.standard and self.irradiance is None and not self.points:
            return list(map(float, standard_sun()[0]))
        return [place for place, _ in self.points]
