"""Statistics and histogram of samples, in double precision and fixed blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.threads import ForEach, in_turn

Array = NDArray[Any]
BLOCK_SAMPLES = 1 << 18
_LEAST, _MOST = 1e-100, 1e100  # deviations that can be squared as they are


@dataclass(frozen=True)
class Statistics:
    """Extremes, mean and standard deviation (of the population)."""

    minimum: float
    maximum: float
    mean: float
    sigma: float


def blocks(samples: Array, check: Callable[[], None]) -> Iterator[NDArray[np.float64]]:
    """The samples in order as 1-D blocks in double precision, `check` called before each."""
    flat = samples.reshape(-1)
    for start in range(0, flat.size, BLOCK_SAMPLES):
        check()
        yield flat[start : start + BLOCK_SAMPLES].astype(np.float64)


def statistics(samples: Array, *, for_each: ForEach = in_turn) -> Statistics:
    """Statistics of a real array of any shape that is not empty.

    Parameters
    ----------
    samples : ndarray
        The samples.
    for_each : callable
        Calls a function on every block, in any order: `Work.for_each`.
    """
    low, high = float(samples.min()), float(samples.max())
    # Relative to the minimum: the sum of large equal samples would round their mean.
    mean = low + _sum_of(samples, lambda block: float(np.sum(block)), low, for_each) / samples.size
    mean = min(max(mean, low), high)
    reach = max(high - mean, mean - low)
    if reach == 0.0:
        return Statistics(low, high, mean, 0.0)
    # Squares of huge or tiny deviations leave the range of numbers.
    scale = 1.0 if _LEAST < reach < _MOST else reach

    def squares(block: Array) -> float:
        if scale != 1.0:
            block /= scale
        return float(np.einsum("i,i->", block, block))

    mean_square = _sum_of(samples, squares, mean, for_each) / samples.size
    return Statistics(low, high, mean, scale * math.sqrt(mean_square))


def _sum_of(
    samples: Array, summed: Callable[[Array], float], offset: float, for_each: ForEach
) -> float:
    """Sum of a function's values on the blocks in double precision, less an offset."""
    flat = samples.reshape(-1)
    starts = range(0, flat.size, BLOCK_SAMPLES)
    sums = [0.0] * len(starts)

    def one(index: int) -> None:
        start = starts[index]
        block = flat[start : start + BLOCK_SAMPLES].astype(np.float64)
        block -= offset
        sums[index] = summed(block)

    for_each(one, range(len(starts)))
    return math.fsum(sums)


def histogram(
    samples: Array, *, bins: int, check: Callable[[], None]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres of equal bins from minimum to maximum, and the samples in each; one if constant."""
    low, high = float(samples.min()), float(samples.max())
    width = high - low
    if width == 0.0:
        return np.array([low]), np.array([float(samples.size)])
    counts = np.zeros(bins, np.int64)
    for block in blocks(samples, check):
        index = ((block - low) / width * bins).astype(np.int64)
        counts += np.bincount(np.minimum(index, bins - 1), minlength=bins)
    centres = low + (np.arange(bins) + 0.5) / bins * width
    return centres, counts.astype(np.float64)
