"""The node that a panel is of: what the panel's parts edit, and what they ask of the window."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from PySide6.QtCore import QObject, Signal

from app.editor.session import Session
from core.editing.operations import ABSENT, Operation, Together, set_parameter
from core.names import thaw
from core.network.expression_grammar import quoted
from core.network.macro import unfolded


class Requests(QObject):
    """What panels ask for."""

    view = Signal(
        str, str, int
    )  # node, port, viewer: show that output in the viewer of that number
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
        """Whether the network still has it."""
        return self.name in self.session.network.nodes

    def given(self, parameter: str) -> object:
        """A parameter's value as the network file has it; ABSENT where it has its default."""
        node = self.session.network.nodes[self.name]
        return thaw(node.params.get(parameter, ABSENT))

    def do(self, operation: Operation, gesture: object = None) -> None:
        if self.is_there:
            self.session.do(operation, gesture=gesture)

    def put(self, parameter: str, value: object, gesture: object = None) -> None:
        """Give a parameter a value; values of one gesture are one step.

        Nodes of one module that are selected together all get it.
        """
        self.do(_for_each(set_parameter(name, parameter, value) for name in self._alike), gesture)

    def put_back(self, parameter: str, gesture: object) -> None:
        """Give it the values from before the gesture, each node its own."""
        before = self.session.document.history.start
        if before is not None:
            nodes = unfolded(before).nodes
            values = {name: nodes[name].params.get(parameter, ABSENT) for name in self._alike}
            steps = (set_parameter(name, parameter, thaw(value)) for name, value in values.items())
            self.do(_for_each(steps), gesture)

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
    return Together((one, *others)) if others else one
