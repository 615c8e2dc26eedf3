"""What a set of opaque intervals leaves open of a window, for many points at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Interval = tuple["Floats | float", "Floats | float"]


def open_gaps(
    *, window: tuple[Floats, Floats], opaque: Sequence[Interval]
) -> tuple[Floats, Floats]:
    """Start and end of each gap that a union of intervals leaves in a window.

    Parameters
    ----------
    window : (low, high)
        Arrays of shape (points,), low <= high.
    opaque : sequence of (low, high)
        m intervals, arrays of shape (points,) or scalars; an empty one has high <= low.

    Returns
    -------
    start, end : ndarray
        Shape (m + 1, points). A gap that does not exist has end == start.

    Notes
    -----
    The k-th gap lies between the k-th smallest end and the (k+1)-th smallest start, each sorted
    by itself: at a point left open, as many intervals have ended as have begun.
    """
    low, high = window
    starts = np.empty((len(opaque) + 1, low.size))
    ends = np.empty_like(starts)
    starts[-1], ends[-1] = high, low
    for row, (begin, end) in enumerate(opaque):
        np.clip(begin, low, high, out=starts[row])
        np.clip(end, low, high, out=ends[row])
        np.maximum(ends[row], starts[row], out=ends[row])
    _sort_columns(starts)
    _sort_columns(ends)
    return ends, np.maximum(starts, ends)


def _sort_columns(rows: Floats) -> None:
    """Sort a few long rows column by column: a network of whole-row minima and maxima."""
    count = len(rows)
    for turn in range(count):
        first = rows[turn % 2 : count - 1 : 2]
        second = rows[turn % 2 + 1 : count : 2]
        smaller = np.minimum(first, second)
        np.maximum(first, second, out=second)
        first[...] = smaller
