"""The noises of a picture, as each arrives there: predicted from the chain, no noise drawn."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from core.delivered import Delivered, block_combine
from core.errors import DataError
from core.grid import Grid
from core.noise_power import Array, NoisePower, Operator
from core.noise_spectrum import spectrum_of
from core.physics.noise_components import NoiseVariances, components_of_moments
from core.planes import Axes
from core.recipes import Recipe, Step
from core.values import Image
from core.work import Work
from nodes.analysis.lineage import noise_sources as sources
from nodes.analysis.lineage.noise_free import noise_free
from nodes.analysis.lineage.transfer import PASSING
from nodes.analysis.spatial_blur import blurred
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
        Mean of the picture, noise and all.
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
        """The picture, of which its mean is taken."""
        return (self.image.recipe,)

    def compute(self, work: Work) -> ImageNoise:
        """Follow every noise to the picture."""
        known = _Follow(work, self.uniform)
        found = known.to(self.image.recipe, *self.image.shape)
        if any(each.pattern for each in found):
            clean = work.value(noise_free(self.image.recipe))
            found = [self._seen(work, each, clean) for each in found]
        terms = tuple(
            NoiseTerm(each.node, each.name, each.temporal, _components(each)) for each in found
        )
        mean = sources.mean_of(work, self.image.recipe)
        spectrum = spectrum_of([each.power for each in found if each.temporal])
        return ImageNoise(terms, mean, tuple(dict.fromkeys(known.unknown)), spectrum)

    def _seen(self, work: Work, noise: sources.Noise, clean: Array) -> sources.Noise:
        """A known pattern as it shows in the picture."""
        if noise.pattern is None:
            return noise
        alone = work.value(noise_free(self.image.recipe, but=noise.pattern.step))
        return replace(noise, power=NoisePower.of_pattern(np.subtract(alone, clean, dtype=float)))


def _components(noise: sources.Noise) -> NoiseVariances:
    power = noise.power
    return components_of_moments(
        moments=power.moments(), rows=power.rows, columns=power.columns, temporal=noise.temporal
    )


class _Follow:
    """Goes up a picture's recipe, and down again with the noises met."""

    def __init__(self, work: Work, uniform: bool = False) -> None:
        self._work = work
        self._uniform = uniform
        self.unknown: list[str] = []

    def to(self, recipe: Recipe, rows: int, columns: int) -> list[sources.Noise]:
        """All noises in a picture of this size."""
        self._work.check()
        if isinstance(recipe, Delivered):
            behind: _Behind = self._work.value(_DeliveredNoise(recipe, self._uniform))
            self.unknown += behind.unknown
            return list(behind.noises)
        if not isinstance(recipe, Step) or not recipe.inputs:
            return []
        given, values = recipe.inputs[0], dict(recipe.parameters)
        if recipe.function in PASSING:
            before = self.to(given, rows, columns)
            if recipe.function is read_out and values["model"] == "literal":
                # The gain error as printed scales the whole picture.
                mean = self._work.value(recipe.inputs[1]).mean
                before = [_scaled(each, values["gain_percent"] / 100.0 * mean) for each in before]
            uniform = self._uniform
            return [*before, *sources.arising(self._work, recipe, rows, columns, before, uniform)]
        if recipe.function is filtered_lines:
            axes: Axes = "mirrored" if values["edges"] == "reflect" else "periodic"
            return self._filtered(
                self.to(given, rows, columns), values["factors"], values["grid"], axes
            )
        if recipe.function is blurred:
            settings = dict(recipe.inputs[1].parameters)  # type: ignore[attr-defined]
            axes = "mirrored" if values["edges"] == "reflect" else "periodic"
            return self._filtered(
                self.to(given, rows, columns), settings["factors"], settings["grid"], axes
            )
        if recipe.function is block_combine:
            return self._combined(recipe, values)
        if recipe.function is resampled:
            return self._resampled(given, values)
        return self._lost(recipe)

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

    def _combined(self, recipe: Step, values: dict[str, Any]) -> list[sources.Noise]:
        x, y = values["factor_x"], values["factor_y"]
        shape = self._work.value(recipe.inputs[0]).shape  # some rows may have been cropped
        before = self.to(recipe.inputs[0], *shape)
        behind = [replace(each, power=each.power.averaged(x, y)) for each in before]
        return [_scaled(each, x * y) for each in behind] if values["mode"] == "sum" else behind

    def _resampled(self, given: Recipe, values: dict[str, Any]) -> list[sources.Noise]:
        old, new, order = values["old"], values["new"], values["order"]
        before = self.to(given, *old)
        return [
            replace(
                each,
                power=each.power.resampled(
                    new,
                    interpolator(old[0], new[0], order),
                    interpolator(old[1], new[1], order),
                ),
            )
            for each in before
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

    def compute(self, work: Work) -> _Behind:
        """Follow the noises through its transfer functions."""
        known = _Follow(work, self.uniform)
        noises = tuple(known.delivered(self.recipe))
        return _Behind(noises, tuple(known.unknown))


def _scaled(noise: sources.Noise, factor: float) -> sources.Noise:
    return replace(noise, power=noise.power.scaled(factor))


def interpolator(old: int, new: int, order: int) -> Operator:
    """Interpolation of columns of samples as a linear operator."""
    base, further = taps(old, new, order)

    def interpolated(waves: Array) -> Array:
        total = waves[base]
        for index, weight in further:
            total = total + weight[:, np.newaxis] * (waves[index] - waves[base])
        return total

    return interpolated
