"""Where pixels lie among the samples of a scene, and the shift of their picture."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.numerics.scalar_checks import positive

Vector = NDArray[np.float64]
_WHOLE = 1e-6  # of a pixel that may lack at the frame's end: ratios come of rounded data sheets


def pixel_count(*, samples: int, ratio: float) -> int:
    """Whole pixels that fit a frame.

    Parameters
    ----------
    samples : int
        Samples of the frame along this axis.
    ratio : float
        Samples a pixel, above zero; need not be whole.

    Returns
    -------
    int
        At least 1; a millionth of the last pixel may lie beyond the frame.

    Raises
    ------
    DataError
        If not one pixel fits.
    """
    count = math.floor(samples / positive("ratio", ratio) + _WHOLE)
    if count < 1:
        raise DataError(f"a pixel of {ratio:g} samples does not fit a frame of {samples}")
    return count


def pixel_places(*, samples: int, ratio: float, offset: float = 0.0) -> Vector:
    """Middles of the pixels, counted in samples from the middle of the first sample.

    Parameters
    ----------
    samples, ratio
        As for `pixel_count`.
    offset : float
        How far the pixels lie from where the frame's edge would have them, in pixels.

    Returns
    -------
    ndarray
        (m + 1/2 + offset)·ratio − 1/2. Without an offset pixel m covers the same part of the frame
        as a block of samples, so that the picture does not move.
    """
    number = np.arange(pixel_count(samples=samples, ratio=ratio))
    return np.asarray((number + 0.5 + offset) * ratio - 0.5, np.float64)


def shifted_samples_ptf(*, frequency: ArrayLike, shift_mrad: float) -> Vector:
    """Phase of samples that lie `shift_mrad` further to +x than they are taken for.

    Parameters
    ----------
    frequency : array_like
        Cycles/mrad.
    shift_mrad : float
        The shift.

    Returns
    -------
    ndarray
        2π·frequency·shift, radians: the picture moves to −x. By the shift theorem.
    """
    return np.asarray(2.0 * np.pi * shift_mrad * np.asarray(frequency, np.float64), np.float64)
