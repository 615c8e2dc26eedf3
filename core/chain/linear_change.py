"""Linear changes of a picture: what they do to sampling, contrast, noise and an edge's row.

`Linear` leaves all as it is. A step whose change is none of those below derives a class of its own
beside its function, and overrides what it changes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from core.chain.noise_power import NoisePower
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.physics.sampling.interpolation import (
    block_mean_mtf,
    pixel_count,
    pixel_places,
    shifted_samples_ptf,
)
from core.transfer.factors import Edges, Factor, Grid, Law, Separable, factor_at
from core.transfer.planar_blocks import Axes
from core.transfer.sampled_waves import sampled_columns

Vector = NDArray[np.float64]
Axis = Literal["x", "y"]


@dataclass(frozen=True)
class LevelChange:
    """What a change does about the level of its picture, where that depends on the picture.

    `gain` is that of small differences about the `mean` of the picture before, `reason` why it is
    0, where it is. `signal` is what the mean becomes, less what is there without any scene.
    `per_sample` is the gain of the picture's own samples, where `gain` is of a radiance that they
    stand for.
    """

    gain: float
    mean: float
    signal: float
    reason: str = ""
    per_sample: float | None = None


class Linear:
    """A linear change of a picture; here none at all."""

    @property
    def level(self) -> Recipe | None:
        """Recipe of the `LevelChange` of a change that is linear in small differences alone."""
        return None

    @property
    def gain(self) -> float:
        """What a uniform picture is multiplied by."""
        return 1.0

    @property
    def by_chance(self) -> str:
        """Why the gain is random, in one line; empty where it is not."""
        return ""

    @property
    def by_sample(self) -> bool:
        """Whether a noise behind it is that before it times one factor, the same everywhere."""
        return type(self).noise is Linear.noise and type(self).carried is Linear.carried

    @property
    def before_camera(self) -> bool:
        """Whether it ends at the camera, whose own gains are those behind it."""
        return False

    @property
    def combines_pixels(self) -> bool:
        return False

    @property
    def of_reflectance(self) -> float | None:
        """Reflectance of a sample of 1 before it, where it is the light on surfaces."""
        return None

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        """Size of the picture that it is applied to, of the one that it makes."""
        return rows, columns

    def grid_before(self, grid: Grid) -> Grid:
        """Sampling of the picture that it is applied to, of the one that it makes."""
        return grid

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        """Its transfer function, in factors that belong to the node."""
        return ()

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power

    def carried(self, work: Work, power: NoisePower, *, temporal: bool) -> NoisePower | None:
        """The same of one that is new in every frame or stays; None where it ends here."""
        return self.noise(work, power)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        """A row behind it, or a column (axis y), of a picture whose rows, or columns, are alike.

        Up to a factor: what is made of it is a contrast.
        """
        return row


@dataclass(frozen=True)
class Filtering(Linear):
    """Transfer functions on a frame that goes on mirrored or periodic beyond its edges.

    With a label it is one stage of this name, whatever its factors are called.
    """

    factors: tuple[Factor, ...]
    grid: Grid
    edges: Edges
    label: str = ""

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        if not self.label:
            return self.factors
        return tuple(replace(factor, label=self.label, node=node) for factor in self.factors)

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        axes: Axes = "mirrored" if self.edges == "reflect" else "periodic"
        return power.filtered(work, self.factors, self.grid, axes)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        """The row filtered; mirrored at its ends, or repeated."""
        whole = np.concatenate([row, row[::-1]]) if self.edges == "reflect" else row
        interval = self.grid.interval_x_mrad if axis == "x" else self.grid.interval_y_mrad
        frequency = np.asarray(scipy.fft.rfftfreq(len(whole), interval), np.float64)
        none = np.zeros_like(frequency)
        places = (frequency, none) if axis == "x" else (none, frequency)
        spectrum = scipy.fft.rfft(whole)
        for factor in self.factors:
            values = factor_at(work, factor, *places)
            spectrum = spectrum * (values if factor.part == "mtf" else np.exp(1j * values))
        return np.asarray(scipy.fft.irfft(spectrum, len(whole))[: len(row)], np.float64)


@dataclass(frozen=True)
class Blocks(Linear):
    """Mean or sum of blocks of a picture of the `old` size; what is left over is cropped."""

    factor_x: int
    factor_y: int
    mode: str
    old: tuple[int, int]

    @property
    def gain(self) -> float:
        return self.factor_x * self.factor_y if self.mode == "sum" else 1.0

    @property
    def combines_pixels(self) -> bool:
        return True

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.old

    def grid_before(self, grid: Grid) -> Grid:
        """Finer by the factors, with what is cropped."""
        x, y = grid.interval_x_mrad / self.factor_x, grid.interval_y_mrad / self.factor_y
        return Grid(*self.old, x, y)

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        """Of the mean of neighbouring samples."""
        if (self.factor_x, self.factor_y) == (1, 1):
            return ()
        x, y = (
            Law.of(block_mean_mtf, interval_mrad=interval, samples=factor) if factor > 1 else None
            for interval, factor in (
                (before.interval_x_mrad, self.factor_x),
                (before.interval_y_mrad, self.factor_y),
            )
        )
        return (Separable(x, y, label="Combined pixels", node=node),)

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        behind = power.averaged(self.factor_x, self.factor_y)
        return behind.scaled(self.gain) if self.mode == "sum" else behind

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        factor = self.factor_x if axis == "x" else self.factor_y
        whole = len(row) // factor
        return np.asarray(row[: whole * factor].reshape(whole, factor).mean(axis=1), np.float64)


@dataclass(frozen=True)
class PlaceDependent(Separable, ABC):
    """A factor that differs from sample to sample of a picture: the mean over all."""

    @abstractmethod
    def mean_over(self, law: Law, frequency: Vector, share: float) -> Vector:
        """Modulus of the mean over the samples in this share of an axis, about its middle."""


@dataclass(frozen=True)
class LineOperator(Linear, ABC):
    """A linear operator along every row (axis x) or every column (axis y), the same on each."""

    axis: Axis

    @abstractmethod
    def applied(self, lines: NDArray[Any]) -> NDArray[Any]:
        """Along the first axis of lines, shape (samples, lines), that may be complex."""

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.operated(0 if self.axis == "y" else 1, self.applied)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        return row if axis != self.axis else np.asarray(self.applied(row[:, np.newaxis])[:, 0])


@dataclass(frozen=True)
class PixelSamples(Linear):
    """One sample for each pixel of a frame, at its middle.

    Between samples the frame is that of its waves, exactly, so nothing is lost of the contrast of
    any of them; what lies beyond the pixels' Nyquist frequency folds back, as in a camera. `old`
    are rows and columns before, ratios samples a pixel, offsets how far the samples lie from the
    pixels' middles, in pixels.
    """

    old: tuple[int, int]
    ratio_x: float
    ratio_y: float
    offset_x: float
    offset_y: float
    edges: Edges

    @property
    def places(self) -> tuple[Vector, Vector]:
        """Columns and rows of the samples, counted from the middle of the first one."""
        return self._places("x"), self._places("y")

    @property
    def new(self) -> tuple[int, int]:
        rows, columns = self.old
        return (
            pixel_count(samples=rows, ratio=self.ratio_y),
            pixel_count(samples=columns, ratio=self.ratio_x),
        )

    @property
    def folds(self) -> bool:
        """Whether the pixels are blocks of the frame, sampled in their middles."""
        ratios = zip((self.ratio_y, self.ratio_x), self.old, strict=True)
        return not (self.offset_x or self.offset_y) and all(
            ratio >= 1.0 and ratio == round(ratio) and size % round(ratio) == 0
            for ratio, size in ratios
        )

    @property
    def on_samples(self) -> bool:
        """Whether the middle of every pixel is a sample: odd numbers of them, no offset."""
        return not (self.offset_x or self.offset_y) and all(
            ratio % 2.0 == 1.0 for ratio in (self.ratio_x, self.ratio_y)
        )

    @property
    def combines_pixels(self) -> bool:
        return True

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.old

    def grid_before(self, grid: Grid) -> Grid:
        """Finer by the ratios, with what is cropped."""
        x, y = grid.interval_x_mrad / self.ratio_x, grid.interval_y_mrad / self.ratio_y
        return Grid(*self.old, x, y)

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        """No contrast is lost; an offset moves the picture."""
        x, y = (
            Law.of(shifted_samples_ptf, shift_mrad=offset * ratio * interval) if offset else None
            for offset, ratio, interval in (
                (self.offset_x, self.ratio_x, before.interval_x_mrad),
                (self.offset_y, self.ratio_y, before.interval_y_mrad),
            )
        )
        if x is None and y is None:
            return ()
        return (Separable(x, y, "ptf", label="Sampled pixels", node=node),)

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        """Folded: a sample's variance stays, and so it does between samples on average."""
        if self.folds:
            axes: Axes = "mirrored" if self.edges == "reflect" else "periodic"
            folded = power.on(axes).sampled(round(self.ratio_x), round(self.ratio_y))
            if folded is not None:
                return folded
        across, along = (
            partial(sampled_columns, places=places, edges=self.edges) for places in self.places
        )
        return power.resampled(self.new, along, across)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        made = sampled_columns(row[:, np.newaxis], self._places(axis), self.edges)
        return np.asarray(made[:, 0], np.float64)

    def _places(self, axis: Axis) -> Vector:
        rows, columns = self.old
        if axis == "x":
            return pixel_places(samples=columns, ratio=self.ratio_x, offset=self.offset_x)
        return pixel_places(samples=rows, ratio=self.ratio_y, offset=self.offset_y)
