"""Low-rank approximation of a planar factor on a grid, from a few of its rows and columns.

In the central band a disc's OTF is smooth but for the cusp at zero, and numerically of low rank: 20
at 1e-8. Complete pivoting on a coarse grid of probes chooses rows and columns that span the plane,
which is then the product of two thin matrices (Bebendorf 2000, Numer. Math. 86, 565).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Evaluate = Callable[[Array, Array], Array]  # (row indices, column indices) → block

HIGHEST_RANK = 48  # beyond it the matrices' product takes longer than reading the plane
PROBES = 40  # rows and columns spread evenly, and as many dense at the start
ROUNDS = 2  # of probes, each between the ones before
PRODUCT_TERMS, PRODUCT_COLUMNS = 1 << 19, 1 << 10  # of one piece of the product
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
    i_probes, j_probes = _probes(rows, 0), _probes(columns, 0)
    for turn in range(1, ROUNDS + 1):
        values = evaluate(i_probes, j_probes)
        if not np.all(values):
            return None  # the edge of the support is in the plane, and it is no low-rank curve
        pivot = _pivots(values, 0.5 * tolerance, highest)
        if pivot is None:
            return None
        i, j, left, right = pivot
        # At the pivots' rows and columns the factors on the probes are triangular.
        u = evaluate(every_row, j_probes[j]) @ np.linalg.inv(right[:, j])
        v = np.linalg.inv(left[i]) @ evaluate(i_probes[i], every_column)
        i_between, j_between = _probes(rows, turn), _probes(columns, turn)
        error = evaluate(i_between, j_between) - u[i_between] @ v[:, j_between]
        if np.abs(error).max() <= tolerance and _lines_fit(evaluate, u, v, tolerance):
            return u, v
        # A kink that one set of probes misses, another meets.
        i_probes, j_probes = np.union1d(i_probes, i_between), np.union1d(j_probes, j_between)
    return None


def thin_product(u: Array, v: Array) -> Array:
    """U·V by small pieces.

    Called from several threads at once a matrix product that starts threads of its own takes a
    hundred times as long (66 ms instead of 0.6 ms at 1024² and rank 19); small ones start none.
    """
    rows, columns = len(u), v.shape[1]
    product = np.empty((rows, columns), u.dtype)
    height = max(1, PRODUCT_TERMS // (PRODUCT_COLUMNS * max(1, len(v))))
    for top in range(0, rows, height):
        lines = slice(top, top + height)
        for left in range(0, columns, PRODUCT_COLUMNS):
            part = slice(left, left + PRODUCT_COLUMNS)
            np.matmul(u[lines], v[:, part], out=product[lines, part])
    return product


def _pivots(
    values: Array, tolerance: float, highest: int
) -> tuple[Array, Array, Array, Array] | None:
    """Rows and columns of the pivots, and the two factors; None where the rank is not low."""
    residual = values.copy()
    left, right = np.empty((len(values), highest)), np.empty((highest, values.shape[1]))
    i, j = np.empty(highest, np.intp), np.empty(highest, np.intp)
    for rank in range(highest + 1):
        at = int(np.argmax(np.abs(residual)))
        row, column = divmod(at, residual.shape[1])
        if abs(residual[row, column]) <= tolerance:
            return i[:rank], j[:rank], left[:, :rank], right[:rank]
        if rank == highest:
            break
        i[rank], j[rank] = row, column
        left[:, rank] = residual[:, column]
        right[rank] = residual[row] / residual[row, column]
        residual -= np.multiply.outer(left[:, rank], right[rank])
    return None


def _lines_fit(evaluate: Evaluate, u: Array, v: Array, tolerance: float) -> bool:
    """Whether whole rows and columns between the probes agree."""
    rows, columns = len(u), v.shape[1]
    golden = (np.arange(1, LINES + 1) * 0.6180339887498949) % 1.0
    i, j = (golden * rows).astype(np.int64), (golden * columns).astype(np.int64)
    across = evaluate(i, np.arange(columns)) - u[i] @ v
    along = evaluate(np.arange(rows), j) - u @ v[:, j]
    return bool(max(np.abs(across).max(), np.abs(along).max()) <= tolerance)


def _probes(size: int, turn: int) -> Array:
    """Indices spread evenly, dense at the start; every turn's lie between those before."""
    count, shift = min(size, PROBES), (0.0, 0.5, 0.25, 0.75)[turn]
    places = np.minimum((np.arange(count) + shift) / max(count - 1, 1), 1.0)
    dense = np.arange(min(size, 8)) + int(8 * shift)
    spread = np.concatenate([(size - 1) * places, (size - 1) * places**3]).round()
    return np.unique(np.minimum(np.concatenate([dense, spread]), size - 1).astype(np.int64))
