"""Linear changes of a picture: what they do to sampling, contrast, noise and an edge's row.

`Linear` leaves all as it is. A step whose change is none of those below derives a class of its own
beside its function, and overrides what it changes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from core.chain.noise_power import NoisePower
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.physics.sampling.interpolation import block_mean_mtf
from core.transfer.factors import Edges, Factor, Grid, Law, Separable, factor_at
from core.transfer.planar_blocks import Axes

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
        """Number of pixels in a sum, 1 of a mean."""
        return self.factor_x * self.factor_y if self.mode == "sum" else 1.0

    @property
    def combines_pixels(self) -> bool:
        """True: these are blocks of pixels."""
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
        """Averaged, or summed."""
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
