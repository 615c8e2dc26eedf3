"""Functions of one scene coordinate, averaged exactly over each sample.

A profile is zero outside `low` to `high` and known by its integral, so its mean over a sample is
a difference of two values: no sampling error whatever the size of the picture.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from nodes.scenes.coverage import FloatArray


@dataclass(frozen=True)
class Profile:
    """A function on `low` to `high`, by its indefinite integral."""

    low: float
    high: float
    integral: Callable[[FloatArray], FloatArray]

    def means(self, edges: FloatArray) -> FloatArray:
        """Mean over each sample between successive `edges`."""
        means: FloatArray = np.diff(self.integral(np.clip(edges, self.low, self.high)))
        return means / np.diff(edges)

    def span(self, edges: FloatArray) -> slice:
        """The samples that the profile touches."""
        first = int(edges.searchsorted(self.low, side="right")) - 1
        last = int(edges.searchsorted(self.high, side="left"))
        first = min(max(first, 0), edges.size - 1)
        return slice(first, max(min(last, edges.size - 1), first))


def band(low: float, high: float) -> Profile:
    """1 between `low` and `high`."""
    return Profile(low, high, lambda e: e)


def steps(
    starts: npt.ArrayLike,
    ends: npt.ArrayLike,
    values: npt.ArrayLike = 1.0,
) -> Profile:
    """`values` on disjoint intervals in increasing order, 0 between them."""
    begin = np.asarray(starts, dtype=np.float64)
    end = np.asarray(ends, dtype=np.float64)
    single = (end - begin) * np.asarray(values, dtype=np.float64)
    area = np.cumsum(single)
    knots = np.column_stack([begin, end]).ravel()
    sums = np.column_stack([area - single, area]).ravel()
    return Profile(float(begin[0]), float(end[-1]), lambda e: np.interp(e, knots, sums))


def power(low: float, high: float, exponent: int) -> Profile:
    """((u - low) / (high - low))^exponent."""
    width = high - low

    def integral(e: FloatArray) -> FloatArray:
        area: FloatArray = width / (exponent + 1) * ((e - low) / width) ** (exponent + 1)
        return area

    return Profile(low, high, integral)


def wave(low: float, high: float, *, cycles: float, phase: float) -> Profile:
    """cos(2π·cycles·u + phase), with `cycles` per unit and not 0."""
    k = 2.0 * np.pi * cycles

    def integral(e: FloatArray) -> FloatArray:
        area: FloatArray = np.sin(k * e + phase) / k
        return area

    return Profile(low, high, integral)


def bell(centre: float, sigma: float, height: float = 1.0) -> Profile:
    """A Gaussian of the given height, cut at 5 sigma."""
    scale = height * sigma * float(np.sqrt(2.0 * np.pi))

    def integral(e: FloatArray) -> FloatArray:
        area: FloatArray = scale * ndtr((e - centre) / sigma)
        return area

    return Profile(centre - 5.0 * sigma, centre + 5.0 * sigma, integral)
