"""Spectra: detector materials, each number with its source; sunlight; coarse tables.

The values are typical published ones, not those of one device; a measured D* is typed in as
`manual` instead.
"""

import math
from math import inf
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats
from core.errors import DataError, ParameterError, several
from core.physics.numerics import gauss_legendre
from core.physics.radiometry.planck import (
    STEFAN_BOLTZMANN_W_M2_K4,
    band_radiance,
    band_radiance_derivative,
    brightness_temperature_of_samples,
    spectral_radiance,
)
from core.records import dataclass

MANUAL = "manual"
"""The choice of a D* typed in by hand, in every region."""


@dataclass(frozen=True)
class Material:
    """A photon detector: all photons up to the cut-off count alike, unless it is a Schottky one.

    `quantum_efficiency` holds up to `cut_off_um`; with `fowler_per_eV` it is the internal
    photoemission C1·(hν − ψ)²/hν with ψ = hc/`cut_off_um` instead. `noise_factor` is 2 for the
    shot noise of a junction and 4 for generation and recombination in a photoconductor.
    """

    name: str
    cut_off_um: float
    temperature_K: float
    noise_factor: Literal[2, 4]
    quantum_efficiency: float = 0.0
    fowler_per_eV: float = 0.0
    resistance_area_ohm_cm2: float = inf
    dark_current_A_per_cm2: float = 0.0


# Photodiode at room temperature: band gap 1.12 eV (Sze 1981); zero-bias resistance of about 1 GΩ
# for 1 mm² (makers' data sheets), D* about 1e13 at the peak.
SILICON = Material("Si", 1.107, 300.0, 2, quantum_efficiency=0.7, resistance_area_ohm_cm2=1e7)

# Photovoltaic at 77 K (Rogalski 2011, Infrared Detectors, InSb photodiodes); EG&G Judson 1995: D*
# about 1e11 at 5 µm in a 60° field of view.
INSB = Material("InSb", 5.5, 77.0, 2, quantum_efficiency=0.7, resistance_area_ohm_cm2=1e6)

# Schottky barrier of 0.22 eV on p-type silicon; emission C1 (hν − ψ)²/hν (Fowler 1931), C1 0.2 to
# 0.4 per eV (Shepherd 1992); about 1% at 4 µm.
PTSI = Material("PtSi", 5.6, 77.0, 2, fowler_per_eV=0.25, dark_current_A_per_cm2=1e-9)

# Photovoltaic, Hg0.70Cd0.30Te at 77 K; cutoff from the band gap of Hansen, Schmit and Casselman
# 1982.
HGCDTE_MWIR = Material("HgCdTe", 5.1, 77.0, 2, quantum_efficiency=0.7, resistance_area_ohm_cm2=1e6)

# Photoconductive, Hg0.79Cd0.21Te at 77 K; cutoff as above; EG&G Judson 1995: D* about 4e10 in a 60°
# field of view.
HGCDTE_LWIR = Material("HgCdTe", 12.5, 77.0, 4, quantum_efficiency=0.7)

# Extrinsic photoconductors of ionization energies of 0.0725 and 0.0537 eV (Bratt 1977,
# Semiconductors and Semimetals 12).
SI_GA = Material("Si:Ga", 17.1, 20.0, 4, quantum_efficiency=0.3)
SI_AS = Material("Si:As", 23.1, 10.0, 4, quantum_efficiency=0.2)

MATERIALS_BY_REGION = MappingProxyType(
    {"VIS": (SILICON,), "MWIR": (INSB, PTSI, HGCDTE_MWIR), "LWIR": (HGCDTE_LWIR, SI_GA, SI_AS)}
)
"""Which materials serve which region (Tantalo 1996, fig. 4.42)."""


def find_material(*, region: str, material: str, cut_off_um: float | None = None) -> Material:
    """The material of a name in a wavelength region.

    A material the region does not have is looked for in the others: of several compositions the
    one with the shortest cut-off that reaches `cut_off_um`, else the longest.
    """
    if region not in MATERIALS_BY_REGION:
        raise ParameterError("region", region, f"must be one of {', '.join(MATERIALS_BY_REGION)}")
    choices = {choice.name: choice for choice in MATERIALS_BY_REGION[region]}
    if material in choices:
        return choices[material]
    everywhere = [choice for part in MATERIALS_BY_REGION.values() for choice in part]
    named = [choice for choice in everywhere if choice.name == material]
    if not named:
        names = ", ".join(dict.fromkeys([*(choice.name for choice in everywhere), MANUAL]))
        raise ParameterError("material", material, f"must be one of {names}")
    named.sort(key=lambda choice: choice.cut_off_um)
    reaching = [choice for choice in named if choice.cut_off_um >= (cut_off_um or 0.0)]
    return reaching[0] if reaching else named[-1]


# The Sun's direct light on the ground, without the air.

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
    """Band radiance, W m⁻² sr⁻¹, of a level, white, matt surface in direct sunlight.

    L = E·sin(elevation)/π with E = Ω·L_band(5800 K), Ω/π = (radius/distance)² of the Sun.

    Source: Planck's law; Lambert's cosine law. Over all wavelengths E is 1390 W m⁻², where 1361
    are measured (Kopp and Lean 2011, Geophysical Research Letters 38, L01706).
    """
    if not 0.0 <= sun_elevation_deg <= 90.0:
        raise ParameterError("sun_elevation_deg", sun_elevation_deg, "0 to 90", unit="deg")
    own = band_radiance(cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=SUNLIGHT_K)
    return SUN_SHARE * math.sin(math.radians(sun_elevation_deg)) * float(own)


# Spectra given at a few wavelengths, straight between them, and their means over a band.


CoarseSpectrum = tuple[tuple[float, float], ...]
"""A quantity at a few ascending wavelengths, µm: straight between, constant beyond the ends."""


def mean_by_planck(
    *spectra: CoarseSpectrum, cut_on_um: float, cut_off_um: float, temperature_K: ArrayLike
) -> Floats:
    """Mean of a spectrum, or of a product of several, by the light of black bodies in a band.

    ∫ s(λ)·L(λ, T) dλ / ∫ L(λ, T) dλ by Gauss's rule between the points: with the band's radiance,
    the light that a surface of that emissivity gives, however wide the band is. Of the shape
    (temperatures,); the plain mean where a black body gives no light that a number can hold.
    """
    points = {wavelength for spectrum in spectra for wavelength, _ in spectrum}
    inside = sorted(point for point in points if cut_on_um < point < cut_off_um)
    ends = np.array([cut_on_um, *inside, cut_off_um])
    middle, half = (ends[1:] + ends[:-1]) / 2.0, np.diff(ends) / 2.0
    nodes, weights = gauss_legendre(12)
    places = (middle[:, None] + half[:, None] * nodes).ravel()
    widths = (half[:, None] * weights).ravel()
    kelvins = np.atleast_1d(np.asarray(temperature_K, float))
    light = widths * spectral_radiance(places, kelvins[:, None])
    light[~(light.sum(axis=1) > 0.0)] = widths
    values = np.prod([np.interp(places, *np.array(spectrum).T) for spectrum in spectra], axis=0)
    return np.asarray((light @ values) / light.sum(axis=1))


# Radiance of surfaces of an emissivity, and the temperature of a radiance.

_OFFSETS_K = {"K": 0.0, "kelvin": 0.0, "°C": 273.15, "C": 273.15, "degC": 273.15}


def in_kelvin(samples: NDArray[Any], *, unit: str) -> Floats:
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
) -> Floats:
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
) -> Floats:
    """Temperature of opaque surfaces that give a band radiance: the inverse of `grey_radiance`."""
    band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    share = _emissivity(emissivity)
    if not np.all(share > 0.0):
        raise DataError(
            "the temperature cannot be determined: a surface with an emissivity of 0 emits "
            "nothing. Give an emissivity above 0"
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


def _emissivity(values: ArrayLike) -> Floats:
    share = np.asarray(values, np.float64)
    wrong = ~((share >= 0.0) & (share <= 1.0))
    if np.any(wrong):
        first = float(share[wrong].flat[0])
        raise DataError(
            f"emissivity: outside 0 to 1 in {np.count_nonzero(wrong)} of "
            f"{several(share.size, 'sample')} "
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
