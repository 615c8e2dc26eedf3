"""Turbulence and aerosol scattering between target and aperture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import non_negative, positive, within

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
    wavelength_um : float
        Wavelength in µm, above zero.
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

    Raises
    ------
    ParameterError
        When a value is out of range, or alpha is above 0 without an aperture.

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
            raise ParameterError("aperture_mm", None, "needed when alpha is above 0", unit="mm")
        diameter = positive("aperture_mm", aperture_mm, unit="mm")
        with np.errstate(over="ignore"):
            exponent = exponent * np.maximum(0.0, 1.0 - share * np.cbrt(lag_mm / diameter))
    return np.asarray(np.exp(exponent), dtype=np.float64)


def _r0_m(fried_r0_m: float) -> float:
    if isinstance(fried_r0_m, int | float | np.floating) and fried_r0_m == math.inf:
        return math.inf
    return positive("fried_r0_m", fried_r0_m, unit="m")


def fried_r0_at_m(*, fried_r0_m: float, from_wavelength_um: float, wavelength_um: float) -> float:
    """Fried's r0 of the same air at another wavelength.

    Parameters
    ----------
    fried_r0_m : float
        r0 in m, above zero, or infinite.
    from_wavelength_um, wavelength_um : float
        Wavelength at which it holds, and that of the result; µm, above zero.

    Returns
    -------
    float
        r0·(λ/λ₀)^{6/5} in m.

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
    """MTF of small-angle scattering by particles of one radius.

    Parameters
    ----------
    rho, optical_depth
        As of `aerosol_mtf`.
    particle_radius_um, wavelength_um : float
        Radius a and wavelength λ in µm, above zero.

    Returns
    -------
    ndarray of float64
        `aerosol_mtf` with the cutoff a/λ cycles/rad.

    Source: as of `aerosol_mtf`: light scattered by a particle spreads over about λ/a.
    """
    radius = positive("particle_radius_um", particle_radius_um, unit="µm")
    cutoff = radius / positive("wavelength_um", wavelength_um, unit="µm") / 1000.0
    return aerosol_mtf(rho=rho, optical_depth=optical_depth, cutoff_cyc_per_mrad=cutoff)


def turbidity_optical_depth(*, level: str) -> float:
    """Optical depth that gives the plateau of a named turbidity level.

    Parameters
    ----------
    level : str
        `none`, `low`, `moderate` or `high`: plateaus 1, 0.99, 0.975 and 0.955.

    Returns
    -------
    float
        −ln(plateau), without unit.

    Source: Tantalo 1996, fig. 4.8a, after Kaufman (1982) and Pearce (1977).
    """
    plateaus = dict(_TURBIDITY_PLATEAUS)
    if level not in plateaus:
        raise ParameterError("turbidity", level, "one of " + ", ".join(plateaus))
    return abs(math.log(plateaus[level]))


@dataclass(frozen=True, slots=True)
class PathOpticalDepth:
    """Optical depth of a path, by cause; both without unit."""

    absorption: float
    scattering: float

    @property
    def extinction(self) -> float:
        """Absorption and scattering together: exp(−extinction) is the direct transmission."""
        return self.absorption + self.scattering


def path_optical_depth(
    *,
    absorption_per_km: float,
    scattering_per_km: float,
    path_m: float,
    view: str = "horizontal",
    scale_height_km: float = 1.0,
) -> PathOpticalDepth:
    """Optical depth from the ground coefficients and the length of the path.

    Parameters
    ----------
    absorption_per_km, scattering_per_km : float
        Aerosol coefficients at ground level in km⁻¹, zero or above.
    path_m : float
        Length of the path in m, zero or above: range, or height when looking down or up.
    view : str
        `horizontal`: the same air all along, coefficient × path. `vertical` (down) and `up`, which
        have the same depth: coefficients that fall as exp(−height/scale height) from the ground to
        the height `path_m`.
    scale_height_km : float
        Scale height of the aerosol in km, above zero; not used by `horizontal`.

    Returns
    -------
    PathOpticalDepth
        Absorption and scattering apart. Absorption dims every frequency alike, zero included, so
        the depth of an MTF is `scattering`; `extinction` is that of the path's transmission.

    Source: horizontal, Sadot and Kopeika 1992. Vertical: exponential profile, L. Elterman, Appl.
    Opt. 9, 1804 (1970); an effective height of 1 km in the visible, falling to 0.2-0.3 km in 8 to
    12 µm, is reported by N. N. Shchelkanov, Proc. SPIE 5397 (2004).
    """
    absorption = non_negative("absorption_per_km", absorption_per_km, unit="1/km")
    scattering = non_negative("scattering_per_km", scattering_per_km, unit="1/km")
    path_km = non_negative("path_m", path_m, unit="m") / 1000.0
    height = positive("scale_height_km", scale_height_km, unit="km")
    if view in ("vertical", "up"):
        path_km = -height * math.expm1(-path_km / height)
    elif view != "horizontal":
        raise ParameterError("view", view, "one of horizontal, vertical, up")
    depth = PathOpticalDepth(absorption * path_km, scattering * path_km)
    if not math.isfinite(depth.extinction):
        raise ParameterError("path_m", path_m, "a path with a finite optical depth", unit="m")
    return depth
