"""Timing in T0: a subject and the bare Fourier round trip in turn, and the median of ratios."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import scipy.fft
from numpy.typing import NDArray

Array = NDArray[Any]
Seconds = Callable[[], float]


@dataclass(frozen=True)
class Timing:
    """Medians over pairs: seconds of the subject, of T0 beside it, and their ratios' quartiles.

    `alone_seconds` is T0 measured back to back, with warm caches: how far T0 itself varies.
    """

    seconds: float
    t0_seconds: float
    alone_seconds: float
    ratio: float
    low: float
    high: float
    pairs: int

    def facts(self) -> dict[str, Any]:
        """Columns of a table."""
        return {
            "t0": self.ratio,
            "low": self.low,
            "high": self.high,
            "ms": 1e3 * self.seconds,
            "t0_ms": 1e3 * self.t0_seconds,
            "alone_ms": 1e3 * self.alone_seconds,
            "pairs": self.pairs,
        }


def seconds(function: Callable[[], object]) -> float:
    """How long a call takes."""
    start = time.perf_counter()
    function()
    return time.perf_counter() - start


def round_trip(image: Array, workers: int) -> Seconds:
    """T0: a bare transform there and back of this image."""

    def trip() -> float:
        start = time.perf_counter()
        scipy.fft.irfft2(scipy.fft.rfft2(image, workers=workers), s=image.shape, workers=workers)
        return time.perf_counter() - start

    return trip


def paired(subject: Seconds, t0: Seconds, *, pairs: int, warm_up: int = 2) -> Timing:
    """Measure in turn; both return their own seconds, so that preparations do not count.

    Parameters
    ----------
    subject, t0 : callable
        Give the seconds that one repetition took.
    pairs : int
        Repetitions that count.
    warm_up : int
        Repetitions before that do not.
    """
    for _ in range(warm_up):
        t0()
        subject()
    samples = [(t0(), subject()) for _ in range(pairs)]
    ratios = sorted(took / unit for unit, took in samples)
    quarters = statistics.quantiles(ratios, n=4, method="inclusive") if pairs > 1 else ratios * 3
    return Timing(
        statistics.median(took for _, took in samples),
        statistics.median(unit for unit, _ in samples),
        statistics.median(t0() for _ in range(pairs)),
        quarters[1],
        quarters[0],
        quarters[2],
        pairs,
    )
