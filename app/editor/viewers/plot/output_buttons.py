"""Buttons of all that one node has to plot, beside the list of all nodes."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QAbstractButton, QButtonGroup, QHBoxLayout, QWidget

from app.editor.declared_text import label_of
from app.editor.session import Session
from app.editor.viewers.network_ports import ports_by_node
from app.editor.widgets import Toggle, toggle_button


class OutputButtons(QWidget):
    """One button for each output of the node that is shown; none where it has but one.

    Parameters
    ----------
    session : Session
        The open document.
    types : tuple of str
        Types of ports that are offered.
    owner : str
        The viewer's name, which those of the buttons begin with.
    parent : QWidget
        The bar.

    Signals
    -------
    chosen(port)
        The person has chosen one, ``NODE.PORT``.
    """

    chosen = Signal(str)

    def __init__(
        self, session: Session, types: tuple[str, ...], owner: str, parent: QWidget
    ) -> None:
        super().__init__(parent)
        self.setAccessibleName("Outputs of the node that is plotted")
        self._session = session
        self._types = types
        self._owner = owner
        self.buttons: dict[str, Toggle] = {}
        self._group = QButtonGroup(self)
        self._group.buttonClicked.connect(self._clicked)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(0, 0, 0, 0)
        self._row.setSpacing(1)

    def show_port(self, port: str | None) -> None:
        """Show a port as chosen beside the others of its node, without a signal."""
        ports = self._beside(port)
        if ports != tuple(self.buttons):
            self._make(ports)
        if port in self.buttons:
            self.buttons[port].setChecked(True)
        self.setVisible(bool(ports))

    def _beside(self, port: str | None) -> tuple[str, ...]:
        if port is None:
            return ()
        for group in ports_by_node(self._session.network, self._session.library, self._types):
            if port in group.ports:
                return group.ports if len(group.ports) > 1 else ()
        return ()

    def _make(self, ports: tuple[str, ...]) -> None:
        for button in self.buttons.values():
            self._group.removeButton(button)
            self._row.removeWidget(button)
            button.hide()
            button.deleteLater()
        self.buttons = {port: self._button(port) for port in ports}

    def _button(self, port: str) -> Toggle:
        name = port.rpartition(".")[2]
        button = toggle_button(f"{self._owner}.output.{name}", label_of(name), f"Show {port}", self)
        self._group.addButton(button)
        self._row.addWidget(button)
        return button

    def _clicked(self, clicked: QAbstractButton) -> None:
        for port, button in self.buttons.items():
            if button is clicked:
                self.chosen.emit(port)
                return
