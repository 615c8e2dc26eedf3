"""Poisson deviates about a blurred picture, event by event, without blurring the picture.

Events of a Poisson process that move independently of each other form a Poisson process again,
whose intensity is the first one's spread by the distribution of the moves. So an event is drawn
at a place weighted by the picture, and then moved by a Gaussian step: exactly the deviates that the
Gaussian-weighted local mean calls for, at the cost of the events alone.

Source: Kingman 1993, Poisson Processes, section 5.1 (displacement theorem); Lewis and Shedler 1979
(thinning).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.noise.random_fields import Stream
from core.scratch.allocation import Empty
from core.threads import ForEach, in_turn

Array = NDArray[Any]

BLOCK = 1 << 20
"""Samples whose events come from one counter; part of what defines a field."""

LEAST_SIGMA_PX = 2.5
"""From here on sampled Gaussian weights are those of the Gaussian transfer function, to 1e-13."""

LARGEST_SIGMA_PX = 1e4
"""Up to here the table of weights is small; wider ones blur the picture instead."""

MOST = 0.08
"""Largest mean of a sample that is drawn by events. Measured at 1024² in one thread: 0.5 ms for a
mean of 0.003, 6.6 ms for 0.07; the blurred picture and its deviates take 7 to 8 ms."""

_REACH = 8.5  # standard deviations; less than 2e-17 of the weight is beyond


def events_are_few(picture: Array, *, share: float, sigma_px: float) -> bool:
    """Whether `displaced_events` serves, and is faster than blurring the picture."""
    if not LEAST_SIGMA_PX <= sigma_px <= LARGEST_SIGMA_PX:
        return False
    return bool(picture.min() >= 0 and share * float(picture.max()) <= MOST)


def displaced_events(
    picture: Array,
    stream: Stream,
    *,
    share: float,
    sigma_px: float,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Array:
    """Poisson deviates whose means are `share` of the picture's Gaussian-weighted local mean.

    Parameters
    ----------
    picture : ndarray, shape (rows, columns)
        Float samples, 0 or above. Beyond its edges the picture is mirrored.
    stream : Stream
        Where the deviates come from.
    share : float
        Events per unit of the picture, above 0.
    sigma_px : float
        Standard deviation of the weights along each axis in samples, `LEAST_SIGMA_PX` to
        `LARGEST_SIGMA_PX`.
    for_each : callable
        Calls a function on every block: `Work.for_each`.
    empty : callable
        Makes the array to be filled in: `Work.empty`.

    Returns
    -------
    ndarray
        Counts, of the picture's shape and type.
    """
    flat = np.ravel(picture)
    steps = _gaussian_steps(sigma_px)
    places_by_block: dict[int, Array] = {}

    def one(block: int) -> None:
        generator = stream.generator(block)
        source = flat[block * BLOCK : (block + 1) * BLOCK]
        places = _drawn_places(generator, source, share) + block * BLOCK
        moves = np.searchsorted(steps, generator.random((2, len(places)))) - len(steps) // 2
        rows, columns = np.divmod(places, picture.shape[1])
        rows = _mirrored(rows + moves[0], picture.shape[0])
        columns = _mirrored(columns + moves[1], picture.shape[1])
        places_by_block[block] = rows * picture.shape[1] + columns

    for_each(one, range(-(-flat.size // BLOCK)))
    counts = empty((flat.size,), picture.dtype)
    counts.fill(0)
    for places in places_by_block.values():
        np.add.at(counts, places, picture.dtype.type(1))
    return counts.reshape(picture.shape)


def _drawn_places(generator: np.random.Generator, means: Array, share: float) -> Array:
    """Where events happen: thinned from a constant rate."""
    largest = float(means.max())
    count = generator.poisson(share * largest * means.size)
    places = generator.integers(0, means.size, size=count)
    return np.asarray(places[generator.random(count) * largest < means[places]])


def _gaussian_steps(sigma_px: float) -> Array:
    """Cumulated weights of the steps −n … n, the last left out."""
    reach = int(np.ceil(_REACH * sigma_px))
    steps = np.arange(-reach, reach + 1)
    weights = np.exp(-0.5 * np.square(steps / sigma_px))
    below = np.cumsum(weights)
    return np.asarray(below[:-1] / below[-1])


def _mirrored(places: Array, size: int) -> Array:
    """Places beyond the frame's edges, back on it."""
    places = places % (2 * size)
    return np.asarray(np.minimum(places, 2 * size - 1 - places))
