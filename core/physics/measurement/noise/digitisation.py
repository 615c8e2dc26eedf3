"""What digitising leaves in a picture: clipping, rounding steps, blocks of compression."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.noise.flat_blocks import FINE, MIDDLE, SIDE, picture_blocks

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAST = 64  # samples at the end of the values that make a pile


def clipped_ends(*, picture: Matrix) -> tuple[float | None, float | None]:
    """Lowest and highest value where samples pile up there: clipped.

    Raises
    ------
    DataError
        For samples that are not finite.
    """
    low, high = float(picture.min()), float(picture.max())
    if not (math.isfinite(low) and math.isfinite(high)):
        raise DataError(
            "the picture has samples that are not finite numbers, so its noise cannot be measured"
        )
    if low == high:
        return None, None
    return (
        low if _piled_up(picture, low, np.min) else None,
        high if _piled_up(picture, high, np.max) else None,
    )


def _piled_up(picture: Matrix, end: float, nearest: Callable[[Matrix], Any]) -> bool:
    """Whether the end of the values holds at least as many samples as what lies next to it.

    Noise has tails: its last value is a rare one.
    """
    at_end = picture == end
    many = int(np.count_nonzero(at_end))
    if many < _LEAST:
        return False
    others = picture[~at_end]
    return many >= int(np.count_nonzero(others == nearest(others)))


def samples_that_count(
    *, picture: Matrix, avoid: Mask | None, low: float | None, high: float | None
) -> Mask | None:
    """Samples that count: not avoided, and not clipped; None where all do."""
    good = None if avoid is None else ~avoid
    for end in (low, high):
        if end is not None:
            free = picture != end
            good = free if good is None else good & free
    return good


# The step of the converter, from the values that occur in a picture.

_MOST = 1 << 19  # samples that are looked at
_REPEATED = 0.75  # values per sample beyond which there is no step
_LIKE = 0.05  # by how much steps may differ, as in numbers turned to radiance
_MOST_ALIKE = 0.9  # of the gaps that are whole steps


def rounding_step(*, picture: Matrix) -> float | None:
    """Smallest distance of two values where all are whole multiples of it; None of others.

    Notes
    -----
    Steps that differ by some percent count as one: a table has turned the numbers to another
    quantity. Noise of fewer values than samples is what shows a step at all.
    """
    every = max(1, picture.size // _MOST)
    values, many = np.unique(picture[::every], return_counts=True)
    if len(values) < 2 or len(values) > _REPEATED * many.sum():
        return None
    gaps = np.diff(values)
    step = float(np.quantile(gaps, 0.25, method="lower"))
    if not step > 1e-12 * float(np.abs(values).max()):
        return None
    steps = gaps / step
    whole = np.rint(steps)
    like = (whole >= 1.0) & (np.abs(steps - whole) <= _LIKE * whole)
    if float(np.mean(like)) < _MOST_ALIKE:
        return None
    return float(np.median(gaps[like] / whole[like]))


# Whether a picture was compressed in blocks of 8 × 8 samples, as JPEG does.

_MOST_SIDE = 512  # samples along a side that are looked at
_LEAST_BLOCKS = 60
_DIFFERS = 0.1  # logarithm of what the blocks' waves and those of shifted blocks differ by
_CHANCES = 3.0  # times what two sets of shifted blocks differ by
_SHIFTS = ((4, 4), (2, 6))  # samples down and across
_TAIL = 4.0  # times the mean of neighbours' differences, at which edges are cut


def compressed_in_blocks(*, picture: Matrix) -> bool:
    """Whether waves of blocks, wherever they begin, are rounded, and of shifted blocks not.

    Notes
    -----
    The compression rounds the waves of its blocks, many to zero. The spread of a wave, and the
    shape of its distribution, by quartiles of its modulus, are then others than in blocks that lie
    part of a block further, where nothing else makes them differ. Where else than at the first
    sample blocks may begin is where neighbours differ most unlike the rest.
    """
    first = [max(0, (size - _MOST_SIDE) // 2) // SIDE * SIDE for size in picture.shape]
    part = picture[first[0] : first[0] + _MOST_SIDE, first[1] : first[1] + _MOST_SIDE]
    begin = _begin(part), _begin(part.T)
    return _rounded(part) or (any(begin) and _rounded(part[begin[0] :, begin[1] :]))


def _begin(part: Matrix) -> int:
    """First row, of the first eight, at which blocks may begin, by neighbours down."""
    step = np.diff(part, axis=0)
    step -= step.mean(axis=1, keepdims=True)  # rows have offsets of their own
    size = np.abs(step, out=step)
    np.minimum(size, _TAIL * float(size.mean()), out=size)
    rows = size.mean(axis=1)
    phases = np.array([rows[k::SIDE].mean() for k in range(min(SIDE, len(rows)))])
    unlike = np.abs(phases - np.median(phases))
    return (int(np.argmax(unlike)) + 1) % SIDE


def _rounded(part: Matrix) -> bool:
    """Whether waves of the blocks from the first sample on are rounded."""
    shifts = ((0, 0), *_SHIFTS)
    sets = [picture_blocks(picture=part[down:, across:]) for down, across in shifts]
    if min(len(blocks.level) for blocks in sets) < _LEAST_BLOCKS:
        return False
    waves = FINE | MIDDLE
    largest = float(np.abs(sets[0].level).max())
    least = max((1e-6 * largest) ** 2, 1e-30)
    quartiles = []
    for blocks in sets:
        power = np.maximum(blocks.power[:, waves], least)
        quartiles.append(0.5 * np.log(np.quantile(power, (0.25, 0.75), axis=0)).mean(axis=1))
    own, chance = quartiles[0] - quartiles[1], quartiles[2] - quartiles[1]
    spread = abs(own[1]) > _DIFFERS + _CHANCES * abs(chance[1])
    shape = abs(own[1] - own[0]) > _DIFFERS + _CHANCES * abs(chance[1] - chance[0])
    return bool(spread or shape)
