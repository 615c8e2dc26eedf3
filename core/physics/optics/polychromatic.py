"""How much each wavelength of a band counts in an image: by photons, by energy, or all alike.

A response of the detector, or of a filter, may weight it besides.
"""

import math
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Vector
from core.errors import ParameterError
from core.physics.detector.detectivity import ResponseCurve
from core.physics.numerics import gauss_legendre, positive
from core.physics.radiometry.planck import SECOND_RADIATION_CONSTANT_M_K
from core.records import dataclass

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
