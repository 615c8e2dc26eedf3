"""Recipes: how a value is made, without the value.

A recipe has a content key. Two recipes with equal keys give the same value to the last bit, so the
value is made once and shared. Nothing is computed until `Work.value` asks.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from core.keys import content_key

if TYPE_CHECKING:
    from core.work import Work


class Recipe(ABC):
    """Something that can be computed, identified by its content key."""

    node: str | None

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """Recipes whose values this one is made of."""
        return ()

    @cached_property
    def key(self) -> str:
        """Content key; fields declared with ``compare=False`` do not enter it."""
        return content_key(type(self).__qualname__, *self._content())

    @abstractmethod
    def _content(self) -> tuple[object, ...]:
        """What the key is made of."""

    @abstractmethod
    def compute(self, work: Work) -> Any:
        """Make the value; inputs come from `work.value`."""


@dataclass(frozen=True, eq=False)
class Step(Recipe):
    """One function applied to the values of other recipes.

    Parameters
    ----------
    function : callable
        Module-level function called as ``function(work, *values, **parameters)``.
    inputs : tuple of Recipe
        Recipes of the positional values.
    parameters : tuple of (name, value)
        Hashable keyword arguments.
    node : str, optional
        Node an error belongs to.
    """

    function: Callable[..., Any]
    inputs: tuple[Recipe, ...] = ()
    parameters: tuple[tuple[str, Any], ...] = ()
    node: str | None = field(default=None, compare=False)

    @classmethod
    def of(
        cls,
        function: Callable[..., Any],
        *inputs: Recipe,
        node: str | None = None,
        **parameters: Any,
    ) -> Step:
        """Write ``Step.of(f, a, b, sigma=2)`` for f(work, a's value, b's value, sigma=2)."""
        return cls(function, inputs, tuple(sorted(parameters.items())), node)

    def _content(self) -> tuple[object, ...]:
        return self.function, tuple(recipe.key for recipe in self.inputs), self.parameters

    def compute(self, work: Work) -> Any:
        """Evaluate the inputs, then the function."""
        values = [work.value(recipe) for recipe in self.inputs]
        work.check()
        return self.function(work, *values, **dict(self.parameters))
