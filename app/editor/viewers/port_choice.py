"""The choice of a wire: every output of the network that can be shown, by node."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QStandardItem, QStandardItemModel
from PySide6.QtWidgets import QComboBox, QSizePolicy, QWidget

from app.editor.declared_text import titled
from app.editor.session import Session
from app.editor.viewers.network_ports import ports_by_node, ports_depend_on

_PORT = Qt.ItemDataRole.UserRole


class PortChoice(QComboBox):
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
        super().__init__(parent)
        self._session = session
        self._types = types
        self._nothing = nothing
        self._filled: Hashable = None
        self._port = ""
        self._list = QStandardItemModel(self)
        self.setModel(self._list)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(3)
        self.setMaxVisibleItems(24)
        self.activated.connect(self._activated)
        session.changed.connect(self._changed)
        session.opened.connect(self._fill)
        self._fill()

    @property
    def port(self) -> str:
        """The port that is chosen, ``NODE.PORT``; empty for none."""
        return self._port

    def choose(self, port: str | None) -> None:
        """Show a port as chosen, without a signal."""
        self._port = port or ""
        index = max(0, self.findData(self._port, _PORT))
        self.setCurrentIndex(index)
        self.setToolTip(self._port or self._nothing)

    def showPopup(self) -> None:
        """Make the list as wide as its longest line."""
        width = (
            self.view().sizeHintForColumn(0) + self.view().verticalScrollBar().sizeHint().width()
        )
        self.view().setMinimumWidth(max(width, self.width()))
        super().showPopup()

    def _activated(self, index: int) -> None:
        port = self.itemData(index, _PORT)
        if port is not None:
            self._port = port
            self.chosen.emit(port)

    def _changed(self, _before: Any, after: Any) -> None:
        if ports_depend_on(after) != self._filled:
            self._fill()

    def _fill(self) -> None:
        network = self._session.network
        self._filled = ports_depend_on(network)
        model = self._list
        model.clear()
        nothing = QStandardItem(self._nothing)
        nothing.setData("", _PORT)
        model.appendRow(nothing)
        for group in ports_by_node(network, self._session.library, self._types):
            head = QStandardItem(titled(group.node, group.title))
            head.setFlags(Qt.ItemFlag.NoItemFlags)
            model.appendRow(head)
            for port in group.ports:
                item = QStandardItem(port)
                item.setData(port, _PORT)
                model.appendRow(item)
        self.choose(self._port)
