"""A list of what the nodes of a network have, to choose from, by node."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QStandardItem, QStandardItemModel
from PySide6.QtWidgets import QComboBox, QWidget

from app.editor.session import Session
from app.editor.viewers.network_ports import ports_depend_on
from app.editor.widgets import require_defined

VALUE = Qt.ItemDataRole.UserRole


class NodeChoice(QComboBox):
    """Entries under the names of their nodes; the first one stands for none.

    Subclasses give their entries in `groups` and say in `take` what a choice does. They call
    `fill` once they are made.

    Parameters
    ----------
    session : Session
        The open document.
    nothing : str
        What stands for none.
    parent : QWidget or None
        Qt's owner.
    """

    def __init__(self, session: Session, nothing: str, parent: QWidget | None) -> None:
        require_defined(type(self), NodeChoice, "groups", "take")
        super().__init__(parent)
        self.session = session
        self.value = ""
        """The entry that is chosen; empty for none."""
        self._nothing = nothing
        self._filled: Hashable = None
        self.entries = QStandardItemModel(self)
        self.setModel(self.entries)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMaxVisibleItems(24)
        self.activated.connect(self.take_at)
        session.changed.connect(self._changed)
        session.opened.connect(self.fill)

    def groups(self) -> Iterable[tuple[str, Sequence[QStandardItem]]]:
        """The names of nodes, with the entries below each."""
        return ()

    def take(self, value: str | None) -> None:
        """An entry has been chosen: its value, empty for none; None where it has no value."""

    def take_at(self, index: int) -> None:
        """Choose the entry at a place of the list."""
        self.take(self.itemData(index, VALUE))

    def show_value(self, value: str) -> None:
        """Show an entry as chosen, without a signal."""
        self.value = value
        self.setCurrentIndex(max(0, self.findData(value, VALUE)))
        self.setToolTip(value or self._nothing)

    def showPopup(self) -> None:
        """Make the list as wide as its longest line."""
        bar = self.view().verticalScrollBar().sizeHint().width()
        width = self.view().sizeHintForColumn(0) + bar
        self.view().setMinimumWidth(max(width, self.width()))
        super().showPopup()

    def fill(self) -> None:
        """List what the network has now."""
        self._filled = ports_depend_on(self.session.network)
        rows = [entry(self._nothing, "")]
        for name, entries in self.groups():
            head = QStandardItem(name)
            head.setFlags(Qt.ItemFlag.NoItemFlags)
            rows += [head, *entries]
        self.entries.clear()
        self.entries.invisibleRootItem().appendRows(rows)  # at once: the box follows each insertion
        self.show_value(self.value)

    def _changed(self, _before: Any, after: Any) -> None:
        if ports_depend_on(after) != self._filled:
            self.fill()


def entry(text: str, value: str, tooltip: str = "") -> QStandardItem:
    """An entry of the list."""
    item = QStandardItem(text)
    item.setData(value, VALUE)
    if tooltip:
        item.setToolTip(tooltip)
    return item
