"""The step of the converter, from the values that occur in a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

_MOST = 1 << 19  # samples that are looked at
_REPEATED = 0.75  # values per sample beyond which there is no step
_LIKE = 0.05  # by how much steps may differ, as in numbers turned to radiance
_MOST_ALIKE = 0.9  # of the gaps that are whole steps


def rounding_step(*, picture: Matrix) -> float | None:
    """Smallest distance of two values where all are whole multiples of it; None of others.

    Parameters
    ----------
    picture : ndarray
        Samples; not all of a large picture are looked at, whole rows apart.

    Notes
    -----
    Steps that differ by some percent count as one: a table has turned the numbers to another
    quantity. Noise of fewer values than samples is what shows a step at all.
    """
    every = max(1, picture.size // _MOST)
    values, many = np.unique(picture[::every], return_counts=True)
    if len(values) < 2 or len(values) > _REPEATED * many.sum():
        return None
    gaps = np.diff(values)
    step = float(np.quantile(gaps, 0.25, method="lower"))
    if not step > 1e-12 * float(np.abs(values).max()):
        return None
    steps = gaps / step
    whole = np.rint(steps)
    like = (whole >= 1.0) & (np.abs(steps - whole) <= _LIKE * whole)
    if float(np.mean(like)) < _MOST_ALIKE:
        return None
    return float(np.median(gaps[like] / whole[like]))
