"""Order of a picture's lines in which all of its parts and directions have their turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Index = NDArray[np.intp]

_SIDE = 4  # parts of the picture across, and as many down
_DIRECTIONS = 3  # near x, near y, and between
_NEAR_DEG = 30.0


def spread_out(
    *, x: Vector, y: Vector, angle_deg: Vector, merit: Vector, shape: tuple[int, ...]
) -> Index:
    """Order lines by merit, less where better ones lie near and run alike.

    Parameters
    ----------
    x, y : ndarray
        Places.
    angle_deg : ndarray
        Of the normals.
    merit : ndarray
        Larger is better; not negative.
    shape : tuple of int
        Rows and columns of the picture.

    Returns
    -------
    ndarray of int
        Their numbers, best first.

    Notes
    -----
    The merit of the k-th best in a sixteenth of the picture and one of three classes of
    directions is divided by k: the first few then serve both axes and the whole frame, and weak
    lines come before strong ones only where these have many others beside them.
    """
    across = np.clip(x / shape[1] * _SIDE, 0, _SIDE - 1).astype(np.intp)
    down = np.clip(y / shape[0] * _SIDE, 0, _SIDE - 1).astype(np.intp)
    off = np.abs((angle_deg + 90.0) % 180.0 - 90.0)  # from x, 0 to 90
    direction = np.where(off <= _NEAR_DEG, 0, np.where(off >= 90.0 - _NEAR_DEG, 1, 2))
    group = (down * _SIDE + across) * _DIRECTIONS + direction
    order = np.lexsort((-merit, group))
    starts = np.searchsorted(group[order], group[order], side="left")
    rank = np.empty(len(order), np.intp)
    rank[order] = np.arange(len(order)) - starts
    return np.argsort(-merit / (rank + 1.0), kind="stable")
