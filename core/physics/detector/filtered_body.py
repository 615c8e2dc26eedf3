"""Light of black bodies behind responses, or in parts of a band: photons, radiance, inverse."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.detector.detectivity import ResponseCurve
from core.physics.detector.spectral_photons import PHOTON_ENERGY_J_UM, QuantumEfficiency
from core.physics.radiometry.constants import SECOND_RADIATION_CONSTANT_UM_K
from core.physics.radiometry.planck import band_nodes, spectral_radiance

FloatArray = NDArray[np.float64]
Band = tuple[float, float]

_LARGEST_X = 700.0
_STEPS = 60
_NEAR = 1e-14  # of ln L
_COLDEST_K, _HOTTEST_K = 1.0, 1e6


@dataclass(frozen=True)
class FilteredBody:
    """What a detector receives of black bodies.

    Parameters
    ----------
    windows : tuple of (float, float)
        Parts of the band whose light comes, µm; where two overlap it counts twice.
    efficiency : QuantumEfficiency
        Of the detector within its filter.
    responses : tuple of ResponseCurve
        What the light has passed.
    """

    windows: tuple[Band, ...]
    efficiency: QuantumEfficiency
    responses: tuple[ResponseCurve, ...] = ()

    def photons(self, temperature_K: ArrayLike) -> FloatArray:
        """∫ QE·R·L_q dλ, s⁻¹ m⁻² sr⁻¹."""
        return self._sum(temperature_K, self._counting, slope=False)

    def photons_slope(self, temperature_K: ArrayLike) -> FloatArray:
        """Derivative of `photons` by the temperature."""
        return self._sum(temperature_K, self._counting, slope=True)

    @property
    def flat_photons(self) -> float:
        """∫ QE·R·λ/(hc) dλ: photons counted of 1 W/m²/sr/µm at all wavelengths."""
        return float(self._counting[1].sum())

    def radiance(self, temperature_K: ArrayLike) -> FloatArray:
        """∫ R·L dλ, W/m²/sr."""
        return self._sum(temperature_K, self._passing, slope=False)

    def radiance_slope(self, temperature_K: ArrayLike) -> FloatArray:
        """Derivative of `radiance` by the temperature."""
        return self._sum(temperature_K, self._passing, slope=True)

    def temperature(self, radiance: ArrayLike) -> FloatArray:
        """Temperatures whose `radiance` is this; by Newton's steps in ln L over 1/T.

        Raises
        ------
        DataError
            For a radiance of no black body from 1 K to 1 000 000 K.
        """
        wanted = np.asarray(radiance, np.float64)
        target = np.log(wanted)
        inverse = np.full(wanted.shape, 1.0 / 300.0)
        for _ in range(_STEPS):
            kelvin = 1.0 / inverse
            there = self.radiance(kelvin)
            away = np.log(there) - target
            # d ln L/d(1/T) = −T²·L'/L
            step = away * there / (self.radiance_slope(kelvin) * kelvin**2)
            # The logarithm bends upwards where it is steep: no further than by halves or doubles.
            inverse = np.clip(inverse + step, inverse / 2.0, inverse * 2.0)
            inverse = np.clip(inverse, 1.0 / _HOTTEST_K, 1.0 / _COLDEST_K)
            if np.abs(away).max() <= _NEAR:
                break
        if not np.allclose(np.log(self.radiance(1.0 / inverse)), target, rtol=0.0, atol=1e-9):
            raise DataError(
                f"no black body from {_COLDEST_K:g} to {_HOTTEST_K:g} K has a radiance of "
                f"{float(wanted.ravel()[0]):.6g} W/m²/sr weighted by the response"
            )
        return np.asarray(1.0 / inverse)

    def _sum(
        self, temperature_K: ArrayLike, weighted: tuple[FloatArray, FloatArray], *, slope: bool
    ) -> FloatArray:
        wavelength, weight = weighted
        temperature = np.asarray(temperature_K, np.float64)
        flat = temperature.reshape(-1, 1)
        light = spectral_radiance(wavelength, flat)
        if slope:
            x = SECOND_RADIATION_CONSTANT_UM_K / (wavelength * flat)
            x = np.minimum(x, _LARGEST_X)  # beyond, the radiance is zero anyway
            light = light * x / -np.expm1(-x) / flat
        return np.asarray((light @ weight).reshape(temperature.shape))

    @cached_property
    def _passing(self) -> tuple[FloatArray, FloatArray]:
        """Nodes of a quadrature over the windows, and weights with the responses."""
        places = sorted(
            {place for response in self.responses for place in response.bends_um}
            | {place for place, _ in self.efficiency.points}
            | {self.efficiency.cut_on_um, self.efficiency.cut_off_um}
        )
        nodes = [band_nodes(*window, places) for window in self.windows]
        wavelength = np.concatenate([place for place, _ in nodes])
        weight = np.concatenate([width for _, width in nodes])
        for response in self.responses:
            weight = weight * response.at(wavelength)
        return wavelength, weight

    @cached_property
    def _counting(self) -> tuple[FloatArray, FloatArray]:
        """The same with the photons of a watt that are counted."""
        wavelength, weight = self._passing
        counted = self.efficiency.at(wavelength) * wavelength / PHOTON_ENERGY_J_UM
        return wavelength, weight * counted
