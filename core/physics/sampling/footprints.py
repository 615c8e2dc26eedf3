"""Footprints of a frame's samples, which a projection lays on a scene.

The rays of a frame's columns a and lines b meet the scene at M·(a, b, 1), so that lines of equal a,
and of equal b, are straight on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
SQUARE = 1e-7  # samples by which a border may leave the scene's rows, too few to matter


@dataclass(frozen=True, eq=False)
class Footprints:
    """Footprints on a scene, counted in its samples: the first reaches from 0 to 1.

    Parameters
    ----------
    shape : (int, int)
        Rows and columns of the frame.
    scene : (int, int)
        Rows and columns of the scene.
    turned : bool
        Whether what follows holds with lines and columns of the frame exchanged.
    level : bool
        Whether all strips of a line end at the same rows of the scene, or columns if `swapped`.
    swapped : bool
        Whether rows and columns of the scene are exchanged; of those not level, as is best for
        each strip.
    matrix : ndarray, shape (3, 3)
        From (a, b, 1) to the scene's x and y, before they are exchanged.
    edges : ndarray, shape (columns·strips + 1,)
        a at the borders of strips.
    ends : ndarray, shape (ends,)
        b at the borders of lines; with `widths`, at their middles.
    widths : ndarray, shape (columns,), or None
        Extent of each column's samples in b.
    strips : int
        Strips a footprint is cut into; 1 where they are level.
    """

    shape: tuple[int, int]
    scene: tuple[int, int]
    turned: bool
    level: bool
    swapped: bool
    matrix: Vector
    edges: Vector
    ends: Vector
    widths: Vector | None
    strips: int

    @property
    def columns(self) -> int:
        """Columns, or lines where they are exchanged."""
        return (len(self.edges) - 1) // self.strips

    @property
    def lines(self) -> int:
        """Lines, or columns where they are exchanged."""
        return len(self.ends) - (self.widths is None)


def footprints(
    *,
    matrix: Vector,
    across: Vector,
    along: Vector,
    middles: Vector,
    widths: Vector,
    scene: tuple[int, int],
    strips: int,
) -> Footprints:
    """Lay footprints on a scene.

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
        From (a, b, 1) to the scene's x and y, counted in its samples.
    across : ndarray, shape (columns + 1,)
        a at the borders of columns.
    along : ndarray, shape (rows + 1,)
        b at the borders of lines.
    middles : ndarray, shape (rows,)
        b at the middles of lines.
    widths : ndarray, shape (columns,)
        Extent of each column's samples, in lines.
    scene : (int, int)
        Rows and columns of the scene.
    strips : int
        Strips to cut a footprint into where it lies askew.

    Returns
    -------
    Footprints
    """
    even = bool(np.all(np.abs(widths - 1.0) < 1e-12))
    ways = [way for way in product((False, True), (False, True)) if even or not way[0]]
    slopes = [_slope(arranged(matrix, *way), across, along, way[0]) for way in ways]
    best = int(np.argmin(slopes))
    level = slopes[best] < SQUARE
    turned, swapped = ways[best] if level else (False, False)
    first, second = (along, across) if turned else (across, along)
    cuts = 1 if level else strips
    places = np.arange((len(first) - 1) * cuts + 1) / cuts
    height = (along[-1] - along[0]) / (len(along) - 1)
    return Footprints(
        shape=(len(along) - 1, len(across) - 1),
        scene=scene,
        turned=turned,
        level=level,
        swapped=swapped,
        matrix=arranged(matrix, turned, False),
        edges=first if cuts == 1 else np.interp(places, np.arange(len(first)), first),
        ends=second if even else middles,
        widths=None if even else widths * height,
        strips=cuts,
    )


def arranged(matrix: Vector, turned: bool, swapped: bool) -> Vector:
    """With a and b exchanged, and x and y."""
    own = matrix[:, [1, 0, 2]] if turned else matrix
    return own[[1, 0, 2]] if swapped else own


def _slope(matrix: Vector, across: Vector, along: Vector, turned: bool) -> float:
    """How many rows of the scene a sample's end rises in its width, over its own height."""
    first, second = (along, across) if turned else (across, along)
    steps = [(borders[-1] - borders[0]) / (len(borders) - 1) for borders in (first, second)]
    worst = 0.0
    for a, b in product((first[0], 0.5 * (first[0] + first[-1]), first[-1]), second[[0, -1]]):
        _, y, z = matrix @ (a, b, 1.0)
        rise = np.abs((matrix[1, :2] * z - matrix[2, :2] * y) * steps)
        worst = max(worst, float(rise[0]) / max(float(rise[1]), 1e-300))
    return worst
