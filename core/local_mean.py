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
    mean = float(np.mean(image))
    along, across = (_response(size, sigma_px, dtype) for size in image.shape)
    workers = work.policy.workers
    values = np.subtract(image, mean, dtype=dtype)
    values = scipy.fft.dct(values, type=2, axis=1, overwrite_x=True, workers=workers)
    low = values[:, : len(across)] * across
    work.check()
    low = scipy.fft.dct(low, type=2, axis=0, overwrite_x=True, workers=workers)
    low[: len(along)] *= along[:, np.newaxis]
    low[len(along) :] = 0
    low = scipy.fft.idct(low, type=2, axis=0, overwrite_x=True, workers=workers)
    work.check()
    values[:, : len(across)] = low
    values[:, len(across) :] = 0
    values = scipy.fft.idct(values, type=2, axis=1, overwrite_x=True, workers=workers)
    require_finite(values)
    values += dtype.type(mean)
    return np.asarray(values)


def _response(size: int, sigma_px: float, dtype: np.dtype[Any]) -> Array:
    """The Gaussian's response at k/(2·size) up to where it is below rounding."""
    # exp(−2π²σ²f²) = rounding / 64 at this frequency in cycles a sample
    faintest = float(np.finfo(dtype).eps) / 64
    limit = math.sqrt(-math.log(faintest) / 2) / (math.pi * sigma_px)
    count = min(size, math.floor(min(limit * 2 * size, size)) + 1)
    response = gaussian_mtf(frequency=np.arange(count) / (2 * size), sigma_mrad=sigma_px)
    return response.astype(dtype)
