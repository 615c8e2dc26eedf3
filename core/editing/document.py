"""The document that is open: a network, where it is stored, and its history."""

import hashlib
import os
import stat
from collections.abc import Callable, Collection, Hashable, Mapping
from functools import partial
from os.path import realpath
from pathlib import Path
from typing import Any

from core.editing.layout import is_in_reach
from core.editing.operations import ABSENT, Operation
from core.editing.wiring import check_new_wires
from core.errors import ChangedFileError, NetworkError, in_line, thaw
from core.modules.declaration import Library, declaration
from core.network.file import LARGEST, format_network, save_network
from core.network.network import EXPRESSION, Network
from core.records import replace

_LONGEST = 32  # letters of a value


def _value_text(value: Any) -> str:
    if value is ABSENT:
        return "default"
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, Mapping) and EXPRESSION in value:
        text = f"= {value[EXPRESSION]}"
    elif isinstance(value, list | tuple):
        text = ", ".join(map(str, value)) or "none"
    else:
        text = str(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


Listener = Callable[[Network, Network], None]


class Document:
    """A network being edited. Only `do`, `undo`, `redo` and `go_to` change it; they call listeners.

    `path` is the file it was read from, and is saved to; `saved`, whether that holds it as it is,
    not so for recovered work and copies; `stored`, the `mark` of what it held when it was read.
    """

    def __init__(
        self,
        network: Network,
        *,
        library: Library,
        path: Path | None = None,
        saved: bool = True,
        stored: str | None = None,
    ) -> None:
        # Networks, what was done to come to each, and the path of the one field that this set.
        self._states: list[tuple[Network, str, tuple[str, ...]]] = [(_tidied(network), "", ())]
        self.position = 0
        """How many steps are done."""
        self.saved = 0 if saved else None
        """The position that is saved; None where no step leads there."""
        self._gesture: Hashable = None
        self.library = library
        self.path = path
        self.stored = GONE if path is None else mark_of(path) if stored is None else stored
        self._listeners: list[Listener] = []

    @property
    def network(self) -> Network:
        return self._states[self.position][0]

    def start_of(self, gesture: Hashable) -> Network | None:
        """The network before a gesture, if that is the one that is going on."""
        going_on = gesture is not None and gesture == self._gesture
        return self._states[self.position - 1][0] if going_on else None

    @property
    def last(self) -> int:
        """The position after all steps, those included that were undone."""
        return len(self._states) - 1

    @property
    def undo_text(self) -> str:
        return self._states[self.position][1]

    @property
    def redo_text(self) -> str:
        return self._states[self.position + 1][1] if self.position < self.last else ""

    @property
    def modified(self) -> bool:
        return self.saved != self.position

    def line(self, position: int) -> str:
        """What the step did that leads to a position, in one line; of 0 nothing."""
        network, text, field = self._states[position]
        match field:
            case ("nodes", node, "params", name) if node in network.nodes:
                values = [
                    _value_text(thaw(one.nodes[node].params.get(name, ABSENT)))
                    for one, _, _ in self._states[position - 1 : position + 1]
                ]
                return in_line(f"{text}: {' → '.join(values)}")
        return in_line(text)

    @property
    def folder(self) -> Path:
        """What file names in the network are relative to."""
        return self.path.parent if self.path is not None else Path()

    def text(self) -> str:
        return format_network(self.network, library=self.library)

    def listen(self, listener: Listener) -> None:
        self._listeners.append(listener)

    def do(self, operation: Operation, gesture: Hashable = None) -> bool:
        """Carry an operation out, unless it changes nothing; whether it did."""
        before = self.network
        after = operation.apply(before)
        if self._same(before, after):
            return False
        check_new_wires(before, after, self.library)
        self._add(after, operation, gesture)
        start = self.start_of(gesture)
        if start is not None and self._same(start, after):  # the drag is back where it began
            self._states.pop()
            self.position -= 1
            self.end_gesture()
        self._tell(before)
        return True

    def _add(self, network: Network, operation: Operation, gesture: Hashable) -> None:
        del self._states[self.position + 1 :]
        if self.saved is not None and self.saved > self.position:
            self.saved = None
        text, field = operation.text, operation.path
        if gesture is not None and gesture == self._gesture:
            _, first_text, first_field = self._states.pop()
            if field != first_field or not field:
                text, field = first_text, ()
        self._states.append((network, text, field))
        self.position = self.last
        self._gesture = gesture

    def end_gesture(self) -> None:
        """The next operation is an undo step of its own."""
        self._gesture = None

    def undo(self) -> None:
        self.go_to(max(self.position - 1, 0))

    def redo(self) -> None:
        self.go_to(min(self.position + 1, self.last))

    def go_to(self, position: int) -> None:
        """Undo, or do again, until so many steps are done; the listeners are called once."""
        before = self.network
        self.position = position
        self.end_gesture()
        self._tell(before)

    def disagreement(self) -> str:
        """What another program has done to its file since then; empty where it is unchanged."""
        if self.path is None or (current := mark_of(self.path)) == self.stored:
            return ""
        return "removed" if current == GONE else "changed"

    def save(self, path: Path | None = None, *, over: bool = False) -> None:
        target = path or self.path
        if target is None:
            raise NetworkError("the network has no file yet: choose where to save it")
        if not over and self.is_own(target) and (done := self.disagreement()):
            raise ChangedFileError(f"{target} has been {done} since it was opened or saved here")
        text = save_network(self.network, target, library=self.library)
        self.path, self.stored = target, mark(text.encode())
        self.saved = self.position
        self.end_gesture()

    def is_own(self, path: Path) -> bool:
        """Whether a path, however it is written, is that of its file."""
        try:
            return self.path is not None and realpath(path) == realpath(self.path)
        except ValueError:  # no file name is possible
            return False

    def _same(self, one: Network, other: Network) -> bool:
        # To Python 1 is true, and mappings in another order are equal; to a file they are not.
        text = partial(format_network, library=self.library)
        return one is other or (one == other and text(one) == text(other))

    def _tell(self, before: Network) -> None:
        if (after := self.network) is not before:
            for listener in tuple(self._listeners):
                listener(before, after)


def _tidied(network: Network) -> Network:
    """Without points of nodes that are not there, or that no canvas reaches; in macros, too."""
    layout = {
        name: at
        for name, at in network.layout.items()
        if name in network.nodes and is_in_reach(*at)
    }
    tidy = network if len(layout) == len(network.layout) else replace(network, layout=layout)
    for node in network.nodes.values():
        if node.macro is not None and (body := _tidied(node.macro)) is not node.macro:
            tidy = tidy.with_node(replace(node, macro=body))
    return tidy


GONE = ""


def mark(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def mark_of(path: Path) -> str:
    """The mark of what a file holds; `GONE` where there is none."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would wait
            return "not a regular file"
        with path.open("rb") as file:
            # More than the largest network: the mark then differs from every network's.
            return mark(file.read(LARGEST + 1))
    except FileNotFoundError:
        return GONE
    except (OSError, ValueError) as error:
        return f"unreadable: {type(error).__name__}"


def rebased(
    network: Network,
    library: Library,
    old_folder: Path,
    new_folder: Path,
    *,
    typed: Collection[tuple[str, str]] = (),
) -> Network:
    """The network with relative file names that lead to the same files from another folder.

    `typed` are nodes and parameters whose full names become relative below the new folder.
    """
    old, new = (Path(os.path.realpath(folder)) for folder in (old_folder, new_folder))
    for node in network.nodes.values():
        if node.module not in library:
            continue
        for name in declaration(library[node.module]).path_names:
            value = node.params.get(name)
            if not isinstance(value, str):
                continue
            file, is_typed = Path(value), (node.id, name) in typed
            if file.is_absolute():
                place = Path(os.path.realpath(file.parent)) if is_typed else None
                moves = place is not None and place.is_relative_to(new)
            else:
                moves = old != new and bool(value) and "\0" not in value
            if moves:
                moved = _from(old / value, new)
                if moved != value:
                    network = network.with_parameter(node.id, name, moved)
    return network


def _from(file: Path, folder: Path) -> str:
    """The file's name from a folder: relative, or in full where there is no way between them."""
    # The last part is kept: a name that is a link to a file stays that name.
    place = Path(os.path.realpath(file.parent), file.name) if file.name != ".." else file
    try:
        return Path(os.path.relpath(place, folder)).as_posix()
    except ValueError:  # another drive
        return place.as_posix()
