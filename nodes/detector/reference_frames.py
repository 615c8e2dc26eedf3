"""What a camera gives of a uniform reference: its own recipe, with the scene replaced."""

from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.frame_sequence import Remaking, at_frame
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks
from core.evaluation.work import Work
from core.lineage.step_lineage import Lineage, lineage_of

Array = NDArray[Any]


def seen_by_camera(picture: Recipe) -> Recipe | None:
    """The picture that enters the first node that adds noise to samples; None without one.

    Samples begin behind the transform that the optics' picture comes from, if there is one.
    """
    way = list(_samples(picture))
    noisy = {step.node for step, lineage in way if lineage.noise is not None}
    entered = [lineage.picture for step, lineage in way if step.node in noisy]
    return entered[-1] if entered else None


def _samples(recipe: Recipe) -> Iterator[tuple[Recipe, Lineage]]:
    while isinstance(recipe, Step):
        lineage = lineage_of(recipe)
        if lineage is None or lineage.picture is None:
            return
        yield recipe, lineage
        recipe = lineage.picture


def of_uniform(picture: Recipe, seen: Recipe, *, radiance: float, node: str) -> Recipe:
    """The camera's picture of a uniform radiance in the place of what it has seen."""
    flat = Step.of(uniform_like, seen, radiance=radiance, node=node)
    return Remaking(lambda part: flat if part.key == seen.key else None).of(picture)


@in_blocks()
@ends_lineage
def uniform_like(work: Work, picture: Array, *, radiance: float) -> Array:
    """A uniform picture of the same size."""
    uniform: Array = work.empty(picture.shape)
    uniform.fill(radiance)
    return uniform


@dataclass(frozen=True, eq=False)
class MeanFrame(Recipe):
    """Mean of several frames, in double. A sequence leaves it as it is: it is taken once.

    Parameters
    ----------
    picture : Recipe
        Frame 0.
    start, frames : int
        Number of the first of them, and how many.
    """

    picture: Recipe
    start: int
    frames: int
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.picture.key, self.start, self.frames

    @property
    def in_words(self) -> str:
        """What takes pictures as a whole."""
        return "the mean of reference frames"

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """The first of them, and what they share: the pattern of the pixels."""
        first, next_one = (at_frame(self.picture, self.start + step) for step in (0, 1))
        return (first, *_shared(first, {recipe.key for recipe in _all(next_one)}))

    def compute(self, work: Work) -> Array:
        """Take the frames one after the other; none is kept."""
        numbers = range(self.start, self.start + self.frames)
        total: Array | None = None
        for made in work.one_by_one(at_frame(self.picture, number) for number in numbers):
            work.check()
            total = np.array(made, np.float64) if total is None else total + made
        assert total is not None
        total /= self.frames
        return total


def _all(recipe: Recipe) -> Iterator[Recipe]:
    """A recipe and all it is made of, each once."""
    seen: dict[str, Recipe] = {}
    left = [recipe]
    while left:
        one = left.pop()
        if one.key not in seen:
            seen[one.key] = one
            left += one.inputs
    return iter(seen.values())


def _shared(recipe: Recipe, keys: Set[str]) -> Iterator[Recipe]:
    """What of those keys a recipe is made of, without what these are made of."""
    seen: set[str] = set()
    left = list(recipe.inputs)
    while left:
        one = left.pop()
        if one.key in seen:
            continue
        seen.add(one.key)
        if one.key in keys:
            yield one
        else:
            left += one.inputs
