"""Spectrum of a picture's noise in equal cells of frequency, whatever waves it is known on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.noise.noise_power import NoisePower
from core.transfer.planar_blocks import Axes

Vector = NDArray[np.float64]
CELLS = 48  # filters of sensors are smooth: more change no share of a noise by 1e-3


def spectrum_of(powers: list[NoisePower], cells: int = CELLS) -> Vector | None:
    """Power of all of these noises of one picture together.

    Parameters
    ----------
    powers : list of NoisePower
        Of independent noises, of frames of one size.
    cells : int
        Most cells along an axis, from frequency zero to Nyquist's. A frame has no more than
        samples, and as many whatever waves its noises are known on.

    Returns
    -------
    ndarray or None
        Mean power in each cell, shape (along, across), either 1 where all cells of an axis are
        alike; None without any noise.
    """
    total: Vector | None = None
    for power in powers:
        shown = np.asarray(power.shown, np.float64)
        for axis, size in ((0, power.rows), (1, power.columns)):
            if shown.shape[axis] > 1:
                shares = _shares(size, power.axes, min(cells, size))
                shown = shares @ shown if axis == 0 else shown @ shares.T
        total = shown if total is None else total + shown
    return total if total is not None and total.sum() > 0.0 else None


def _shares(size: int, axes: Axes, cells: int) -> Vector:
    """Share that each wave has in the mean over each cell, shape (cells, waves).

    A wave stands for the frequencies nearer to its own than to its neighbours'.
    """
    if axes == "mirrored":
        place = np.arange(size) / size  # of Nyquist's frequency
        twice = np.ones(size)
        order = np.arange(size)
    else:
        order = np.minimum(np.arange(size), size - np.arange(size))
        place = np.arange(size // 2 + 1) / (size / 2.0)
        twice = np.bincount(order).astype(float)
    bounds = np.concatenate([[0.0], (place[1:] + place[:-1]) / 2.0, [1.0]])
    edges = np.linspace(0.0, 1.0, cells + 1)
    low = np.maximum(edges[:-1, np.newaxis], bounds[:-1])
    high = np.minimum(edges[1:, np.newaxis], bounds[1:])
    part = np.clip(high - low, 0.0, None) * (len(edges) - 1)
    return np.asarray((part / twice)[:, order], np.float64)
