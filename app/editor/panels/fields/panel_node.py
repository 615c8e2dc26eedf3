"""The node that a panel is of: what the panel edits, copies, and asks of the window."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QGuiApplication

from app.editor.session import Session
from core.editing.clipboard import copied_values, pasted_values
from core.editing.operations import ABSENT, Operation, named, set_parameter, together
from core.errors import ImagechainError, thaw
from core.network.expressions import quoted
from core.records import dataclass


class Requests(QObject):
    view = Signal(str, str, int)  # node, port, viewer: show that output in that viewer
    trade_off = Signal(str, str)  # node, parameter: show figures of merit as it moves
    generate = Signal()  # compute everything
    handbook = Signal(str)  # node: the page of its module is to be opened
    named = Signal()  # Enter in the name: the keyboard goes back to the canvas
    close = Signal(str)  # node: put the panel away
    illustrated = Signal(str, bool)  # module, on: panels of that kind show their illustration


@dataclass(frozen=True)
class PanelNode:
    session: Session
    name: str
    requests: Requests

    @property
    def is_there(self) -> bool:
        return self.name in self.session.network.nodes

    def given(self, parameter: str) -> object:
        """A parameter's value as the network file has it; ABSENT where it has its default."""
        node = self.session.network.nodes[self.name]
        return thaw(node.params.get(parameter, ABSENT))

    def do(self, operation: Operation, gesture: object = None) -> None:
        if self.is_there:
            self.session.do(operation, gesture=gesture)

    def put(self, parameter: str, value: object, gesture: object = None) -> None:
        """Give a value to the node, and to others selected with it; a gesture is one step."""
        self.do(_for_each(set_parameter(name, parameter, value) for name in self._alike), gesture)

    def names_beside(self) -> list[str]:
        """The numbers of the nodes that lie in the same macro, as expressions name them."""
        session, names = self.session, []
        around = self.name.removesuffix(session.local_name(self.name))
        for name in session.network.nodes:
            local, declared = session.local_name(name), session.declared(name)
            for one in declared.parameters if declared and around + local == name else ():
                if one.kind in ("number", "integer"):
                    names.append(f"{quoted(local)}.{one.name}")
        return names

    @property
    def _alike(self) -> tuple[str, ...]:
        alike = self.session.selected_alike
        return alike if self.name in alike else (self.name,)


def _for_each(steps: Iterable[Operation]) -> Operation:
    one, *others = steps
    return together((one, *others)) if others else one


_MOST_REASONS = 3


def copy_values(session: Session, names: Sequence[str]) -> None:
    """Put the values of the last of these nodes on the clipboard, as JSON text."""
    for name in names[-1:]:
        text = copied_values(session.network.nodes[name], session.declared(name))
        QGuiApplication.clipboard().setText(text)
        session.message.emit("note", f"copied the values of {name}")


def paste_values(session: Session, names: Sequence[str]) -> None:
    """Give nodes the clipboard's values, as one step; what is left out is said in one line."""
    text = QGuiApplication.clipboard().text()
    try:
        operation, left_out = pasted_values(text, names, session.declared)
    except ImagechainError as error:
        session.message.emit("error", f"no values were pasted: {error}")
        return
    session.do(operation)
    text = f"pasted values into {named(names)}"
    if left_out:
        more = len(left_out) - _MOST_REASONS
        reasons = "; ".join(left_out[:_MOST_REASONS])
        text += f"; left out: {reasons}{f'; and {more} more' if more > 0 else ''}"
    session.message.emit("note", text)
