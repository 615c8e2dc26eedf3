"""From the radiance of a band to electrons, where no spectrum is known.

Photons per watt depend on the spectrum. A thermal scene's is that of a black body of each sample's
own brightness temperature; sunlight's that of a source; or all photons have the energy of the
band's middle. Electrons over radiance is then a smooth function of the radiance's logarithm that
lies between the efficiencies at the ends of the band: one Chebyshev sum serves all samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.electrons.spectral_photons import PHOTON_ENERGY_J_UM, QuantumEfficiency
from core.physics.numerics.chebyshev import chebyshev_fit, chebyshev_sum
from core.physics.radiometry.planck import (
    band_radiance,
    band_radiance_derivative,
    brightness_temperature,
)

Array = NDArray[Any]
FloatArray = NDArray[np.float64]
Weighting = Literal["scene", "source", "middle"]
WEIGHTINGS: tuple[Weighting, ...] = ("scene", "source", "middle")
SHORTEST_THERMAL_UM = 2.5
"""What reaches a camera of shorter waves is reflected light, of no brightness temperature."""

_DEEPEST = 1e-9  # of the largest radiance; below it electrons are in proportion to the radiance
_FLAT = 1e-14  # of ln L: a picture of one value


@dataclass(frozen=True)
class PhotonWeights:
    """The spectrum by which a band's radiance is counted in photons.

    Parameters
    ----------
    weighting : Weighting
        As wanted; `scene` gives way to `source` where the band begins below 2.5 µm.
    band_um : (float, float)
        Of the radiance.
    efficiency : QuantumEfficiency
        Of the detector within its filter.
    source_K : float
        Temperature of the source.
    """

    weighting: Weighting
    band_um: tuple[float, float]
    efficiency: QuantumEfficiency
    source_K: float

    @property
    def is_thermal(self) -> bool:
        """Whether a brightness temperature means anything in the band."""
        return min(self.band_um[0], self.efficiency.cut_on_um) >= SHORTEST_THERMAL_UM

    @property
    def used(self) -> Weighting:
        """The weighting that is used."""
        return "source" if self.weighting == "scene" and not self.is_thermal else self.weighting

    @property
    def _band(self) -> dict[str, float]:
        return {"cut_on_um": self.band_um[0], "cut_off_um": self.band_um[1]}

    def per_radiance(self, radiance: FloatArray) -> FloatArray:
        """∫ QE·L_q dλ over L, s⁻¹ W⁻¹, for radiances above 0."""
        if self.used == "scene":
            temperature = brightness_temperature(radiance=radiance, **self._band)
            return np.asarray(self.efficiency.photon_radiance(temperature) / radiance)
        return np.full(np.shape(radiance), self._constant)

    def slope(self, radiance: float) -> float:
        """Derivative of ∫ QE·L_q dλ by L at a radiance above 0, s⁻¹ W⁻¹."""
        if self.used == "scene":
            temperature = float(brightness_temperature(radiance=radiance, **self._band))
            photons = float(self.efficiency.photon_radiance_slope(temperature))
            return photons / band_radiance_derivative(temperature_K=temperature, **self._band)
        return self._constant

    @cached_property
    def _constant(self) -> float:
        """Photons per radiance where that is the same for all samples."""
        efficiency = self.efficiency
        if self.used == "source":
            radiance = band_radiance(temperature_K=self.source_K, **self._band)
            if not radiance > 0.0:
                low, high = self.band_um
                raise DataError(
                    f"a source of {self.source_K:g} K emits nothing from {low:g} to {high:g} µm: "
                    "give a hotter source_K"
                )
            return float(efficiency.photon_radiance(self.source_K)) / radiance
        low = max(self.band_um[0], efficiency.cut_on_um)
        high = min(self.band_um[1], efficiency.cut_off_um)
        if not low < high:
            return 0.0
        share = (high - low) / (self.band_um[1] - self.band_um[0])
        counted = QuantumEfficiency(low, high, efficiency.value, efficiency.points).mean()
        return share * counted * (low + high) / 2.0 / PHOTON_ENERGY_J_UM


@dataclass(frozen=True)
class Conversion:
    """Electrons of radiances between two limits, and back.

    Parameters
    ----------
    coefficients, inverse : ndarray
        Chebyshev coefficients of electrons over radiance, over the logarithm of the radiance, and
        of radiance over electrons, over that of the electrons.
    middle, half : float
        Of the logarithm of the radiance.
    inverse_middle, inverse_half : float
        Of the logarithm of the electrons.
    """

    coefficients: FloatArray
    middle: float
    half: float
    inverse: FloatArray
    inverse_middle: float
    inverse_half: float

    def electrons(self, radiance: Array) -> Array:
        """Electrons of radiances; in proportion to it below and beyond the limits."""
        return _scaled(radiance, self.coefficients, self.middle, self.half)

    def radiance(self, electrons: Array) -> Array:
        """Radiance of electrons: the inverse of `electrons`."""
        return _scaled(electrons, self.inverse, self.inverse_middle, self.inverse_half)


def conversion_between(
    *, weights: PhotonWeights, electrons_per_photon: float, low: float, high: float
) -> Conversion:
    """The conversion for radiances from `low` to `high`, W/m²/sr.

    Parameters
    ----------
    weights : PhotonWeights
        Photons of a radiance.
    electrons_per_photon : float
        What ∫ QE·L_q dλ is multiplied by, m² sr s.
    low, high : float
        Least and greatest radiance; what is below 1e-9 of the greatest is taken in proportion.

    Returns
    -------
    Conversion
        To rounding between the limits.
    """
    if not high > 0.0:
        low = high = 1.0  # a picture without light
    ends = np.log([max(low, high * _DEEPEST), high])
    middle, half = float(ends.mean()), float(ends[1] - ends[0]) / 2.0
    if half <= _FLAT or weights.used != "scene":
        half = 0.0

    def forward(places: FloatArray) -> FloatArray:
        radiance = np.exp(middle + half * places)
        return np.asarray(electrons_per_photon * weights.per_radiance(radiance))

    if half == 0.0:
        ratio = float(forward(np.zeros(1))[0])
        back = 1.0 / ratio if ratio > 0.0 else 0.0
        return Conversion(np.array([ratio]), middle, 0.0, np.array([back]), 0.0, 0.0)
    coefficients = _short(chebyshev_fit(forward))
    logs = ends + np.log(chebyshev_sum(coefficients, np.array([-1.0, 1.0])))
    inverse_middle, inverse_half = float(logs.mean()), float(logs[1] - logs[0]) / 2.0
    inverse = _short(
        chebyshev_fit(_inverse(coefficients, (middle, half), (inverse_middle, inverse_half)))
    )
    return Conversion(coefficients, middle, half, inverse, inverse_middle, inverse_half)


def _inverse(
    coefficients: FloatArray, logs: tuple[float, float], inverse: tuple[float, float]
) -> Callable[[FloatArray], FloatArray]:
    """Radiance over electrons, over the scaled logarithm of the electrons."""
    (middle, half), (target_middle, target_half) = logs, inverse

    def function(places: FloatArray) -> FloatArray:
        target = target_middle + target_half * places
        log_radiance = middle + half * places
        for _ in range(60):  # each step leaves less than a half of the error
            position = np.clip((log_radiance - middle) / half, -1.0, 1.0)
            log_radiance = target - np.log(chebyshev_sum(coefficients, position))
        return np.asarray(np.exp(log_radiance - target))

    return function


def _short(coefficients: FloatArray) -> FloatArray:
    """Without the last ones, which add less than rounding."""
    rest = np.cumsum(np.abs(coefficients[::-1]))[::-1]
    used = np.flatnonzero(rest > 1e-15 * abs(coefficients[0]))
    return coefficients[: int(used[-1]) + 1 if used.size else 1]


def _scaled(values: Array, coefficients: FloatArray, middle: float, half: float) -> Array:
    """Values times a Chebyshev sum over their logarithm."""
    number = values.dtype.type
    if half == 0.0:
        return np.asarray(values * number(coefficients[0]))
    # In single precision the last terms are below rounding.
    floor = float(np.finfo(values.dtype).eps) / 8.0 * abs(coefficients[0])
    rest = np.cumsum(np.abs(coefficients[::-1]))[::-1]
    length = max(1, int(np.count_nonzero(rest > floor)))
    least = max(number(np.exp(middle - half)), np.finfo(values.dtype).tiny)
    places = np.log(np.clip(values, least, number(np.exp(middle + half))))
    places -= number(middle)
    places *= number(1.0 / half)
    np.clip(places, -1.0, 1.0, out=places)
    if length <= _HORNER:
        powers = np.polynomial.chebyshev.cheb2poly(coefficients[:length])
        total = np.full_like(places, number(powers[-1]))
        for power in powers[-2::-1]:
            total *= places
            total += number(power)
    else:
        total = chebyshev_sum(coefficients[:length].astype(values.dtype), places)
    total *= values
    return np.asarray(total)


_HORNER = 12  # terms up to which powers are as accurate as the recurrence
