"""The node that a panel is of: what the panel's parts edit, and what they ask of the window."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QObject, Signal

from app.editor.session import Session
from core.editing.operations import ABSENT, Operation, set_parameter
from core.names import thaw


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
        """Give a parameter a value; values of one gesture are one step."""
        self.do(set_parameter(self.name, parameter, value), gesture)
