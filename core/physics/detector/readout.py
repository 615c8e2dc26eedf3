"""What reading a detector does to its picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.checks import all_finite

Vector = NDArray[np.float64]
REACH = 8  # samples to either side of a place
_KAISER = 7.0  # waves of up to 0.35 cycles/sample are exact within 6e-4


def sinc_weights(*, fraction: ArrayLike) -> Vector:
    """Weights, shape (…, 2·REACH), of the samples around a place: a sinc in Kaiser's window.

    `fraction` is how far the place is behind a sample, from 0 to 1. The weights, whose sum is 1,
    begin REACH − 1 samples before that sample.

    Source: Oppenheim and Schafer 2010, Discrete-Time Signal Processing, section 7.5.
    """
    away = all_finite("fraction", fraction)[..., np.newaxis] - np.arange(1 - REACH, REACH + 1)
    window = np.i0(_KAISER * np.sqrt(np.clip(1.0 - (away / REACH) ** 2, 0.0, None)))
    weights = np.sinc(away) * window
    weights[np.abs(weights) < 1e-13] = 0.0  # at a sample, it alone
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))
