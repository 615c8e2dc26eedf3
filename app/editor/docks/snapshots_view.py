"""The dock of snapshots: their list, what is done with them, and which figures have changed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, replace
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemDelegate,
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QListWidget,
    QSplitter,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import label_of, shown_value, tip
from app.editor.docks.snapshot_states import AllFiguresQuery, KeptState, NodeFigure, changed_figures
from app.editor.docks.snapshots import Comparing, Snapshots
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.freshness import Freshness
from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import ElidedLabel, toggle_button, tool_button
from core.errors import ParameterError
from core.modules.declaration import Declaration
from core.names import thaw
from core.network.linked_values import expression_text
from core.network.network import EXPRESSION, Network, Node

_NUMBER = Qt.ItemDataRole.UserRole
_NAME, _TIME, _CHANGED = range(3)
_MARK = "A  "
_HINT = "nothing is kept yet: Ctrl+K keeps the present state"


class SnapshotsView(Viewer):
    """Lists snapshots, and the figures that differ from those of the one that is A.

    Parameters
    ----------
    session, evaluator, parent
        As for `Viewer`.
    snapshots : Snapshots
        The states.
    comparing : Comparing
        Keeps the present one.
    """

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator,
        snapshots: Snapshots,
        comparing: Comparing,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, "snapshots", parent)
        self.setAccessibleName("Snapshots")
        self._snapshots = snapshots
        self._now: tuple[NodeFigure, ...] | None = None
        self._build()
        self._soon = QTimer(self, singleShot=True, interval=30)
        self._soon.timeout.connect(self._fill_list)
        self._freshness = Freshness(session, evaluator, self)
        self._freshness.changed.connect(self.figures.setDisabled)
        snapshots.changed.connect(self._follow_snapshots)
        self.keep.clicked.connect(comparing.keep)
        self.flip.clicked.connect(snapshots.flip)
        self.wipe.clicked.connect(snapshots.wipe)
        self.back.clicked.connect(self._go_back)
        self.remove.clicked.connect(self._remove)
        self.list.chosen.connect(snapshots.choose)
        self.list.renamed.connect(snapshots.rename)
        self.list.removed.connect(snapshots.remove)
        self.list.went_back.connect(snapshots.go_back)
        self.list.typed.connect(self._fill_list)
        self._follow_snapshots()

    def queries(self) -> Sequence[Query]:
        """The present figures, where there is something to compare them with."""
        return () if self._snapshots.chosen is None else (AllFiguresQuery(),)

    def take(self, answer: Answer) -> None:
        """Show which figures differ."""
        self._now = answer.value if isinstance(answer.value, tuple) else None
        self._freshness.catch_up(answer.generation)
        self._fill_figures()

    def follow(self, before: Network, after: Network) -> None:  # noqa: ARG002
        """Say anew what has changed since; a drag has many changes."""
        if self.isVisible() and self._snapshots.states and not self._soon.isActive():
            self._soon.start()

    def follow_opening(self) -> None:
        """Show nothing of another document."""
        self._now = None
        self._follow_snapshots()

    def sizeHint(self) -> QSize:
        """Room for some snapshots and figures."""
        width, line = self.fontMetrics().averageCharWidth(), self.fontMetrics().height()
        return QSize(75 * width, 20 * line)

    def showEvent(self, event: Any) -> None:
        """Show what has changed meanwhile."""
        super().showEvent(event)
        self._fill_list()
        self._fill_figures()

    def _build(self) -> None:
        name = self.owner
        self.keep = tool_button(f"{name}.keep", "Keep", "Keep the present state (Ctrl+K)", self)
        self.flip = toggle_button(
            f"{name}.flip", "Flip", "Show A in the place of B, and back (K)", self
        )
        self.wipe = toggle_button(
            f"{name}.wipe", "Wipe", "Show A left and B right of a divider (W)", self
        )
        self.back = tool_button(
            f"{name}.back", "Go Back", "Make the network what it was in A; can be undone", self
        )
        self.remove = tool_button(f"{name}.remove", "Remove", "Keep A no longer (Del)", self)
        self.list = SnapshotList(self)
        self.figures = QListWidget(self)
        self.figures.setObjectName(f"{name}.figures")
        self.figures.setAccessibleName("Figures that have changed; Ctrl+C copies one")
        self.figures.setToolTip("Figures of the snapshot, A → of the network now, B")
        self.figures.setWordWrap(True)
        self.title = ElidedLabel(f"{name}.title", "How many figures differ", self)
        bar = QHBoxLayout()
        bar.setContentsMargins(2, 2, 2, 0)
        bar.setSpacing(3)
        for button in (self.keep, self.flip, self.wipe, self.back, self.remove):
            bar.addWidget(button)
        bar.addStretch(1)
        below = QWidget(self)
        figures = QVBoxLayout(below)
        figures.setContentsMargins(0, 0, 0, 0)
        figures.setSpacing(1)
        self.title.setContentsMargins(6, 0, 2, 0)
        figures.addWidget(self.title)
        figures.addWidget(self.figures, 1)
        self.parts = QSplitter(Qt.Orientation.Vertical, self)
        self.parts.setChildrenCollapsible(False)
        self.parts.addWidget(self.list)
        self.parts.addWidget(below)
        self.parts.setStretchFactor(0, 1)
        self.parts.setStretchFactor(1, 3)
        line = self.fontMetrics().height()
        self.list.setMinimumHeight(4 * line)
        self.parts.setSizes([5 * line, 15 * line])
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addLayout(bar)
        layout.addWidget(self.parts, 1)

    def _follow_snapshots(self) -> None:
        way, chosen = self._snapshots.way, self._snapshots.chosen
        self.flip.setChecked(way == "flip")
        self.wipe.setChecked(way == "wipe")
        for button in (self.flip, self.wipe, self.back, self.remove):
            button.setEnabled(chosen is not None)
        self._fill_list()
        self._fill_figures()
        self.ask()

    def _declared(self, node: Node) -> Declaration | None:
        return self.session.declared(node.id)

    def _fill_list(self) -> None:
        if not self.isVisible():
            return
        states, now = self._snapshots.states, self.session.network
        changed = [changes(state.nodes, now, self._declared) for state in states]
        self.list.fill(states, self._snapshots.chosen, changed)

    def _fill_figures(self) -> None:
        if not self.isVisible():
            return
        state, now = self._snapshots.chosen, self._now
        self.figures.clear()
        if state is None:
            self.title.show_text(_HINT)
        elif state.results.figures is None or now is None:
            self.title.show_text(f"the figures of A {state.name} and of now are being computed")
        else:
            lines, count = changed_figures(state.results.figures, now)
            self.figures.addItems(lines)
            self.title.show_text(f"A {state.name}, B now: {len(lines)} of {count} figures differ")

    def _go_back(self) -> None:
        self._snapshots.go_back()

    def _remove(self) -> None:
        state = self._snapshots.chosen
        if state is not None:
            self._snapshots.remove(state.number)


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


# What has changed from one state of a network to another, in words.

Declared = Callable[[Node], Declaration | None]
NOTHING = "as now"
MOST = 3


def changes(before: Network, after: Network, declared: Declared) -> tuple[str, ...]:
    """Each change in a few words, nodes first; none where the two are the same.

    Parameters
    ----------
    before, after : Network
        The two states.
    declared : callable
        Gives a node's declaration; None of an unknown module.
    """
    if before is after:
        return ()
    old, new = before.nodes, after.nodes
    names = _renamed(old, new)
    texts = [f"{one} renamed {other}" for one, other in names.items()]
    texts += [f"{name} added" for name in new if name not in old and name not in names.values()]
    texts += [f"{name} removed" for name in old if name not in new and name not in names]
    for name, node in old.items():
        now = new.get(names.get(name, name))
        if now is not None and now is not node:
            texts += _of_node(node, now, declared)
    texts += _wires(before, after, names)
    texts += _of_network(before, after)
    return tuple(texts)


def in_short(texts: tuple[str, ...]) -> str:
    """The first few, and how many more."""
    if not texts:
        return NOTHING
    more = len(texts) - MOST
    return "; ".join(texts[:MOST]) + (f"; and {more} more" if more > 0 else "")


def _renamed(old: Mapping[str, Node], new: Mapping[str, Node]) -> dict[str, str]:
    """New names of nodes that are the same otherwise, by their old ones."""
    come = [node for name, node in new.items() if name not in old]
    names: dict[str, str] = {}
    for name, node in old.items():
        if name not in new:
            same = (other for other in come if replace(other, id=name) == node)
            match = next((other for other in same if other.id not in names.values()), None)
            if match is not None:
                names[name] = match.id
    return names


def _of_node(old: Node, new: Node, declared: Declared) -> list[str]:
    name = new.id
    if old.module != new.module:
        return [f"{name} is another module"]
    declaration = declared(new)
    texts = []
    for key in dict.fromkeys((*old.params, *new.params)):
        one, other = (_text(declaration, key, node) for node in (old, new))
        if one != other:
            parameter = declaration.parameter(key) if declaration is not None else None
            unit = f" {parameter.param.unit}" if parameter and parameter.param.unit else ""
            label = label_of(key)
            texts.append(f"{name} {label} {one} → {other}{unit}")
    if old.disabled != new.disabled:
        texts.append(f"{name} {'disabled' if new.disabled else 'enabled'}")
    if (old.auto is False) != (new.auto is False):
        texts.append(f"{name} {'held' if new.auto is False else 'no longer held'}")
    if old.final != new.final:
        texts.append(f"{name} {'marked as the output' if new.final else 'no longer the output'}")
    if old.extra != new.extra and not texts:
        texts.append(f"{name} looks different")
    return texts


def _text(declaration: Declaration | None, key: str, node: Node) -> str:
    """A parameter's value as a person reads it, the default where it is left out."""
    parameter = declaration.parameter(key) if declaration is not None else None
    if key not in node.params:
        missing = parameter is None or parameter.default is MISSING
        return "default" if parameter is None or missing else _shown(parameter, parameter.default)
    value = node.params[key]
    if isinstance(value, Mapping) and EXPRESSION in value:
        return f"= {expression_text(value)}"
    plain = thaw(value)
    return f"{plain}" if parameter is None else _shown(parameter, plain)


def _shown(parameter: Any, value: Any) -> str:
    try:
        return shown_value(parameter, parameter.coerce(value))
    except (ParameterError, TypeError, ValueError):  # a value that is not allowed is shown, too
        return str(value)


def _wires(before: Network, after: Network, names: Mapping[str, str]) -> list[str]:
    """Wires made and taken away between nodes that both states have."""
    moved = {
        replace(
            link,
            source=names.get(link.source, link.source),
            target=names.get(link.target, link.target),
        )
        for link in before.links
    }
    both = {names.get(name, name) for name in before.nodes} & set(after.nodes)
    now = set(after.links)
    texts = []
    for word, links in (("wired", now - moved), ("no longer wired", moved - now)):
        texts += [f"{link} {word}" for link in sorted(links) if {link.source, link.target} <= both]
    return texts


def _of_network(before: Network, after: Network) -> list[str]:
    texts = []
    if before.seed != after.seed:
        texts.append(f"seed {before.seed} → {after.seed}")
    if before.name != after.name:
        texts.append("name of the network")
    if before.description != after.description:
        texts.append("description of the network")
    if before.extra != after.extra:
        texts.append("notes, backdrops or other fields")
    if any(after.layout.get(name, at) != at for name, at in before.layout.items()):
        texts.append("places on the canvas")
    return texts
