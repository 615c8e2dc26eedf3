"""Carrying recipes out: the store, the numerical policy, threads, progress and cancelling."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from core.arithmetic import watched
from core.errors import Cancelled, ImagechainError
from core.policy import Policy
from core.recipes import Recipe
from core.region import Region
from core.store import Store
from core.tally import Tally
from core.workers import Workers

Progress = Callable[[str | None], None]


class Work:
    """One evaluation: turns recipes into values.

    Parameters
    ----------
    policy : Policy
        Precision, tolerance and number of threads.
    store : Store
        Where values are kept; may be shared by several evaluations.
    cancel : threading.Event, optional
        Set from another thread to stop at the next block of work.
    progress : callable, optional
        Called with a node's id whenever one of its recipes is about to be computed.
    workers : Workers, optional
        Threads to work in; may be shared like the store.
    """

    def __init__(
        self,
        policy: Policy,
        store: Store,
        cancel: threading.Event | None = None,
        progress: Progress | None = None,
        workers: Workers | None = None,
    ) -> None:
        self.policy = policy
        self._workers = workers if workers is not None else Workers()
        self.store = store
        self.tally = Tally()
        self._cancel = cancel
        self._progress = progress

    def value(self, recipe: Recipe) -> Any:
        """The value of a recipe, from the store or computed now.

        Raises
        ------
        Cancelled
            When the caller has asked to stop.
        """
        self.tally.asked[recipe.key] = recipe
        return self.store.get(f"{recipe.key}/{self.policy.key}", lambda: self._compute(recipe))

    def part(self, recipe: Recipe, region: Region) -> Any:
        """The samples of a picture in a region; what is no array comes whole.

        They are cut from the whole where it is known already or has to be made, and the same to
        the bit where they are made alone.
        """
        key = f"{recipe.key}/{self.policy.key}"
        if recipe.in_parts and self.store.peek(key) is None:
            self.tally.parts[recipe.key, region] = recipe
            return self.store.get(f"{key}/{region}", lambda: self._compute(recipe, region))
        value = self.value(recipe)
        if not isinstance(value, np.ndarray):
            return value
        self.tally.parts[recipe.key, region] = recipe
        cut = region.cut(value)
        cut.flags.writeable = False
        return cut

    def parts(self, recipes: Sequence[Recipe], region: Region) -> list[Any]:
        """The same region of several pictures.

        Those that only come whole are made first: what they are made of is then known, and parts
        of it need not be made once more.
        """
        order = sorted(range(len(recipes)), key=lambda index: recipes[index].in_parts)
        found = {index: self.part(recipes[index], region) for index in order}
        return [found[index] for index in range(len(recipes))]

    def check(self) -> None:
        """Raise `Cancelled` if the caller has asked to stop."""
        if self._cancel is not None and self._cancel.is_set():
            raise Cancelled("stopped on request")

    def each(self, function: Callable[[Any], None], items: Sequence[Any]) -> None:
        """Call `function` on every item, in threads; items must write to different places."""

        def one(item: Any) -> None:
            self.check()
            with watched(None):  # a thread of the pool does not know that it is watched
                function(item)

        self._workers.each(one, items, self.policy.workers)

    def _compute(self, recipe: Recipe, region: Region | None = None) -> Any:
        self.tally.computed.add(recipe.key if region is None else (recipe.key, region))
        self.check()
        if self._progress is not None:
            self._progress(recipe.node)
        try:
            with watched(recipe.node):
                if region is not None:
                    return recipe.compute_part(self, region)
                return recipe.compute(self)
        except ImagechainError as error:
            if recipe.node is None:
                raise
            raise error.at(recipe.node) from error
