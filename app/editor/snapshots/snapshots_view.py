"""The dock of snapshots: their list, what is done with them, and the figures of A beside B's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtWidgets import QHBoxLayout, QSplitter, QVBoxLayout, QWidget

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.freshness import Freshness
from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.snapshots.all_figures import AllFiguresQuery, NodeFigure
from app.editor.snapshots.changes import changes
from app.editor.snapshots.comparing import Comparing
from app.editor.snapshots.difference_table import DifferenceTable
from app.editor.snapshots.figure_differences import FigureDifference, figure_differences
from app.editor.snapshots.snapshot_list import SnapshotList
from app.editor.snapshots.snapshots import Snapshots
from app.editor.theme import Theme
from app.editor.viewers.viewer import Viewer
from app.editor.widgets.buttons import toggle_button, tool_button
from app.editor.widgets.elided_label import ElidedLabel
from app.run.figures import SENSOR_FIGURES
from core.modules.declaration import Declaration
from core.network.network import Network, Node

_HINT = "nothing is kept yet: Ctrl+K keeps the present state"
_ALWAYS = frozenset(name for shown in SENSOR_FIGURES.values() for name, _ in shown)


class SnapshotsView(Viewer):
    """Lists snapshots, and shows the figures of the one that is A beside the present ones.

    Parameters
    ----------
    session, evaluator, theme, parent
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
        theme: Theme,
        snapshots: Snapshots,
        comparing: Comparing,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, theme, "snapshots", parent)
        self.setAccessibleName("Snapshots")
        self._snapshots = snapshots
        self._now: tuple[NodeFigure, ...] | None = None
        self._build()
        self._soon = QTimer(self, singleShot=True, interval=30)
        self._soon.timeout.connect(self._fill_list)
        self._freshness = Freshness(session, evaluator, self)
        self._freshness.changed.connect(self.table.mark_old)
        snapshots.changed.connect(self._follow_snapshots)
        self.keep.clicked.connect(comparing.keep)
        self.flip.clicked.connect(snapshots.flip)
        self.wipe.clicked.connect(snapshots.wipe)
        self.back.clicked.connect(self._go_back)
        self.remove.clicked.connect(self._remove)
        self.every.toggled.connect(self._fill_table)
        self.list.chosen.connect(snapshots.choose)
        self.list.renamed.connect(snapshots.rename)
        self.list.removed.connect(snapshots.remove)
        self.list.went_back.connect(snapshots.go_back)
        self.list.typed.connect(self._fill_list)
        self.set_theme(theme)
        self._follow_snapshots()

    def set_theme(self, theme: Theme) -> None:
        """Draw in other colours."""
        self.theme = theme
        for button in (self.flip, self.wipe, self.every):
            button.set_theme(theme)
        self.table.set_theme(theme)

    def queries(self) -> Sequence[Query]:
        """The present figures, where there is something to compare them with."""
        return () if self._snapshots.chosen is None else (AllFiguresQuery(),)

    def take(self, answer: Answer) -> None:
        """Show the present figures beside those of A."""
        self._now = answer.value if isinstance(answer.value, tuple) else None
        self._freshness.catch_up(answer.generation)
        self._fill_table()

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
        self._fill_table()

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
        self.every = toggle_button(
            f"{name}.every", "All Figures", "Show figures that are the same, too", self
        )
        self.list = SnapshotList(self)
        self.table = DifferenceTable(self.theme, self)
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
        head = QHBoxLayout()
        head.setContentsMargins(6, 0, 2, 0)
        head.addWidget(self.title, 1)
        head.addWidget(self.every)
        figures.addLayout(head)
        figures.addWidget(self.table, 1)
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
        self._fill_table()
        self.ask()

    def _declared(self, node: Node) -> Declaration | None:
        return self.session.declared(node.id)

    def _fill_list(self) -> None:
        if not self.isVisible():
            return
        states, now = self._snapshots.states, self.session.network
        changed = [changes(state.nodes, now, self._declared) for state in states]
        self.list.fill(states, self._snapshots.chosen, changed)

    def _fill_table(self, *_: object) -> None:
        if not self.isVisible():
            return
        state, now = self._snapshots.chosen, self._now
        if state is None:
            self.table.show_rows(())
            self.title.show_text(_HINT)
            return
        if state.results.figures is None or now is None:
            self.table.show_rows(())
            self.title.show_text(f"the figures of A {state.name} and of now are being computed")
            return
        rows = figure_differences(state.results.figures, now)
        differing = sum(row.differs for row in rows)
        self.table.show_rows([row for row in rows if self.every.isChecked() or _is_shown(row)])
        self.title.show_text(f"A {state.name}, B now: {differing} of {len(rows)} figures differ")

    def _go_back(self) -> None:
        self._snapshots.go_back()

    def _remove(self) -> None:
        state = self._snapshots.chosen
        if state is not None:
            self._snapshots.remove(state.number)


def _is_shown(row: FigureDifference) -> bool:
    """Whether it is shown while not all are: what differs, and the figures of the sensor."""
    return row.differs or row.name in _ALWAYS
