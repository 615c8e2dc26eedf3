"""OTF of a centrally obscured circular aperture out of focus."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.numerics.quadrature import gauss_legendre

Vector = NDArray[np.float64]
MOST_DEFOCUS_WAVES = 100.0
_NODES = 24  # Gauss-Legendre nodes of a panel
_PHASE_PER_PANEL = 12.0  # [rad]; 24 nodes integrate cos over it to rounding
_VALUES_PER_BLOCK = 1 << 19


def annular_defocus_otf(
    *, frequency_ratio: ArrayLike, w20_waves: ArrayLike, obscuration_ratio: float = 0.0
) -> Vector:
    """OTF of a disc or annulus with the wavefront error W = W20 rho², real and signed.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff (aperture diameter over wavelength), 0 or above.
    w20_waves : array_like
        Wavefront error at the outer rim [waves], at most 100 in size; broadcasts.
    obscuration_ratio : float
        Inner over outer radius, 0 up to but not including 1.

    Returns
    -------
    ndarray
        1 at zero, 0 from the cutoff on; absolute error near 1e-15.

    Raises
    ------
    ParameterError
        If defocus or obscuration are out of range.
    DataError
        If a frequency is not finite.

    Notes
    -----
    Pupils moved by ±v differ in phase by kx, k = 8π·W20·v, so that the OTF is the integral of
    cos(kx) over the area they share, (D − d)(D' − d') with discs D and obscurations d: a lens of
    the discs, less twice that of a disc and the other's obscuration, and one of the obscurations.
    Each is bounded by arcs x = c + R·cos t, whose chords are 2R·sin t. Source: Hopkins 1955, Proc.
    R. Soc. A 231, 91, for the disc; O'Neill 1956, JOSA 46, 285, for the parts of the annulus.
    """
    inner = float(obscuration_ratio)
    if not 0.0 <= inner < 1.0:
        raise ParameterError(
            "obscuration_ratio", inner, "0 up to but not including 1 (an opening must remain)"
        )
    v, w20 = np.broadcast_arrays(
        np.asarray(frequency_ratio, np.float64), np.abs(np.asarray(w20_waves, np.float64))
    )
    if not np.all(np.isfinite(v)) or np.any(v < 0.0):
        raise DataError("frequency_ratio holds a value that is negative or not finite")
    if not np.all(w20 <= MOST_DEFOCUS_WAVES):
        worst = float(w20[~(w20 <= MOST_DEFOCUS_WAVES)][0])
        allowed = f"at most {MOST_DEFOCUS_WAVES:g} in size"
        raise ParameterError("defocus_waves", worst, allowed, unit="waves")
    flat, rate = v.ravel(), (8.0 * np.pi * w20 * v).ravel()
    otf = np.zeros(flat.size)
    inside = np.flatnonzero(flat < 1.0)
    panels = np.ceil(rate[inside] * (1.0 + inner) / _PHASE_PER_PANEL).astype(np.int64) + 1
    sizes = 1 << np.ceil(np.log2(panels)).astype(np.int64)
    for size in np.unique(sizes):
        chosen = inside[sizes == size]
        nodes, weights = _panel_rule(int(size))
        step = max(1, _VALUES_PER_BLOCK // len(nodes))
        for start in range(0, chosen.size, step):
            block = chosen[start : start + step]
            otf[block] = _shared(flat[block], rate[block], inner, nodes, weights)
    otf[flat == 0.0] = 1.0
    return otf.reshape(v.shape)


def _shared(v: Vector, k: Vector, inner: float, nodes: Vector, weights: Vector) -> Vector:
    """∫ cos(kx) over what two annuli moved by ±v share, over the area of one."""

    def arc(centre: Vector, radius: float, low: Vector, high: Vector) -> Vector:
        """∫ of 2·√(R² − (x − c)²)·cos(kx) over x from low to high, 0 where high ≤ low."""
        first = np.arccos(np.clip((high - centre) / radius, -1.0, 1.0))
        last = np.arccos(np.clip((low - centre) / radius, -1.0, 1.0))
        width = np.maximum(last - first, 0.0)
        angle = first[:, np.newaxis] + width[:, np.newaxis] * nodes
        x = centre[:, np.newaxis] + radius * np.cos(angle)
        values = np.sin(angle) ** 2 * np.cos(k[:, np.newaxis] * x)
        made: Vector = 2.0 * radius**2 * width * (values @ weights)
        return made

    zero = np.zeros_like(v)
    area = 2.0 * arc(-v, 1.0, zero, 1.0 - v)
    if inner > 0.0:
        area += 2.0 * arc(-v, inner, zero, np.maximum(inner - v, 0.0))
        # The disc about −v bounds the obscuration about v beyond where their outlines cross.
        with np.errstate(divide="ignore"):
            crossing = np.where(v > 0.0, (1.0 - inner**2) / (4.0 * v), np.inf)
        crossing = np.clip(crossing, v - inner, v + inner)
        area -= 2.0 * arc(v, inner, v - inner, crossing)
        beyond = np.where(crossing < v + inner, 1.0 - v, crossing)
        area -= 2.0 * arc(-v, 1.0, crossing, np.maximum(beyond, crossing))
    return np.asarray(area / (np.pi * (1.0 - inner**2)))


def _panel_rule(panels: int) -> tuple[Vector, Vector]:
    """Nodes and weights over [0, 1] in equal panels."""
    nodes, weights = gauss_legendre(_NODES)
    places = (np.arange(panels)[:, np.newaxis] + 0.5 * (nodes + 1.0)) / panels
    return places.ravel(), np.tile(0.5 * weights / panels, panels)
