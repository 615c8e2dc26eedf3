"""How an image viewer shows its wire: one immutable value, kept with the window's layout."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, get_args

from app.editor.viewers.network_ports import followed
from app.editor.viewers.pixels.band_choice import ALL, BandChoice
from app.editor.viewers.pixels.picture_layers import Automatic
from app.editor.viewers.pixels.picture_query import Levels, Mode, PictureQuery, Scale
from core.network.network import Network

SCALES: tuple[Scale, ...] = get_args(Scale)
MODES: tuple[Mode, ...] = get_args(Mode)
AUTOMATIC: tuple[Automatic, ...] = get_args(Automatic)
AUTOMATIC_LEVELS: Automatic = "percentiles"  # a few hot samples leave the rest its contrast


@dataclass(frozen=True)
class Choices:
    """What an image viewer is to show; `levels` are manual where they are two numbers."""

    port: str | None = None
    other: str | None = None
    mode: Mode = "alone"
    mapping: Scale = "linear"
    levels: Levels = AUTOMATIC_LEVELS
    bands: BandChoice = ALL

    @property
    def query(self) -> PictureQuery | None:
        """The query; None where nothing is to be shown."""
        if self.port is None:
            return None
        alone = PictureQuery(
            self.port, mapping=self.mapping, levels=self.levels, bands=self.bands.in_use
        )
        return replace(alone, other=self.other, mode=self.mode) if self.compares else alone

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
        """Whether two wires are shown."""
        return self.mode != "alone" and self.other is not None

    def moved(self, before: Network, after: Network) -> Choices:
        """With the names that nodes have after a change; those of nodes that are gone stay."""
        port = self.port and (followed(self.port, before, after) or self.port)
        other = self.other and (followed(self.other, before, after) or self.other)
        return replace(self, port=port, other=other)

    def plain(self) -> dict[str, Any]:
        levels = self.levels if isinstance(self.levels, str) else list(self.levels)
        return {
            "port": self.port,
            "other": self.other,
            "mode": self.mode,
            "mapping": self.mapping,
            "levels": levels,
            "bands": self.bands.plain(),
        }

    @classmethod
    def of(cls, plain: Mapping[str, Any]) -> Choices:
        """From JSON; what cannot be used is left out."""
        port, other = plain.get("port"), plain.get("other")
        mode, mapping, levels = (plain.get(name) for name in ("mode", "mapping", "levels"))
        return cls(
            port if isinstance(port, str) else None,
            other if isinstance(other, str) else None,
            mode if mode in MODES else "alone",
            mapping if mapping in SCALES else "linear",
            levels if levels in AUTOMATIC else _manual(levels) or AUTOMATIC_LEVELS,
            BandChoice.of(plain.get("bands")),
        )


def _manual(levels: Any) -> tuple[float, float] | None:
    numbers = numbers_of(levels, 2)
    return (numbers[0], numbers[1]) if numbers and numbers[0] < numbers[1] else None


def numbers_of(plain: Any, count: int) -> tuple[float, ...] | None:
    """A list of so many finite numbers; None for anything else."""
    if not isinstance(plain, list | tuple) or len(plain) != count:
        return None
    if not all(isinstance(number, int | float) and math.isfinite(number) for number in plain):
        return None
    return tuple(float(number) for number in plain)
