"""Functions of one scene coordinate, averaged exactly over each sample.

A profile is zero outside `low` to `high` and known by its integral, so its mean over a sample is
a difference of two values: no sampling error whatever the size of the picture.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from nodes.scenes.coverage import FloatArray


@dataclass(frozen=True)
class Profile:
    """A function on `low` to `high`, or several, by the indefinite integral.

    The integral of several has an axis more in front than what it is given.
    """

    low: float
    high: float
    integral: Callable[[FloatArray], FloatArray]

    def means(self, edges: FloatArray) -> FloatArray:
        """Mean over each sample between successive `edges`."""
        sums = self.integral(np.minimum(np.maximum(edges, self.low), self.high))
        means: FloatArray = (sums[..., 1:] - sums[..., :-1]) / (edges[1:] - edges[:-1])
        return means

    def span(self, edges: FloatArray) -> slice:
        """The samples that the profile touches."""
        return span(self.low, self.high, edges)


def span(low: float, high: float, edges: FloatArray) -> slice:
    """The samples between `edges` that `low` to `high` touches."""
    # Searching by numpy gives other threads no turn: it lets go of Python and takes it again
    # within microseconds, sooner than one that waits wakes up.
    first = bisect_right(edges, low) - 1
    last = bisect_left(edges, high)
    first = min(max(first, 0), edges.size - 1)
    return slice(first, max(min(last, edges.size - 1), first))


def band(low: float, high: float) -> Profile:
    """1 between `low` and `high`."""
    return Profile(low, high, lambda e: e)


def steps(starts: npt.ArrayLike, ends: npt.ArrayLike, values: npt.ArrayLike = 1.0) -> Profile:
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


def wave(
    low: float,
    high: float,
    *,
    cycles: npt.ArrayLike,
    phase: npt.ArrayLike,
    height: npt.ArrayLike = 1.0,
) -> Profile:
    """height·cos(2π·cycles·u + phase), with `cycles` per unit and not 0; several from arrays."""
    k = 2.0 * np.pi * np.asarray(cycles, dtype=np.float64)[..., None]
    start = np.asarray(phase, dtype=np.float64)[..., None]
    scale = np.asarray(height, dtype=np.float64)[..., None] / k

    def integral(e: FloatArray) -> FloatArray:
        area: FloatArray = scale * np.sin(k * e + start)
        return area

    return Profile(low, high, integral)


def bell(centre: float, sigma: float, height: float = 1.0) -> Profile:
    """A Gaussian of the given height, cut at 5 sigma."""
    scale = height * sigma * float(np.sqrt(2.0 * np.pi))

    def integral(e: FloatArray) -> FloatArray:
        area: FloatArray = scale * ndtr((e - centre) / sigma)
        return area

    return Profile(centre - 5.0 * sigma, centre + 5.0 * sigma, integral)


def bells(centres: FloatArray, sigma: float, heights: FloatArray) -> Profile:
    """A sum of equal Gaussians side by side, cut at 5 sigma beyond the first and the last."""
    scale = heights * (sigma * float(np.sqrt(2.0 * np.pi)))
    reach = 5.0 * sigma

    def integral(e: FloatArray) -> FloatArray:
        area: FloatArray = scale @ ndtr((e - centres[:, None]) / sigma)
        return area

    return Profile(float(centres[0]) - reach, float(centres[-1]) + reach, integral)
