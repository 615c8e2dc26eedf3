"""What lies beyond an edge and reaches into its samples through the chain's spread.

An ideal edge is alone and endless. A real one has corners, and neighbours whose faint tails reach
far: behind optics the line spread falls as the square of the distance only. What the picture shows
beyond an edge's samples tells of the scene there; nothing but the ideal edge is where its samples
are. So the scene's difference from the ideal edge is sought, by the method of Landweber (1951) with
that constraint, and what of it the chain spreads into the edge's samples is no part of the edge.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from app.fit.edge_fit import EdgesAt
from app.fit.patch import MARGIN, Patch, Window
from app.fit.spread_table import SpreadTable

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

# After the first: at a frequency that the chain passes to a share t, (1 − t)³ is left, and of what
# comes back into the edge at most a tenth; further ones raise noise for little.
_PASSES = 2
_IN_PERIOD = 0.45  # of a spread's period, to which its table is used


def reaching_in(
    *, patch: Patch, edges: EdgesAt, number: int, table: SpreadTable, spread: Matrix
) -> Vector:
    """What the surroundings add to an edge's samples.

    Parameters
    ----------
    patch : Patch
        The edge, with its window.
    edges : EdgesAt
        All edges as fitted.
    number : int
        Which of them this one is.
    table : SpreadTable
        Their spreads.
    spread : ndarray
        What a point leaves in the samples about it, as far as the margin is wide.

    Returns
    -------
    ndarray
        In the order of the patch's samples.
    """
    window = patch.window
    inside = patch.row - window.top, patch.column - window.left
    beside = window.samples - _alone(patch, window, edges, number, table)

    about = np.zeros(beside.shape)
    about[: spread.shape[0], : spread.shape[1]] = spread
    transfer = scipy.fft.rfft2(np.roll(about, (-MARGIN, -MARGIN), (0, 1)))

    def seen(scene: Matrix) -> Matrix:
        lines = scipy.fft.rfft2(scene) * transfer
        return np.asarray(scipy.fft.irfft2(lines, scene.shape), np.float64)

    scene = beside.copy()
    scene[inside] = 0.0
    for _ in range(_PASSES):
        more = beside - seen(scene)
        more[inside] = 0.0
        scene += more
    return seen(scene)[inside]


def _alone(patch: Patch, window: Window, edges: EdgesAt, number: int, table: SpreadTable) -> Matrix:
    """The edge as fitted, alone and endless, over the window."""
    rows, columns = window.samples.shape
    x = np.arange(window.left, window.left + columns) - patch.x
    y = (np.arange(window.top, window.top + rows) - patch.y)[:, np.newaxis]
    across, down = patch.normal
    half = float(np.abs(patch.along).max()) or 1.0
    along = np.clip((across * y - down * x) / half, -1.0, 1.0)
    distance = across * x + down * y - patch.curvature * (along * half) ** 2
    incline = np.clip(distance / patch.reach, -1.0, 1.0)
    place, turn, bend = edges.own[number]
    distance = distance - place - turn * along - bend * (along**2 - 1.0 / 3.0)
    limit = _IN_PERIOD * table.period
    spread = table.at(number, np.clip(distance, -limit, limit))
    low, step, slope, tilt, *shaded = edges.levels[number]
    model = low + step * spread + slope * incline + tilt * along
    if patch.shaded:
        model += spread * (shaded[0] * incline + shaded[1] * along)
    return np.asarray(model, np.float64)
