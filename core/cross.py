"""Low-rank approximation of a planar factor on a grid, from a few of its rows and columns.

In the central band a pupil's OTF is smooth but for the cusp at zero, and numerically of low rank:
a disc has rank 20 at 1e-8. Adaptive cross approximation evaluates a few rows and columns, and the
plane is then the product of two thin matrices (Bebendorf 2000, Numer. Math. 86, 565).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Evaluate = Callable[[Array, Array], Array]  # (rows indices, columns indices) → block

HIGHEST_RANK = 96
PROBES = 40  # rows and columns of the grid on which the result is checked


def cross_approximation(
    evaluate: Evaluate, rows: int, columns: int, tolerance: float
) -> tuple[Array, Array] | None:
    """Thin matrices U (rows × r) and V (r × columns) with U·V equal to the plane.

    Parameters
    ----------
    evaluate : callable
        Block of the plane at row indices × column indices.
    rows, columns : int
        Size of the plane.
    tolerance : float
        Largest absolute error on the probes, which are drawn evenly and include the first rows and
        columns, where an OTF has its cusp.

    Returns
    -------
    (U, V) or None
        None where the rank is not low: then the plane is better evaluated directly.
    """
    highest = min(HIGHEST_RANK, min(rows, columns) // 4)
    every_row, every_column = np.arange(rows), np.arange(columns)
    u, v = np.empty((rows, highest)), np.empty((highest, columns))
    rank = 0
    for shift in (0.0, 0.5, 0.25, 0.75):
        # Each set of probes lies between the ones before: a kink that one misses, another meets.
        i_probes, j_probes = _probes(rows, shift), _probes(columns, shift)
        residual = evaluate(i_probes, j_probes) - u[i_probes, :rank] @ v[:rank, j_probes]
        while True:
            at = np.unravel_index(int(np.argmax(np.abs(residual))), residual.shape)
            if abs(residual[at]) <= 0.5 * tolerance:
                break
            if rank == highest:
                return None
            # The worst probe's row, then the column of that row's largest element.
            i = int(i_probes[at[0]])
            row = evaluate(np.array([i]), every_column)[0] - u[i, :rank] @ v[:rank]
            j = int(np.argmax(np.abs(row)))
            column = evaluate(every_row, np.array([j]))[:, 0] - u[:, :rank] @ v[:rank, j]
            u[:, rank], v[rank] = column, row / row[j]
            residual = residual - np.outer(column[i_probes], v[rank, j_probes])
            rank += 1
    return u[:, :rank].copy(), v[:rank].copy()


def _probes(size: int, shift: float) -> Array:
    """Indices spread evenly, dense at the start."""
    places = np.minimum((np.arange(min(size, PROBES)) + shift) / max(min(size, PROBES) - 1, 1), 1)
    dense = np.arange(min(size, 8)) + int(8 * shift)
    spread = np.concatenate([(size - 1) * places, (size - 1) * places**3]).round()
    return np.unique(np.minimum(np.concatenate([dense, spread]), size - 1).astype(np.int64))
