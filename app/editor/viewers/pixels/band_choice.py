"""Which bands of a picture are shown: their sum, one alone, or three as red, green and blue."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from core.chain.band_stack import BandStack
from core.chain.wires import Image

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

    def plain(self) -> dict[str, Any]:
        colours = None if self.colours_um is None else list(self.colours_um)
        return {"shown": self.shown, "one_um": self.one_um, "colours_um": colours}

    @classmethod
    def of(cls, plain: Any) -> BandChoice:
        """From JSON; what cannot be used is left out."""
        if not isinstance(plain, Mapping):
            return ALL
        shown, one, colours = (plain.get(name) for name in ("shown", "one_um", "colours_um"))
        known = _wavelengths([one], 1)
        three = _wavelengths(colours, 3)
        return cls(
            shown if shown in BANDS_SHOWN else "all",
            known[0] if known else None,
            (three[0], three[1], three[2]) if three else None,
        )


ALL = BandChoice()


def bands_of(value: Any) -> BandStack | None:
    """The bands of what is on a wire; None where it has none."""
    return value.bands if isinstance(value, Image) else None


def evenly_spaced(count: int) -> tuple[int, int, int]:
    """Three of so many bands, the last as red: the middles of three equal parts."""
    red, green, blue = ((2 * third + 1) * count // 6 for third in (2, 1, 0))
    return red, green, blue


def _nearest(bands: BandStack, wavelength_um: float) -> int:
    return int(np.argmin(np.abs(np.array(bands.centres_um) - wavelength_um)))


def _wavelengths(plain: Any, count: int) -> tuple[float, ...] | None:
    if not isinstance(plain, list | tuple) or len(plain) != count:
        return None
    if not all(isinstance(one, int | float) and math.isfinite(one) and one > 0 for one in plain):
        return None
    return tuple(float(one) for one in plain)
