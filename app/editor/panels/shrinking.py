"""Fewer samples of a picture, for drawing it small."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_MEAN_OF = 4  # samples each way that are averaged; of more, every n-th


def shrunk(samples: NDArray[Any], most: int) -> NDArray[np.float64]:
    """At most so many rows and columns, C order.

    Blocks are averaged. Of a picture far too large, only every n-th row and column is looked at
    before.
    """
    rows, columns = samples.shape
    factor = max(1, -(-max(rows, columns) // most))
    stride = max(1, factor // _MEAN_OF)
    seen = samples[::stride, ::stride]
    block = -(-max(seen.shape) // most)
    if block > 1:
        high, wide = (max(1, side // block) for side in seen.shape)
        part = seen[: min(high * block, seen.shape[0]), : min(wide * block, seen.shape[1])]
        down, across = part.shape[0] // high, part.shape[1] // wide
        part = part[: high * down, : wide * across].reshape(high, down, wide, across)
        seen = part.mean(axis=(1, 3), dtype=np.float64)
    return np.ascontiguousarray(seen, np.float64)
