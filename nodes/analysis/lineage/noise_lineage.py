"""The noises of a picture, as each arrives there: predicted from the chain, no noise drawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from core.chain.back_transformed import Delivered, block_combine
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.noise.noise_power import Array, NoisePower, Operator
from core.noise.noise_spectrum import spectrum_of
from core.physics.noise.noise_components import NoiseVariances, components_of_moments
from core.transfer.grid import Edges, Grid
from core.transfer.planar_blocks import Axes
from nodes.analysis.lineage import noise_sources as sources
from nodes.analysis.lineage.noise_free import noise_free
from nodes.analysis.lineage.transfer_lineage import PASSING
from nodes.analysis.space.spatial_blur import blurred
from nodes.electronics.noise_steps import filtered_lines, read_out
from nodes.transform.interpolate import resampled, taps


@dataclass(frozen=True)
class NoiseTerm:
    """One noise as it arrives in the picture.

    Parameters
    ----------
    node, name : str
        The node that adds it, and what it is there.
    temporal : bool
        Whether it is drawn anew with every frame; else it is a fixed pattern.
    variances : NoiseVariances
        Its components, in the picture's unit squared.
    """

    node: str
    name: str
    temporal: bool
    variances: NoiseVariances


@dataclass(frozen=True)
class Summed:
    """All noises together."""

    variances: NoiseVariances


@dataclass(frozen=True)
class ImageNoise:
    """Every noise of a picture.

    Parameters
    ----------
    terms : tuple of NoiseTerm
        In the order in which they arise.
    mean : float
        Mean of the picture without any noise: an error of gain or bias, or a few samples' deviates,
        do not move it. Where the gain scales the whole picture as printed, of the picture itself.
    unknown : tuple of str
        Nodes through which noise cannot be followed; what lies before them is not counted.
    spectrum : ndarray, optional
        Power of all temporal noise in equal cells up to Nyquist's frequencies, (along, across).
    """

    terms: tuple[NoiseTerm, ...]
    mean: float
    unknown: tuple[str, ...] = ()
    spectrum: Array | None = field(default=None, compare=False)

    @property
    def total(self) -> Summed:
        """Variances of independent noises add."""
        total = NoiseVariances()
        for term in self.terms:
            total += term.variances
        return Summed(total)

    def require_known(self) -> None:
        """Refuse a picture of which not all noise is known (`DataError`)."""
        if self.unknown:
            raise DataError(
                f"noise cannot be followed through {', '.join(self.unknown)}: measure or budget "
                "the picture before it"
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
        """The picture without noise, of which its mean is taken."""
        return (self._mean_of,)

    @cached_property
    def _mean_of(self) -> Recipe:
        try:
            return noise_free(self.image.recipe)
        except DataError:  # with a gain error as printed, nothing is left without it
            return self.image.recipe

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """What is looked at on the way to the picture too."""
        return (self._mean_of, *_asked(self.image.recipe, self.uniform))

    def first(self, work: Work) -> tuple[Recipe, ...]:
        """The picture without noise, and the noises behind the transform it comes from."""
        return (self._mean_of, *_behind(self.image.recipe, self.uniform))

    def compute(self, work: Work) -> ImageNoise:
        """Follow every noise to the picture."""
        known = _Follow(work, self.uniform)
        found = known.to(self.image.recipe, *self.image.shape)
        if any(each.pattern for each in found):
            found = self._with_patterns(work, found)
        terms = tuple(
            NoiseTerm(each.node, each.name, each.temporal, _components(each)) for each in found
        )
        mean = sources.mean_of(work, self._mean_of)
        spectrum = spectrum_of([each.power for each in found if each.temporal])
        return ImageNoise(terms, mean, tuple(dict.fromkeys(known.unknown)), spectrum)

    def _with_patterns(self, work: Work, noises: list[sources.Noise]) -> list[sources.Noise]:
        """Known patterns as they show in the picture."""
        picture = self.image.recipe
        without = noise_free(picture)
        alone = [
            noise_free(picture, but=each.pattern.step) if each.pattern else None for each in noises
        ]
        with work.hold([without, *(each for each in alone if each is not None)]) as held:
            clean = work.value(without)

            def seen(noise: sources.Noise, recipe: Recipe | None) -> sources.Noise:
                if recipe is None:
                    return noise
                pattern = np.subtract(work.value(recipe), clean, dtype=float)
                held.release([recipe])
                return replace(noise, power=NoisePower.of_pattern(pattern))

            return [seen(*each) for each in zip(noises, alone, strict=True)]


def _components(noise: sources.Noise) -> NoiseVariances:
    power = noise.power
    return components_of_moments(
        moments=power.moments(), rows=power.rows, columns=power.columns, temporal=noise.temporal
    )


# Steps through which noises are followed: to their first input.
_FOLLOWED = (*PASSING, filtered_lines, blurred, block_combine, resampled)


def _way_up(recipe: Recipe) -> Iterator[Recipe]:
    """A picture and those it stems from, up to a filtered one or where nothing is known."""
    yield recipe
    while isinstance(recipe, Step) and recipe.inputs and recipe.function in _FOLLOWED:
        recipe = recipe.inputs[0]
        yield recipe


def _behind(recipe: Recipe, uniform: bool) -> tuple[Recipe, ...]:
    """The noises behind the transform that a picture comes from, if any."""
    *_, last = _way_up(recipe)
    return (_DeliveredNoise(last, uniform),) if isinstance(last, Delivered) else ()


def _asked(recipe: Recipe, uniform: bool) -> tuple[Recipe, ...]:
    """What `_Follow.to` asks for."""
    steps = [each for each in _way_up(recipe) if isinstance(each, Step)]
    looked_at = (one for each in steps for one in sources.asked_by(each))
    return (*looked_at, *_behind(recipe, uniform))


class _Follow:
    """Goes up a picture's recipe, and down again with the noises met."""

    def __init__(self, work: Work, uniform: bool = False) -> None:
        self._work = work
        self._uniform = uniform
        self.unknown: list[str] = []

    def to(self, recipe: Recipe, rows: int, columns: int) -> list[sources.Noise]:
        """All noises in a picture of this size."""
        noises: list[sources.Noise] = []
        way: list[tuple[Step, int, int]] = []
        for each in _way_up(recipe):
            self._work.check()
            if isinstance(each, Delivered):
                behind: _Behind = self._work.value(_DeliveredNoise(each, self._uniform))
                self.unknown += behind.unknown
                noises = list(behind.noises)
            elif isinstance(each, Step) and each.inputs and each.function in _FOLLOWED:
                way.append((each, rows, columns))
                rows, columns = self._size_before(each, rows, columns)
            elif isinstance(each, Step) and each.inputs:
                noises = self._lost(each)
        for step, rows, columns in reversed(way):
            noises = self._after(step, noises, rows, columns)
        return noises

    def _size_before(self, step: Step, rows: int, columns: int) -> tuple[int, int]:
        """Size of the picture that a step takes."""
        if step.function is block_combine:
            shape: tuple[int, int] = self._work.value(step.inputs[0]).shape
            return shape  # some rows may have been cropped
        if step.function is resampled:
            old: tuple[int, int] = dict(step.parameters)["old"]
            return old
        return rows, columns

    def _after(
        self, step: Step, before: list[sources.Noise], rows: int, columns: int
    ) -> list[sources.Noise]:
        """All noises in the picture that a step makes."""
        values = dict(step.parameters)
        if step.function is filtered_lines or step.function is blurred:
            settings = values
            if step.function is blurred:
                settings = dict(step.inputs[1].parameters)  # type: ignore[attr-defined]
            axes: Axes = "mirrored" if values["edges"] == "reflect" else "periodic"
            return self._filtered(before, settings["factors"], settings["grid"], axes)
        if step.function is block_combine:
            return _combined(before, values)
        if step.function is resampled:
            return _resampled(before, values)
        if step.function is read_out and values["model"] == "literal":
            # The gain error as printed scales the whole picture.
            mean = self._work.value(step.inputs[1]).mean
            before = [_scaled(each, values["gain_percent"] / 100.0 * mean) for each in before]
        found = sources.arising(self._work, step, rows, columns, before, self._uniform)
        return [*before, *found]

    def delivered(self, recipe: Delivered) -> list[sources.Noise]:
        """All noises in a filtered picture."""
        source = recipe.magnitude.image
        if source is None or not recipe.one_source:
            return self._lost(recipe)
        grid = recipe.magnitude.grid
        before = self.to(source.recipe, grid.rows, grid.columns)
        factors = (*recipe.magnitude.factors, *recipe.phase.factors)
        axes: Axes = "mirrored" if recipe.mirrored else "periodic"
        behind = self._filtered(before, factors, grid, axes, recipe.factor_x, recipe.factor_y)
        if recipe.mode == "sum":
            return [_scaled(each, recipe.factor_x * recipe.factor_y) for each in behind]
        return behind

    def _filtered(
        self,
        noises: list[sources.Noise],
        factors: tuple[Any, ...],
        grid: Grid,
        axes: Axes,
        factor_x: int = 1,
        factor_y: int = 1,
    ) -> list[sources.Noise]:
        return [
            replace(
                each,
                power=each.power.filtered(
                    self._work, factors, grid, axes, factor_x=factor_x, factor_y=factor_y
                ),
            )
            for each in noises
        ]

    def _lost(self, recipe: Recipe) -> list[sources.Noise]:
        """Nothing is known to come through; said only where there was noise to be followed."""
        if any(sources.is_noisy(each) for each in recipe.inputs):
            self.unknown.append(recipe.node or "a node")
        return []


@dataclass(frozen=True)
class _Behind:
    """Noises behind a transform, and the nodes through which none could be followed."""

    noises: tuple[sources.Noise, ...]
    unknown: tuple[str, ...]


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
        """The filtered picture."""
        return (self.recipe,)

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """What is looked at on the way to what is filtered, and what laws are bound to."""
        source = self.recipe.magnitude.image
        before = () if source is None else _asked(source.recipe, self.uniform)
        return (*self.recipe.bound, *before)

    def first(self, work: Work) -> tuple[Recipe, ...]:
        """The noises behind the transform before."""
        source = self.recipe.magnitude.image
        if source is None or not self.recipe.one_source:
            return ()
        return _behind(source.recipe, self.uniform)

    def compute(self, work: Work) -> _Behind:
        """Follow the noises through its transfer functions."""
        known = _Follow(work, self.uniform)
        noises = tuple(known.delivered(self.recipe))
        return _Behind(noises, tuple(known.unknown))


def _combined(noises: list[sources.Noise], values: dict[str, Any]) -> list[sources.Noise]:
    x, y = values["factor_x"], values["factor_y"]
    behind = [replace(each, power=each.power.averaged(x, y)) for each in noises]
    return [_scaled(each, x * y) for each in behind] if values["mode"] == "sum" else behind


def _resampled(noises: list[sources.Noise], values: dict[str, Any]) -> list[sources.Noise]:
    old, new = values["old"], values["new"]
    how = values["order"], values["edges"]
    along, across = (interpolator(old[axis], new[axis], *how) for axis in (0, 1))
    return [replace(each, power=each.power.resampled(new, along, across)) for each in noises]


def _scaled(noise: sources.Noise, factor: float) -> sources.Noise:
    return replace(noise, power=noise.power.scaled(factor))


def interpolator(old: int, new: int, order: int, edges: Edges | None) -> Operator:
    """Interpolation of columns of samples as a linear operator."""
    base, further = taps(old, new, order, edges)

    def interpolated(waves: Array) -> Array:
        total = waves[base]
        for index, weight in further:
            total = total + weight[:, np.newaxis] * (waves[index] - waves[base])
        return total

    return interpolated
