"""The list of snapshots: name, time, and what has changed since."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemDelegate,
    QAbstractItemView,
    QHeaderView,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.snapshots.changes import NOTHING, in_short
from app.editor.snapshots.kept_state import KeptState

_NUMBER = Qt.ItemDataRole.UserRole
_NAME, _TIME, _CHANGED = range(3)
_MARK = "A  "


class SnapshotList(QTreeWidget):
    """One row for each state, the newest first; the current row is A.

    F2 or a double click renames, Del removes, Enter goes back.

    Signals
    -------
    chosen(number)
        Another state is to be A.
    renamed(number, name)
        The person has given one another name.
    removed(number)
        One is to be removed.
    went_back(number)
        The document is to be as it was in that state.
    typed
        No name is being typed any more.
    """

    chosen = Signal(int)
    renamed = Signal(int, str)
    removed = Signal(int)
    went_back = Signal(int)
    typed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("snapshots.list")
        self.setAccessibleName("Snapshots: F2 renames, Del removes, Enter goes back")
        self.setToolTip("The current one is A. F2 renames, Del removes, Enter goes back to it")
        self.setHeaderLabels(["Snapshot", "Kept", "Changed since"])
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setTextElideMode(Qt.TextElideMode.ElideRight)
        head = self.header()
        head.setSectionResizeMode(_NAME, QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(_TIME, QHeaderView.ResizeMode.ResizeToContents)
        head.setStretchLastSection(True)
        self.currentItemChanged.connect(self._current_changed)
        self.itemChanged.connect(self._item_changed)
        self.itemDoubleClicked.connect(self._double_clicked)

    def fill(
        self,
        states: Sequence[KeptState],
        chosen: KeptState | None,
        changed: Sequence[tuple[str, ...]],
    ) -> None:
        """Show these states, which is A, and what has changed since each of them."""
        if self.state() is QAbstractItemView.State.EditingState:
            return  # what is typed stays; the list is filled again after it
        blocker = QSignalBlocker(self)
        numbers = [state.number for state in reversed(states)]
        if numbers != [self._number(self.topLevelItem(row)) for row in range(self._count())]:
            self.clear()
            self.addTopLevelItems([QTreeWidgetItem() for _ in states])
        rows = zip(reversed(states), reversed(changed), strict=True)
        for row, (state, texts) in enumerate(rows):
            item = self.topLevelItem(row)
            assert item is not None
            is_a = chosen is not None and state.number == chosen.number
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsEditable)
            item.setData(_NAME, _NUMBER, state.number)
            item.setText(_NAME, _MARK + state.name if is_a else state.name)
            item.setText(_TIME, state.time)
            item.setText(_CHANGED, in_short(texts))
            item.setToolTip(_CHANGED, tip("\n".join(texts) or NOTHING))
            if is_a:
                self.setCurrentItem(item)
        del blocker

    def rename_current(self) -> None:
        """Type another name for the current one."""
        self._edit(self.currentItem())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Rename, remove, go back."""
        item = self.currentItem()
        key = event.key()
        if item is None or self.state() is QAbstractItemView.State.EditingState:
            super().keyPressEvent(event)
        elif key == Qt.Key.Key_F2:
            self._edit(item)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.removed.emit(self._number(item))
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.went_back.emit(self._number(item))
        else:
            super().keyPressEvent(event)

    def closeEditor(self, editor: QWidget, hint: QAbstractItemDelegate.EndEditHint) -> None:
        """Show the names as they are taken."""
        super().closeEditor(editor, hint)
        self.typed.emit()

    def keyboardSearch(self, search: str) -> None:
        """Letters are shortcuts here, and look nothing up."""

    def _count(self) -> int:
        return self.topLevelItemCount()

    @staticmethod
    def _number(item: QTreeWidgetItem | None) -> int:
        number = item.data(_NAME, _NUMBER) if item is not None else None
        return int(number) if number is not None else 0

    def _edit(self, item: QTreeWidgetItem | None) -> None:
        if item is None:
            return
        blocker = QSignalBlocker(self)
        item.setText(_NAME, item.text(_NAME).removeprefix(_MARK))
        del blocker
        self.editItem(item, _NAME)

    def _double_clicked(self, item: QTreeWidgetItem, _column: int) -> None:
        self._edit(item)

    def _current_changed(self, item: QTreeWidgetItem | None, _before: object) -> None:
        if item is not None:
            self.chosen.emit(self._number(item))

    def _item_changed(self, item: QTreeWidgetItem, column: int) -> None:
        if column == _NAME:
            self.renamed.emit(self._number(item), item.text(_NAME))
