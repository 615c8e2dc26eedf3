"""Names of the arrays that are passed on: of any type, and by what they hold."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Floats = NDArray[np.float64]
Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
Mask = NDArray[np.bool_]
Index = NDArray[np.intp]


def block_means(samples: Array, down: int, across: int | None = None) -> Array:
    """Means of blocks of samples, as high as wide if not said otherwise; the rest is left out."""
    across = down if across is None else across
    rows, columns = samples.shape[0] // down, samples.shape[1] // across
    whole = samples[: rows * down, : columns * across]
    return np.asarray(whole.reshape(rows, down, columns, across).mean(axis=(1, 3)))
