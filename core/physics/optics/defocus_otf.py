"""OTF of a clear circular aperture out of focus."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.numerics.quadrature import gauss_legendre
from core.physics.optics.annular_otf import annular_otf

MOST_DEFOCUS_WAVES = 1e4
_NODES = 24  # Gauss-Legendre nodes of a panel
_PHASE_PER_PANEL = 12.0  # [rad]; 24 nodes integrate cos over it to rounding
_VALUES_PER_BLOCK = 1 << 17


def defocus_otf(*, frequency_ratio: ArrayLike, w20_waves: float) -> NDArray[np.float64]:
    """OTF of a disc with the wavefront error W = W20 rho², real and signed.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff (aperture diameter over wavelength), of either sign.
    w20_waves : float
        Wavefront error at the rim [waves], at most 10000 in size.

    Returns
    -------
    ndarray
        OTF, shape of `frequency_ratio`; absolute error near 1e-15.

    Raises
    ------
    ParameterError
        If the defocus is out of range.
    DataError
        If a frequency is not finite.

    Notes
    -----
    H = (4/pi) ∫ sin²t cos(k (cos t - v)) dt over t from 0 to acos v, with k = 8 pi W20 v, by
    Gauss-Legendre panels no longer than the oscillation allows; x + v = cos t takes the root out
    of the integrand. Source: Hopkins 1955, Proc. R. Soc. A 231, 91, eq. 17.
    """
    w20 = abs(float(w20_waves))
    if not w20 <= MOST_DEFOCUS_WAVES:
        allowed = f"at most {MOST_DEFOCUS_WAVES:g} in size"
        raise ParameterError("defocus_waves", w20_waves, allowed, unit="waves")
    v = np.abs(np.asarray(frequency_ratio, dtype=np.float64))
    if not np.all(np.isfinite(v)):
        raise DataError("frequency_ratio holds a value that is not finite")
    if w20 == 0.0:
        return annular_otf(frequency_ratio=v)
    flat = np.minimum(v.ravel(), 1.0)
    rate = 8.0 * np.pi * w20 * flat
    panels = np.ceil(rate * (1.0 - flat) / _PHASE_PER_PANEL).astype(np.int64) + 1
    sizes = 1 << np.ceil(np.log2(panels)).astype(np.int64)
    otf = np.empty_like(flat)
    for size in np.unique(sizes):
        chosen = np.flatnonzero(sizes == size)
        step = max(1, _VALUES_PER_BLOCK // (_NODES * int(size)))
        nodes, weights = _panel_rule(int(size))
        for start in range(0, chosen.size, step):
            block = chosen[start : start + step]
            otf[block] = _overlap_integral(flat[block], rate[block], nodes, weights)
    otf[flat == 0.0] = 1.0
    otf[flat >= 1.0] = 0.0
    return otf.reshape(v.shape)


def _panel_rule(panels: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights over [0, 1] in equal panels."""
    nodes, weights = gauss_legendre(_NODES)
    places = (np.arange(panels)[:, np.newaxis] + 0.5 * (nodes + 1.0)) / panels
    return places.ravel(), np.tile(0.5 * weights / panels, panels)


def _overlap_integral(
    v: NDArray[np.float64],
    rate: NDArray[np.float64],
    nodes: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    end = np.arctan2(np.sqrt((1.0 - v) * (1.0 + v)), v)[:, np.newaxis]
    angle = end * nodes
    # cos t - cos(end) as a product: exact also where the overlap is narrow.
    x = 2.0 * np.sin(0.5 * (end + angle)) * np.sin(0.5 * (end - angle))
    values = np.sin(angle) ** 2 * np.cos(rate[:, np.newaxis] * x)
    result: NDArray[np.float64] = (4.0 / math.pi) * end[:, 0] * (values @ weights)
    return result
