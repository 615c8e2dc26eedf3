"""The choice of a wire: every output of the network that can be shown, by node."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QStandardItem
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.editor.declared_text import titled
from app.editor.session import Session
from app.editor.viewers.network_ports import ports_by_node
from app.editor.viewers.node_choice import NodeChoice, entry


class PortChoice(NodeChoice):
    """A list of ports under the names of their nodes.

    Parameters
    ----------
    session : Session
        The open document.
    types : tuple of str
        Types of ports it offers.
    nothing : str
        What stands for no port.
    parent : QWidget, optional
        Qt's owner.

    Signals
    -------
    chosen(port)
        The person has chosen a port; an empty text is none.
    """

    chosen = Signal(str)

    def __init__(
        self, session: Session, types: tuple[str, ...], nothing: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(session, nothing, parent)
        self._types = types
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setMinimumContentsLength(3)
        self.fill()

    @property
    def port(self) -> str:
        """The port that is chosen, ``NODE.PORT``; empty for none."""
        return self.value

    def choose(self, port: str | None) -> None:
        """Show a port as chosen, without a signal."""
        self.show_value(port or "")

    def groups(self) -> Iterable[tuple[str, Sequence[QStandardItem]]]:
        """The ports by node."""
        for group in ports_by_node(self.session.network, self.session.library, self._types):
            yield titled(group.node, group.title), [entry(port, port) for port in group.ports]

    def take(self, value: str | None) -> None:
        """Signal the port."""
        if value is not None:
            self.value = value
            self.chosen.emit(value)
