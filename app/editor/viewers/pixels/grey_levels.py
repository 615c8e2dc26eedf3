"""Samples as 8-bit levels, their histogram and quantiles, in blocks that stay in the cache."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray

from core.machine import ForEach, in_turn
from core.records import dataclass

Array = NDArray[Any]
Levels = NDArray[np.uint8]
Range = tuple[float, float]

BINS = 256
MID_GREY = 128
BLOCK_SAMPLES = 1 << 16  # 1024² singles take 0.5 ms so; 1.2 ms in blocks of an eighth
THREADED_SAMPLES = 1 << 20  # of smaller pictures one thread is done before others start
_NARROWEST, _WIDEST = 1e-30, 1e38  # ranges in which single precision can be scaled


@dataclass(frozen=True, eq=False)
class Spread:
    low: float  # low, high: least and greatest sample
    high: float
    # shape (BINS,): samples in equal bins from low to high; all in the first bin where these are
    # equal
    counts: NDArray[np.int64]

    @property
    def centres(self) -> NDArray[np.float64]:
        share = (np.arange(BINS) + 0.5) / BINS
        return np.asarray(self.low * (1.0 - share) + self.high * share)


def grey_levels(samples: Array, low: float, high: float, *, for_each: ForEach = in_turn) -> Levels:
    """Samples as 0, `low` and below, to 255, `high` and above; mid grey without a range."""
    if not high > low:
        return np.full(samples.shape, MID_GREY, np.uint8)
    return _steps(samples, low, high, 255, 0.5, for_each)


def between_ends(low: float, high: float, bits: int | None) -> Range:
    """Levels of a picture of whole numbers: all of their range where each sample is at one end.

    A saturated picture is white so, and one of zeros black. `bits`: samples are whole numbers from
    0 to 2^bits − 1; None where they have no known ends.
    """
    if bits is None or low != high:
        return low, high
    top = 2.0**bits - 1.0
    return (0.0, top) if low in (0.0, top) else (low, high)


def spread_of(samples: Array, *, for_each: ForEach = in_turn) -> Spread:
    """Extremes and histogram of a picture, shape (rows, columns), real and finite."""
    low, high = float(samples.min()), float(samples.max())
    counts = np.zeros(BINS, np.int64)
    if not high > low:
        counts[0] = samples.size
        return Spread(low, high, counts)
    bins = _steps(samples, low, high, BINS, 0.0, for_each)
    return Spread(low, high, np.bincount(bins.reshape(-1), minlength=BINS))


def quantiles(
    samples: Array, spread: Spread, shares: tuple[float, ...], *, for_each: ForEach = in_turn
) -> tuple[float, ...]:
    """Values below which shares of the samples lie; exact: the bin that has one is sorted."""
    if not spread.high > spread.low:
        return (spread.low,) * len(shares)
    index = _steps(samples, spread.low, spread.high, BINS, 0.0, for_each)
    ends = np.cumsum(spread.counts)
    return tuple(_quantile(samples, index, ends, share) for share in shares)


def _quantile(samples: Array, index: Levels, ends: NDArray[np.int64], share: float) -> float:
    rank = share * (samples.size - 1)
    lower = math.floor(rank)
    upper = min(lower + 1, samples.size - 1)
    first, last = np.searchsorted(ends, (lower, upper), side="right")
    members = samples[index == first]
    if last != first:
        members = np.concatenate([members, samples[index == last]])
    before = int(ends[first - 1]) if first else 0
    places = (lower - before, upper - before)
    ordered = np.partition(members, places)
    a, b = (float(ordered[place]) for place in places)
    part = rank - lower
    return a * (1.0 - part) + b * part


def _steps(
    samples: Array, low: float, high: float, top: int, shift: float, for_each: ForEach
) -> Levels:
    """Integers below (sample − low)/(high − low)·top + shift, 0 to 255."""
    levels = np.empty(samples.shape, np.uint8)
    scaled = _single(low, high, top, shift) if _fits(samples, low, high) else None
    scale = scaled or _double(low, high, top, shift)

    def one(rows: slice) -> None:
        # What lies far outside may overflow: it is clipped.
        with np.errstate(all="ignore"):
            values = scale(samples[rows])
            np.clip(values, 0, 255, out=values)
        np.copyto(levels[rows], values, casting="unsafe")

    _suited_to(samples, for_each)(one, list(_rows(samples)))
    return levels


def _fits(samples: Array, low: float, high: float) -> bool:
    """Whether single precision is as good: the difference to `low` is exact to its rounding."""
    return (
        samples.dtype == np.float32
        and _NARROWEST < high - low < _WIDEST
        and max(abs(low), abs(high)) < _WIDEST
    )


def _single(low: float, high: float, top: int, shift: float) -> Callable[[Array], Array]:
    factor = top / (high - low)
    base = np.float32(low)
    rest = np.float32(shift - (low - float(base)) * factor)
    single = np.float32(factor)

    def scale(block: Array) -> Array:
        values = np.subtract(block, base)
        np.multiply(values, single, out=values)
        return np.add(values, rest, out=values) if rest else values

    return scale


def _double(low: float, high: float, top: int, shift: float) -> Callable[[Array], Array]:
    width = high - low
    # Halved where the difference of the largest numbers overflows.
    part = 1.0 if math.isfinite(width) else 0.5
    width = width if part == 1.0 else high * part - low * part

    def scale(block: Array) -> Array:
        values = block.astype(np.float64)
        values *= part
        values -= low * part
        values /= width
        values *= top
        values += shift
        return values

    return scale


def _rows(samples: Array) -> list[slice]:
    rows, columns = samples.shape
    height = max(1, BLOCK_SAMPLES // columns)
    return [slice(start, start + height) for start in range(0, rows, height)]


def _suited_to(samples: Array, for_each: ForEach) -> ForEach:
    return for_each if samples.size > THREADED_SAMPLES else in_turn


# Colour maps of pictures, as tables of 256 colours.

Table = NDArray[np.uint8]

NAMES: Mapping[str, str] = MappingProxyType(
    {
        "grey": "Grey",
        "inverted": "Grey inverted",
        "viridis": "Viridis",
        "inferno": "Inferno",
        "magma": "Magma",
        "turbo": "Turbo",
        "diverging": "Blue–white–red",
    }
)
_FILES = MappingProxyType({"diverging": "CET-D1"})


@cache
def colour_table(name: str) -> Table:
    """Red, green and blue of the 256 levels, shape (256, 3)."""
    ramp = np.arange(256, dtype=np.uint8)
    if name in ("grey", "inverted"):
        ramp = ramp if name == "grey" else ramp[::-1]
        return np.repeat(ramp[:, np.newaxis], 3, axis=1)
    colours = pg.colormap.get(_FILES.get(name, name)).getLookupTable(nPts=256, alpha=False)
    return np.ascontiguousarray(colours, np.uint8)


def colour_map(name: str) -> pg.ColorMap:
    return pg.ColorMap(None, colour_table(name)[::15])
