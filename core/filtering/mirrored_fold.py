"""Folding a mirrored frame's spectrum, as averaging blocks of pixels does.

On a frame of M samples index k = 2M·j ± k' acts as ±(−1)^j at k'.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def mean_kernel(size: int, factor: int) -> Array:
    """Response of the mean of `factor` samples at the mirrored frequencies k/(2·size)."""
    kernel = np.ones(size)
    if factor > 1:
        half = np.pi * np.arange(1, size) / (2 * size)
        kernel[1:] = np.sin(half * factor) / (factor * np.sin(half))
    return kernel


def alias_rows(
    start: int, stop: int, size: int, factor: int, odd: bool
) -> Iterator[tuple[slice, slice, Array]]:
    """Which indices k of a mirrored spectrum fold into places start … stop − 1.

    A place is k' for the even part and k' − 1 for the odd part. Yields (places, indices k,
    weights); the one place that an inverse transform counts once gets weight 2.
    """
    for segment in range(factor):
        j, backward = (segment + 1) // 2, segment % 2 == 1
        # A forward segment holds k' = 0 … size − 1, a backward one k' = size … 1. Even terms
        # have nothing at k' = size, odd ones nothing at 0.
        low, high = (1, size) if backward else (0, size - 1)
        low, high = (max(low, 1), high) if odd else (low, min(high, size - 1))
        shift = 1 if odd else 0
        first, last = max(low, start + shift), min(high, stop - 1 + shift)
        if first > last:
            continue
        wanted = np.arange(first, last + 1)
        sign = (-1.0) ** j * (-1.0 if backward and odd else 1.0)
        weights = np.full(len(wanted), sign)
        if odd or segment > 0:
            weights[wanted == (size if odd else 0)] *= 2.0
        if backward:
            end = 2 * size * j - last - 1
            rows = slice(2 * size * j - first, end if end >= 0 else None, -1)
        else:
            rows = slice(2 * size * j + first, 2 * size * j + last + 1)
        yield slice(first - shift, last - shift + 1), rows, weights


@dataclass(frozen=True)
class ColumnFold:
    """How the columns k of a mirrored spectrum fold into `size` places.

    Parameters
    ----------
    size : int
        Columns after folding.
    factor : int
        How many times as many there are before.
    odd : bool
        Whether they belong to sines.
    """

    size: int
    factor: int
    odd: bool

    @cached_property
    def segments(self) -> tuple[tuple[slice, slice, bool, int | None], ...]:
        """Places, columns, whether they count negative, and which column counts twice."""
        segments = []
        for places, columns, weights in alias_rows(0, self.size, self.size, self.factor, self.odd):
            twice = np.flatnonzero(np.abs(weights) == 2.0)
            edge = int(twice[0]) if len(twice) else None
            segments.append((places, columns, bool(weights[0] < 0), edge))
        return tuple(segments)

    def __call__(self, values: Array) -> Array:
        """Fold a block of rows; `values` may be overwritten."""
        if self.odd:
            folded = np.zeros((values.shape[0], self.size), values.dtype)
            segments = self.segments
        else:
            folded = values[:, : self.size]
            segments = self.segments[1:]  # the first is in place already
        for places, columns, negative, edge in segments:
            target, part = folded[:, places], values[:, columns]
            (np.subtract if negative else np.add)(target, part, out=target)
            if edge is not None:
                target[:, edge] += -part[:, edge] if negative else part[:, edge]
        return folded
