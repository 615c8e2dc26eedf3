"""A 2-D array on disk that is written by rows and transformed by columns, or the other way round.

Blocks of columns ("strips") lie together, each by rows. A block of rows is then as many pieces as
there are strips, and all rows of a strip are one piece: either way disks read and write long runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class StripArray:
    """Rows are read and written by ``array[start:stop]``, strips are views.

    Parameters
    ----------
    flat : ndarray, shape (rows·columns,)
        Where the samples lie.
    shape : (int, int)
        Rows and columns.
    width : int
        Columns of a strip; the last may have fewer.
    """

    def __init__(self, flat: Array, shape: tuple[int, int], width: int) -> None:
        self.shape, self.dtype = shape, flat.dtype
        rows, columns = shape
        self.places = [slice(left, min(left + width, columns)) for left in range(0, columns, width)]
        self.strips = [
            flat[rows * place.start : rows * place.stop].reshape(rows, place.stop - place.start)
            for place in self.places
        ]

    @property
    def nbytes(self) -> int:
        """Size on disk."""
        return self.shape[0] * self.shape[1] * self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, rows: slice | Array) -> Array:
        """A copy of some rows."""
        parts = [strip[rows] for strip in self.strips]
        return np.concatenate(parts, axis=1)

    def __setitem__(self, rows: slice, block: Array | float) -> None:
        for place, strip in zip(self.places, self.strips, strict=True):
            strip[rows] = block[:, place] if isinstance(block, np.ndarray) else block

    def __iter__(self) -> Iterator[tuple[slice, Array]]:
        """Columns and strip, in order."""
        return zip(self.places, self.strips, strict=True)
