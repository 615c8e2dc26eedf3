"""OTF of a circular or annular aperture over a band, by as many wavelengths as a tolerance takes.

The OTF of one wavelength has kinks where outlines of the aperture touch: at the cutoff, and with an
obscuration at three more places. At a fixed frequency they lie at certain wavelengths of the band,
between which the OTF is smooth but for half-integer powers at their ends, so that Gauss quadrature
between them, in a variable that takes these powers away, converges like a power. A response of a
few points has corners of its own, at fixed wavelengths: between these, too. One of many points is
integrated exactly in narrow panels, over each of which the OTF is taken for a cubic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.detector.response_curve import ResponseCurve
from core.physics.numerics.quadrature import gauss_legendre
from core.physics.numerics.scalar_checks import positive
from core.physics.optics.annular_otf import annular_otf
from core.physics.optics.diffraction.annular_defocus import MOST_DEFOCUS_WAVES, annular_defocus_otf
from core.physics.optics.diffraction.band_weights import (
    SpectralWeighting,
    Spectrum,
    panel_wavelengths,
)
from core.physics.optics.diffraction.radial_series import RadialSeries
from core.physics.optics.diffraction.wavefront_factor import wavefront_factor

Vector = NDArray[np.float64]
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

    Parameters
    ----------
    diameter_mm : float
        Outer diameter, above 0.
    obscuration_ratio : float
        Inner over outer diameter, 0 up to but not including 1.
    defocus_waves : float
        W20 at the outer rim, at the reference wavelength; at most 100 waves at any wavelength.
    rms_waves : float
        Random wavefront error, waves rms at the reference wavelength; at most 0.18 at any.
    reference_um : float
        That wavelength.
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
        wavefront_factor(frequency_ratio=0.0, rms_waves=self.rms_waves * scale)
        if not abs(self.defocus_waves * scale) <= MOST_DEFOCUS_WAVES:
            allowed = f"at most {MOST_DEFOCUS_WAVES:g} waves of the shortest wavelength in size"
            raise ParameterError("defocus_waves", self.defocus_waves, allowed, unit="waves")


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
        total = _series(aperture, spectrum, tolerance).at(radii)
    return np.where(radii == 0.0, 1.0, total)


def wavelengths_needed(
    aperture: Aperture, spectrum: Spectrum, tolerance: float
) -> tuple[int, float]:
    """Wavelengths between two kinks that reach a tolerance, and the error left.

    Raises
    ------
    ParameterError
        For a tolerance out of range.
    DataError
        If none of the numbers tried reaches it.
    """
    if not FINEST_TOLERANCE <= tolerance < 1.0:
        raise ParameterError("tolerance", tolerance, f"{FINEST_TOLERANCE:g} or more and below 1")
    return _judged(aperture, spectrum, tolerance)


def has_many_bends(spectrum: Spectrum) -> bool:
    """Whether responses have more corners than series are parted at."""
    return len(spectrum.corners_um) > MOST_PARTED


@lru_cache(maxsize=32)
def _judged(aperture: Aperture, spectrum: Spectrum, tolerance: float) -> tuple[int, float]:
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
        f"{counts[-1]} wavelengths between kinks leave an error of {error:.2g}: give a tolerance "
        "above that, or fewer waves of defocus"
    )


@lru_cache(maxsize=32)
def _series(aperture: Aperture, spectrum: Spectrum, tolerance: float) -> RadialSeries:
    count, _ = wavelengths_needed(aperture, spectrum, tolerance)
    return RadialSeries.of(
        lambda radii: _over_band(radii, aperture, spectrum, count),
        ends=_ends(aperture, spectrum),
        tolerance=tolerance,
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
    """Wavelengths and weights, which sum to 1."""
    places, weights = map(np.array, spectrum.places(count))
    if count == 1:
        return places, weights
    weights = weights * spectrum.weight(places)
    if not np.sum(weights) > 0.0:
        raise DataError(
            f"the response is 0 at each of the {count} wavelengths over the band: take more, or as "
            "many as the tolerance needs"
        )
    return places, weights / np.sum(weights)
