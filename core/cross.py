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
PROBES = 40  # rows and columns of each set on which the error is sought
LINES = 4  # whole rows and columns on which the result is checked


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
        columns, where an OTF has its cusp, and on some whole lines between them.

    Returns
    -------
    (U, V) or None
        None where the rank is not low or the plane has zeros: then it is evaluated directly.
    """
    highest = min(HIGHEST_RANK, min(rows, columns) // 4)
    every_row, every_column = np.arange(rows), np.arange(columns)
    u, v = np.empty((rows, highest)), np.empty((highest, columns))
    rank = 0
    for shift in (0.0, 0.5, 0.25, 0.75):
        # Each set of probes lies between the ones before: a kink that one misses, another meets.
        i_probes, j_probes = _probes(rows, shift), _probes(columns, shift)
        values = evaluate(i_probes, j_probes)
        if not np.all(values):
            return None  # the edge of the support is in the plane, and it is no low-rank curve
        residual = values - u[i_probes, :rank] @ v[:rank, j_probes]
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
    u, v = u[:, :rank].copy(), v[:rank].copy()
    if _lines_fit(evaluate, u, v, tolerance):
        return u, v
    return None


def _lines_fit(evaluate: Evaluate, u: Array, v: Array, tolerance: float) -> bool:
    """Whether whole rows and columns between the probes agree."""
    rows, columns = len(u), v.shape[1]
    golden = (np.arange(1, LINES + 1) * 0.6180339887498949) % 1.0
    i, j = (golden * rows).astype(np.int64), (golden * columns).astype(np.int64)
    across = evaluate(i, np.arange(columns)) - u[i] @ v
    along = evaluate(np.arange(rows), j) - u @ v[:, j]
    return bool(max(np.abs(across).max(), np.abs(along).max()) <= tolerance)


def _probes(size: int, shift: float) -> Array:
    """Indices spread evenly, dense at the start."""
    places = np.minimum((np.arange(min(size, PROBES)) + shift) / max(min(size, PROBES) - 1, 1), 1)
    dense = np.arange(min(size, 8)) + int(8 * shift)
    spread = np.concatenate([(size - 1) * places, (size - 1) * places**3]).round()
    return np.unique(np.minimum(np.concatenate([dense, spread]), size - 1).astype(np.int64))
