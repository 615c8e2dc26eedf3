"""How much each wavelength of a band counts in an image: by photons, by energy, or all alike."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.numerics.scalar_checks import positive
from core.physics.radiometry.constants import SECOND_RADIATION_CONSTANT_M_K

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

    Notes
    -----
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
