"""What there is to know of a picture beside its samples, and its samples as 8-bit levels."""

import math
from collections.abc import Callable, Hashable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, Literal, get_args

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QRectF

from core.arrays import Array
from core.chain.band_stack import BandStack
from core.chain.wires import Image, Magnitude, Phase, Pupil, SpectrumWire, Transfer
from core.machine import ForEach, in_turn
from core.records import dataclass, replace
from core.transfer.factors import Grid

Band = tuple[float, float]
Range = tuple[float, float]
Kind = Literal["picture", "plane", "pupil"]
_MOST_OBLONG = 8.0  # longer over shorter side; a pixel beyond is drawn square


@dataclass(frozen=True)
class Axis:
    first: float  # first, step: place of the first sample, and from one to the next
    step: float
    label: str  # label, unit: quantity along the axis, and its unit
    unit: str = ""

    @property
    def title(self) -> str:
        return f"{self.label} ({self.unit})" if self.unit else self.label

    def at(self, index: float) -> float:
        return self.first + index * self.step

    def index(self, place: float) -> float:
        return (place - self.first) / self.step


@dataclass(frozen=True)
class Facts:
    kind: Kind  # samples in space, in frequency with zero in the middle, or in the aperture
    rows: int  # rows, columns: size
    columns: int
    quantity: str  # quantity, unit: what the samples are
    unit: str
    across: Axis  # across, along: where the columns and rows lie
    along: Axis
    band_um: Band | None = None  # cut-on and cut-off wavelength
    # width of a sample over its height, in angle; 1 where that is not known or beyond 8
    pixel_shape: float = 1.0
    # middles of the bands that are shown alone, or as red, green and blue; empty for all
    wavelengths_um: tuple[float, ...] = ()
    width_um: float | None = None  # width of the one band shown, whose samples are per µm

    @property
    def title(self) -> str:
        return f"{self.quantity} ({self.unit})" if self.unit else self.quantity

    @property
    def extent(self) -> QRectF:
        """What the samples cover on the axes, each of them around its place."""
        x, y = self.across, self.along
        return QRectF(
            x.first - x.step / 2, y.first - y.step / 2, x.step * self.columns, y.step * self.rows
        )


def identity(value: Any) -> Hashable:
    """What a picture of the value depends on; the pixels' key alone does not hold their unit."""
    if isinstance(value, Image):
        interval = value.interval_x_mrad, value.interval_y_mrad
        bands = value.bands.key if value.bands is not None else None
        return value.key, value.shape, interval, value.unit, value.band_um, bands
    if isinstance(value, SpectrumWire):
        return value.key, value.image.unit if value.image is not None else ""
    return getattr(value, "key", None)


def laid_over(preview: Facts, full: Facts) -> Facts:
    """Facts of a preview with its samples laid over those of the picture at full size.

    How much smaller a picture of a preview is depends on what lies before it. Planes lie where
    their frequencies are.
    """
    if preview.kind != "picture" or full.kind != "picture":
        return preview
    ways = ((preview.columns, full.across, full.columns), (preview.rows, full.along, full.rows))
    across, along = (
        replace(axis, first=axis.first + (step - axis.step) / 2, step=step)
        for count, axis, whole in ways
        for step in (axis.step * whole / count,)
    )
    return replace(preview, across=across, along=along, pixel_shape=full.pixel_shape)


def image_facts(image: Image, reduced: int = 1) -> Facts:
    """Of an image; in a preview `reduced` times smaller, the axes count its full-size samples."""
    first = (reduced - 1) / 2
    return Facts(
        "picture",
        image.rows,
        image.columns,
        "radiance" if image.unit.startswith("W") else "value",
        image.unit,
        Axis(first, reduced, "column"),
        Axis(first, reduced, "row"),
        image.band_um,
        _pixel_shape(image),
    )


def of_bands(facts: Facts, bands: BandStack, places: tuple[int, ...]) -> Facts:
    """Facts of all bands, as those of one or of three shown alone."""
    wavelengths = tuple(bands.centres_um[place] for place in places)
    band, width = None, None
    if len(places) == 1:
        (centre,), width = wavelengths, bands.widths_um[places[0]]
        band = centre - width / 2, centre + width / 2
    facts = replace(facts, wavelengths_um=wavelengths, band_um=band)
    if not bands.density:
        return facts
    quantity = "spectral radiance" if facts.quantity == "radiance" else facts.quantity
    unit = f"{facts.unit}/µm" if facts.unit else "1/µm"
    return replace(facts, quantity=quantity, unit=unit, width_um=width)


def _pixel_shape(image: Image) -> float:
    """Width over height; 1 where the picture would be drawn too thin to be looked at."""
    if not (image.interval_x_mrad and image.interval_y_mrad):
        return 1.0
    shape = image.interval_x_mrad / image.interval_y_mrad
    return shape if 1 / _MOST_OBLONG <= shape <= _MOST_OBLONG else 1.0


def spectrum_facts(image: Image) -> Facts:
    known = image.interval_x_mrad and image.interval_y_mrad
    axes = (
        _frequencies(image.grid()) if known else _axes(image.rows, image.columns, 1, 1, "samples")
    )
    return Facts("plane", image.rows, image.columns, "modulus", image.unit, *axes)


def plane_facts(value: SpectrumWire | Transfer, rows: int, columns: int, own: Any = None) -> Facts:
    if own is not None:
        axes = _axes(rows, columns, own.interval_x, own.interval_y)
    else:
        axes = _frequencies(value.grid)
    if isinstance(value, Phase) or (isinstance(value, Transfer) and value.part == "ptf"):
        named = ("phase", "rad")
    elif isinstance(value, Magnitude) and value.image is not None:
        named = ("modulus", value.image.unit)
    else:
        named = ("MTF", "")
    return Facts("plane", rows, columns, *named, *axes)


def pupil_facts(pupil: Pupil) -> Facts:
    axes = Axis(0, 1, "column"), Axis(0, 1, "row")
    return Facts("pupil", pupil.rows, pupil.columns, "transmission", "", *axes)


def _frequencies(grid: Grid) -> tuple[Axis, Axis]:
    return _axes(grid.rows, grid.columns, grid.frequency_interval_x, grid.frequency_interval_y)


def _axes(
    rows: int, columns: int, step_x: float, step_y: float, unit: str = "cyc/mrad"
) -> tuple[Axis, Axis]:
    return (
        Axis(-(columns // 2) * step_x, step_x, "ξ", unit),
        Axis(-(rows // 2) * step_y, step_y, "η", unit),
    )


Mode = Literal["alone", "wipe", "difference"]
Scale = Literal["linear", "log", "spectrum"]
Automatic = Literal["extremes", "percentiles"]
Levels = Automatic | Range
MODES: tuple[Mode, ...] = get_args(Mode)
AUTOMATIC_LEVELS: Automatic = "percentiles"  # a few hot samples leave the rest its contrast

# Which bands of a picture are shown: their sum, one alone, or three as red, green and blue.

BandsShown = Literal["all", "one", "colours"]
CHANNELS = ("red", "green", "blue")
Channels = tuple[float, float, float]


@dataclass(frozen=True)
class BandChoice:
    """By wavelengths, not numbers of bands: another file, or a narrower filter, has others."""

    shown: BandsShown = "all"  # all bands together, one alone, or three as red, green and blue
    one_um: float | None = None  # wavelength of the one, in µm; None for the middle one
    # wavelengths of the three, in µm; None for three evenly spaced, the longest as red
    colours_um: Channels | None = None

    def places(self, bands: BandStack) -> tuple[int, ...]:
        """Indices of the bands shown alone: none, one, or three; those nearest in wavelength."""
        if self.shown == "all":
            return ()
        if self.shown == "one":
            wavelengths: tuple[float, ...] = (self.one_um,) if self.one_um is not None else ()
            return tuple(_nearest(bands, one) for one in wavelengths) or (bands.count // 2,)
        if self.colours_um is None:
            return evenly_spaced(bands.count)
        return tuple(_nearest(bands, one) for one in self.colours_um)


ALL = BandChoice()


def bands_of(value: Any) -> BandStack | None:
    return value.bands if isinstance(value, Image) else None


def evenly_spaced(count: int) -> tuple[int, int, int]:
    """Three of so many bands, the last as red: the middles of three equal parts."""
    red, green, blue = ((2 * third + 1) * count // 6 for third in (2, 1, 0))
    return red, green, blue


def _nearest(bands: BandStack, wavelength_um: float) -> int:
    return int(np.argmin(np.abs(np.array(bands.centres_um) - wavelength_um)))


# Samples as 8-bit levels, their histogram and quantiles, in blocks that stay in the cache.

Grey = NDArray[np.uint8]

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


def grey_levels(samples: Array, low: float, high: float, *, for_each: ForEach = in_turn) -> Grey:
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


def _quantile(samples: Array, index: Grey, ends: NDArray[np.int64], share: float) -> float:
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
) -> Grey:
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

    rows, columns = samples.shape
    height = max(1, BLOCK_SAMPLES // columns)
    blocks = [slice(start, start + height) for start in range(0, rows, height)]
    (for_each if samples.size > THREADED_SAMPLES else in_turn)(one, blocks)
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

    def scale(block: Array) -> Array:
        values = block.astype(np.float64)
        values -= low
        values /= width
        values *= top
        values += shift
        return values

    return scale


_MEAN_OF = 4  # samples each way that are averaged; of more, every n-th


def shrunk(samples: NDArray[Any], most: int) -> NDArray[np.float64]:
    """At most so many rows and columns, as means of blocks; of far too many, of every n-th."""
    rows, columns = samples.shape
    factor = max(1, -(-max(rows, columns) // most))
    stride = max(1, factor // _MEAN_OF)
    seen = samples[::stride, ::stride]
    block = -(-max(seen.shape) // most)
    if block > 1:
        high, wide = (max(1, side // block) for side in seen.shape)
        part = seen[: min(high * block, seen.shape[0]), : min(wide * block, seen.shape[1])]
        down, across = part.shape[0] // high, part.shape[1] // wide
        part = part[: high * down, : wide * across].reshape(high, down, wide, across)
        seen = part.mean(axis=(1, 3), dtype=np.float64)
    return np.ascontiguousarray(seen, np.float64)


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
