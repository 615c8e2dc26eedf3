"""Pixels that are dead or hot, alone and in clusters."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from core.physics.numerics.scalar_checks import within

GOOD, DEAD, HOT = 0, 1, 2
_SINGLE_SHARE = 0.7  # of the clusters, which are then of one pixel
_LARGEST = 9
_STEPS = np.array([(-1, 0), (1, 0), (0, -1), (0, 1)])


def bad_pixel_map(
    *, rows: int, columns: int, percent: float, generator: Generator
) -> NDArray[np.uint8]:
    """A map of good, dead and hot pixels.

    Parameters
    ----------
    rows, columns : int
        Of the detector.
    percent : float
        Share of its pixels that are bad, 0 to 100; their number is rounded.
    generator : Generator
        Decides where they are.

    Returns
    -------
    ndarray
        `GOOD`, `DEAD` or `HOT` for each pixel, (rows, columns). Seven in ten clusters are single
        pixels, the others up to nine neighbours; the pixels of a cluster are of one kind, which is
        either with equal chance.
    """
    wanted = round(within("bad_pixel_percent", percent, 0.0, 100.0) / 100.0 * rows * columns)
    kinds = np.full(rows * columns, GOOD, np.uint8)
    if wanted > rows * columns // 4:
        # So many are no clusters any more.
        places = generator.permutation(rows * columns)[:wanted]
        kinds[places] = generator.integers(DEAD, HOT, size=wanted, endpoint=True)
        return kinds.reshape(rows, columns)
    left = wanted
    while left > 0:
        places, found = _clusters(left, rows, columns, generator)
        places, first = np.unique(places, return_index=True)
        order = np.argsort(first)  # in the order they came, so that a cut leaves no edge
        places, found = places[order], found[np.sort(first)]
        fresh = kinds[places] == GOOD
        places, found = places[fresh][:left], found[fresh][:left]
        kinds[places] = found
        left -= len(places)
    return kinds.reshape(rows, columns)


def _clusters(
    count: int, rows: int, columns: int, generator: Generator
) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """Flat places and kinds of about so many pixels, cluster by cluster."""
    clusters = max(1, count // 2)
    single = generator.random(clusters) < _SINGLE_SHARE
    sizes = np.where(single, 1, generator.integers(2, _LARGEST, size=clusters, endpoint=True))
    kinds = generator.integers(DEAD, HOT, size=clusters, endpoint=True).astype(np.uint8)
    row = generator.integers(0, rows, size=clusters)
    column = generator.integers(0, columns, size=clusters)
    # A walk from neighbour to neighbour; a pixel that is met twice counts once.
    steps = _STEPS[generator.integers(0, len(_STEPS), size=(clusters, _LARGEST))]
    steps[:, 0] = 0
    walk = np.cumsum(steps, axis=1)
    inside = np.arange(_LARGEST) < sizes[:, np.newaxis]
    at_row, at_column = row[:, np.newaxis] + walk[..., 0], column[:, np.newaxis] + walk[..., 1]
    inside &= (at_row >= 0) & (at_row < rows) & (at_column >= 0) & (at_column < columns)
    places = (at_row * columns + at_column)[inside]
    return places, np.broadcast_to(kinds[:, np.newaxis], inside.shape)[inside]
