"""Work beside a pass: it takes what the pass's store holds, and leaves nothing there.

The pictures of a trade-off would crowd out what the next edit of the network needs again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from core.evaluation.store import Store
from core.evaluation.work import Work

SIDE_BYTES = 1 << 28


class SideStore(Store):
    """Finds values in another store too, and keeps its own to itself."""

    def __init__(self, base: Store, capacity_bytes: int = SIDE_BYTES) -> None:
        super().__init__(capacity_bytes)
        self._base = base

    def peek(self, key: str, default: Any = None) -> Any:
        """The value of `key` in either store, else `default`."""
        value = super().peek(key, self)
        return self._base.peek(key, default) if value is self else value


class SideWork(Work):
    """An evaluation that stops when another one is to stop, and works in its threads."""

    def __init__(self, work: Work) -> None:
        super().__init__(work.policy, SideStore(work.store))
        self._work = work

    def check(self) -> None:
        """Raise `Cancelled` if the other one is to stop."""
        self._work.check()

    def for_each(self, function: Callable[[Any], None], items: Sequence[Any]) -> None:
        """Call `function` on every item, in the other one's threads."""
        self._work.for_each(function, items)
