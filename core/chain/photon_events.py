"""Poisson deviates about a blurred picture, event by event, without blurring the picture.

Events of a Poisson process that move independently of each other form a Poisson process again,
whose intensity is the first one's spread by the distribution of the moves. So an event is drawn
at a place weighted by the picture, and then moved by a Gaussian step: exactly the deviates that the
Gaussian-weighted local mean calls for, at the cost of the events alone.

Source: Kingman 1993, Poisson Processes, section 5.1 (displacement theorem); Lewis and Shedler 1979
(thinning).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.random_fields import Stream
from core.evaluation.float_guard import require_finite
from core.evaluation.work import Work
from core.machine import ForEach, in_turn
from core.physics.optics.gaussian import gaussian_mtf
from core.scratch import Empty, StripArray
from core.transfer.mirrored import (
    column_blocks,
    row_blocks,
    transform_block,
)

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

    The picture, (rows, columns), has samples of 0 or above and is mirrored beyond its edges.
    `share` are events per unit of it, `sigma_px` the standard deviation of the weights along each
    axis in samples, `LEAST_SIGMA_PX` to `LARGEST_SIGMA_PX`. The counts have the picture's shape and
    type.
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


# Gaussian-weighted local mean of a mirrored frame, by its low frequencies alone.
#
# A Gaussian of five samples is below rounding beyond two fifths of the band, so that most columns
# of the transforms hold nothing and are left out.


def local_mean(work: Work, image: Array, *, sigma_px: float) -> Array:
    """Gaussian-weighted mean around each sample, the frame mirrored at its edges; a new array.

    `sigma_px` is the standard deviation of the weights in samples; 0 gives the picture itself.
    """
    dtype = work.policy.dtype
    made: Array = work.empty(image.shape)
    if sigma_px == 0:
        made[...] = image
        return made
    mean = float(np.mean(image))
    along, across = (_response(size, sigma_px, dtype) for size in image.shape)
    width = len(across)  # of the columns that hold something
    lines = work.strips((image.shape[0], width))

    def spread(rows: slice) -> None:
        part = transform_block(np.subtract(image[rows], mean, dtype=dtype), "dct", axis=1)
        lines[rows] = part[:, :width] * across

    def blur(block: Array) -> None:
        values = transform_block(np.ascontiguousarray(block), "dct", axis=0)
        values[: len(along)] *= along[:, np.newaxis]
        values[len(along) :] = 0
        block[...] = transform_block(values, "idct", axis=0)

    def gather(rows: slice) -> None:
        part = np.zeros((len(image[rows]), image.shape[1]), dtype)
        part[:, :width] = lines[rows]
        part = transform_block(part, "idct", axis=1)
        require_finite(part)
        part += dtype.type(mean)
        made[rows] = part

    work.for_each(spread, row_blocks(image.shape))
    for strip in lines.strips if isinstance(lines, StripArray) else [lines]:
        work.for_each(blur, column_blocks(strip))
    work.for_each(gather, row_blocks(image.shape))
    return made


def _response(size: int, sigma_px: float, dtype: np.dtype[Any]) -> Array:
    """The Gaussian's response at k/(2·size) up to where it is below rounding."""
    # exp(−2π²σ²f²) = rounding / 64 at this frequency in cycles a sample
    faintest = float(np.finfo(dtype).eps) / 64
    limit = math.sqrt(-math.log(faintest) / 2) / (math.pi * sigma_px)
    count = min(size, math.floor(min(limit * 2 * size, size)) + 1)
    response = gaussian_mtf(frequency=np.arange(count) / (2 * size), sigma_mrad=sigma_px)
    return response.astype(dtype)
