"""Statistics and histogram of samples, in double precision and fixed blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
BLOCK_SAMPLES = 1 << 18


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


def statistics(samples: Array, *, check: Callable[[], None]) -> Statistics:
    """Statistics of a real array of any shape that is not empty."""
    low, high = float(samples.min()), float(samples.max())
    # Relative to the minimum: the sum of large equal samples would round their mean.
    mean = low + math.fsum(float(np.sum(b - low)) for b in blocks(samples, check)) / samples.size
    mean = min(max(mean, low), high)
    reach = max(high - mean, mean - low)
    if reach == 0.0:
        return Statistics(low, high, mean, 0.0)
    # Relative to the reach: squares of huge or tiny deviations leave the range of numbers.
    squares = math.fsum(float(np.sum(((b - mean) / reach) ** 2)) for b in blocks(samples, check))
    return Statistics(low, high, mean, reach * math.sqrt(squares / samples.size))


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
