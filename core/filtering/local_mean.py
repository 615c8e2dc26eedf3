"""Gaussian-weighted local mean of a mirrored frame, by its low frequencies alone.

A Gaussian of five samples is below rounding beyond two fifths of the band, so that most columns
of the transforms hold nothing and are left out.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.float_guard import require_finite
from core.evaluation.work import Work
from core.filtering.cosine_transforms import (
    column_blocks,
    row_blocks,
    transform_block,
    transform_columns,
    transform_rows,
)
from core.physics.optics.gaussian import gaussian_mtf
from core.scratch.strip_array import StripArray

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
        same: Array = work.empty(image.shape)
        same[...] = image
        return same
    mean = float(np.mean(image))
    along, across = (_response(size, sigma_px, dtype) for size in image.shape)
    if work.blocks is not None and work.blocks.disk.wants(image.shape, dtype):
        return _from_disk(work, image, mean, along, across)
    values = np.empty(image.shape, dtype)

    def spread(rows: slice) -> None:
        part = np.subtract(image[rows], mean, out=values[rows], dtype=dtype)
        values[rows] = transform_block(part, "dct", axis=1)
        values[rows, : len(across)] *= across
        values[rows, len(across) :] = 0

    work.for_each(spread, row_blocks(image.shape))
    width = len(across)
    transform_columns(work, values, "dct", width)
    values[: len(along), :width] *= along[:, np.newaxis]
    values[len(along) :, :width] = 0
    transform_columns(work, values, "idct", width)
    transform_rows(work, values, "idct")
    require_finite(values)
    values += dtype.type(mean)
    return values


def _from_disk(work: Work, image: Array, mean: float, along: Array, across: Array) -> Array:
    """The same, the columns that hold something on disk."""
    dtype, width = work.policy.dtype, len(across)
    lines = work.strips((image.shape[0], width))
    made: Array = work.empty(image.shape)

    def spread(rows: slice) -> None:
        part = transform_block(np.subtract(image[rows], mean, dtype=dtype), "dct", axis=1)
        lines[rows] = part[:, :width] * across

    def blur(block: Array) -> None:
        values = transform_block(np.ascontiguousarray(block), "dct", axis=0)
        values[: len(along)] *= along[:, np.newaxis]
        values[len(along) :] = 0
        block[...] = transform_block(values, "idct", axis=0)

    def gather(rows: slice) -> None:
        part = np.zeros((len(image[rows]), image.shape[1]), dtype)
        part[:, :width] = lines[rows]
        part = transform_block(part, "idct", axis=1)
        require_finite(part)
        part += dtype.type(mean)
        made[rows] = part

    work.for_each(spread, row_blocks(image.shape))
    for strip in lines.strips if isinstance(lines, StripArray) else [lines]:
        work.for_each(blur, column_blocks(strip))
    work.for_each(gather, row_blocks(image.shape))
    return made


def _response(size: int, sigma_px: float, dtype: np.dtype[Any]) -> Array:
    """The Gaussian's response at k/(2·size) up to where it is below rounding."""
    # exp(−2π²σ²f²) = rounding / 64 at this frequency in cycles a sample
    faintest = float(np.finfo(dtype).eps) / 64
    limit = math.sqrt(-math.log(faintest) / 2) / (math.pi * sigma_px)
    count = min(size, math.floor(min(limit * 2 * size, size)) + 1)
    response = gaussian_mtf(frequency=np.arange(count) / (2 * size), sigma_mrad=sigma_px)
    return response.astype(dtype)
