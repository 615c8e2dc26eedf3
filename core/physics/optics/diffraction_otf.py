"""OTF of a circular or annular aperture over a band, by as many wavelengths as a tolerance takes.

The OTF of one wavelength has kinks where outlines of the aperture touch: at the cutoff, and with an
obscuration at three more places. At a fixed frequency they lie at certain wavelengths of the band,
between which the OTF is smooth but for half-integer powers at their ends, so that Gauss quadrature
between them, in a variable that takes these powers away, converges like a power. A response of a
few points has corners of its own, at fixed wavelengths: between these, too. One of many points is
integrated exactly in narrow panels, over each of which the OTF is taken for a cubic.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core import kernels
from core.arrays import Vector
from core.errors import DataError, ParameterError
from core.physics.detector.detectivity import ResponseCurve
from core.physics.numerics import chebyshev_sum, gauss_legendre, positive
from core.physics.optics.overlap_area import annular_otf, checked_aperture
from core.physics.radiometry.planck import SECOND_RADIATION_CONSTANT_M_K
from core.records import dataclass

# How much each wavelength of a band counts in an image: by photons, by energy, or all alike.

SpectralWeighting = Literal["photons", "energy", "uniform"]


def spectral_weight(
    *, wavelength_um: ArrayLike, weighting: SpectralWeighting, temperature_K: float, near_um: float
) -> NDArray[np.float64]:
    """Relative weight of wavelengths in the light of a black body.

    Parameters
    ----------
    wavelength_um : array_like
        Wavelengths, above 0.
    weighting : "photons", "energy" or "uniform"
        Photon radiance (what a photon detector counts), radiance, or 1 for each.
    temperature_K : float
        Of the black body, above 0.
    near_um : float
        A wavelength whose weight is near 1, so that none over- or underflows: the longest of the
        band.

    Returns
    -------
    ndarray
        (λ0/λ)⁴·e^{−(x − x0)}·(1 − e^{−x0})/(1 − e^{−x}) for photons, x = c2/(λT).

    Source: Planck's law; Dereniak and Boreman 1996, Infrared Detectors and Systems, eq. 2.9.
    """
    wavelength = np.asarray(wavelength_um, np.float64)
    if weighting == "uniform":
        return np.ones(wavelength.shape)
    temperature = positive("source_K", temperature_K, unit="K")
    second = SECOND_RADIATION_CONSTANT_M_K * 1e6 / temperature
    x, near = second / wavelength, second / near_um
    power = 4 if weighting == "photons" else 5
    thermal = np.exp(near - x) * np.expm1(-near) / np.expm1(-x)
    return np.asarray((near_um / wavelength) ** power * thermal)


@dataclass(frozen=True)
class Spectrum:
    """A band, and how much its wavelengths count in it: by a black body's light and responses.

    `temperature_K` is of that black body, not looked at where all count alike. `responses` are of a
    detector or a filter. A band whose ends are equal is one wavelength.
    """

    cut_on_um: float
    cut_off_um: float
    weighting: SpectralWeighting = "photons"
    temperature_K: float = 300.0
    responses: tuple[ResponseCurve, ...] = ()

    @property
    def ends_um(self) -> tuple[float, float]:
        """Where the light that counts begins and ends: the band, within the responses."""
        low, high = self.cut_on_um, self.cut_off_um
        for response in self.responses:
            first, last = response.ends_um
            low, high = max(low, first), min(high, last)
        return low, high

    @property
    def edges_um(self) -> tuple[float, ...]:
        """Wavelengths between which the weight is smooth, with both ends."""
        low, high = self.ends_um
        bends = {place for response in self.responses for place in response.bends_um}
        return (low, *sorted(place for place in bends if low < place < high), high)

    @property
    def corners_um(self) -> tuple[float, ...]:
        """Both ends, and where the weight has a jump or a corner."""
        low, high = self.ends_um
        sharp = (each for each in self.responses if each.shape != "gaussian")
        corners = {place for response in sharp for place in response.bends_um}
        return (low, *sorted(place for place in corners if low < place < high), high)

    def check(self) -> None:
        """Refuse a band or a temperature that is none, and responses that let nothing through."""
        positive("cut_on_um", self.cut_on_um, unit="µm")
        if not (math.isfinite(self.cut_off_um) and self.cut_off_um >= self.cut_on_um):
            allowed = f"a finite number, at least cut_on_um = {self.cut_on_um:g}"
            raise ParameterError("cut_off_um", self.cut_off_um, allowed, unit="µm")
        if self.weighting != "uniform":
            positive("temperature_K", self.temperature_K, unit="K")
        if self.responses and self.cut_on_um < self.cut_off_um and not self._lets_light_through():
            whole = f"{self.cut_on_um:g} to {self.cut_off_um:g} µm"
            met = "above 0 somewhere in the band"
            raise ParameterError("response", f"0 from {whole}", met)

    def _lets_light_through(self) -> bool:
        low, high = self.ends_um
        if not low < high:
            return False
        edges = np.array(self.edges_um)
        places = np.concatenate([edges, (edges[1:] + edges[:-1]) / 2.0])
        return bool(np.any(self._passed(places) > 0.0))

    def places(self, count: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Wavelengths of Gauss-Legendre over what the responses let through, and their weights.

        One is the middle of the band.
        """
        low, high = self.cut_on_um, self.cut_off_um
        if count > 1 and low < high:
            low, high = self.ends_um
        places, weights = band_wavelengths(cut_on_um=low, cut_off_um=high, count=count)
        return tuple(places.tolist()), tuple(weights.tolist())

    def weight(self, wavelength_um: Vector) -> Vector:
        """Relative weight of wavelengths."""
        light = spectral_weight(
            wavelength_um=wavelength_um,
            weighting=self.weighting,
            temperature_K=self.temperature_K,
            near_um=self.cut_off_um,
        )
        return light * self._passed(wavelength_um) if self.responses else light

    def _passed(self, wavelength_um: Vector) -> Vector:
        passed = np.ones(np.shape(wavelength_um))
        for response in self.responses:
            passed = passed * response.at(wavelength_um)
        return passed


@lru_cache(maxsize=32)
def panel_wavelengths(spectrum: Spectrum, panels: int) -> tuple[Vector, Vector]:
    """Wavelengths and weights that integrate the spectrum times cubics on equal panels exactly.

    However many bends the responses have, the number of wavelengths is that of the panels: each
    has the four nodes of Gauss, weighted by the integrals of the spectrum times Lagrange's basis.
    The weights sum to 1.
    """
    low, high = spectrum.ends_um
    ends = np.linspace(low, high, panels + 1)
    middle, half = (ends[1:] + ends[:-1]) / 2.0, (high - low) / panels / 2.0
    nodes, _ = gauss_legendre(4)
    # Between bends, and within panels, everything is smooth.
    edges = np.union1d(ends, spectrum.edges_um)
    fine_nodes, fine_weights = gauss_legendre(6)
    centre, width = (edges[1:] + edges[:-1]) / 2.0, np.diff(edges) / 2.0
    fine = centre[:, np.newaxis] + width[:, np.newaxis] * fine_nodes
    light = spectrum.weight(fine) * fine_weights * width[:, np.newaxis]
    panel = np.clip(np.searchsorted(ends, centre, side="right") - 1, 0, panels - 1)
    place = (fine - middle[panel, np.newaxis]) / half
    weights = np.zeros((panels, nodes.size))
    for index, node in enumerate(nodes):
        others = np.delete(nodes, index)
        basis = np.prod([(place - other) / (node - other) for other in others], axis=0)
        np.add.at(weights[:, index], panel, np.sum(light * basis, axis=1))
    places = middle[:, np.newaxis] + half * nodes
    return places.ravel(), weights.ravel() / weights.sum()


# Wavelengths and weights that stand for a spectral band.

MOST_WAVELENGTHS = 256


def band_wavelengths(
    *, cut_on_um: float, cut_off_um: float, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wavelengths over a uniformly weighted band, ascending, with weights that sum to 1.

    One is the band's mean, up to 256 are Gauss-Legendre nodes.
    """
    if not (math.isfinite(cut_on_um) and cut_on_um > 0.0):
        raise ParameterError("cut_on_um", cut_on_um, "above 0", unit="µm")
    if not (math.isfinite(cut_off_um) and cut_off_um >= cut_on_um):
        raise ParameterError("cut_off_um", cut_off_um, f"{cut_on_um:g} or more", unit="µm")
    if not 1 <= count <= MOST_WAVELENGTHS:
        raise ParameterError("wavelengths", count, f"1 to {MOST_WAVELENGTHS}")
    nodes, weights = gauss_legendre(count)
    middle, half = 0.5 * (cut_on_um + cut_off_um), 0.5 * (cut_off_um - cut_on_um)
    weights = weights / np.sum(weights)
    # Added in their order the weights give 1 exactly, and an OTF made with them H(0) = 1.
    before = 0.0
    for weight in weights[:-1]:
        before += float(weight)
    weights[-1] = 1.0 - before
    return middle + half * nodes, weights


# The OTF over a band.

COUNTS = (8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256)
FINEST_TOLERANCE = 1e-13
USUAL_WITH_DEFOCUS = 1e-10  # each of its OTFs is an integral itself: a third of the time
USUAL_WITH_MANY_BENDS = 1e-6
MOST_PARTED = 12  # ends and corners of responses, at which series are parted
PANELS = (64, 128, 256, 512, 1024, 2048, 4096)  # of a response with more
_PROBES = 24  # frequencies at which the number of wavelengths is judged


@dataclass(frozen=True)
class Aperture:
    """A circular aperture and its wavefront error.

    The obscuration is inner over outer diameter, at least 0 and below 1. The defocus is W20 at
    the outer rim and the rms a random wavefront error, both in waves of `reference_um`; at any
    wavelength they are at most 100 and 0.18.
    """

    diameter_mm: float
    obscuration_ratio: float = 0.0
    defocus_waves: float = 0.0
    rms_waves: float = 0.0
    reference_um: float = 1.0

    @property
    def kinks(self) -> tuple[float, ...]:
        """Where outlines touch, in frequencies over the cutoff."""
        inner = self.obscuration_ratio
        return ((1.0 - inner) / 2.0, inner, (1.0 + inner) / 2.0, 1.0) if inner else (1.0,)

    def otf(self, rho: Vector, wavelength_um: Vector) -> Vector:
        """Real OTF at radial frequencies, cycles/mrad, and wavelengths; they broadcast."""
        ratio = wavelength_um * rho / self.diameter_mm
        scale = self.reference_um / wavelength_um
        if self.defocus_waves:
            otf = annular_defocus_otf(
                frequency_ratio=ratio,
                w20_waves=self.defocus_waves * scale,
                obscuration_ratio=self.obscuration_ratio,
            )
        else:
            otf = annular_otf(frequency_ratio=ratio, obscuration_ratio=self.obscuration_ratio)
        if self.rms_waves:
            rms = self.rms_waves * scale
            otf = otf * wavefront_factor(frequency_ratio=ratio, rms_waves=rms)
        return otf

    def check(self, shortest_um: float) -> None:
        """Refuse what is out of range at the shortest wavelength of a band (`ParameterError`)."""
        positive("aperture_mm", self.diameter_mm, unit="mm")
        scale = self.reference_um / positive("cut_on_um", shortest_um, unit="µm")
        annular_otf(frequency_ratio=0.0, obscuration_ratio=self.obscuration_ratio)
        most = MOST_DEFOCUS_WAVES
        for name, waves, low, high, (limit, remedy) in (
            ("rms_wavefront_waves", self.rms_waves, 0.0, MOST_RMS_WAVES, _BY_SHANNON),
            ("defocus_waves", self.defocus_waves, -most, most, ("", "")),
        ):
            if not low <= waves * scale <= high:
                place = f"at {shortest_um:g} µm{limit}, where it is {waves * scale:.6g} waves"
                allowed = f"from {low:g} to {high:g} waves {place}{remedy}"
                raise ParameterError(name, waves, allowed, unit="waves")


def diffraction_otf(
    *,
    rho: ArrayLike,
    aperture: Aperture,
    cut_on_um: float,
    cut_off_um: float,
    weighting: SpectralWeighting,
    temperature_K: float,
    responses: tuple[ResponseCurve, ...] = (),
    wavelengths: int = 0,
    tolerance: float = FINEST_TOLERANCE,
) -> Vector:
    """OTF over a band, weighted.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad.
    aperture : Aperture
        What diffracts.
    cut_on_um, cut_off_um, weighting, temperature_K, responses
        As of `Spectrum`.
    wavelengths : int
        Number of Gauss-Legendre wavelengths over what the responses let through of the band, 1
        being the band's middle; 0 for as many as the tolerance takes.
    tolerance : float
        Largest error with these, 1e-13 or more.

    Returns
    -------
    ndarray
        Real, signed where there is defocus, 1 at zero frequency.

    Raises
    ------
    ParameterError
        For a value out of range.
    DataError
        If the tolerance is not reached.

    Notes
    -----
    ∫ w(λ)·OTF(λρ/D) dλ / ∫ w(λ) dλ. Source: Goodman 2005, Introduction to Fourier Optics, section
    6.4; the weights of a photon detector: Boreman 2001, Modulation Transfer Function, chapter 1.
    """
    spectrum = Spectrum(cut_on_um, cut_off_um, weighting, temperature_K, responses)
    spectrum.check()
    aperture.check(cut_on_um)
    if not (math.isfinite(wavelengths) and wavelengths >= 0):
        raise ParameterError("wavelengths", wavelengths, "a whole number, zero or above")
    radii = np.abs(np.asarray(rho, np.float64))
    if wavelengths or cut_on_um == cut_off_um:
        places, weights = _fixed(spectrum, max(1, wavelengths))
        total = np.zeros(radii.shape)
        for wavelength, weight in zip(places, weights, strict=True):
            total = total + weight * aperture.otf(radii, np.asarray(wavelength))
    else:
        total = _series(aperture, spectrum, tolerance)(radii)
    return np.where(radii == 0.0, 1.0, total)


def has_many_bends(spectrum: Spectrum) -> bool:
    """Whether responses have more corners than series are parted at."""
    return len(spectrum.corners_um) > MOST_PARTED


@lru_cache(maxsize=32)
def wavelengths_needed(
    aperture: Aperture, spectrum: Spectrum, tolerance: float
) -> tuple[int, float]:
    """Wavelengths between two kinks that reach a tolerance, and the error left."""
    if not FINEST_TOLERANCE <= tolerance < 1.0:
        raise ParameterError("tolerance", tolerance, f"at least {FINEST_TOLERANCE:g} and below 1")
    last = _ends(aperture, spectrum)[-1]
    probes = last * (np.arange(_PROBES) + 0.37) / _PROBES
    counts = PANELS if has_many_bends(spectrum) else COUNTS
    before = _over_band(probes, aperture, spectrum, counts[0])
    error = math.inf
    for count in counts[1:]:
        finer = _over_band(probes, aperture, spectrum, count)
        # Convergence is geometric: what a half more of them change bounds the error of the finer.
        before, error = finer, float(np.abs(finer - before).max())
        if error <= tolerance:
            return count, max(error, 1e-15)
    raise DataError(
        f"the error of the polychromatic OTF is {error:.2g} with {counts[-1]} wavelengths between "
        f"the OTF's kinks, above the tolerance of {tolerance:g}. Give a larger tolerance, or a "
        "smaller defocus_waves"
    )


@lru_cache(maxsize=32)
def _series(aperture: Aperture, spectrum: Spectrum, tolerance: float) -> Callable[[Vector], Vector]:
    count, _ = wavelengths_needed(aperture, spectrum, tolerance)
    return _radial_series(
        lambda radii: _over_band(radii, aperture, spectrum, count),
        _ends(aperture, spectrum),
        tolerance,
    )


def _ends(aperture: Aperture, spectrum: Spectrum) -> tuple[float, ...]:
    """Frequencies at which a kink enters or leaves the band."""
    diameter = aperture.diameter_mm
    corners = spectrum.ends_um if has_many_bends(spectrum) else spectrum.corners_um
    places = sorted(kink * diameter / end for kink in aperture.kinks for end in corners)
    ends = [0.0]
    for place in places:
        if place > ends[-1] * (1.0 + 1e-12):
            ends.append(place)
    return tuple(ends)


def _over_band(rho: Vector, aperture: Aperture, spectrum: Spectrum, count: int) -> Vector:
    """The weighted mean at frequencies above 0, by `count` wavelengths between the kinks.

    By `count` panels where the response has many corners.
    """
    if has_many_bends(spectrum):
        places, weights = panel_wavelengths(spectrum, count)
        return np.array([float(aperture.otf(np.full(1, each), places) @ weights) for each in rho])
    kinks = np.array(sorted(aperture.kinks)) * aperture.diameter_mm
    at_kinks = kinks / rho[:, np.newaxis]
    total, whole = np.zeros(rho.size), 0.0
    for low, high in pairwise(spectrum.edges_um):
        # Beyond the last kink, the cutoff, there is nothing.
        inside = np.clip(at_kinks, low, high)
        edges = np.concatenate([np.full((rho.size, 1), low), inside], axis=1)
        for left, right in pairwise(edges.T):
            chosen = np.flatnonzero(right > left)
            if chosen.size:
                places, weights = _between(left[chosen], right[chosen], count)
                otf = aperture.otf(rho[chosen, np.newaxis], places)
                total[chosen] += np.sum(weights * spectrum.weight(places) * otf, axis=1)
        places, weights = _between(np.array([low]), np.array([high]), count)
        whole += float(np.sum(weights * spectrum.weight(places)))
    return np.asarray(total / whole)


def _between(left: Vector, right: Vector, count: int) -> tuple[Vector, Vector]:
    """Wavelengths and weights between ends, with powers of a half at the ends taken away."""
    nodes, weights = gauss_legendre(count)
    angle = 0.25 * np.pi * (nodes + 1.0)
    width = (right - left)[:, np.newaxis]
    places = left[:, np.newaxis] + width * np.sin(angle) ** 2
    return places, width * (0.25 * np.pi * weights * np.sin(2.0 * angle))


def _fixed(spectrum: Spectrum, count: int) -> tuple[Vector, Vector]:
    places, weights = map(np.array, spectrum.places(count))
    if count == 1:
        return places, weights
    weights = weights * spectrum.weight(places)
    if not np.sum(weights) > 0.0:
        raise DataError(
            f"the response is 0 at all {count} wavelengths that sample the band: use more "
            "wavelengths, or set wavelengths = auto"
        )
    return places, weights / np.sum(weights)


# OTF of a centrally obscured circular aperture out of focus.

MOST_DEFOCUS_WAVES = 100.0  # over a band
_MOST_WAVES = 1e4
_NODES_PER_PANEL = 24  # Gauss-Legendre nodes of a panel
_PHASE_PER_PANEL = 12.0  # [rad]; 24 nodes integrate cos over it to rounding
_VALUES_PER_BLOCK = 1 << 15  # to stay in a core's cache


def annular_defocus_otf(
    *, frequency_ratio: ArrayLike, w20_waves: ArrayLike, obscuration_ratio: float = 0.0
) -> Vector:
    """OTF of a disc or annulus with the wavefront error W = W20 rho², real and signed.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff (aperture diameter over wavelength), of either sign.
    w20_waves : array_like
        Wavefront error at the outer rim [waves], at most 10000 in size; broadcasts.
    obscuration_ratio : float
        Inner over outer radius, at least 0 and below 1.

    Returns
    -------
    ndarray
        1 at zero, 0 from the cutoff on; absolute error near 1e-15.

    Pupils moved by ±v differ in phase by kx, k = 8π·W20·v, so that the OTF is the integral of
    cos(kx) over the area they share, (D − d)(D' − d') with discs D and obscurations d: a lens of
    the discs, less twice that of a disc and the other's obscuration, and one of the obscurations.
    Each is bounded by arcs x = c + R·cos t, whose chords are 2R·sin t. Source: Hopkins 1955, Proc.
    R. Soc. A 231, 91, for the disc; O'Neill 1956, JOSA 46, 285, for the parts of the annulus.
    """
    sizes, inner = checked_aperture(frequency_ratio, obscuration_ratio)
    v, w20 = np.broadcast_arrays(sizes, np.abs(np.asarray(w20_waves, np.float64)))
    if not np.all(w20 <= _MOST_WAVES):
        worst = float(w20[~(w20 <= _MOST_WAVES)][0])
        allowed = f"from -{_MOST_WAVES:g} to {_MOST_WAVES:g}"
        raise ParameterError("defocus_waves", worst, allowed, unit="waves")
    flat, rate = v.ravel(), (8.0 * np.pi * w20 * v).ravel()
    otf = np.zeros(flat.size)
    inside = np.flatnonzero(flat < 1.0)
    reach = 1.0 + inner if inner else 1.0 - flat[inside]
    panels = np.ceil(rate[inside] * reach / _PHASE_PER_PANEL).astype(np.int64) + 1
    counts = 1 << np.ceil(np.log2(panels)).astype(np.int64)
    for count in np.unique(counts):
        chosen = inside[counts == count]
        nodes, weights = _panel_rule(int(count))
        step = max(1, _VALUES_PER_BLOCK // len(nodes))
        for start in range(0, chosen.size, step):
            block = chosen[start : start + step]
            otf[block] = _shared(flat[block], rate[block], inner, nodes, weights)
    otf[flat == 0.0] = 1.0
    return otf.reshape(v.shape)


def _shared(v: Vector, k: Vector, inner: float, nodes: Vector, weights: Vector) -> Vector:
    """∫ cos(kx) over what two annuli moved by ±v share, over the area of one."""

    def arc(centre: Vector, radius: float, low: Vector, high: Vector) -> Vector:
        """∫ of 2·√(R² − (x − c)²)·cos(kx) over x from low to high, 0 where high ≤ low."""
        first = np.arccos(np.clip((high - centre) / radius, -1.0, 1.0))
        last = np.arccos(np.clip((low - centre) / radius, -1.0, 1.0))
        width = np.maximum(last - first, 0.0)
        angle = first[:, np.newaxis] + width[:, np.newaxis] * nodes
        x = centre[:, np.newaxis] + radius * np.cos(angle)
        values = np.sin(angle) ** 2 * np.cos(k[:, np.newaxis] * x)
        return np.asarray(2.0 * radius**2 * width * (values @ weights))

    zero = np.zeros_like(v)
    area = 2.0 * arc(-v, 1.0, zero, 1.0 - v)
    if inner > 0.0:
        area += 2.0 * arc(-v, inner, zero, np.maximum(inner - v, 0.0))
        # The disc about −v bounds the obscuration about v beyond where their outlines cross.
        with np.errstate(divide="ignore"):
            crossing = np.where(v > 0.0, (1.0 - inner**2) / (4.0 * v), np.inf)
        crossing = np.clip(crossing, v - inner, v + inner)
        area -= 2.0 * arc(v, inner, v - inner, crossing)
        beyond = np.where(crossing < v + inner, 1.0 - v, crossing)
        area -= 2.0 * arc(-v, 1.0, crossing, np.maximum(beyond, crossing))
    return np.asarray(area / (np.pi * (1.0 - inner**2)))


def _panel_rule(panels: int) -> tuple[Vector, Vector]:
    nodes, weights = gauss_legendre(_NODES_PER_PANEL)
    places = (np.arange(panels)[:, np.newaxis] + 0.5 * (nodes + 1.0)) / panels
    return places.ravel(), np.tile(0.5 * weights / panels, panels)


# A function of the radial frequency as series between its kinks, to a given tolerance.
#
# Between kinks of half-integer powers, as edges of apertures make them, ρ = a + (b − a)·sin²(πs/2)
# makes the function an analytic one of s, whose Chebyshev series converges like a power.

SIZES = (16, 32, 64, 128, 256, 512, 1024)


def _radial_series(
    function: Callable[[Vector], Vector], ends: tuple[float, ...], tolerance: float
) -> Callable[[Vector], Vector]:
    """Series of an OTF of radii between ends that rise from 0: 0 beyond, and never beyond ±1."""
    pieces = [_fit(function, low, high, tolerance) for low, high in pairwise(ends)]

    def at(rho: Vector) -> Vector:
        values = np.zeros(rho.shape)
        piece = np.searchsorted(ends, rho, side="right") - 1
        for index, coefficients in enumerate(pieces):
            chosen = piece == index
            if chosen.any():
                low, high = ends[index], ends[index + 1]
                share = np.clip((rho[chosen] - low) / (high - low), 0.0, 1.0)
                place = 4.0 / np.pi * np.arcsin(np.sqrt(share)) - 1.0
                values[chosen] = chebyshev_sum(coefficients, place)
        return np.clip(values, -1.0, 1.0)

    return at


def _fit(function: Callable[[Vector], Vector], low: float, high: float, tolerance: float) -> Vector:
    for size in SIZES:
        place = np.cos(np.pi * (np.arange(size) + 0.5) / size)
        radii = low + (high - low) * np.sin(0.25 * np.pi * (place + 1.0)) ** 2
        coefficients = kernels.dct(function(radii), type=2) / size
        coefficients[0] /= 2.0
        rest = np.cumsum(np.abs(coefficients[::-1]))[::-1]
        if rest[size - size // 4] <= tolerance:
            return np.asarray(coefficients[: max(2, int(np.count_nonzero(rest > tolerance / 8)))])
    raise DataError(
        f"the polychromatic OTF between {low:g} and {high:g} cycles/mrad needs more than "
        f"{SIZES[-1]} Chebyshev terms. Give a larger tolerance or a smaller defocus_waves, or set "
        "wavelengths to a number"
    )


# What a small random wavefront error takes off the MTF, known by its rms alone.

MOST_RMS_WAVES = 0.18
_BY_SHANNON = (" (the range of Shannon's formula)", ". For a larger error, use Exit Pupils")


def wavefront_factor(*, frequency_ratio: ArrayLike, rms_waves: ArrayLike) -> NDArray[np.float64]:
    """Shannon's aberration transfer factor.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff, 0 to 1; beyond there is no contrast left.
    rms_waves : array_like
        Wavefront error over the pupil [waves rms], 0 to 0.18; broadcasts. Beyond, the form gives
        negative contrast.

    Returns
    -------
    ndarray
        1 − (W/0.18)²·(1 − 4(ν − 1/2)²), least at half the cutoff.

    Source: Shannon 1994, "Optical specifications", in Handbook of Optics, 2nd ed., vol. I, chapter
    35. An empirical mean over aberrations of low order; a known wavefront belongs to Exit Pupils.
    """
    rms = np.asarray(rms_waves, np.float64)
    if not np.all((rms >= 0.0) & (rms <= MOST_RMS_WAVES)):
        worst = float(rms.max() if np.all(rms >= 0.0) else rms.min())
        raise ParameterError(
            "rms_wavefront_waves",
            worst,
            f"0 to {MOST_RMS_WAVES:g}{''.join(_BY_SHANNON)}",
            unit="waves",
        )
    ratio = np.minimum(np.abs(np.asarray(frequency_ratio, np.float64)), 1.0)
    return np.asarray(1.0 - (rms / MOST_RMS_WAVES) ** 2 * (1.0 - 4.0 * (ratio - 0.5) ** 2))
