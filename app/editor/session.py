"""The open document as the parts of the window see it: what they may do, and its signals."""

from collections.abc import Hashable, Iterable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from app.editor.declared_text import error_text
from app.editor.messages import told
from app.run.staging import read_record, remember_chosen
from core.editing.document import Document
from core.editing.macros import at_level
from core.editing.operations import Operation, restored, set_parameter
from core.errors import ImagechainError
from core.modules.declaration import Declaration, Library
from core.modules.parameters import Parameter
from core.network import linked_values
from core.network.macro import SEPARATOR, declared_node, expanded, path_of, unfolded
from core.network.network import Network, Node
from core.records import dataclass, replace


@dataclass(frozen=True)
class FreeNumber:
    """A parameter that is free for a fit; a limit that is None is the parameter's own."""

    node: str
    name: str
    low: float | None = None
    high: float | None = None

    @property
    def place(self) -> tuple[str, str]:
        return self.node, self.name

    @property
    def port(self) -> str:
        return f"{self.node}.{self.name}"


class Session(QObject):
    """One document in one window. The parts of the window hold none of its state."""

    opened = Signal()  # another document has taken the place of the last one
    changed = Signal(object, object)  # (before, after): the network has changed; both are `Network`
    state_changed = Signal()  # path, modified mark or what undo and redo would do may have changed
    selection_changed = Signal(tuple)  # (names): other nodes are selected: a tuple of ids
    free_changed = Signal()  # other numbers are free for a fit, or their limits differ
    # (kind, text): A line for the person; kind is "note", "warning" or "error"
    message = Signal(str, str)

    def __init__(self, library: Library, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.library = library
        # What a fit is to determine: no file holds it, and undo leaves it.
        self.free: tuple[FreeNumber, ...] = ()
        self._chosen: set[Path] = set()
        self.document = Document(Network(), library=library)
        self.document.listen(self._changed)
        # With the nodes inside of macros beside all others: they are called ``camera/blur``, and
        # operations given to `do` may name them so.
        self.network = self.document.network
        self.selection: tuple[str, ...] = ()
        self._resolved = (self.network, linked_values.ResolvedNetwork(self.network))

    @property
    def plain(self) -> Network:
        """The network with its macros written out, which is what is computed."""
        return expanded(self.document.network, self.library)

    @property
    def resolved(self) -> linked_values.ResolvedNetwork:
        """The plain network with values in the place of its expressions."""
        of, before = self._resolved
        document = self.document.network
        if of is not document:
            known = before.network.nodes.get
            now = linked_values.with_values(self.plain, library=self.library, known=known)
            self._resolved = (document, now)
        return self._resolved[1]

    def valued(self, name: str) -> Node:
        node = self.resolved.node(name)
        if node is not None:
            return node
        macro = self.network.nodes[name]
        values = {one: self.resolved.value(name, one) for one in macro.linked}
        return replace(macro, params={**macro.params, **values}) if values else macro

    def link_fault(self, node: str, parameter: str, raw: object) -> linked_values.LinkError | None:
        """Why a parameter cannot follow that; None where it can."""
        network = set_parameter(node, parameter, raw).apply(self.document.network)
        trial = linked_values.resolved(network, library=self.library)
        behind, name = trial.network.parameter_behind(node, parameter)
        faults = trial.faults.get(behind, ())
        return next((fault for fault in faults if fault.parameter == name), None)

    def follows(self, name: str, parameters: Iterable[str]) -> str:
        """Which of a node's parameters follows others, so that no drag may set it; or empty."""
        node = self.network.nodes[name]
        for parameter in parameters:
            if parameter in node.linked:
                text = linked_values.expression_text(node.params[parameter])
                return f"{name}.{parameter} is linked to {text}: unlink it in the panel first"
        return ""

    @property
    def folder(self) -> Path:
        return self.document.folder

    @property
    def stem(self) -> str:
        path = self.document.path
        if path is not None:
            return path.stem
        name = self.network.name or "network"
        return "".join(c if c.isalnum() or c in "-_" else "_" for c in name.lower())

    @property
    def selected_alike(self) -> tuple[str, ...]:
        """The selected nodes, if they are several of one module; a change of one is for all."""
        nodes = [self.network.nodes[name] for name in self.selection]
        alike = len({node.module for node in nodes}) == 1 and all(not node.macro for node in nodes)
        return self.selection if alike and nodes[1:] else ()

    def declared(self, name: str) -> Declaration | None:
        node = self.network.nodes.get(name)
        return declared_node(node, self.library) if node is not None else None

    def parameter(self, node: str, name: str) -> Parameter | None:
        declared = self.declared(node)
        return declared.parameter(name) if declared is not None else None

    def local_name(self, name: str) -> str:
        return path_of(self.document.network, name)[-1]

    def open(self, document: Document) -> None:
        self.document = document
        self.network = unfolded(document.network)
        self._chosen.clear()
        self._set_free(())
        document.listen(self._changed)
        self.selection = ()
        self.opened.emit()
        self.selection_changed.emit(())
        self.state_changed.emit()

    def do(self, operation: Operation, gesture: Hashable = None) -> bool:
        """Carry an operation out; whether it changed something.

        One that does not fit is refused with a `message`. Operations in a row that share
        a `gesture` are one undo step; `end_gesture` when the mouse goes up.
        """
        try:
            return self.document.do(operation, gesture)
        except ImagechainError as error:
            self.message.emit("error", error_text(error))
            return False

    def check(self, operation: Operation) -> None:
        """Refuse an operation that does not fit, with an error that says why; change nothing."""
        operation.apply(self.document.network)

    def end_gesture(self) -> None:
        self.document.end_gesture()

    def give_up(self, gesture: Hashable) -> None:
        """Put all that a gesture has changed back, and end it."""
        before = self.document.start_of(gesture)
        if before is not None:
            self.do(restored(before, ""), gesture)
        self.end_gesture()

    def undo(self) -> None:
        self.document.undo()

    def redo(self) -> None:
        self.document.redo()

    def save(self, path: Path | None = None, *, over: bool = False) -> bool:
        """Save the document, `over` another program's changes too; whether that worked."""
        before = self.document.path
        with told(self.message.emit, "not saved: "):
            self.document.save(path, over=over)
            self.state_changed.emit()
            if self.document.path is not None:
                self._remember(self.document.path, before)
            return True
        return False

    @property
    def chosen_outputs(self) -> tuple[Path, ...]:
        """Files to be written that were chosen while the document was open."""
        return tuple(sorted(self._chosen))

    def choose_output(self, file: Path) -> None:
        """The person has chosen a file to be written: a run of this network may write it."""
        self._chosen.add(file.absolute())
        if self.document.path is not None:
            self._remember(self.document.path)

    def _remember(self, network: Path, before: Path | None = None) -> None:
        try:
            known = read_record(before).chosen if before is not None else frozenset()
            if known or self._chosen:
                remember_chosen(network, [*known, *self._chosen])
        except ImagechainError as error:
            self.message.emit(
                "warning", f"could not record the chosen output file for later runs: {error}"
            )

    def make_free(self, number: FreeNumber) -> None:
        """Free a number for a fit, in place of itself where it is free within other limits."""
        self._set_free({one.place: one for one in (*self.free, number)}.values())

    def fix(self, node: str, name: str) -> None:
        self._set_free(one for one in self.free if one.place != (node, name))

    def _set_free(self, numbers: Iterable[FreeNumber]) -> None:
        before, self.free = self.free, tuple(numbers)
        if self.free != before:
            self.free_changed.emit()

    def select(self, names: Iterable[str]) -> None:
        chosen = tuple(name for name in dict.fromkeys(names) if name in self.network.nodes)
        if chosen != self.selection:
            self.selection = chosen
            self.selection_changed.emit(chosen)

    def _changed(self, _before: Network, after: Network) -> None:
        shown, self.network = self.network, unfolded(after)
        renamed = renamed_node(shown, self.network)
        free = [replace(one, node=followed_name(one.node, renamed)) for one in self.free]
        self._set_free(one for one in free if one.node in self.network.nodes)
        self.changed.emit(shown, self.network)
        self.state_changed.emit()
        self.select(followed_name(name, renamed) for name in self.selection)


def renamed_node(before: Network, after: Network) -> tuple[str, str] | None:
    """The old and the new name of a node, where one was renamed; of a macro without its inside."""
    gone = _outermost(name for name in before.nodes if name not in after.nodes)
    come = _outermost(name for name in after.nodes if name not in before.nodes)
    if len(gone) != 1 or len(come) != 1:
        return None
    old, new = before.nodes[gone[0]], after.nodes[come[0]]
    return (old.id, new.id) if replace(old, id=new.id) == new else None


def followed_name(name: str, renamed: tuple[str, str] | None) -> str:
    """A node's name after a rename of it, or of a macro it lies in."""
    old, new = renamed or ("", "")
    if name == old:
        return new
    inside = bool(old) and name.startswith(old + SEPARATOR)
    return new + name.removeprefix(old) if inside else name


def _outermost(names: Iterable[str]) -> list[str]:
    """Those that do not lie in another of them."""
    outermost: list[str] = []
    for name in names:  # a macro comes before its inside
        if not (outermost and name.startswith(outermost[-1] + SEPARATOR)):
            outermost.append(name)
    return outermost


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
        self.session, self.library = session, session.library
        self.path: tuple[str, ...] = ()  # the macros that it lies in, the outermost first
        self.network = session.document.network
        session.opened.connect(self._begin)
        session.changed.connect(self._follow)
        session.selection_changed.connect(self._follow_selection)
        self.message.connect(session.message)

    @property
    def head(self) -> str:
        """What the ids here begin with in the whole network: ``camera/``."""
        return "".join(f"{macro}{SEPARATOR}" for macro in self.path)

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
        return self.session.do(at_level(self.path, operation), gesture)

    def end_gesture(self) -> None:
        self.session.end_gesture()

    def select(self, names: Iterable[str]) -> None:
        self.session.select(self.head + name for name in names)

    def is_macro(self, name: str) -> bool:
        node = self.network.nodes.get(name)
        return node is not None and node.macro is not None

    def enter(self, name: str) -> None:
        if self.is_macro(name):
            self.go_to((*self.path, name))

    def leave(self) -> None:
        if self.path:
            macro = self.path[-1]
            self.go_to(self.path[:-1])
            self.select([macro])

    def go_to(self, path: tuple[str, ...]) -> None:
        """Show the inside of the last macro of a path; the whole network for none."""
        network = _inside(self.session.document.network, path)
        if network is None or path == self.path:
            return
        self.path, self.network = path, network
        self.session.select(())
        self.opened.emit()

    def _begin(self) -> None:
        self.path, self.network = (), self.session.document.network
        self.opened.emit()

    def _follow(self, before: Any, after: Any) -> None:
        name = followed_name(SEPARATOR.join(self.path), renamed_node(before, after))
        path = tuple(name.split(SEPARATOR)) if name else ()
        whole = self.session.document.network
        shown = path
        while (network := _inside(whole, shown)) is None:
            shown = shown[:-1]
        former, self.path, self.network = self.network, shown, network
        if shown != path:
            self.opened.emit()
        elif former is not network:
            self.changed.emit(former, network)

    def _follow_selection(self, names: tuple[str, ...]) -> None:
        self.selection_changed.emit(self._local(names))

    def _local(self, names: tuple[str, ...]) -> tuple[str, ...]:
        head = self.head
        local = (name.removeprefix(head) for name in names if name.startswith(head))
        return tuple(name for name in local if name in self.network.nodes)


def _inside(network: Network, path: tuple[str, ...]) -> Network | None:
    for macro in path:
        node = network.nodes.get(macro)
        if node is None or node.macro is None:
            return None
        network = node.macro
    return network
