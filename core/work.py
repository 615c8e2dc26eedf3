"""Carrying recipes out: the store, the numerical policy, threads, progress and cancelling."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

from core.arithmetic import watched
from core.errors import Cancelled, ImagechainError
from core.policy import Policy
from core.recipes import Recipe
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

    def _compute(self, recipe: Recipe) -> Any:
        self.tally.computed.add(recipe.key)
        self.check()
        if self._progress is not None:
            self._progress(recipe.node)
        try:
            with watched(recipe.node):
                return recipe.compute(self)
        except ImagechainError as error:
            if recipe.node is None:
                raise
            raise error.at(recipe.node) from error
