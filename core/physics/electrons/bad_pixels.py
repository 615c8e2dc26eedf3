"""Pixels that are dead or hot, alone and in clusters."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from core.physics.numerics.scalar_checks import within

DEAD, HOT = 1, 2
_SINGLE_SHARE = 0.7  # of the clusters, which are then of one pixel
_LARGEST = 9
_ROW_STEPS, _COLUMN_STEPS = np.array([-1, 1, 0, 0]), np.array([0, 0, -1, 1])


def bad_pixel_places(
    *, rows: int, columns: int, percent: float, generator: Generator
) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """Where the dead and the hot pixels are.

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
    ndarray, ndarray
        Place of each bad pixel in the rows one after the other, no place twice, in no order; and
        whether it is `DEAD` or `HOT`. Seven in ten clusters are single pixels, the others up to
        nine neighbours; the pixels of a cluster are of one kind, which is either with equal chance.
    """
    wanted = round(within("bad_pixel_percent", percent, 0.0, 100.0) / 100.0 * rows * columns)
    if wanted > rows * columns // 4:
        # So many are no clusters any more.
        anywhere = generator.permutation(rows * columns)[:wanted]
        either = generator.integers(DEAD, HOT, size=wanted, endpoint=True)
        return anywhere, either.astype(np.uint8)
    taken = np.zeros(rows * columns, bool)
    all_places = [np.empty(0, np.intp)]
    all_kinds = [np.empty(0, np.uint8)]
    left = wanted
    while left > 0:
        places, kinds = _clusters(left, rows, columns, generator)
        first = np.unique(places, return_index=True)[1]
        first.sort()  # in the order they came, so that a cut leaves no edge
        first = first[~taken[places[first]]][:left]
        taken[places[first]] = True
        all_places.append(places[first])
        all_kinds.append(kinds[first])
        left -= len(first)
    return np.concatenate(all_places), np.concatenate(all_kinds)


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
    directions = generator.integers(0, len(_ROW_STEPS), size=(clusters, _LARGEST))
    places = np.empty((clusters, _LARGEST), np.intp)
    inside = np.zeros((clusters, _LARGEST), bool)
    places[:, 0], inside[:, 0] = row * columns + column, True
    walking = np.flatnonzero(~single)
    at_row, at_column = (
        start[walking, np.newaxis] + np.cumsum(steps[directions[walking, 1:]], axis=1)
        for start, steps in ((row, _ROW_STEPS), (column, _COLUMN_STEPS))
    )
    places[walking, 1:] = at_row * columns + at_column
    met = np.arange(1, _LARGEST) < sizes[walking, np.newaxis]
    met &= (at_row >= 0) & (at_row < rows) & (at_column >= 0) & (at_column < columns)
    inside[walking, 1:] = met
    return places[inside], np.broadcast_to(kinds[:, np.newaxis], inside.shape)[inside]
