"""Strength of turbulence along a path, and Fried's coherence diameter from it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import non_negative, positive
from core.physics.numerics import gauss_legendre

# Heights (m) between which the Hufnagel-Valley profile is smooth enough for one Gauss rule.
_PANEL_HEIGHTS_M = (
    *(100, 250, 500, 1000, 2000, 4000, 6000, 8000, 10000, 12000, 14000, 16000, 20000, 24000),
    *(30000, 40000, 60000, 100000, 200000),
)
_NODES = 24


def hufnagel_valley_cn2(
    *, height_m: ArrayLike, wind_m_per_s: float = 21.0, ground_cn2: float = 1.7e-14
) -> NDArray[np.float64]:
    """Refractive-index structure constant against height.

    Parameters
    ----------
    height_m : array_like
        Heights above ground in m, any shape, finite, zero or above.
    wind_m_per_s : float
        rms wind speed from 5 to 20 km in m/s, zero or above.
    ground_cn2 : float
        Cn² at the ground in m^(−2/3), zero or above.

    Returns
    -------
    ndarray of float64
        Cn² in m^(−2/3). The defaults are the HV 5/7 model: r0 = 5 cm at 0.5 µm to the zenith.

    Source: L. C. Andrews and R. L. Phillips, Laser Beam Propagation through Random Media, 2nd ed.
    (SPIE, 2005), chapter 12, after Hufnagel (1974) and Valley (1980).
    """
    wind = non_negative("wind_m_per_s", wind_m_per_s, unit="m/s")
    ground = non_negative("ground_cn2", ground_cn2, unit="m^(-2/3)")
    height = np.asarray(height_m, dtype=np.float64)
    # Beyond 1000 km every term underflows; a larger height would overflow its tenth power first.
    height = np.minimum(height, 1e6)
    high = 0.00594 * (wind / 27.0) ** 2 * (1e-5 * height) ** 10 * np.exp(-height / 1000.0)
    middle = 2.7e-16 * np.exp(-height / 1500.0)
    return np.asarray(high + middle + ground * np.exp(-height / 100.0), dtype=np.float64)


def fried_r0_uniform_m(
    *, cn2: float, path_m: float, wavelength_um: float, wave: str = "spherical"
) -> float:
    """Fried's r0 of a path with the same Cn² all along (horizontal view).

    Parameters
    ----------
    cn2 : float
        Structure constant in m^(−2/3), zero or above.
    path_m : float
        Length of the path in m, zero or above.
    wavelength_um : float
        Wavelength in µm, above zero.
    wave : str
        `spherical` (a target at the end of the path) or `plane` (one far beyond it).

    Returns
    -------
    float
        r0 in m; infinite without turbulence.

    Source: Fried 1966; the spherical wave's mean weight is ∫u^{5/3}du = 3/8.
    """
    strength = non_negative("cn2", cn2, unit="m^(-2/3)")
    strength *= non_negative("path_m", path_m, unit="m")
    weight = 3.0 / 8.0 if _is_spherical(wave) else 1.0
    return _r0_m(strength * weight, wavelength_um)


def fried_r0_slant_m(
    *,
    target_height_m: float,
    sensor_height_m: float,
    path_m: float,
    wavelength_um: float,
    wave: str = "spherical",
    wind_m_per_s: float = 21.0,
    ground_cn2: float = 1.7e-14,
) -> float:
    """Fried's r0 of a straight path through the Hufnagel-Valley profile.

    Parameters
    ----------
    target_height_m, sensor_height_m : float
        Heights of the two ends above ground in m, zero or above.
    path_m : float
        Length of the path in m, at least the difference of the heights.
    wavelength_um : float
        Wavelength in µm, above zero.
    wave : str
        `spherical` (weight (z/L)^{5/3}, z from the target) or `plane` (weight 1).
    wind_m_per_s, ground_cn2 : float
        As in `hufnagel_valley_cn2`.

    Returns
    -------
    float
        (0.423 k² ∫Cn²·weight dz)^{−3/5} in m; infinite without turbulence.

    Raises
    ------
    ParameterError
        When a value is out of range, or the path is shorter than the difference of the heights.

    Source: Fried 1966; Andrews and Phillips 2005, chapter 12. Turbulence near the aperture blurs
    most, so looking down through it is better than looking up (Tantalo 1996, fig. 4.9).
    """
    low = non_negative("target_height_m", target_height_m, unit="m")
    rise = non_negative("sensor_height_m", sensor_height_m, unit="m") - low
    length = positive("path_m", path_m, unit="m")
    if length < abs(rise) * (1.0 - 1e-12):
        allowed = f"at least the difference of the heights, {abs(rise):g} m"
        raise ParameterError("path_m", path_m, allowed, unit="m")
    share, weights = _path_rule(low, rise)
    cn2 = hufnagel_valley_cn2(
        height_m=np.maximum(low + rise * share, 0.0),
        wind_m_per_s=wind_m_per_s,
        ground_cn2=ground_cn2,
    )
    if _is_spherical(wave):
        weights = weights * share ** (5.0 / 3.0)
    return _r0_m(length * float(np.sum(weights * cn2)), wavelength_um)


def _path_rule(low: float, rise: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights over the path from 0 (target) to 1 (sensor).

    The path is u = s³ with Gauss-Legendre panels in s: u^{5/3} is a polynomial in s, so the
    spherical weight costs no accuracy at the target's end.
    """
    inner = [(height - low) / rise for height in _PANEL_HEIGHTS_M] if rise else []
    edges = np.cbrt(np.sort([0.0, *(u for u in inner if 0.0 < u < 1.0), 1.0]))
    nodes, weights = gauss_legendre(_NODES)
    half = np.diff(edges)[:, np.newaxis] / 2.0
    s = (edges[:-1, np.newaxis] + half * (1.0 + nodes)).ravel()
    return s**3, (half * weights).ravel() * 3.0 * s**2


def _is_spherical(wave: str) -> bool:
    if wave not in ("spherical", "plane"):
        raise ParameterError("wave", wave, "one of spherical, plane")
    return wave == "spherical"


def _r0_m(moment: float, wavelength_um: float) -> float:
    """Coherence diameter for the weighted integral of Cn² over the path, in m^(1/3)."""
    wavelength_m = 1e-6 * positive("wavelength_um", wavelength_um, unit="µm")
    if not math.isfinite(moment):
        raise ParameterError("integral of cn2 over the path", moment, "finite", unit="m^(1/3)")
    if moment == 0.0:
        return math.inf
    # The root is taken of each factor: k² and the integral are 27 orders of magnitude apart.
    return float((0.423 * moment) ** -0.6 * (wavelength_m / (2.0 * math.pi)) ** 1.2)
