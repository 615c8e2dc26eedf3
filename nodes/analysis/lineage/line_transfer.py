"""Transfer functions along a line through zero frequency, without the 2-D plane."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.chain.results import SampledTransfer
from core.chain.step_lineage import Array, lineage_of
from core.chain.wires import Image
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.transfer.factors import Factor, Grid, Part, factor_at

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Line:
    """A direction in the plane of frequencies: unit vector and name."""

    name: str
    across: float
    along: float

    @classmethod
    def at(cls, angle_deg: float) -> Line:
        """From the xi axis (0°) towards the eta axis (90°); multiples of 90° lie on an axis."""
        quarter = angle_deg / 90.0
        if quarter == round(quarter):
            across, along = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarter) % 4]
        else:
            angle = math.radians(angle_deg)
            across, along = math.cos(angle), math.sin(angle)
        return cls(f"{angle_deg:g}°", across, along)

    def end(self, highest_x: float, highest_y: float) -> float:
        """Frequency at which the line leaves the rectangle of |xi| and |eta| up to these."""
        ends = ((highest_x, abs(self.across)), (highest_y, abs(self.along)))
        return min(highest / share for highest, share in ends if share > 0.0)

    def frequencies(self, grid: Grid, samples: int) -> Vector:
        return np.linspace(0.0, self.end(grid.nyquist_x, grid.nyquist_y), samples)


HORIZONTAL = Line("horizontal", 1.0, 0.0)
VERTICAL = Line("vertical", 0.0, 1.0)


@dataclass(frozen=True)
class Stage:
    """Factors of one module under one name."""

    label: str
    factors: tuple[Factor, ...]

    @property
    def key(self) -> str:
        """Content key; a curve carries its name, so the name counts."""
        return "/".join((self.label, *(factor.key for factor in self.factors)))


def stages_of(factors: tuple[Factor, ...]) -> tuple[Stage, ...]:
    """Factors grouped by the module they came from, in order, under unique names."""
    groups: dict[tuple[str | None, str], list[Factor]] = {}
    for factor in factors:
        groups.setdefault((factor.node, factor.label), []).append(factor)
    labels = Counter(label for _, label in groups)
    stages: list[Stage] = []
    for number, ((node, label), members) in enumerate(groups.items(), 1):
        name = label or node or f"Stage {number}"
        if labels[label] > 1 and label and node:
            name = f"{label} ({node})"
        stages.append(Stage(name, tuple(members)))
    return tuple(stages)


def stage_along(work: Work, stage: Stage, part: Part, line: Line, frequency: Vector) -> Vector:
    """A stage's MTF, signed, or its PTF in radians, at points of the line."""
    value = np.ones(len(frequency)) if part == "mtf" else np.zeros(len(frequency))
    for factor in stage.factors:
        values = _factor_along(work, factor, line, frequency)
        value = value * values if part == "mtf" else value + values
    return value


def all_along(work: Work, stages: tuple[Stage, ...], line: Line, frequency: Vector) -> Vector:
    """The MTF of all stages together at points of the line, signed."""
    total = np.ones(len(frequency))
    for stage in stages:
        work.check()
        total = total * stage_along(work, stage, "mtf", line, frequency)
    return total


def _factor_along(work: Work, factor: Factor, line: Line, frequency: Vector) -> Vector:
    xi, eta = line.across * frequency, line.along * frequency
    if line.along == 0.0:
        return np.asarray(factor.plane(work, xi, np.zeros(1))[0], np.float64)
    if line.across == 0.0:
        return np.asarray(factor.plane(work, np.zeros(1), eta)[:, 0], np.float64)
    return factor_at(work, factor, xi, eta)


def samples_along(
    sampled: SampledTransfer, part: Part, line: Line, samples: int
) -> tuple[Vector, Vector]:
    """Frequency and value of a sampled function: its samples on an axis, else bilinear ones."""
    rows, columns = sampled.values.shape
    highest_x, highest_y = (columns - 1) // 2, (rows - 1) // 2
    if line.along == 0.0 or line.across == 0.0:
        highest, step = (
            (highest_x, sampled.interval_x)
            if line.along == 0.0
            else (highest_y, sampled.interval_y)
        )
        frequency = np.arange(highest + 1) * step
    else:
        end = line.end(highest_x * sampled.interval_x, highest_y * sampled.interval_y)
        frequency = np.linspace(0.0, end, samples)
    x = np.clip(line.across * frequency / sampled.interval_x, -highest_x, highest_x)
    y = np.clip(line.along * frequency / sampled.interval_y, -highest_y, highest_y)
    if line.along == 0.0 or line.across == 0.0:
        x, y = np.rint(x), np.rint(y)  # on the samples, whatever the division rounded
    value = _bilinear(sampled.values, x, y)
    if part == "ptf":
        value = np.angle(value) if np.iscomplexobj(value) else value
    elif np.iscomplexobj(value):
        value = np.abs(value)
    return frequency, np.asarray(value, np.float64)


def _bilinear(values: Array, x: Vector, y: Vector) -> Array:
    """Values at fractional indices of an array in FFT order; negative ones count from its end."""
    left, top = np.floor(x).astype(np.intp), np.floor(y).astype(np.intp)
    tx, ty = x - left, y - top
    rows, columns = values.shape

    def at(row: NDArray[np.intp], column: NDArray[np.intp]) -> Array:
        return np.asarray(values[row % rows, column % columns])

    upper = at(top, left) * (1 - tx) + at(top, left + 1) * tx
    lower = at(top + 1, left) * (1 - tx) + at(top + 1, left + 1) * tx
    return np.asarray(upper * (1 - ty) + lower * ty)


# The transfer functions on the way to a picture, from its source on.


@dataclass(frozen=True)
class ImageTransfer:
    """The linear stages of a picture, in order, each under a name of its own.

    `source` makes the scene's samples, or is the result of a step whose transfer function is not
    known; `area_means`: its samples are known to be means over their area, which blurs too. `gain`
    is what a uniform scene is multiplied by, None where that is left to chance (a gain error as
    printed); `levels` are recipes of the `LevelChange` of each stage whose gain depends on the
    picture, and `gain_before` the gain up to the first of these. `reflectance` is that of a sample
    of 1 of the source, where the scene is lit surfaces.
    """

    stages: tuple[Stage, ...]
    grid: Grid
    source_grid: Grid
    source: Recipe
    gain: float | None = 1.0
    area_means: bool = False
    levels: tuple[Recipe, ...] = ()
    gain_before: float = 1.0
    reflectance: float | None = None

    @property
    def factors(self) -> tuple[Factor, ...]:
        return tuple(factor for stage in self.stages for factor in stage.factors)

    def part(self, part: str) -> tuple[Stage, ...]:
        """The stages with the factors of their MTF, or of their PTF, alone."""
        stages = (
            Stage(s.label, tuple(f for f in s.factors if f.part == part)) for s in self.stages
        )
        return tuple(stage for stage in stages if stage.factors)


def transfer_of(image: Image, *, of_camera: bool = False) -> ImageTransfer:
    """Every transfer function between the scene and the picture.

    Interpolation counts with the mean over its samples; what folds back from beyond the Nyquist
    frequency is no part of it. `of_camera`: gain and levels count from what reaches the camera on,
    behind the air, as its data sheet has them; the transfer functions are all the same.
    """
    grid = image.grid()
    factors: list[Factor] = []
    recipe, here, gain, known = image.recipe, grid, 1.0, True
    levels: list[Recipe] = []
    gain_before, counted = 1.0, True
    reflectance: float | None = None
    while (lineage := lineage_of(recipe)) is not None and lineage.picture is not None:
        change = lineage.linear
        before = change.grid_before(here)
        factors = [*change.transfer(before, here, recipe.node), *factors]
        reflectance = change.of_reflectance
        counted = counted and not (of_camera and change.before_camera)
        if counted:
            gain *= change.gain
            gain_before *= change.gain
            if change.level is not None:
                levels.insert(0, change.level)
                gain_before = 1.0
            known = known and not change.by_chance
        recipe, here = lineage.picture, before
    return ImageTransfer(
        stages_of(tuple(factors)),
        grid,
        here,
        recipe,
        gain if known else None,
        area_means=lineage is not None and lineage.area_means,
        levels=tuple(levels),
        gain_before=gain_before,
        reflectance=reflectance,
    )
