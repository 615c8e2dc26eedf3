"""Correction of the unlike gains and offsets of detector elements by uniform references."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError

Array = NDArray[Any]
LEAST_RESPONSE = 0.1
"""Of the mean response; an element of less is taken for bad, and its gain is left as it is."""


def one_point_offset(*, low: Array) -> Array:
    """Offset to be added, by one reference: its mean less each element's own.

    Source: Perry and Dereniak 1993, Linear theory of nonuniformity correction in infrared staring
    sensors, Opt. Eng. 32; Holst 2008, Electro-Optical Imaging System Performance.
    """
    return np.asarray(np.mean(low, dtype=np.float64) - np.asarray(low, np.float64))


def two_point_gain(*, low: Array, high: Array) -> Array:
    """Factor by which an element's response between two references becomes the mean one.

    Parameters
    ----------
    low, high : ndarray
        What the elements give of a cooler and of a warmer uniform reference.

    Returns
    -------
    ndarray of float64
        (mean of high − mean of low)/(high − low); 1 where an element's response is below
        `LEAST_RESPONSE` of the mean one.

    Raises
    ------
    DataError
        If both references give the same on average.

    Notes
    -----
    Source: Perry and Dereniak 1993; Schulz and Caldwell 1995, Infrared Phys. Technol. 36.
    """
    response = np.asarray(high, np.float64) - np.asarray(low, np.float64)
    mean = float(response.mean())
    if mean == 0.0 or not np.isfinite(mean):
        raise DataError(
            f"both references give {float(np.mean(low)):.6g} on average: a correction of gain "
            "needs two that differ, and none beyond what the detector holds"
        )
    share = response / mean
    good = share > LEAST_RESPONSE
    return np.asarray(1.0 / np.where(good, share, 1.0))


def two_point_offset(*, low: Array, gain: Array) -> Array:
    """Offset to be added behind the gain: the cooler reference comes out as its mean."""
    return np.asarray(np.mean(low, dtype=np.float64) - gain * np.asarray(low, np.float64))
