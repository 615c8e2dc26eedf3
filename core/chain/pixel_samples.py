"""Samples taken once a pixel: what that does to sampling, phases, noise and an edge's row."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from core.chain.linear_change import Axis, Linear, Vector
from core.chain.noise_power import NoisePower
from core.evaluation.work import Work
from core.physics.sampling.interpolation import pixel_count, pixel_places, shifted_samples_ptf
from core.transfer.factors import Edges, Factor, Grid, Law, Separable
from core.transfer.planar_blocks import Axes
from core.transfer.sampled_waves import sampled_columns


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
        """Rows and columns of pixels."""
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
        """True: samples become pixels."""
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
