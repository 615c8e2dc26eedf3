"""The Sun's direct light on the ground, without the air."""

from __future__ import annotations

import math

from core.errors import ParameterError
from core.physics.radiometry.planck import band_radiance

SUNLIGHT_K = 5800.0
"""Temperature of the black body that stands for the Sun's spectrum."""

_SUN_RADIUS_M = 6.957e8
_ASTRONOMICAL_UNIT_M = 1.495978707e11
SUN_SHARE = (_SUN_RADIUS_M / _ASTRONOMICAL_UNIT_M) ** 2
"""Radiance of a white matt surface in overhead sun, as a share of the Sun's own. Source of the
numbers: IAU 2015, resolution B3 (nominal values); IAU 2012, resolution B2."""


def white_surface_radiance(
    *, cut_on_um: float, cut_off_um: float, sun_elevation_deg: float
) -> float:
    """Band radiance of a level, white, matt surface in direct sunlight.

    L = E·sin(elevation)/π with E = Ω·L_band(5800 K), Ω/π = (radius/distance)² of the Sun.

    Parameters
    ----------
    cut_on_um, cut_off_um : float
        Band [µm].
    sun_elevation_deg : float
        Of the Sun above the horizon, 0 to 90.

    Returns
    -------
    float
        Radiance [W m⁻² sr⁻¹]; 0 where the Sun is on the horizon.

    Raises
    ------
    ParameterError
        For a band or an elevation out of range.

    Notes
    -----
    Source: Planck's law; Lambert's cosine law. Over all wavelengths E is 1390 W m⁻², where 1361
    are measured (Kopp and Lean 2011, Geophysical Research Letters 38, L01706).
    """
    if not 0.0 <= sun_elevation_deg <= 90.0:
        raise ParameterError("sun_elevation_deg", sun_elevation_deg, "0 to 90", unit="deg")
    own = band_radiance(cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=SUNLIGHT_K)
    return SUN_SHARE * math.sin(math.radians(sun_elevation_deg)) * float(own)
