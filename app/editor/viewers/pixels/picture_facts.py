"""What of a picture is to be shown, and what there is to know of it beside its samples."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, Literal, get_args

import numpy as np
from PySide6.QtCore import QRectF

from app.editor.viewers.pixels.grey_levels import Range
from app.editor.viewers.viewer import PICTURE_TYPES, followed
from core.chain.band_stack import BandStack
from core.chain.wires import Image, Magnitude, Phase, Pupil, SpectrumWire, Transfer
from core.errors import NetworkError
from core.network.network import Network
from core.records import dataclass, replace
from core.transfer.factors import Grid

Band = tuple[float, float]
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


def check_is_picture(value: Any, port: str) -> None:
    kind = getattr(value, "port_type", None)
    if kind not in PICTURE_TYPES:
        shown = ", ".join(PICTURE_TYPES[:-1])
        raise NetworkError(
            f"{port} is of type {kind}: only {shown} and {PICTURE_TYPES[-1]} can be shown as "
            "pictures"
        )


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


def picture_facts(image: Image, reduced: int = 1) -> Facts:
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


# All that an image viewer is to show.


@dataclass(frozen=True)
class Choices:
    """What an image viewer is to show; `levels` are manual where they are two numbers."""

    port: str | None = None
    other: str | None = None
    mode: Mode = "alone"
    mapping: Scale = "linear"
    levels: Levels = AUTOMATIC_LEVELS
    bands: BandChoice = ALL

    def with_(self, **changes: Any) -> Choices:
        """With some of it changed; manual levels hold only for what they were set for."""
        changed = replace(self, **changes)
        meant_for = ("port", "other", "mode", "mapping")
        otherwise = any(getattr(self, name) != getattr(changed, name) for name in meant_for)
        # Of another band in the same place they hold, so that bands can be compared.
        otherwise = otherwise or self.bands.shown != changed.bands.shown
        if otherwise and "levels" not in changes and not isinstance(changed.levels, str):
            return replace(changed, levels=AUTOMATIC_LEVELS)
        return changed

    @property
    def compares(self) -> bool:
        return self.mode != "alone" and self.other is not None

    def moved(self, before: Network, after: Network) -> Choices:
        """With the names that nodes have after a change; those of nodes that are gone stay."""
        port = self.port and (followed(self.port, before, after) or self.port)
        other = self.other and (followed(self.other, before, after) or self.other)
        return replace(self, port=port, other=other)
