"""The lineage of steps: what analysis needs of one, declared beside its function.

Transfer functions and noises of a picture are read off its recipe, step by step from the picture
back to its source. Of a step six things are needed:

1. Which input is the picture that goes on?              `picture`, by its name in the function
2. Which linear change is made of it?                    `linear`, see `Linear`:
   its transfer function, the sampling before, a noise behind it, a row of an edge behind it
3. Which noises are added, of which power and colour?    `noise`, see `Noise`
4. The values of which inputs do these make?             `looks_at`, by their names
5. What is the picture with those at their mean?         `noise_free`; if not given, the picture
6. If a picture begins here: are its samples means over
   their area, which blurs as an aperture does?          `source_step(area_means=…)`

Functions for 2, 3 and 5 take the inputs' recipes and the parameters, as the step's own function
takes values. A new source of noise is complete in its file:

    def _shot(at: AtStep, image: Recipe, *, electrons: float) -> list[Noise]:
        return [at.white("shot", at.work.value(image) / electrons)]

    @picture_step(noise=_shot, looks_at=("image",))
    def with_shot_noise(work: Work, image: Array, deviates: Array, *, electrons: float) -> Array: …

A picture that carries none on is marked by `core.evaluation.recipes.ends_lineage`. What differs
from frame to frame needs no mark: it is what a `Stream` among the parameters draws, unless fixed.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial
from inspect import Parameter, signature
from typing import Any, Literal, TypeVar, cast

import numpy as np

from core import kernels
from core.arrays import Array, Vector
from core.chain.noise_power import NoisePower
from core.evaluation.recipes import Recipe, Step, marked
from core.evaluation.work import Work
from core.physics.sampling.detector_sampling import (
    block_mean_mtf,
    pixel_count,
    pixel_places,
    shifted_samples_ptf,
)
from core.records import dataclass, replace
from core.transfer.factors import Edges, Factor, Grid, Law, Separable, factor_at
from core.transfer.periodic import sampled_columns

# Linear changes of a picture: what they do to sampling, contrast, noise and an edge's row.
#
# `Linear` leaves all as it is. A step whose change is none of those below derives a class of its
# own beside its function, and overrides what it changes.

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
        return power.filtered(work, self.factors, self.grid, self.edges)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        """The row filtered; mirrored at its ends, or repeated."""
        whole = np.concatenate([row, row[::-1]]) if self.edges == "reflect" else row
        interval = self.grid.interval_x_mrad if axis == "x" else self.grid.interval_y_mrad
        frequency = np.asarray(np.fft.rfftfreq(len(whole), interval), np.float64)
        none = np.zeros_like(frequency)
        places = (frequency, none) if axis == "x" else (none, frequency)
        spectrum = kernels.rfft(whole)
        for factor in self.factors:
            values = factor_at(work, factor, *places)
            spectrum = spectrum * (values if factor.part == "mtf" else np.exp(1j * values))
        return np.asarray(kernels.irfft(spectrum, len(whole))[: len(row)], np.float64)


class Pixels(Linear, ABC):
    """Pixels of so many `samples` across and along of a picture of the `old` size."""

    old: tuple[int, int]

    @property
    @abstractmethod
    def samples(self) -> tuple[float, float]: ...

    @property
    def combines_pixels(self) -> bool:
        return True

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.old

    def grid_before(self, grid: Grid) -> Grid:
        across, along = self.samples
        return Grid(*self.old, grid.interval_x_mrad / across, grid.interval_y_mrad / along)


@dataclass(frozen=True)
class Blocks(Pixels):
    """Mean or sum of blocks of a picture of the `old` size; what is left over is cropped."""

    factor_x: int
    factor_y: int
    mode: str
    old: tuple[int, int]

    @property
    def gain(self) -> float:
        return self.factor_x * self.factor_y if self.mode == "sum" else 1.0

    @property
    def samples(self) -> tuple[float, float]:
        return self.factor_x, self.factor_y

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
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
class LineOperator(Linear, ABC):
    """A linear operator along every row (axis x) or every column (axis y), the same on each."""

    axis: Axis

    @abstractmethod
    def applied(self, lines: Array) -> Array:
        """Along the first axis of lines, shape (samples, lines), that may be complex."""

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.operated(0 if self.axis == "y" else 1, self.applied)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        return row if axis != self.axis else np.asarray(self.applied(row[:, np.newaxis])[:, 0])


@dataclass(frozen=True)
class PixelSamples(Pixels):
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
    def samples(self) -> tuple[float, float]:
        return self.ratio_x, self.ratio_y

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
            folded = power.on(self.edges).sampled(round(self.ratio_x), round(self.ratio_y))
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


# Noise where a step adds it: its name, whether it changes in time, its power.

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class Noise:
    """A noise on its way: which node added it, whether it changes in time, and its power now.

    What becomes of a pattern that is known to the last sample is seen by making the picture with it
    alone: `pattern` is the step that adds it.
    """

    node: str
    name: str
    temporal: bool
    power: NoisePower
    pattern: Step | None = None


@dataclass(frozen=True)
class AtStep:
    """A step that adds noise, and the picture there.

    `before` are the noises that its picture has already. With `uniform`, gain errors are those of a
    uniform field of the picture's mean. `filtered`: whether any noise is filtered on its way; what
    is not needs no sample's own variance.
    """

    work: Work
    step: Step
    rows: int
    columns: int
    before: tuple[Noise, ...]
    uniform: bool = False
    filtered: bool = True

    def by_rows(self, function: Callable[[Array], Array], picture: Array) -> Array:
        """Variances in double, each made of a picture's sample at its place; on disk as that is."""
        slabs = self.work.row_slabs(picture)
        if len(slabs) == 1:
            return np.asarray(function(picture), np.float64)
        made: Array = self.work.empty(picture.shape, np.dtype(np.float64))
        for rows in slabs:
            self.work.check()
            made[rows] = function(picture[rows])
        return made

    def white(self, name: str, variance: float | Array, *, temporal: bool = True) -> Noise:
        power = NoisePower.white(self.rows, self.columns, variance)
        if not self.filtered:
            power = replace(power, variances=None)
        return self.coloured(name, power, temporal=temporal)

    def coloured(self, name: str, power: NoisePower, *, temporal: bool = True) -> Noise:
        return Noise(self.step.node or "", name, temporal, power)

    def known(self, name: str) -> Noise:
        """A pattern known to the last sample, the same in every frame."""
        none = NoisePower.white(self.rows, self.columns, 0.0)
        return Noise(self.step.node or "", name, False, none, self.step)


_UNCHANGED = Linear()
_POSITIONAL = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)


@dataclass(frozen=True)
class Noises:
    """What a step adds: `at` gives the noises where the step is, which are added to its picture.

    `on` is the step on another picture, `free` what takes its place on a picture without noise; if
    it `leaves_change`, that makes the step's linear change too. `in_blocks`: whether `at` is marked
    so. Then a noise's power is one number, and variances of samples are made by `AtStep.by_rows`.
    """

    at: Callable[[AtStep], list[Noise]]
    on: Callable[[Recipe], Recipe]
    free: Callable[[Recipe], Recipe]
    leaves_change: bool = False
    in_blocks: bool = False


@dataclass(frozen=True)
class Lineage:
    """What becomes of a picture in one recipe.

    `picture` is the one that goes on, None where one begins; `linear` the change that is made of
    it, `noise` what is added, whose values are made of `looks_at`. `area_means`: the samples of a
    picture that begins here are means over their area.

    Raises `ValueError` where a step adds noise and filters, and nothing filters without its noise.
    """

    picture: Recipe | None
    linear: Linear = _UNCHANGED
    noise: Noises | None = None
    looks_at: tuple[Recipe, ...] = ()
    area_means: bool = False

    def __post_init__(self) -> None:
        if not self.noise or type(self.linear) is Linear or self.linear.by_chance:
            return
        if not self.noise.leaves_change:
            raise ValueError(
                "a step cannot both add noise and make a linear change: split it into two steps, "
                "or give it a noise_free function that makes the same change"
            )


def lineage_of(recipe: Recipe) -> Lineage | None:
    """What becomes of a picture in a recipe; None where nothing behind it can be followed."""
    return cast("Lineage | None", recipe.lineage)


def picture_step(
    *,
    picture: str = "",
    linear: Callable[..., Linear] | None = None,
    noise: Callable[..., list[Noise]] | None = None,
    looks_at: tuple[str, ...] = (),
    noise_free: Callable[..., Recipe] | None = None,
) -> Callable[[F], F]:
    """Mark a step's function that carries a picture on.

    `picture` is the input that is the picture, the first one if not given. `linear` is called as
    ``linear(*inputs, **parameters)`` with the inputs' recipes, `noise` as ``noise(at, *inputs,
    **parameters)`` with the `AtStep`; `looks_at` are inputs whose values these read. `noise_free`
    is called like `linear`, with the picture without noise in the picture's place: what takes the
    step's place, at its node. It raises `DataError` where nothing is left.
    """

    def mark(function: F) -> F:
        names = _inputs(function)
        place = names.index(picture) if picture else 0
        seen = tuple(names.index(name) for name in looks_at)

        def lineage(step: Step) -> Lineage:
            how, inputs = dict(step.parameters), step.inputs
            change = linear(*inputs, **how) if linear else _UNCHANGED
            looked_at = tuple(inputs[index] for index in seen if index < len(inputs))
            return Lineage(inputs[place], change, noises(step) if noise else None, looked_at)

        def noises(step: Step) -> Noises:
            how, inputs = dict(step.parameters), step.inputs

            def at(there: AtStep) -> list[Noise]:
                assert noise is not None
                return noise(there, *inputs, **how)

            def on(other: Recipe) -> Step:
                return replace(step, inputs=(*inputs[:place], other, *inputs[place + 1 :]))

            def free(other: Recipe) -> Recipe:
                made = noise_free(*on(other).inputs, **how) if noise_free else other
                if made is other or not isinstance(made, Step) or made.node is not None:
                    return made
                return replace(made, node=step.node)

            blocks = hasattr(noise, "in_blocks")
            return Noises(at, on, free, noise_free is not None, blocks)

        return marked(lineage=lineage)(function)

    return mark


def source_step(*, area_means: bool) -> Callable[[F], F]:
    """Mark a step's function that begins a picture: all that is made of it starts here."""
    begun = Lineage(None, area_means=area_means)
    return marked(lineage=lambda _: begun)


def _inputs(function: Callable[..., Any]) -> list[str]:
    given = signature(function).parameters.values()
    return [parameter.name for parameter in given if parameter.kind in _POSITIONAL][1:]
