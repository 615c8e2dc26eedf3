"""The nearest values that never fall, to some that may."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def nearest_rising(*, values: Vector) -> Vector:
    """Values that never fall, with the least sum of squares of what they are off.

    Notes
    -----
    Neighbours that fall are given their mean, and so on with what lies before (pool adjacent
    violators; Ayer, Brunk, Ewing, Reid and Silverman, 1955).
    """
    means: list[float] = []
    counts: list[int] = []
    for value in values:
        mean, count = float(value), 1
        while means and means[-1] > mean:
            before, many = means.pop(), counts.pop()
            mean = (mean * count + before * many) / (count + many)
            count += many
        means.append(mean)
        counts.append(count)
    return np.repeat(np.array(means, np.float64), counts)
