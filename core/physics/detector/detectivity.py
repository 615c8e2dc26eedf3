"""Specific detectivity D* and quantum efficiency of detector materials, and D* over a band."""

import math
from collections.abc import Callable
from functools import partial
from math import degrees, isfinite, pi, radians, sin, sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Floats
from core.errors import DataError, ParameterError, several
from core.physics.numerics import positive, within
from core.physics.radiometry.planck import (
    BOLTZMANN_J_K,
    ELEMENTARY_CHARGE_C,
    PHOTON_ENERGY_J_UM,
    SECOND_RADIATION_CONSTANT_M_K,
    SECOND_RADIATION_CONSTANT_UM_K,
    SPEED_OF_LIGHT_M_S,
    WIDEST_X,
    band_nodes,
    band_radiance,
    reduced,
    spectral_radiance,
    unit_rule,
)
from core.physics.radiometry.spectra import Material
from core.records import dataclass

SpectralFunction = Callable[[Floats], Floats]

STANDARD_HALF_ANGLE_DEG = 30.0
"""Half of the 60° field of view that makers state D* for."""

_COLDEST_K = 1.0
_PANEL_X = 2.0
_PANEL_RATIO = 1.5


def quantum_efficiency(wavelength_um: ArrayLike, *, material: Material) -> Floats:
    """Electrons per incident photon of a material, 0 beyond its cut-off.

    Source: ideal photon detector (Rogalski 2011, Infrared Detectors, chapter 3); Schottky
    barrier: Fowler 1931, as C1 (hν − ψ)²/hν = C1·hν·(1 − λ/λc)².
    """
    wavelength = np.asarray(wavelength_um, dtype=float)
    if not np.all(wavelength > 0.0):
        first = float(wavelength[~(wavelength > 0.0)].flat[0])
        raise ParameterError("wavelength_um", first, "must be above 0", unit="µm")
    if material.fowler_per_eV:
        photon_eV = PHOTON_ENERGY_J_UM / ELEMENTARY_CHARGE_C / wavelength
        excess = 1.0 - wavelength / material.cut_off_um
        efficiency = np.minimum(material.fowler_per_eV * photon_eV * excess**2, 1.0)
    else:
        efficiency = np.full_like(wavelength, material.quantum_efficiency)
    return np.where(wavelength <= material.cut_off_um, efficiency, 0.0)


def d_star(
    wavelength_um: ArrayLike,
    *,
    material: Material,
    background_K: float = 300.0,
    half_angle_deg: float = STANDARD_HALF_ANGLE_DEG,
) -> Floats:
    """Specific detectivity of a material that sees a blackbody background through a cone.

    D*(λ) = ηλ/(hc) / √(m·∫ηE dλ + m·J/q + 4kT/(q²RA)) with E the background's photons, J the dark
    current, RA the zero-bias resistance times area, and m 2 for a junction, 4 for a
    photoconductor. For constant η and the background alone this is the background limit
    (λ/hc)·√(η/(m·Q_B)).

    Parameters
    ----------
    wavelength_um
        µm, above 0, any shape.
    material
        One of `core.physics.radiometry.spectra`.
    background_K
        Temperature of the background, K, 1 or above, and not so cold that nothing limits the
        detector.
    half_angle_deg
        Half the cone that the cold shield leaves open, degrees, above 0 and at most 90.

    Returns
    -------
    cm √Hz/W, of the shape of `wavelength_um`; 0 beyond the cut-off.

    Source: Dereniak and Boreman 1996, Infrared Detectors and Systems; Rogalski 2011, Infrared
    Detectors, chapter 3. Stands in for the curves of Tantalo 1996, figs. D.1-D.2.
    """
    efficiency = quantum_efficiency(wavelength_um, material=material)
    events = _noise_events(material, background_K, half_angle_deg)
    if not events > 0.0:
        allowed = (
            f"too cold for a background-limited D* of {material.name}, whose internal noise "
            "is not known. Enter D* instead"
        )
        raise ParameterError("background_K", background_K, allowed, unit="K")
    per_joule = efficiency * np.asarray(wavelength_um, dtype=float) / PHOTON_ENERGY_J_UM
    return np.asarray(100.0 * per_joule / sqrt(events))


def band_d_star(
    *,
    material: Material | SpectralFunction,
    cut_on_um: float,
    cut_off_um: float,
    background_K: float,
    half_angle_deg: float = STANDARD_HALF_ANGLE_DEG,
) -> float:
    """D* of a band: the mean of D*(λ) weighted by the exitance of a blackbody at `background_K`.

    Parameters
    ----------
    material
        A material, or a function from wavelengths (µm, 1-D) to D* (cm √Hz/W).
    background_K
        K, 1 or above: of the weight and, for a material, of what limits it.
    half_angle_deg
        As in `d_star`; of no effect for a function.

    Returns
    -------
    cm √Hz/W; 0 where the material responds nowhere in the band.

    Source: Tantalo 1996, eq. 4.53.
    """
    _require_background(background_K)
    # refuses a band that is none
    band_radiance(cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=background_K)
    end_um = cut_off_um
    curve: SpectralFunction
    if isinstance(material, Material):
        end_um = min(cut_off_um, material.cut_off_um)
        curve = partial(
            d_star, material=material, background_K=background_K, half_angle_deg=half_angle_deg
        )
        curve(np.array([end_um]))  # refuses what is wrong even where nothing responds
        if end_um <= cut_on_um:
            return 0.0
    else:
        curve = material
    x_end = float(reduced(end_um, background_K))
    x_off = float(reduced(cut_off_um, background_K))
    weighted = _planck_mean(curve, cut_on_um, end_um, background_K, power=3)
    weight = _planck_mean(np.ones_like, cut_on_um, cut_off_um, background_K, power=3)
    with np.errstate(under="ignore"):
        return float(weighted / weight * np.exp(x_off - x_end))


def cold_shield_half_angle_deg(*, f_number: float) -> float:
    """Half-angle of a cold shield that fits the optics: sin²θ = 1/(1 + 4F²), degrees.

    Source: the same cone as in the throughput number, Tantalo 1996, eq. 4.54.
    """
    return degrees(float(np.arctan2(1.0, 2.0 * positive("f_number", f_number))))


def _require_background(background_K: float) -> None:
    if not (isfinite(background_K) and background_K >= _COLDEST_K):
        allowed = f"must be at least {_COLDEST_K:g} and finite"
        raise ParameterError("background_K", background_K, allowed, unit="K")


def _noise_events(material: Material, background_K: float, half_angle_deg: float) -> float:
    """Squared noise current per area and bandwidth in units of q², m⁻² s⁻¹."""
    _require_background(background_K)
    if not 0.0 < half_angle_deg <= 90.0:
        raise ParameterError(
            "half_angle_deg", half_angle_deg, "must be above 0 and at most 90", unit="°"
        )

    def efficiency(wavelength_um: Floats) -> Floats:
        return quantum_efficiency(wavelength_um, material=material)

    scaled = _planck_mean(efficiency, None, material.cut_off_um, background_K, power=2)
    x_off = float(reduced(material.cut_off_um, background_K))
    scale = 2.0 * SPEED_OF_LIGHT_M_S / SECOND_RADIATION_CONSTANT_M_K**3 * background_K**3
    with np.errstate(under="ignore"):
        radiance = scale * scaled * float(np.exp(-x_off))
    background = pi * sin(radians(half_angle_deg)) ** 2 * radiance
    dark = material.dark_current_A_per_cm2 * 1e4 / ELEMENTARY_CHARGE_C
    resistance_area_m2 = material.resistance_area_ohm_cm2 * 1e-4
    thermal = 4.0 * BOLTZMANN_J_K * material.temperature_K
    return (
        material.noise_factor * (background + dark)
        + thermal / resistance_area_m2 / ELEMENTARY_CHARGE_C**2
    )


def _planck_mean(
    curve: SpectralFunction,
    cut_on_um: float | None,
    cut_off_um: float,
    temperature_K: float,
    *,
    power: int,
) -> float:
    """e^(x_off) times ∫ curve(λ) x^power/(eˣ − 1) dx over a band; all shorter waves for no cut-on.

    Power 3 weights by radiance, 2 by photons. Panels are short both against the decay of the
    weight and against the wavelength, whatever curve a caller brings.
    """
    c2 = SECOND_RADIATION_CONSTANT_UM_K
    x_off = float(reduced(cut_off_um, temperature_K))
    width = WIDEST_X
    if cut_on_um is not None:
        width = min(x_off * (cut_off_um - cut_on_um) / cut_on_um, width)
    edges = [0.0]  # counted from x_off: a narrow band is not lost in rounding
    while edges[-1] < width:
        step = min(_PANEL_X, (_PANEL_RATIO - 1.0) * (x_off + edges[-1]))
        edges.append(min(edges[-1] + step, width))
    starts = np.array(edges[:-1])[:, np.newaxis]
    sizes = np.diff(np.array(edges))[:, np.newaxis]
    places, weights = unit_rule()
    beyond = starts + sizes * places
    x = x_off + beyond
    with np.errstate(under="ignore"):
        planck = x**power * np.exp(-beyond) / -np.expm1(-x)
    # rounding must not put the first node beyond the cut-off
    wavelength = np.minimum(c2 / (x * temperature_K), cut_off_um)
    values = np.asarray(curve(wavelength.ravel()), dtype=float).reshape(x.shape)
    return float(np.sum(sizes * weights * planck * values))


# How a detector or a filter responds over wavelength: points, a rectangle, or a Gaussian.

Shape = Literal["file", "rectangle", "gaussian"]
_NEAR = 1e-12  # by which a form may end before a band
_REACH = 6.0  # standard deviations, beyond which a Gaussian is below 2e-8
_PIECES = 48  # of a Gaussian on which a quadrature of 24 nodes or 8 is exact


@dataclass(frozen=True)
class ResponseCurve:
    """Response over wavelength: points joined by straight lines, or one of two forms.

    Points are (µm, response), rising; beyond the first and last it is 0. A form has a middle, a
    whole width or a full width at half maximum, above 0, and a peak of 0 to 1.
    """

    shape: Shape
    centre_um: float = 1.0
    width_um: float = 1.0
    peak: float = 1.0
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        if self.shape == "file":
            if len(self.points) < 2:
                found = f"a file with {several(len(self.points), 'point')}"
                raise ParameterError("path", found, "a file with two or more points")
            return
        positive("centre_um", self.centre_um, unit="µm")
        positive("width_um", self.width_um, unit="µm")
        within("peak", self.peak, 0.0, 1.0)

    @property
    def _sigma_um(self) -> float:
        return self.width_um / (2.0 * math.sqrt(2.0 * math.log(2.0)))

    @property
    def ends_um(self) -> tuple[float, float]:
        """Between which it is not 0, or next to it."""
        if self.shape == "file":
            return self.points[0][0], self.points[-1][0]
        half = self.width_um / 2.0 if self.shape == "rectangle" else _REACH * self._sigma_um
        return max(self.centre_um - half, 0.0), self.centre_um + half

    @property
    def bends_um(self) -> tuple[float, ...]:
        """Wavelengths between which it is smooth."""
        if self.shape == "file":
            return tuple(place for place, _ in self.points)
        if self.shape == "rectangle":
            return self.ends_um
        return tuple(np.linspace(*self.ends_um, _PIECES + 1).tolist())

    def at(self, wavelength_um: ArrayLike) -> Floats:
        """Response at wavelengths, µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.shape == "file":
            known, values = np.array(self.points).T
            return np.asarray(np.interp(wavelength, known, values, left=0.0, right=0.0))
        if self.shape == "rectangle":
            low, high = self.ends_um
            return np.where((wavelength >= low) & (wavelength <= high), self.peak, 0.0)
        away = (wavelength - self.centre_um) / self._sigma_um
        return np.asarray(self.peak * np.exp(-0.5 * away * away))

    def integral(self, low_um: float, high_um: float) -> float:
        """∫ R dλ, µm; exact."""
        if not low_um < high_um:
            return 0.0
        if self.shape == "gaussian":
            root = self._sigma_um * math.sqrt(2.0)
            ends = [math.erf((end - self.centre_um) / root) for end in (low_um, high_um)]
            return self.peak * self._sigma_um * math.sqrt(math.pi / 2.0) * (ends[1] - ends[0])
        first, last = self.ends_um
        low, high = max(low_um, first), min(high_um, last)
        if not low < high:
            return 0.0
        if self.shape == "rectangle":
            return self.peak * (high - low)
        known = np.array([place for place, _ in self.points])
        ends_of = np.array([low, *known[(known > low) & (known < high)], high])
        values = self.at(ends_of)
        return float(np.sum((values[1:] + values[:-1]) / 2.0 * np.diff(ends_of)))

    def is_one_over(self, low_um: float, high_um: float) -> bool:
        """Whether it is 1 all over a band."""
        first, last = self.ends_um
        if first > low_um * (1.0 + _NEAR) or last < high_um * (1.0 - _NEAR):
            return False
        places = np.clip([low_um, *self.bends_um, high_um], low_um, high_um)
        return bool(np.all(self.at(np.clip(places, first, last)) == 1.0))

    def mean(self, low_um: float, high_um: float) -> float:
        """Mean over a band whose spectrum is flat."""
        return self.integral(low_um, high_um) / (high_um - low_um)

    def mean_of_body(self, cut_on_um: float, cut_off_um: float, *, source_K: float) -> float:
        """Mean over a band by the radiance of a black body."""
        inside = tuple(place for place in self.bends_um if cut_on_um < place < cut_off_um)
        wavelength, width = band_nodes(cut_on_um, cut_off_um, inside)
        weight = width * spectral_radiance(wavelength, source_K)
        total = float(weight.sum())
        if not total > 0.0:
            raise DataError(
                f"a black body of {source_K:g} K emits nothing from {cut_on_um:g} to "
                f"{cut_off_um:g} µm, so it cannot weight the response"
            )
        return float(weight @ self.at(wavelength)) / total
