"""Wavelengths and weights that stand for a spectral band."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.errors import ParameterError
from core.physics.numerics.quadrature import gauss_legendre

MOST_WAVELENGTHS = 256


def band_wavelengths(
    *, cut_on_um: float, cut_off_um: float, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wavelengths over a uniformly weighted band, with weights.

    Parameters
    ----------
    cut_on_um, cut_off_um : float
        Ends of the band [µm], cut-on above 0 and not above cut-off.
    count : int
        Number of wavelengths, 1 to 256. 1 is the band's mean; more are Gauss-Legendre nodes.

    Returns
    -------
    wavelengths_um, weights : ndarray
        Shape (count,), ascending; the weights sum to 1.

    Raises
    ------
    ParameterError
        If the band is empty or the count out of range.
    """
    if not (math.isfinite(cut_on_um) and cut_on_um > 0.0):
        raise ParameterError("cut_on_um", cut_on_um, "above 0", unit="um")
    if not (math.isfinite(cut_off_um) and cut_off_um >= cut_on_um):
        raise ParameterError("cut_off_um", cut_off_um, f"{cut_on_um:g} or more", unit="um")
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
