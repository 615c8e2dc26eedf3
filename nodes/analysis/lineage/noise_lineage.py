"""The noises of a picture, as each arrives there: predicted from the chain, no noise drawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from core.chain.back_transformed import Delivered
from core.chain.frame_sequence import Remaking
from core.chain.linear_change import Linear
from core.chain.noise_power import Array, NoisePower, spectrum_of
from core.chain.random_fields import Stream
from core.chain.step_lineage import AtStep, Lineage, Noise, lineage_of
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.machine import amount_text
from core.physics.noise.noise_components import NoiseVariances, components_of_moments


@dataclass(frozen=True)
class NoiseTerm:
    """One noise as it arrives in the picture; one that is not `temporal` is a fixed pattern.

    `variances` are its components in the picture's unit squared.
    """

    node: str
    name: str
    temporal: bool
    variances: NoiseVariances


@dataclass(frozen=True)
class ImageNoise:
    """Every noise of a picture, in the order in which they arise.

    `mean` is that of the picture without any noise: an error of gain or bias, or a few samples'
    deviates, do not move it; where the gain scales the whole picture as printed, of the picture
    itself. What lies before the nodes of `unknown` is not counted. `spectrum` is the power of all
    temporal noise in equal cells up to Nyquist's frequencies, (along, across).
    """

    terms: tuple[NoiseTerm, ...]
    mean: float
    unknown: tuple[str, ...] = ()
    spectrum: Array | None = field(default=None, compare=False)

    @property
    def total(self) -> NoiseVariances:
        """Of all noises together."""
        return sum((term.variances for term in self.terms), NoiseVariances())

    def require_known(self) -> None:
        """Refuse a picture of which not all noise is known (`DataError`)."""
        if self.unknown:
            raise DataError(
                f"the noise after {', '.join(self.unknown)} cannot be computed: connect the "
                "picture before it"
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
        return "computing noise that passes filters and patterns"

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
        known = _Follow(work, self.uniform, self._filtered)
        noises = known.to(self.image.recipe, *self.image.shape)
        if any(noise.pattern for noise in noises):
            noises = self._with_patterns(work, noises)
        terms = tuple(
            NoiseTerm(noise.node, noise.name, noise.temporal, _components(noise))
            for noise in noises
        )
        mean = float(np.mean(work.value(self._mean_of), dtype=np.float64))
        spectrum = spectrum_of([noise.power for noise in noises if noise.temporal])
        return ImageNoise(terms, mean, tuple(dict.fromkeys(known.unknown)), spectrum)

    def _with_patterns(self, work: Work, noises: list[Noise]) -> list[Noise]:
        """Known patterns as they show in the picture."""
        picture = self.image.recipe
        if work.blocks is not None and work.blocks.disk.wants(self.image.shape, np.float64):
            names = ", ".join(dict.fromkeys(noise.name for noise in noises if noise.pattern))
            raise DataError(
                f"a known pattern ({names}) of {self.image.rows} × {self.image.columns} "
                "samples must be computed in one piece, and "
                f"{amount_text(work.blocks.disk.memory_bytes)} of memory is too little for it",
                hint="give more with --memory",
            )
        without = noise_free(picture)
        alone = [
            noise_free(picture, but=noise.pattern) if noise.pattern else None for noise in noises
        ]
        with work.hold(
            [without, *(picture_alone for picture_alone in alone if picture_alone is not None)]
        ) as held:
            clean = work.value(without)

            def seen(noise: Noise, recipe: Recipe | None) -> Noise:
                if recipe is None:
                    return noise
                pattern = np.subtract(work.value(recipe), clean, dtype=float)
                held.release([recipe])
                return replace(noise, power=NoisePower.of_pattern(pattern))

            return [seen(*pair) for pair in zip(noises, alone, strict=True)]


def _components(noise: Noise) -> NoiseVariances:
    power = noise.power
    return components_of_moments(
        moments=power.moments(), rows=power.rows, columns=power.columns, temporal=noise.temporal
    )


def _way_up(recipe: Recipe) -> Iterator[tuple[Recipe, Lineage | None]]:
    """A picture and those it stems from, up to a filtered one or where nothing is known."""
    while True:
        lineage = lineage_of(recipe)
        yield recipe, lineage
        if isinstance(recipe, Delivered) or lineage is None or lineage.picture is None:
            return
        recipe = lineage.picture


def _behind(recipe: Recipe, uniform: bool) -> tuple[Recipe, ...]:
    """The noises behind the transform that a picture comes from, if any."""
    *_, (last, _) = _way_up(recipe)
    return (_DeliveredNoise(last, uniform),) if isinstance(last, Delivered) else ()


def _needed(recipe: Recipe, uniform: bool) -> tuple[Recipe, ...]:
    """What `_Follow.to` reads."""
    looked_at = (
        one for _, lineage in _way_up(recipe) if lineage is not None for one in lineage.looks_at
    )
    return (*looked_at, *_behind(recipe, uniform))


class _Follow:
    """Walks up a picture's recipe, and down again with the noises on the way."""

    def __init__(self, work: Work, uniform: bool = False, filtered: bool = True) -> None:
        self._work = work
        self._uniform = uniform
        self._filtered = filtered
        self.unknown: list[str] = []

    def to(self, recipe: Recipe, rows: int, columns: int) -> list[Noise]:
        noises: list[Noise] = []
        way: list[tuple[Recipe, Lineage, int, int]] = []
        for upstream, lineage in _way_up(recipe):
            self._work.check()
            if isinstance(upstream, Delivered):
                behind: _Behind = self._work.value(_DeliveredNoise(upstream, self._uniform))
                self.unknown += behind.unknown
                noises = list(behind.noises)
            elif lineage is None or lineage.picture is None:
                noises = self._lost(upstream)
            else:
                way.append((upstream, lineage, rows, columns))
                rows, columns = lineage.linear.size_before(rows, columns)
        for step, lineage, rows, columns in reversed(way):
            noises = self._changed(lineage.linear, noises)
            if lineage.noise is not None:
                assert isinstance(step, Step)
                how = self._uniform, self._filtered
                at = AtStep(self._work, step, rows, columns, tuple(noises), *how)
                noises = [*noises, *lineage.noise.at(at)]
        return noises

    def delivered(self, recipe: Delivered) -> list[Noise]:
        lineage = lineage_of(recipe)
        if lineage is None or lineage.picture is None:
            return self._lost(recipe)
        before = self.to(lineage.picture, *recipe.magnitude.grid.shape)
        return self._changed(lineage.linear, before)

    def _changed(self, change: Linear, noises: list[Noise]) -> list[Noise]:
        """The noises behind a linear change; those that end there are left out."""
        carried = (
            (noise, change.carried(self._work, noise.power, temporal=noise.temporal))
            for noise in noises
        )
        return [replace(noise, power=power) for noise, power in carried if power is not None]

    def _lost(self, recipe: Recipe) -> list[Noise]:
        """Nothing is known to come through; reported only where there was noise to be followed."""
        if any(_is_noisy(source) for source in recipe.inputs):
            self.unknown.append(recipe.node or "a node")
        return []


@dataclass(frozen=True)
class _Behind:
    """Noises behind a transform, and the nodes through which none could be followed."""

    noises: tuple[Noise, ...]
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

    def compute(self, work: Work) -> _Behind:
        known = _Follow(work, self.uniform)
        noises = tuple(known.delivered(self.recipe))
        return _Behind(noises, tuple(known.unknown))


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
    """Whether anything a recipe is made of is drawn at random."""
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
    """The same picture with every noise at its expected value, and nothing rounded.

    The step `but` keeps what it adds. Where a gain error as printed scales the whole picture, that
    is refused (`DataError`).
    """

    def change(part: Recipe) -> Recipe | None:
        lineage = lineage_of(part)
        if lineage is None or lineage.noise is None:
            return None
        picture = made.of(lineage.noise.picture)
        alone = but is not None and part.key == but.key
        return lineage.noise.on(picture) if alone else lineage.noise.free(picture)

    made = Remaking(change)
    return made.of(recipe)
