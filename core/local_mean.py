"""Gaussian-weighted local mean of a mirrored frame, by its low frequencies alone.

A Gaussian of five samples is below rounding beyond two fifths of the band, so that most columns
of the transforms hold nothing and are left out.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.arithmetic import require_finite
from core.physics.gaussian import gaussian_mtf
from core.work import Work

Array = NDArray[Any]
BLOCK_SAMPLES = 1 << 16  # samples of a block of rows or columns, to stay in a core's cache


def local_mean(work: Work, image: Array, *, sigma_px: float) -> Array:
    """Gaussian-weighted mean around each sample, the frame mirrored at its edges.

    Parameters
    ----------
    work : Work
        Threads and precision.
    image : ndarray, shape (rows, columns)
        The picture.
    sigma_px : float
        Standard deviation of the weights in samples; 0 gives the picture itself.

    Returns
    -------
    ndarray
        A new array of the picture's shape.
    """
    dtype = work.policy.dtype
    if sigma_px == 0:
        return image.astype(dtype)
    rows, columns = image.shape
    mean = float(np.mean(image, dtype=np.float64))
    along, across = (_response(size, sigma_px, dtype) for size in image.shape)
    low = np.empty((rows, len(across)), dtype)
    result = np.empty(image.shape, dtype)

    def forward(start: int) -> None:
        lines = slice(start, start + height)
        values = np.subtract(image[lines], mean, dtype=dtype)
        values = scipy.fft.dct(values, type=2, axis=1, overwrite_x=True)
        np.multiply(values[:, : len(across)], across, out=low[lines])

    def middle(start: int) -> None:
        part = slice(start, start + width)
        values = scipy.fft.dct(low[:, part], type=2, axis=0)
        values[: len(along)] *= along[:, np.newaxis]
        values[len(along) :] = 0
        low[:, part] = scipy.fft.idct(values, type=2, axis=0, overwrite_x=True)

    def backward(start: int) -> None:
        lines = slice(start, start + height)
        values = scipy.fft.idct(low[lines], type=2, n=columns, axis=1)
        require_finite(values)
        np.add(values, dtype.type(mean), out=result[lines])

    height = max(1, BLOCK_SAMPLES // columns)
    width = max(1, BLOCK_SAMPLES // rows)
    work.each(forward, range(0, rows, height))
    work.each(middle, range(0, len(across), width))
    work.each(backward, range(0, rows, height))
    return result


def _response(size: int, sigma_px: float, dtype: np.dtype[Any]) -> Array:
    """The Gaussian's response at k/(2·size) up to where it is below rounding."""
    # exp(−2π²σ²f²) = rounding / 64 at this frequency in cycles a sample
    faintest = float(np.finfo(dtype).eps) / 64
    limit = math.sqrt(-math.log(faintest) / 2) / (math.pi * sigma_px)
    count = min(size, math.floor(min(limit * 2 * size, size)) + 1)
    response = gaussian_mtf(frequency=np.arange(count) / (2 * size), sigma_mrad=sigma_px)
    return response.astype(dtype)
