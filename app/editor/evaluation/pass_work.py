"""An evaluation that can be stopped, with the node it is at."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from core.errors import Cancelled
from core.evaluation.policy import Policy
from core.evaluation.recipes import Recipe
from core.evaluation.region import Region
from core.evaluation.store import Store
from core.evaluation.work import Work
from core.threads import Workers


class Position:
    """Where a pass is. Written by the worker, read by the window: each field on its own is true.

    Parameters
    ----------
    wanted : int
        Number of queries the pass is to answer.
    must_stop : callable
        Given the position, whether the pass is to stop now.
    """

    def __init__(self, wanted: int, must_stop: Callable[[Position], bool]) -> None:
        self.started = time.perf_counter()
        self.thread = threading.get_ident()
        self.wanted = wanted
        self.done = 0
        self.stopped = False
        self._nodes: list[str | None] = []
        self._must_stop = must_stop

    @property
    def seconds(self) -> float:
        """How long the pass has been going on."""
        return time.perf_counter() - self.started

    @property
    def node(self) -> str | None:
        """The node under computation, None between nodes."""
        nodes = tuple(self._nodes)
        return next((node for node in reversed(nodes) if node), None)

    def check(self) -> None:
        """Raise `Cancelled` if the pass is to stop.

        Raises
        ------
        Cancelled
            From then on each time.
        """
        if self.stopped or self._must_stop(self):
            self.stopped = True
            raise Cancelled("stopped on request")

    def enter(self, node: str | None) -> None:
        """A recipe of that node is computed from now on."""
        self._nodes.append(node)

    def leave(self) -> None:
        """It is done: the computation that needed it goes on."""
        self._nodes.pop()


class PassWork(Work):
    """One evaluation within a pass."""

    def __init__(self, policy: Policy, store: Store, workers: Workers, position: Position) -> None:
        super().__init__(policy, store, workers=workers)
        self._position = position

    def check(self) -> None:
        """Raise `Cancelled` if the pass is to stop."""
        self._position.check()

    def _compute(self, recipe: Recipe, region: Region | None = None) -> Any:
        position = self._position
        if threading.get_ident() != position.thread:
            return super()._compute(recipe, region)
        position.enter(recipe.node)
        try:
            return super()._compute(recipe, region)
        finally:
            position.leave()
