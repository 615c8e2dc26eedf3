"""Photon radiance as a detector counts it: weighted with its quantum efficiency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import positive, within
from core.physics.detector.detectivity import ResponseCurve
from core.physics.radiometry.constants import (
    ELEMENTARY_CHARGE_C,
    PLANCK_J_S,
    SECOND_RADIATION_CONSTANT_M_K,
    SPEED_OF_LIGHT_M_S,
)
from core.physics.radiometry.planck import (
    band_nodes,
    band_photon_radiance,
    band_photon_radiance_derivative,
    spectral_radiance,
)

FloatArray = NDArray[np.float64]
PHOTON_ENERGY_J_UM = PLANCK_J_S * SPEED_OF_LIGHT_M_S * 1e6
"""Energy of a photon times its wavelength, J µm."""

_LARGEST_X = 700.0


def efficiency_of_responsivity(
    *, responsivity_A_per_W: float, wavelength_um: float, gain: float = 1.0
) -> float:
    """Electrons per photon of a current responsivity at a wavelength: R·hc/(G·q·λ), at most 1.

    The current includes the charge gain G.
    Source: Rogalski 2011, Infrared Detectors, 2nd ed., chapter 3, R = G·η·q·λ/(hc).
    """
    wavelength = positive("responsivity_um", wavelength_um, unit="µm")
    most = gain * ELEMENTARY_CHARGE_C * wavelength / PHOTON_ENERGY_J_UM
    efficiency = positive("responsivity_A_per_W", responsivity_A_per_W, unit="A/W") / most
    if efficiency > 1.0:
        allowed = f"at most {most:.4g} at {wavelength:g} µm, where every photon gives one electron"
        raise ParameterError("responsivity_A_per_W", responsivity_A_per_W, allowed, unit="A/W")
    return efficiency


@dataclass(frozen=True)
class QuantumEfficiency:
    """Electrons per photon in a band: one number, or points joined by straight lines.

    Outside the band, and beyond the first and last point, nothing is counted. Points are (µm,
    efficiency), rising; `value` holds in the whole band where there are none.
    """

    cut_on_um: float
    cut_off_um: float
    value: float = 1.0
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        positive("cut_on_um", self.cut_on_um, unit="µm")
        if not self.cut_on_um < self.cut_off_um < np.inf:
            allowed = f"above cut_on_um = {self.cut_on_um:g} µm"
            raise ParameterError("cut_off_um", self.cut_off_um, allowed, unit="µm")
        within("quantum_efficiency", self.value, 0.0, 1.0)
        if self.points and len(self._places()[0]) == 0:
            first, last = self.points[0][0], self.points[-1][0]
            raise ParameterError(
                "response",
                f"{first:g} to {last:g} µm",
                f"points that overlap the band, {self.cut_on_um:g} to {self.cut_off_um:g} µm",
            )

    def at(self, wavelength_um: ArrayLike) -> FloatArray:
        """Efficiency at wavelengths, µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        inside = (wavelength >= self.cut_on_um) & (wavelength <= self.cut_off_um)
        if not self.points:
            return np.where(inside, self.value, 0.0)
        return np.where(inside, ResponseCurve("file", points=self.points).at(wavelength), 0.0)

    def photon_radiance(self, temperature_K: ArrayLike) -> FloatArray:
        """∫ QE·L_q dλ of black bodies, s⁻¹ m⁻² sr⁻¹."""
        temperature = np.asarray(temperature_K, np.float64)
        if not self.points:
            band = {"cut_on_um": self.cut_on_um, "cut_off_um": self.cut_off_um}
            return np.asarray(self.value * band_photon_radiance(temperature_K=temperature, **band))
        wavelength, weight = self._places()
        flat = temperature.reshape(-1, 1)
        photons = spectral_radiance(wavelength, flat) * wavelength / PHOTON_ENERGY_J_UM
        return np.asarray((photons @ weight).reshape(temperature.shape))

    def photon_radiance_slope(self, temperature_K: ArrayLike) -> FloatArray:
        """Derivative of `photon_radiance` by temperature, s⁻¹ m⁻² sr⁻¹ K⁻¹."""
        temperature = np.asarray(temperature_K, np.float64)
        if not self.points:
            band = {"cut_on_um": self.cut_on_um, "cut_off_um": self.cut_off_um}
            slope = band_photon_radiance_derivative(temperature_K=temperature, **band)
            return np.asarray(self.value * slope)
        wavelength, weight = self._places()
        flat = temperature.reshape(-1, 1)
        x = SECOND_RADIATION_CONSTANT_M_K * 1e6 / (wavelength * flat)
        x = np.minimum(x, _LARGEST_X)  # beyond, the radiance is zero anyway
        photons = spectral_radiance(wavelength, flat) * wavelength / PHOTON_ENERGY_J_UM
        slope = photons * x / -np.expm1(-x) / flat
        return np.asarray((slope @ weight).reshape(temperature.shape))

    def integral(self, low_um: float, high_um: float) -> float:
        """∫ QE dλ over a part of the wavelengths, µm; exact for straight lines."""
        low, high = max(low_um, self.cut_on_um), min(high_um, self.cut_off_um)
        if not low < high:
            return 0.0
        if not self.points:
            return self.value * (high - low)
        return ResponseCurve("file", points=self.points).integral(low, high)

    def mean(self) -> float:
        """Mean over the wavelengths of the band."""
        if not self.points:
            return self.value
        return float(self._places()[1].sum() / (self.cut_off_um - self.cut_on_um))

    def _places(self) -> tuple[FloatArray, FloatArray]:
        """Nodes of a quadrature between the points within the band, and weights with QE."""
        known = np.array([place for place, _ in self.points])
        low, high = max(self.cut_on_um, known[0]), min(self.cut_off_um, known[-1])
        if not low < high:
            return np.empty(0), np.empty(0)
        wavelength, weight = band_nodes(float(low), float(high), known.tolist())
        efficiency = np.interp(wavelength, known, [value for _, value in self.points])
        return wavelength, weight * efficiency
