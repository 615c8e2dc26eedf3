"""Spectra given at a few wavelengths, straight between them, and their means over a band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.radiometry.planck import spectral_radiance

FloatArray = NDArray[np.float64]
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True)
class CoarseSpectrum:
    """A quantity at a few wavelengths.

    Parameters
    ----------
    points : tuple of (wavelength, value)
        Wavelengths ascending [µm]; straight between them, and constant beyond the ends.

    Raises
    ------
    ParameterError
        If there are no points, or their wavelengths do not ascend.
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        wavelengths = [wavelength for wavelength, _ in self.points]
        if not wavelengths or not np.all(np.diff(wavelengths) > 0.0):
            raise ParameterError("points", wavelengths, "one or more, of ascending wavelengths")

    def at(self, wavelength_um: ArrayLike) -> FloatArray:
        """Values at wavelengths [µm]."""
        wavelengths, values = np.array(self.points).T
        return np.asarray(np.interp(np.asarray(wavelength_um, float), wavelengths, values))


def mean_by_planck(
    *spectra: CoarseSpectrum, cut_on_um: float, cut_off_um: float, temperature_K: ArrayLike
) -> FloatArray:
    """Mean of a spectrum, or of a product of several, by the light of black bodies in a band.

    ∫ s(λ)·L(λ, T) dλ / ∫ L(λ, T) dλ by Gauss's rule between the points: with the band's radiance,
    the light that a surface of that emissivity gives, however wide the band is.

    Parameters
    ----------
    *spectra : CoarseSpectrum
        Whose product is averaged.
    cut_on_um, cut_off_um : float
        Band [µm].
    temperature_K : array_like
        Of the black bodies [K], (temperatures,).

    Returns
    -------
    ndarray, (temperatures,)
        The plain mean where a black body gives no light that a number can hold.
    """
    points = {wavelength for spectrum in spectra for wavelength, _ in spectrum.points}
    inside = sorted(point for point in points if cut_on_um < point < cut_off_um)
    ends = np.array([cut_on_um, *inside, cut_off_um])
    middle, half = (ends[1:] + ends[:-1]) / 2.0, np.diff(ends) / 2.0
    places = (middle[:, None] + half[:, None] * _PLACES).ravel()
    widths = (half[:, None] * _WEIGHTS).ravel()
    kelvins = np.atleast_1d(np.asarray(temperature_K, float))
    light = widths * spectral_radiance(places, kelvins[:, None])
    light[~(light.sum(axis=1) > 0.0)] = widths
    values = np.prod([spectrum.at(places) for spectrum in spectra], axis=0)
    return np.asarray((light @ values) / light.sum(axis=1))
