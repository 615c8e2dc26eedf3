"""The spread of an ideal straight edge, from a transfer function along its normal.

ESF(d) = 1/2 + ∫ H(f)·exp(2πifd) / (2πif) df (Goodman 2005, Fourier Optics, section 2): the
integral becomes a sum over a period much longer than the edge's reach, so that what neighbouring
steps of the period leave is next to nothing, and the sum one transform.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]

LEAST_PERIOD = 128  # samples
_REACHES = 8  # of an edge's reach in a period, at least
HIGHEST = 16  # cycles per sample, beyond which nothing counts
_LEAST_HIGHEST = 8  # cycles per sample: a table's steps are half of its inverse


@dataclass(frozen=True)
class SpreadTable:
    """The spreads of edges at equal distances, one in each row, and their slopes."""

    period: int  # samples from the first distance, −period/2, to where the table begins anew
    # ESF, from 0 to 1, and its derivative; shape (edges, distances)
    spread: NDArray[np.float64]
    slope: NDArray[np.float64]

    def at(self, number: int, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Spread of one edge at distances in any shape, by straight lines between the table's."""
        count = self.spread.shape[1]
        place = distance.ravel() * (count / self.period) + 0.5 * count
        values = np.interp(place, np.arange(count), self.spread[number])
        return np.asarray(values.reshape(distance.shape), np.float64)

    def at_all(self, distance: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Spread and slope at any distances, a row for each edge, by cubic Hermite polynomials."""
        edges, count = self.spread.shape
        step = self.period / count
        place = distance * (1.0 / step) + 0.5 * count
        below = place.astype(np.intp)
        np.clip(below, 0, count - 2, out=below)
        t = place - below
        below += np.arange(edges)[:, np.newaxis] * count
        spread, slopes = self.spread.ravel(), self.slope.ravel() * step
        f0, f1, g0, g1 = spread[below], spread[below + 1], slopes[below], slopes[below + 1]
        rise = f1 - f0
        a, b = g0 + g1 - 2.0 * rise, 3.0 * rise - 2.0 * g0 - g1
        value = f0 + t * (g0 + t * (b + t * a))
        slope = (g0 + t * (2.0 * b + t * 3.0 * a)) / step
        return value, slope


def period_for(*, reach: float) -> int:
    """Samples of a period for edges of that reach: a power of 2."""
    return max(LEAST_PERIOD, 1 << math.ceil(math.log2(_REACHES * max(reach, 1.0))))


def frequencies(*, period: int, first: int, end: int) -> Vector:
    """From `first` to below `end`, cycles per sample, as a period has them."""
    return np.asarray(np.arange(first * period, end * period) / period, np.float64)


def spread_table(*, transfer: Complex, period: int) -> SpreadTable:
    """Sum up the spreads of edges.

    Parameters
    ----------
    transfer : ndarray
        H at `frequencies` from 0 on, 1 at zero frequency; shape (edges, frequencies).
    period : int
        Samples of a period.

    Returns
    -------
    SpreadTable
        With steps of 1/16 of a sample or finer.
    """
    edges, given = transfer.shape
    highest = max(_LEAST_HIGHEST, -(-given // period))
    count = 2 * highest * period
    frequency = np.arange(1, given) / period
    distance = (np.arange(count) - count // 2) * (period / count)
    # From −period/2 on: each wave has turned by half a turn a cycle more.
    turned = np.where(np.arange(given) % 2 == 0, 1.0, -1.0)
    lines = np.zeros((edges, count // 2 + 1), np.complex128)
    lines[:, :given] = transfer * turned
    slope = scipy.fft.irfft(lines, count, axis=1) * (count / period)
    lines[:, 0] = 0.0
    lines[:, 1:given] /= 2j * math.pi * frequency
    waves = scipy.fft.irfft(lines, count, axis=1) * (count / period)
    spread = 0.5 + distance / period * transfer[:, :1].real + waves
    return SpreadTable(period, spread, slope)
