"""The lineage of steps: what analysis needs of one, declared beside its function.

Transfer functions and noises of a picture are read off its recipe, step by step from the picture
back to its source. Of a step six things are needed:

1. Which input is the picture that goes on?              `picture`, by its name in the function
2. Which linear change is made of it?                    `linear`, see `core.chain.linear_change`:
   its transfer function, the sampling before, a noise behind it, a row of an edge behind it
3. Which noises are added, of which power and colour?    `noise`, see `core.chain.step_lineage`
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

What carries no picture on is marked by `core.evaluation.recipes.ends_lineage`. What differs from
frame to frame needs no mark: it is what a `Stream` among the parameters draws, unless fixed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from inspect import Parameter, signature
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from core.chain.linear_change import Linear
from core.chain.noise_power import NoisePower
from core.evaluation.recipes import Recipe, Step, marked
from core.evaluation.work import Work

# Noise where a step adds it: its name, whether it changes in time, its power.

Array = NDArray[Any]
F = TypeVar("F", bound=Callable[..., Any])


def noises_in_blocks(function: F) -> F:
    """Mark a function of a step's noises that holds blocks alone of pictures on disk.

    Their power is one number, and variances of samples are made by `AtStep.by_rows`.
    """
    return marked(in_blocks=True)(function)


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
        """Of independent samples, of one variance or each of its own."""
        power = NoisePower.white(self.rows, self.columns, variance)
        if not self.filtered:
            power = replace(power, variances=None)
        return self.coloured(name, power, temporal=temporal)

    def coloured(self, name: str, power: NoisePower, *, temporal: bool = True) -> Noise:
        """Of this power over the frame's waves."""
        return Noise(self.step.node or "", name, temporal, power)

    def known(self, name: str) -> Noise:
        """A pattern known to the last sample, the same in every frame."""
        none = NoisePower.white(self.rows, self.columns, 0.0)
        return Noise(self.step.node or "", name, False, none, self.step)


_UNCHANGED = Linear()
_POSITIONAL = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)


@dataclass(frozen=True)
class Noises:
    """What a step adds: `at` gives the noises where the step is, which are added to `picture`.

    `on` is the step on another picture, `free` what takes its place on a picture without noise; if
    it `leaves_change`, that makes the step's linear change too. `in_blocks`: whether `at` is marked
    by `noises_in_blocks`.
    """

    at: Callable[[AtStep], list[Noise]]
    on: Callable[[Recipe], Recipe]
    free: Callable[[Recipe], Recipe]
    picture: Recipe
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
    lineage: Lineage | None = recipe.lineage
    return lineage


def picture_step(
    *,
    picture: str = "",
    linear: Callable[..., Linear] | None = None,
    noise: Callable[..., list[Noise]] | None = None,
    looks_at: tuple[str, ...] = (),
    noise_free: Callable[..., Recipe] | None = None,
) -> Callable[[F], F]:
    """Mark a step's function that carries a picture on.

    Parameters
    ----------
    picture : str
        The input that is the picture, the first one if not given.
    linear : callable, optional
        Called as ``linear(*inputs, **parameters)`` with the inputs' recipes.
    noise : callable, optional
        Called as ``noise(at, *inputs, **parameters)`` with the `AtStep`.
    looks_at : tuple of str
        Inputs whose values `noise`, or the linear change, reads.
    noise_free : callable, optional
        Called like `linear`, with the picture without noise in the picture's place: what takes the
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

            blocks = getattr(noise, "in_blocks", False)
            return Noises(at, on, free, inputs[place], noise_free is not None, blocks)

        return marked(lineage=lineage)(function)

    return mark


def source_step(*, area_means: bool) -> Callable[[F], F]:
    """Mark a step's function that begins a picture: all that is made of it starts here."""
    begun = Lineage(None, area_means=area_means)
    return marked(lineage=lambda _: begun)


def _inputs(function: Callable[..., Any]) -> list[str]:
    """Names of the inputs that a step's function takes, after the work."""
    given = signature(function).parameters.values()
    return [parameter.name for parameter in given if parameter.kind in _POSITIONAL][1:]
