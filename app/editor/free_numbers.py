"""Which numbers of the network a fit is to determine, and within what limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from PySide6.QtCore import QObject, Signal

from core.network.network import Node


@dataclass(frozen=True)
class FreeNumber:
    """A parameter that is free for a fit; a limit that is None is the parameter's own."""

    node: str
    name: str
    low: float | None = None
    high: float | None = None

    @property
    def place(self) -> tuple[str, str]:
        """Node and parameter."""
        return self.node, self.name

    @property
    def port(self) -> str:
        """As network files name it."""
        return f"{self.node}.{self.name}"


class FreeNumbers(QObject):
    """The free parameters of the open document. No file holds them, and undo leaves them.

    Those of a node that is removed come back with it.

    Signals
    -------
    changed
        Others are free, or their limits differ.
    """

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._numbers: dict[tuple[str, str], FreeNumber] = {}
        self._removed: list[tuple[FreeNumber, Node]] = []

    @property
    def all(self) -> tuple[FreeNumber, ...]:
        """In the order in which they were freed."""
        return tuple(self._numbers.values())

    def has(self, node: str, name: str) -> bool:
        """Whether a parameter is free."""
        return (node, name) in self._numbers

    def put(self, number: FreeNumber) -> None:
        """Free a parameter, or give it other limits."""
        if self._numbers.get(number.place) != number:
            self._numbers[number.place] = number
            self.changed.emit()

    def fix(self, node: str, name: str) -> None:
        """Free it no more."""
        if self._numbers.pop((node, name), None) is not None:
            self.changed.emit()

    def clear(self) -> None:
        """Nothing is free any more."""
        self._removed.clear()
        if self._numbers:
            self._numbers.clear()
            self.changed.emit()

    def follow(
        self,
        name_now: Callable[[str], str],
        before: Mapping[str, Node],
        after: Mapping[str, Node],
    ) -> None:
        """Take the names that nodes have now; what is of no node any more is free no more."""
        numbers = {}
        for one in self._numbers.values():
            now = replace(one, node=name_now(one.node))
            if now.node in after:
                numbers[now.place] = now
            elif one.node in before:
                self._removed.append((one, before[one.node]))
        back = [pair for pair in self._removed if after.get(pair[0].node) == pair[1]]
        for pair in back:
            self._removed.remove(pair)
            numbers.setdefault(pair[0].place, pair[0])
        if numbers != self._numbers:
            self._numbers = numbers
            self.changed.emit()
