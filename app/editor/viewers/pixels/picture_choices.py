"""How an image viewer shows its wire: immutable values, kept with the window's layout."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from app.editor.viewers.network_ports import followed
from app.editor.viewers.pixels.grey_levels import Range
from core.chain.band_stack import BandStack
from core.chain.wires import Image
from core.network.network import Network

Mode = Literal["alone", "wipe", "difference"]
Scale = Literal["linear", "log", "spectrum"]
Automatic = Literal["extremes", "percentiles"]
Levels = Automatic | Range
SCALES: tuple[Scale, ...] = get_args(Scale)
MODES: tuple[Mode, ...] = get_args(Mode)
AUTOMATIC: tuple[Automatic, ...] = get_args(Automatic)
AUTOMATIC_LEVELS: Automatic = "percentiles"  # a few hot samples leave the rest its contrast

# Which bands of a picture are shown: their sum, one alone, or three as red, green and blue.

BandsShown = Literal["all", "one", "colours"]
BANDS_SHOWN: tuple[BandsShown, ...] = get_args(BandsShown)
CHANNELS = ("red", "green", "blue")
Channels = tuple[float, float, float]


@dataclass(frozen=True)
class BandChoice:
    """What is shown of a picture with bands; of any other it means nothing.

    Wavelengths, not numbers of bands: another file, or a narrower filter, has others.
    """

    shown: BandsShown = "all"  # all bands together, one alone, or three as red, green and blue
    one_um: float | None = None  # wavelength of the one, in µm; None for the middle one
    # wavelengths of the three, in µm; None for three evenly spaced, the longest as red
    colours_um: Channels | None = None

    @property
    def in_use(self) -> BandChoice:
        """Without the wavelengths of what is not shown."""
        if self.shown == "one":
            return BandChoice("one", self.one_um)
        return BandChoice("colours", colours_um=self.colours_um) if self.shown != "all" else ALL

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
