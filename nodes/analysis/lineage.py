"""What a picture has gone through: its transfer functions and noises, read off its recipe."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array, Vector
from core.chain.back_transformed import Delivered
from core.chain.noise_power import NoisePower, spectrum_of
from core.chain.random_fields import Remaking, Stream
from core.chain.step_lineage import AtStep, Lineage, Linear, Noise, lineage_of
from core.chain.wires import Image, SampledTransfer
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.machine import amount_text
from core.physics.noise.noise_components import NoiseVariances
from core.records import dataclass, field, replace
from core.transfer.factors import Factor, Grid, Part, factor_at


@dataclass(frozen=True)
class Line:
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
    label: str
    factors: tuple[Factor, ...]

    @property
    def key(self) -> str:
        """Content key; a curve carries its name, so the name counts."""
        return "/".join((self.label, *(factor.key for factor in self.factors)))


Stages = tuple[Stage, ...]


def stages_of(factors: tuple[Factor, ...]) -> Stages:
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


def all_along(work: Work, stages: Stages, line: Line, frequency: Vector) -> Vector:
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
        frequency = np.arange(highest_x + 1) * sampled.interval_x
        if line.across == 0.0:
            frequency = np.arange(highest_y + 1) * sampled.interval_y
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


@dataclass(frozen=True)
class ImageTransfer:
    """The linear stages of a picture, in order, each under a name of its own.

    `source` makes the scene's samples, perhaps means over their area, or is a step whose transfer
    function is not known. `gain` is what a uniform scene is multiplied by, None where that is left
    to chance; `levels` are recipes of the `LevelChange` of each stage whose gain depends on the
    picture, `gain_before` the gain up to the first. `reflectance` is that of a source's sample of
    1, if lit.
    """

    stages: Stages
    grid: Grid
    source_grid: Grid
    source: Recipe
    gain: float | None
    area_means: bool
    levels: tuple[Recipe, ...]
    gain_before: float
    reflectance: float | None

    @property
    def factors(self) -> tuple[Factor, ...]:
        return tuple(factor for stage in self.stages for factor in stage.factors)

    def part(self, part: str) -> Stages:
        stages = (
            Stage(s.label, tuple(f for f in s.factors if f.part == part)) for s in self.stages
        )
        return tuple(stage for stage in stages if stage.factors)


def transfer_of(image: Image, *, of_camera: bool = False) -> ImageTransfer:
    """Every transfer function between the scene and the picture.

    What interpolation folds back from beyond the Nyquist frequency is no part of it. `of_camera`:
    gain and levels count from behind the air on, as a data sheet has them.
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


# The noises of a picture, as each arrives there: predicted from the chain, no noise drawn.


@dataclass(frozen=True)
class NoiseTerm:
    """One noise as it arrives, temporal or a fixed pattern; `variances` in the picture's unit²."""

    node: str
    name: str
    temporal: bool
    variances: NoiseVariances


@dataclass(frozen=True)
class ImageNoise:
    """Every noise of a picture, in the order in which they arise.

    `mean` is that of the picture without noise. What lies before the nodes of `unknown` is not
    counted. `spectrum` is the power of all temporal noise in equal cells up to Nyquist's
    frequencies, (along, across).
    """

    terms: tuple[NoiseTerm, ...]
    mean: float
    unknown: tuple[str, ...]
    spectrum: Array | None = field(compare=False)

    @property
    def total(self) -> NoiseVariances:
        return sum((term.variances for term in self.terms), NoiseVariances())

    def require_known(self) -> None:
        if self.unknown:
            raise DataError(
                f"the noise after {', '.join(self.unknown)} cannot be computed: connect a picture "
                "from an earlier stage"
            )


@dataclass(frozen=True, eq=False)
class NoiseOf(Recipe):
    """The recipe of a picture's `ImageNoise`.

    `uniform`: with the gain errors of detectors as they show on a uniform field of the picture's
    mean, where those of one detector are no pattern; else as they show on the scene.
    """

    image: Image
    node: str | None = field(default=None, compare=False)
    uniform: bool = False

    def _content(self) -> tuple[object, ...]:
        image = self.image
        return (image.key, image.interval_x_mrad, image.interval_y_mrad, self.uniform)

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        return (self._mean_of,)

    @cached_property
    def _mean_of(self) -> Recipe:
        try:
            return noise_free(self.image.recipe)
        except DataError:  # with a gain error as printed, nothing is left without it
            return self.image.recipe

    @property
    def in_words(self) -> str:
        return "propagating noise and fixed patterns through filters"

    @property
    def in_blocks(self) -> bool:
        """Where no noise is filtered on its way, the power of each is a number."""
        return not self._filtered

    @cached_property
    def _filtered(self) -> bool:
        return not _by_samples(self.image.recipe)

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """What is looked at on the way to the picture too."""
        return (self._mean_of, *_needed(self.image.recipe, self.uniform))

    def first(self, work: Work) -> tuple[Recipe, ...]:
        """The picture without noise, and the noises behind the transform it comes from."""
        return (self._mean_of, *_behind(self.image.recipe, self.uniform))

    def compute(self, work: Work) -> ImageNoise:
        picture, shape = self.image.recipe, self.image.shape
        noises, unknown = _followed(work, picture, shape, self.uniform, self._filtered)
        if any(noise.pattern for noise in noises):
            noises = self._with_patterns(work, noises)
        terms = tuple(
            NoiseTerm(one.node, one.name, one.temporal, one.power.components(temporal=one.temporal))
            for one in noises
        )
        mean = float(np.mean(work.value(self._mean_of), dtype=np.float64))
        spectrum = spectrum_of([noise.power for noise in noises if noise.temporal])
        return ImageNoise(terms, mean, tuple(dict.fromkeys(unknown)), spectrum)

    def _with_patterns(self, work: Work, noises: list[Noise]) -> list[Noise]:
        picture = self.image.recipe
        if work.blocks is not None and work.blocks.disk.wants(self.image.shape, np.float64):
            names = ", ".join(dict.fromkeys(noise.name for noise in noises if noise.pattern))
            raise DataError(
                f"fixed-pattern noise ({names}) of {self.image.rows} × {self.image.columns} "
                "samples must be computed in one piece, but "
                f"{amount_text(work.blocks.disk.memory_bytes)} of memory is not enough",
                hint="raise the memory limit with --memory",
            )
        without = noise_free(picture)
        alone = [one.pattern and noise_free(picture, but=one.pattern) for one in noises]
        with work.hold([without, *(one for one in alone if one is not None)]) as release:
            clean = work.value(without)

            def seen(noise: Noise, recipe: Recipe | None) -> Noise:
                if recipe is None:
                    return noise
                pattern = np.subtract(work.value(recipe), clean, dtype=float)
                release([recipe])
                return replace(noise, power=NoisePower.of_pattern(pattern))

            return [seen(*pair) for pair in zip(noises, alone, strict=True)]


def _way_up(recipe: Recipe) -> Iterator[tuple[Recipe, Lineage | None]]:
    """A picture and those it stems from, up to a filtered one or where nothing is known."""
    while True:
        lineage = lineage_of(recipe)
        yield recipe, lineage
        if isinstance(recipe, Delivered) or lineage is None or lineage.picture is None:
            return
        recipe = lineage.picture


def _behind(recipe: Recipe, uniform: bool) -> tuple[Recipe, ...]:
    *_, (last, _) = _way_up(recipe)
    return (_DeliveredNoise(last, uniform),) if isinstance(last, Delivered) else ()


def _needed(recipe: Recipe, uniform: bool) -> tuple[Recipe, ...]:
    looked_at = (
        one for _, lineage in _way_up(recipe) if lineage is not None for one in lineage.looks_at
    )
    return (*looked_at, *_behind(recipe, uniform))


Followed = tuple[list[Noise], list[str]]
"""Noises, and the nodes through which none could be followed."""


def _followed(
    work: Work, recipe: Recipe, shape: tuple[int, int], uniform: bool, filtered: bool = True
) -> Followed:
    """Walk up a picture's recipe, and down again with the noises on the way."""
    noises, unknown = list[Noise](), list[str]()
    way: list[tuple[Recipe, Lineage, tuple[int, int]]] = []
    for upstream, lineage in _way_up(recipe):
        work.check()
        if isinstance(upstream, Delivered):
            noises, unknown = work.value(_DeliveredNoise(upstream, uniform))
        elif lineage is None or lineage.picture is None:
            unknown = _lost(upstream)
        else:
            way.append((upstream, lineage, shape))
            shape = lineage.linear.size_before(*shape)
    for step, lineage, shape in reversed(way):
        noises = _carried(work, lineage.linear, noises)
        if lineage.noise is not None:
            assert isinstance(step, Step)
            at = AtStep(work, step, *shape, tuple(noises), uniform, filtered)
            noises = [*noises, *lineage.noise.at(at)]
    return noises, unknown


def _carried(work: Work, change: Linear, noises: list[Noise]) -> list[Noise]:
    carried = (
        (noise, change.carried(work, noise.power, temporal=noise.temporal)) for noise in noises
    )
    return [replace(noise, power=power) for noise, power in carried if power is not None]


def _lost(recipe: Recipe) -> list[str]:
    """Nothing is known to come through; reported only where there was noise to be followed."""
    noisy = any(_is_noisy(source) for source in recipe.inputs)
    return [recipe.node or "a node"] if noisy else []


@dataclass(frozen=True, eq=False)
class _DeliveredNoise(Recipe):
    """The noises in a filtered picture: a value of its own, for edits of what follows it."""

    recipe: Delivered
    uniform: bool
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.recipe.key, self.uniform

    @property
    def made_of(self) -> tuple[Recipe, ...]:
        return (self.recipe,)

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """What is looked at on the way to what is filtered, and what laws are bound to."""
        source = self.recipe.magnitude.image
        before = () if source is None else _needed(source.recipe, self.uniform)
        return (*self.recipe.bound, *before)

    def first(self, work: Work) -> tuple[Recipe, ...]:
        source = self.recipe.magnitude.image
        if source is None or not self.recipe.one_source:
            return ()
        return _behind(source.recipe, self.uniform)

    def compute(self, work: Work) -> Followed:
        lineage = lineage_of(self.recipe)
        if lineage is None or lineage.picture is None:
            return [], _lost(self.recipe)
        size = self.recipe.magnitude.grid.shape
        noises, unknown = _followed(work, lineage.picture, size, self.uniform)
        return _carried(work, lineage.linear, noises), unknown


def _by_samples(picture: Recipe) -> bool:
    """Whether every noise arises behind the last filter, and all are known block by block."""
    for recipe, lineage in _way_up(picture):
        if lineage is None or lineage.picture is None:
            return True
        if lineage.noise is not None and not lineage.noise.in_blocks:
            return False
        if not _is_noisy(lineage.picture):
            return True
        if isinstance(recipe, Delivered) or not lineage.linear.by_sample:
            return False
    return True


def _is_noisy(recipe: Recipe) -> bool:
    seen, waiting = {recipe.key}, [recipe]
    while waiting:
        current = waiting.pop()
        if isinstance(current, Step) and any(isinstance(v, Stream) for _, v in current.parameters):
            return True
        fresh = [one for one in current.inputs if one.key not in seen]
        seen.update(one.key for one in fresh)
        waiting += fresh
    return False


# The picture without noise: what its noise is measured against.


def noise_free(recipe: Recipe, *, but: Recipe | None = None) -> Recipe:
    """The picture with noises as expected, nothing rounded; the step `but` keeps what it adds."""

    def change(part: Recipe) -> Recipe | None:
        lineage = lineage_of(part)
        if lineage is None or lineage.noise is None or lineage.picture is None:
            return None
        picture = made.of(lineage.picture)
        alone = but is not None and part.key == but.key
        return lineage.noise.on(picture) if alone else lineage.noise.free(picture)

    made = Remaking(change)
    return made.of(recipe)
