"""Pointwise functions evaluated piece by piece, so that what they need stays in the cache."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Points of a tile. Smaller ones would be quicker on one thread, but two threads then wait for each
# other: half the points take half as long again.
POINTS = 1 << 15
COLUMNS = 1 << 8  # nearly square, so that what holds nowhere in a tile can be left out of it


def by_tiles(function: Callable[..., Floats], *coordinates: Floats) -> Floats:
    """Values of a pointwise function of arrays that broadcast.

    Parameters
    ----------
    function : callable
        Given as many arrays of two axes, of which each may have one row or column only.
    coordinates : ndarray
        What it is a function of.

    Returns
    -------
    ndarray
        Values, of the shape to which the coordinates broadcast.
    """
    shape = np.broadcast_shapes(*(coordinate.shape for coordinate in coordinates))
    if len(shape) == 2:
        arrays = [
            coordinate.reshape((1,) * (2 - coordinate.ndim) + coordinate.shape)
            for coordinate in coordinates
        ]
    else:
        arrays = [np.broadcast_to(coordinate, shape).reshape(1, -1) for coordinate in coordinates]
    values: Floats = np.empty(np.broadcast_shapes(*(array.shape for array in arrays)))
    rows, columns = values.shape
    width = min(columns, max(COLUMNS, POINTS // max(1, rows)))
    height = max(1, POINTS // max(1, width))
    for top in range(0, rows, height):
        for left in range(0, columns, width):
            place = slice(top, top + height), slice(left, left + width)
            values[place] = function(*(part_of(array, place) for array in arrays))
    return values.reshape(shape)


def part_of(values: NDArray[np.float64], place: tuple[slice, slice]) -> NDArray[np.float64]:
    """Rows and columns of an array; of one row or column every one is the same."""
    rows, columns = (
        lines if size > 1 else slice(None) for lines, size in zip(place, values.shape, strict=True)
    )
    part: Floats = values[rows, columns]
    return part
