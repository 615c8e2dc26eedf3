"""What the canvas shows: the network, or the inside of one of its macros, as a session of its own.

A node is called `blur` here that is `camera/blur` in the whole network.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from app.editor.session import Session, renamed_node
from core.editing.macros import at_level
from core.editing.operations import Operation
from core.modules.declaration import Declaration, Library
from core.network.macro import SEPARATOR
from core.network.network import Network


class Level(QObject):
    """The part of the session's document that lies in one macro; without a path, all of it."""

    opened = Signal()  # another network is shown: of another document, or of another macro
    # (before, after): the network shown has changed; both are `Network`
    changed = Signal(object, object)
    # (names): other nodes are selected: a tuple of ids in the network shown
    selection_changed = Signal(tuple)
    message = Signal(str, str)  # (kind, text): a line for the person; kind as `Session`'s

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session = session
        self._path: tuple[str, ...] = ()
        self._network = session.document.network
        session.opened.connect(self._begin)
        session.changed.connect(self._follow)
        session.selection_changed.connect(self._follow_selection)
        self.message.connect(session.message)

    @property
    def path(self) -> tuple[str, ...]:
        """Ids of the macros that it lies in, the outermost first."""
        return self._path

    @property
    def head(self) -> str:
        """What the ids here begin with in the whole network: ``camera/``."""
        return "".join(f"{macro}{SEPARATOR}" for macro in self._path)

    @property
    def network(self) -> Network:
        return self._network

    @property
    def library(self) -> Library:
        return self.session.library

    @property
    def folder(self) -> Path:
        return self.session.folder

    @property
    def selection(self) -> tuple[str, ...]:
        return self._local(self.session.selection)

    def value(self, name: str, parameter: str) -> Any:
        """The value of a node's parameter, also of one that follows others or is set outside."""
        return self.session.resolved.value(self.head + name, parameter)

    def declared(self, name: str) -> Declaration | None:
        return self.session.declared(self.head + name)

    def do(self, operation: Operation, gesture: Hashable = None) -> bool:
        return self.session.do(at_level(self._path, operation), gesture)

    def end_gesture(self) -> None:
        self.session.end_gesture()

    def select(self, names: Iterable[str]) -> None:
        self.session.select(self.head + name for name in names)

    def is_macro(self, name: str) -> bool:
        node = self._network.nodes.get(name)
        return node is not None and node.macro is not None

    def enter(self, name: str) -> None:
        if self.is_macro(name):
            self.go_to((*self._path, name))

    def leave(self) -> None:
        """Show what lies around this macro, with the macro selected."""
        if self._path:
            macro = self._path[-1]
            self.go_to(self._path[:-1])
            self.select([macro])

    def go_to(self, path: tuple[str, ...]) -> None:
        """Show the inside of the last macro of a path; the whole network for none."""
        network = _inside(self.session.document.network, path)
        if network is None or path == self._path:
            return
        self._path, self._network = path, network
        self.session.select(())
        self.opened.emit()

    def _begin(self) -> None:
        self._path, self._network = (), self.session.document.network
        self.opened.emit()

    def _follow(self, before: Any, after: Any) -> None:
        """Show the same macro, by its new name; where it is gone, what was around it."""
        old, new = renamed_node(before, after) or ("", "")
        path = self._path
        for depth in range(1, len(path) + 1):
            if SEPARATOR.join(path[:depth]) == old:
                path = (*path[: depth - 1], new.rpartition(SEPARATOR)[2], *path[depth:])
                break
        whole = self.session.document.network
        shown = path
        while (network := _inside(whole, shown)) is None:
            shown = shown[:-1]
        former, self._path, self._network = self._network, shown, network
        if shown != path:
            self.opened.emit()
        elif former is not network:
            self.changed.emit(former, network)

    def _follow_selection(self, names: tuple[str, ...]) -> None:
        self.selection_changed.emit(self._local(names))

    def _local(self, names: tuple[str, ...]) -> tuple[str, ...]:
        head = self.head
        local = (name.removeprefix(head) for name in names if name.startswith(head))
        return tuple(name for name in local if name in self._network.nodes)


def _inside(network: Network, path: tuple[str, ...]) -> Network | None:
    for macro in path:
        node = network.nodes.get(macro)
        if node is None or node.macro is None:
            return None
        network = node.macro
    return network
