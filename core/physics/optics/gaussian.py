"""Gaussian blur: optics, random line-of-sight jitter and a turbulent blur spot."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.checks import non_negative


def gaussian_mtf(*, frequency: ArrayLike, sigma_mrad: float) -> NDArray[np.float64]:
    """MTF of a Gaussian blur along one axis, or of a round one against radial frequency.

    Parameters
    ----------
    frequency : array_like
        Frequencies in cycles/mrad, any shape, finite.
    sigma_mrad : float
        Standard deviation of the blur spot in mrad, zero or above.

    Returns
    -------
    ndarray of float64
        exp(−2π²σ²·frequency²), of the shape of `frequency`.

    Source: Tantalo 1996, eqs. 4.22 and 4.36. Erratum: eq. 4.36 calls σ² the variance and takes
    it in µrad; here σ is in mrad, as the frequencies are per mrad.
    """
    sigma = non_negative("sigma_mrad", sigma_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        turns = sigma * np.asarray(frequency, dtype=np.float64)
        return np.asarray(np.exp(-2.0 * math.pi**2 * np.square(turns)), dtype=np.float64)


def fwhm_to_sigma_mrad(*, fwhm_mrad: float) -> float:
    """Standard deviation of a Gaussian by its full width at half maximum: FWHM/(2·√(2·ln 2)).

    Source: definition of the normal density. Erratum: the width parameter of Tantalo 1996,
    eqs. 4.8-4.9, is damaged in print; this is the relation they stand for.
    """
    width = non_negative("fwhm_mrad", fwhm_mrad, unit="mrad")
    return width / (2.0 * math.sqrt(2.0 * math.log(2.0)))
