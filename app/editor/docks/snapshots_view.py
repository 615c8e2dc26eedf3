"""The dock of snapshots: their list, what is done with them, and which figures have changed."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QKeyEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QListWidget,
    QSplitter,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
)

from app.editor.docks.snapshots import (
    NOTHING_KEPT,
    AllFiguresQuery,
    Figures,
    Snapshots,
    changed_figures,
)
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Query
from app.editor.gestures import without_argument
from app.editor.session import Session
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import ElidedLabel, filled, labelled, toggle_button, tool_button

_STATE = Qt.ItemDataRole.UserRole


class SnapshotsView(Viewer):
    def __init__(self, session: Session, evaluator: Evaluator, snapshots: Snapshots) -> None:
        super().__init__(session, evaluator, "snapshots")
        self.setAccessibleName("Snapshots")
        self._snapshots = snapshots
        self._now: Figures | None = None
        self._build()
        snapshots.changed.connect(self._follow_snapshots)
        self.keep.clicked.connect(snapshots.keep)
        self.flip.clicked.connect(lambda: snapshots.compare("flip"))
        self.wipe.clicked.connect(lambda: snapshots.compare("wipe"))
        self.back.clicked.connect(partial(without_argument, snapshots.go_back))
        self.remove.clicked.connect(lambda: snapshots.remove(snapshots.chosen))
        self._follow_snapshots()

    def queries(self) -> Sequence[Query]:
        return () if self._snapshots.chosen is None else (AllFiguresQuery(),)

    def take(self, answer: Answer) -> None:
        self._now = answer.value
        self._fill_figures()

    def follow_opening(self) -> None:
        self._now = None
        self._follow_snapshots()

    def sizeHint(self) -> QSize:
        width, line = self.fontMetrics().averageCharWidth(), self.fontMetrics().height()
        return QSize(75 * width, 20 * line)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._follow_snapshots()

    def _build(self) -> None:
        self.keep = tool_button(
            "snapshots.keep", "Keep", "Keep the current state as a snapshot (Ctrl+K)", self
        )
        self.flip = toggle_button("snapshots.flip", "Flip", "Switch between A and B (K)", self)
        self.wipe = toggle_button(
            "snapshots.wipe", "Wipe", "Show A on the left and B on the right of a divider (W)", self
        )
        self.back = tool_button(
            "snapshots.back", "Go Back", "Restore the network to A; you can undo this", self
        )
        self.remove = tool_button("snapshots.remove", "Remove", "Delete A (Del)", self)
        self.list = SnapshotList(self._snapshots)
        self.title = ElidedLabel("snapshots.title", "Number of figures that differ", self)
        self.title.setContentsMargins(6, 0, 2, 0)
        self.figures = labelled(
            QListWidget(self), "snapshots.figures",
            "Figures that differ; Ctrl+C copies the selected figure",
            "Figures in the snapshot (A) → current figures (B)",
        )  # fmt: skip
        self.figures.setWordWrap(True)
        buttons = (self.keep, self.flip, self.wipe, self.back, self.remove)
        bar = filled(QHBoxLayout(), *buttons, None, margins=(2, 2, 2, 0), spacing=3)
        line = self.fontMetrics().height()
        self.list.setMinimumHeight(4 * line)
        parts = QSplitter(Qt.Orientation.Vertical, self, childrenCollapsible=False)
        parts.addWidget(self.list)
        parts.addWidget(self.figures)
        parts.setSizes([5 * line, 15 * line])
        margins = (0, 0, 0, 4)  # the line keeps off the ring of focus
        filled(QVBoxLayout(self), bar, (parts, 1), self.title, margins=margins, spacing=1)

    def _follow_snapshots(self) -> None:
        way, chosen = self._snapshots.way, self._snapshots.chosen
        self.flip.setChecked(way == "flip")
        self.wipe.setChecked(way == "wipe")
        for button in (self.flip, self.wipe, self.back, self.remove):
            button.setEnabled(chosen is not None)
        self.list.fill()
        self._fill_figures()
        self.ask()

    def _fill_figures(self) -> None:
        state, then, now = self._snapshots.chosen, self._snapshots.figures, self._now
        if not self.isVisible():
            return
        self.figures.clear()
        if state is None:
            self.title.show_text(NOTHING_KEPT)
        elif then is None or now is None:
            self.title.show_text(f"computing figures: A {state.name}, B now")
        else:
            lines, count = changed_figures(then, now)
            self.figures.addItems(lines)
            self.title.show_text(f"A: {state.name}, B: now; {len(lines)} of {count} figures differ")


class SnapshotList(QTreeWidget):
    """The newest first, the current row is A; F2 renames, Del removes, Enter goes back."""

    def __init__(self, snapshots: Snapshots) -> None:
        super().__init__()
        self._snapshots = snapshots
        labelled(
            self, "snapshots.list", "Snapshots: F2 renames, Del deletes, Enter goes back",
            "The selected snapshot is A. Press F2 to rename this snapshot, Del to delete it or "
            "Enter to restore it",
        )  # fmt: skip
        self.setHeaderLabels(["Snapshot", "Kept"])
        self.setRootIsDecorated(False)
        triggers = QAbstractItemView.EditTrigger
        self.setEditTriggers(triggers.EditKeyPressed | triggers.DoubleClicked)
        self.header().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        self.currentItemChanged.connect(self._current_changed)
        self.itemChanged.connect(self._renamed)

    def fill(self) -> None:
        states, chosen = self._snapshots.states[::-1], self._snapshots.chosen
        with QSignalBlocker(self):
            rows = range(self.topLevelItemCount())
            if states != [_state_of(self.topLevelItem(row)) for row in rows]:
                self.clear()
                self.addTopLevelItems([QTreeWidgetItem() for _ in states])
            for row, state in enumerate(states):
                item = self.topLevelItem(row)
                assert item is not None
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsEditable)
                item.setData(0, _STATE, state)
                item.setText(0, state.name)
                item.setText(1, f"{state.taken:%H:%M:%S}")
                if state is chosen:
                    self.setCurrentItem(item)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        item, key = self.currentItem(), event.key()
        if item is None or self.state() is QAbstractItemView.State.EditingState:
            super().keyPressEvent(event)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self._snapshots.remove(_state_of(item))
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._snapshots.go_back(_state_of(item))
        else:
            super().keyPressEvent(event)

    def keyboardSearch(self, search: str) -> None:
        """Letters are shortcuts here, and look nothing up."""

    def _current_changed(self, item: QTreeWidgetItem | None, _before: object) -> None:
        if item is not None:
            self._snapshots.choose(_state_of(item))

    def _renamed(self, item: QTreeWidgetItem, _column: int) -> None:
        self._snapshots.rename(_state_of(item), item.text(0))


def _state_of(item: Any) -> Any:
    return item.data(0, _STATE)
