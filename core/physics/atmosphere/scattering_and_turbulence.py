"""Turbulence and aerosol scattering between target and aperture."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.numerics import gauss_legendre, non_negative, positive, within

# Plateaus of the three curves of Tantalo 1996, fig. 4.8a.
_TURBIDITY_PLATEAUS = (("none", 1.0), ("low", 0.99), ("moderate", 0.975), ("high", 0.955))

# Beyond this the exponent of Fried's form is infinite for any use; kept finite because the
# short-exposure factor may multiply it by zero.
_LARGEST_LAG_RATIO = 1e150
_LARGEST_LAG_MM = 1e300


def fried_mtf(
    *,
    rho: ArrayLike,
    wavelength_um: float,
    fried_r0_m: float,
    aperture_mm: float | None = None,
    alpha: float = 0.0,
    r0_wavelength_um: float | None = None,
) -> NDArray[np.float64]:
    """MTF of atmospheric turbulence, long or short exposure.

    Parameters
    ----------
    rho : array_like
        Radial frequencies in cycles/mrad, any shape, finite.
    fried_r0_m : float
        Fried's coherence diameter in m, above zero; infinite for air without turbulence.
    aperture_mm : float, optional
        Diameter of the receiving aperture in mm, above zero; needed when alpha is not 0.
    alpha : float
        Share of the wavefront tilt taken out, 0 to 1: 0 long exposure, 1 short exposure in the
        near field, 0.5 in the far field.
    r0_wavelength_um : float, optional
        Wavelength in µm at which `fried_r0_m` holds, above zero; if not given, `wavelength_um`.

    Returns
    -------
    ndarray of float64
        exp(−3.44(λρ/r0)^{5/3}·max(0, 1 − α(λρ/D)^{1/3})), of the shape of `rho`.

    Source: D. L. Fried, J. Opt. Soc. Am. 56, 1372 (1966). The expansion holds for
    λρ < D only; the factor is kept from going negative, so that the MTF never exceeds 1.
    """
    wavelength = positive("wavelength_um", wavelength_um, unit="µm")
    share = within("alpha", alpha, 0.0, 1.0)
    r0_m = _r0_m(fried_r0_m)
    if r0_wavelength_um is not None:
        r0_m = fried_r0_at_m(
            fried_r0_m=r0_m, from_wavelength_um=r0_wavelength_um, wavelength_um=wavelength
        )
    r0_mm = 1000.0 * r0_m
    with np.errstate(over="ignore"):
        lag_mm = wavelength * np.abs(np.asarray(rho, dtype=np.float64))
        lag_mm = np.minimum(lag_mm, _LARGEST_LAG_MM)
        ratio = np.minimum(lag_mm / r0_mm, _LARGEST_LAG_RATIO)
    exponent = -3.44 * ratio ** (5.0 / 3.0)
    if share > 0.0:
        if aperture_mm is None:
            raise ParameterError(
                "aperture_mm", None, "the aperture is needed when alpha is above 0", unit="mm"
            )
        diameter = positive("aperture_mm", aperture_mm, unit="mm")
        with np.errstate(over="ignore"):
            exponent = exponent * np.maximum(0.0, 1.0 - share * np.cbrt(lag_mm / diameter))
    return np.asarray(np.exp(exponent), dtype=np.float64)


def _r0_m(fried_r0_m: float) -> float:
    if isinstance(fried_r0_m, int | float | np.floating) and fried_r0_m == math.inf:
        return math.inf
    return positive("fried_r0_m", fried_r0_m, unit="m")


def fried_r0_at_m(*, fried_r0_m: float, from_wavelength_um: float, wavelength_um: float) -> float:
    """Fried's r0 of the same air at another wavelength: r0·(λ/λ₀)^{6/5}, in m.

    Source: Fried 1966: r0 = (0.423 k² ∫Cn² dz)^{−3/5}, k = 2π/λ, in air without dispersion.
    """
    old = positive("r0_wavelength_um", from_wavelength_um, unit="µm")
    new = positive("wavelength_um", wavelength_um, unit="µm")
    return float(_r0_m(fried_r0_m) * (new / old) ** 1.2)


def aerosol_mtf(
    *, rho: ArrayLike, optical_depth: float, cutoff_cyc_per_mrad: float = 0.001
) -> NDArray[np.float64]:
    """MTF of small-angle scattering by aerosols (turbidity).

    Parameters
    ----------
    rho : array_like
        Radial frequencies in cycles/mrad, any shape, finite.
    optical_depth : float
        Optical depth τ of the path, zero or above; the plateau is exp(−τ).
    cutoff_cyc_per_mrad : float
        Particle radius over wavelength, in cycles/mrad, above zero.

    Returns
    -------
    ndarray of float64
        exp(−τ(ρ/ρc)²) below the cutoff, exp(−τ) from there on.

    Source: D. Sadot and N. S. Kopeika, Opt. Eng. 31, 200 (1992) and N. S. Kopeika, A System
    Engineering Approach to Imaging (SPIE, 1998), divided by its value at zero frequency.
    """
    depth = non_negative("optical_depth", optical_depth)
    cutoff = positive("cutoff_cyc_per_mrad", cutoff_cyc_per_mrad, unit="cyc/mrad")
    with np.errstate(over="ignore"):
        ratio = np.minimum(np.abs(np.asarray(rho, dtype=np.float64)) / cutoff, 1.0)
    return np.asarray(np.exp(-depth * np.square(ratio)), dtype=np.float64)


def aerosol_mtf_of_particles(
    *, rho: ArrayLike, optical_depth: float, particle_radius_um: float, wavelength_um: float
) -> NDArray[np.float64]:
    """`aerosol_mtf` of particles of one radius a, whose cutoff is a/λ cycles/rad.

    Source: as of `aerosol_mtf`: light scattered by a particle spreads over about λ/a.
    """
    radius = positive("particle_radius_um", particle_radius_um, unit="µm")
    cutoff = radius / positive("wavelength_um", wavelength_um, unit="µm") / 1000.0
    return aerosol_mtf(rho=rho, optical_depth=optical_depth, cutoff_cyc_per_mrad=cutoff)


def turbidity_optical_depth(*, level: str) -> float:
    """Optical depth −ln(plateau) of the turbidity `none`, `low`, `moderate` or `high`.

    The plateaus are 1, 0.99, 0.975 and 0.955.
    Source: Tantalo 1996, fig. 4.8a, after Kaufman (1982) and Pearce (1977).
    """
    plateaus = dict(_TURBIDITY_PLATEAUS)
    if level not in plateaus:
        raise ParameterError("turbidity", level, "one of " + ", ".join(plateaus))
    return abs(math.log(plateaus[level]))


def path_optical_depth(
    *, scattering_per_km: float, path_m: float, view: str = "horizontal", scale_height_km: float
) -> float:
    """Optical depth of a path by its aerosols' scattering at ground level.

    Absorption dims every frequency alike, zero included, so that it has no part in an MTF.

    Parameters
    ----------
    path_m : float
        Length of the path in m, zero or above: range, or height when looking down or up.
    view : str
        `horizontal`: the same air all along, coefficient × path. `vertical` (down) and `up`, which
        have the same depth: coefficients that fall as exp(−height/scale height) from the ground to
        the height `path_m`.

    Source: horizontal, Sadot and Kopeika 1992. Vertical: exponential profile, L. Elterman, Appl.
    Opt. 9, 1804 (1970); an effective height of 1 km in the visible, falling to 0.2-0.3 km in 8 to
    12 µm, is reported by N. N. Shchelkanov, Proc. SPIE 5397 (2004).
    """
    scattering = non_negative("scattering_per_km", scattering_per_km, unit="1/km")
    path_km = non_negative("path_m", path_m, unit="m") / 1000.0
    height = positive("scale_height_km", scale_height_km, unit="km")
    if view in ("vertical", "up"):
        path_km = -height * math.expm1(-path_km / height)
    elif view != "horizontal":
        raise ParameterError("view", view, "one of horizontal, vertical, up")
    if not math.isfinite(scattering * path_km):
        raise ParameterError("path_m", path_m, "the optical depth must be finite", unit="m")
    return scattering * path_km


# Strength of turbulence along a path, and Fried's coherence diameter from it.

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
    """Fried's r0 in m of a path with the same Cn² all along (horizontal view).

    `cn2` is in m^(−2/3). The wave is `spherical` (a target at the end of the path) or `plane` (one
    far beyond it). Infinite without turbulence.

    Source: Fried 1966; the spherical wave's mean weight is ∫u^{5/3}du = 3/8.
    """
    strength = non_negative("cn2", cn2, unit="m^(-2/3)")
    strength *= non_negative("path_m", path_m, unit="m")
    weight = 3.0 / 8.0 if _is_spherical(wave) else 1.0
    return _coherence_m(strength * weight, wavelength_um)


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
    wave : str
        `spherical` (weight (z/L)^{5/3}, z from the target) or `plane` (weight 1).
    wind_m_per_s, ground_cn2 : float
        As in `hufnagel_valley_cn2`.

    Returns
    -------
    float
        (0.423 k² ∫Cn²·weight dz)^{−3/5} in m; infinite without turbulence.

    Source: Fried 1966; Andrews and Phillips 2005, chapter 12. Turbulence near the aperture blurs
    most, so looking down through it is better than looking up (Tantalo 1996, fig. 4.9).
    """
    low = non_negative("target_height_m", target_height_m, unit="m")
    rise = non_negative("sensor_height_m", sensor_height_m, unit="m") - low
    length = positive("path_m", path_m, unit="m")
    if length < abs(rise) * (1.0 - 1e-12):
        allowed = f"at least the height difference, {abs(rise):g} m"
        raise ParameterError("path_m", path_m, allowed, unit="m")
    share, weights = _path_rule(low, rise)
    cn2 = hufnagel_valley_cn2(
        height_m=np.maximum(low + rise * share, 0.0),
        wind_m_per_s=wind_m_per_s,
        ground_cn2=ground_cn2,
    )
    if _is_spherical(wave):
        weights = weights * share ** (5.0 / 3.0)
    return _coherence_m(length * float(np.sum(weights * cn2)), wavelength_um)


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


def _coherence_m(moment: float, wavelength_um: float) -> float:
    """Coherence diameter for the weighted integral of Cn² over the path, in m^(1/3)."""
    wavelength_m = 1e-6 * positive("wavelength_um", wavelength_um, unit="µm")
    if not math.isfinite(moment):
        raise ParameterError("integral of cn2 over the path", moment, "finite", unit="m^(1/3)")
    if moment == 0.0:
        return math.inf
    # The root is taken of each factor: k² and the integral are 27 orders of magnitude apart.
    return float((0.423 * moment) ** -0.6 * (wavelength_m / (2.0 * math.pi)) ** 1.2)
