"""The states of the open document: its history, and snapshots, one of which stands beside it."""

from collections.abc import Hashable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QObject, QSignalBlocker, QSize, Qt, QTimer, Signal

from app.editor.declared_text import error_text, label_of
from app.editor.docks.tradeoff_view import SideWork
from app.editor.evaluation.changes import content
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer, KeptSide, Way
from app.editor.viewers.picture.picture_query import KeptPicture, PictureQuery
from app.editor.viewers.plot.figures_strip import NONE, figure_text
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import (
    ElidedLabel,
    filled,
    labelled,
    toggle_button,
    tool_button,
)
from app.run.terminal import number_text, without_rounding
from core.chain.engine import Plan
from core.editing.operations import restored
from core.errors import Cancelled, ImagechainError
from core.network.network import Network
from core.records import dataclass, replace

NOTHING_KEPT = "there are no snapshots yet: press Ctrl+K to keep the current state"
_OWNER = "snapshots.kept"

Figures = Mapping[tuple[str, str], tuple[Any, str]]
"""Value and unit of every read-out, by node and name."""


@dataclass(frozen=True)
class AllFiguresQuery(Query):
    """The read-outs of all nodes in the network's order; of those that fail, none."""

    waits: ClassVar[bool] = True

    def key(self, plan: Plan) -> Hashable:
        return tuple((name, content(planned)) for name, planned in plan.nodes.items())

    def answer(self, passing: Passing) -> Figures:
        work = SideWork(passing.work)
        figures: dict[tuple[str, str], tuple[Any, str]] = {}
        for name, planned in passing.plan.nodes.items():
            if planned.error is not None or planned.node.disabled:
                continue
            units = planned.units
            try:
                values = passing.engine.readouts(passing.plan, name, work) if units else {}
            except Cancelled:
                raise
            except ImagechainError:  # the node's badge has it
                continue
            figures |= {(name, key): (value, units[key]) for key, value in values.items()}
        return figures


@dataclass(eq=False)
class Snapshot:
    """A state that is kept: the document, and the network as it was computed."""

    name: str
    taken: datetime
    document: Network
    network: Network
    folder: Path
    plan: Plan | None = None  # which holds no arrays


@dataclass(frozen=True)
class SnapshotQuery(Query):
    """What is shown of a snapshot, whatever the network has become meanwhile.

    Pictures are wanted by their ports, all else by its query. What has been shown is in the store,
    and only referred to; what has to be computed leaves the store's room to the next edit.
    """

    waits: ClassVar[bool] = True

    state: Snapshot
    wanted: tuple[str | Query, ...]

    def key(self, plan: Plan) -> Hashable:  # noqa: ARG002 - it is of another state
        return self

    def answer(self, passing: Passing) -> dict[str | Query, Any]:
        """By what was wanted; in the place of what fails, why: no node of today's has failed."""
        return {wanted: self._answer(wanted, passing) for wanted in self.wanted}

    def _answer(self, wanted: str | Query, passing: Passing) -> Any:
        state = self.state
        try:
            if state.plan is None:
                state.plan = passing.engine.plan(state.network, folder=state.folder)
            of_state = replace(passing, plan=state.plan, work=SideWork(passing.work), reduced=1)
            if isinstance(wanted, str):
                return PictureQuery(wanted).kept_picture(of_state)
            return wanted.answer(of_state)
        except Cancelled:
            raise
        except ImagechainError as error:
            return error


class Snapshots(QObject):
    """Any number of states of one document; those of another go when it is opened.

    One of them is A, the one that the present, B, is compared with: the newest, until another is
    chosen. Of A alone is held what is shown; of another it is computed once it is A. Pictures of A
    and B are compared in one way or the other; without one, B is shown alone.
    """

    # the list, what was computed of a state, which one is A, or how it is compared
    changed = Signal()

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator,
        images: Mapping[int, ImageViewer],
        plot: PlotViewer,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._session, self._evaluator = session, evaluator
        self._images, self._plot = images, plot
        self.states: list[Snapshot] = []  # the oldest first
        self.chosen: Snapshot | None = None
        self.way: Way | None = None
        self.results: dict[str | Query, Any] = {}  # of A
        self._numbers = 0
        self._followed: set[int] = set()
        session.opened.connect(self._forget)
        evaluator.answered.connect(self._answered)
        plot.posted.connect(self.follow)
        self.follow()

    @property
    def figures(self) -> Figures | None:
        """Those of A; None until they are computed."""
        found = self.results.get(AllFiguresQuery())
        return {} if isinstance(found, ImagechainError) else found

    def keep(self) -> None:
        session, evaluator = self._session, self._evaluator
        if not session.network.nodes:
            self._say("the network is empty: there is nothing to keep", "advice")
            return
        network = session.plain if evaluator.posted is None else evaluator.posted
        self._numbers += 1
        name, document = f"Snapshot {self._numbers}", session.document.network
        state = Snapshot(name, datetime.now(), document, network, session.folder)
        self.states.append(state)
        if self.way == "flip":  # it would look as if nothing followed edits
            self.way = None
        self.choose(state)
        self._say(
            f"kept as {name}: K switches between {name} and the current state; W shows both with a "
            "divider"
        )

    def choose(self, state: Snapshot | None) -> None:
        if state is not self.chosen:
            self.chosen = state
            self.results = {}
            self._update()

    def rename(self, state: Snapshot, name: str) -> None:
        state.name = " ".join(name.split()) or state.name
        self._update()

    def remove(self, state: Snapshot | None) -> None:
        """Keep a state no longer; where it was A, the newest left is."""
        if state is None:
            return
        self.states.remove(state)
        if self.chosen is state:
            self.way = self.way if self.states else None
            self.choose(self.states[-1] if self.states else None)
        else:
            self._update()

    def go_back(self, state: Snapshot | None = None) -> None:
        """Make the document what it was in that state, or in A: a step that can be undone."""
        state = state or self.chosen
        if state is None:
            self._say(NOTHING_KEPT, "advice")
        elif self._session.do(restored(state.document, f"Go back to {state.name}")):
            self._say(f"restored {state.name}; press Ctrl+Z to undo")
        else:
            self._say(f"the network already matches {state.name}")

    def compare(self, way: Way) -> None:
        """Show A in the place of B, or both at the sides of a wipe; again: B alone."""
        if self.chosen is None:
            self._say(NOTHING_KEPT, "advice")
        else:
            self.way = None if self.way == way else way
            self._update()

    # --- beside the present ------------------------------------------------------------------

    def follow(self, *_: object) -> None:
        """Show beside the present what A has of it; what it lacks is computed in a quiet moment."""
        self._ask()
        for number, viewer in self._images.items():
            if number not in self._followed:
                self._followed.add(number)
                viewer.posted.connect(self.follow)
            viewer.compare_kept(self._side(viewer))
        data = None
        for query in self._curves():  # one, or none where the selected node has no curves
            data = self.results.get(query)
        name = "" if self.chosen is None else self.chosen.name
        self._plot.compare_kept(None if isinstance(data, ImagechainError) else data, name)

    def _side(self, viewer: ImageViewer) -> KeptSide | None:
        state, port = self.chosen, viewer.choices.port
        if state is None or self.way is None or not port or not viewer.isVisible():
            return None
        found, missing = self.results.get(port), ""
        if found is None:
            missing = f"{port} of {state.name} is still being computed"
        elif isinstance(found, ImagechainError):
            missing = f"{state.name} has no {port}: {error_text(found)}"
        kept = found if isinstance(found, KeptPicture) else None
        return KeptSide(kept, f"{state.name} · {state.taken:%H:%M:%S}", self.way, missing)

    def _curves(self) -> tuple[Query, ...]:
        return self._plot.queries() if self.chosen is not None and self._plot.isVisible() else ()

    def _ask(self) -> None:
        state, images = self.chosen, self._images.values()
        seen = [viewer.choices.port for viewer in images if viewer.isVisible()]
        ports = seen or [viewer.choices.port for viewer in images]
        pictures = filter(None, ports)
        wanted: list[str | Query] = [*dict.fromkeys(pictures), *self._curves(), AllFiguresQuery()]
        self.results = {one: self.results[one] for one in wanted if one in self.results}
        missing = tuple(one for one in wanted if one not in self.results)
        asked = (SnapshotQuery(state, missing),) if state is not None and missing else ()
        self._evaluator.ask(_OWNER, asked)

    def _answered(self, answer: Any) -> None:
        query = answer.query
        if answer.owner != _OWNER or query.state is not self.chosen:
            return
        if answer.error is None:
            self.results |= answer.value
        else:  # the network as a whole cannot be planned
            self.results |= dict.fromkeys(query.wanted, answer.error)
        self._update()

    def _forget(self) -> None:
        if self.states:
            text = "the snapshots of the previous network were removed"
            QTimer.singleShot(0, self, lambda: self._say(text))
        self.states, self.way, self._numbers = [], None, 0
        self.choose(None)

    def _update(self) -> None:
        self.follow()
        self.changed.emit()

    def _say(self, text: str, kind: str = "note") -> None:
        self._session.message.emit(kind, text)


def changed_figures(before: Figures, now: Figures) -> tuple[list[str], int]:
    """A line for each figure that differs in six digits, and how many there are in all."""
    lines, count = [], 0
    for node, name in dict.fromkeys((*now, *before)):
        a, b = _texts(before.get((node, name))), _texts(now.get((node, name)))
        count += {a[0], b[0]} != {NONE}
        if a[0] != b[0]:
            which = a[1] == b[1]  # then all digits
            lines.append(f"{node} {label_of(name)}: {a[not which]} → {b[not which]}")
    return lines, count


def _texts(figure: tuple[Any, str] | None) -> tuple[str, str]:
    """A figure in six digits, and as it is shown elsewhere."""
    value, unit = figure or (None, "")
    if value is None:
        return NONE, NONE
    exact = f"{number_text(without_rounding(value, unit))} {unit}".rstrip()
    return exact, number_text(value) if isinstance(value, bool) else figure_text(value, unit)


_STATE = Qt.ItemDataRole.UserRole


class SnapshotsView(Viewer):
    room = 75, 20

    def __init__(self, session: Session, evaluator: Evaluator, snapshots: Snapshots) -> None:
        super().__init__(session, evaluator, "snapshots")
        self.setAccessibleName("Snapshots")
        self._snapshots = snapshots
        self._now: Figures | None = None
        self._build()
        snapshots.changed.connect(self._follow_snapshots)
        self._follow_snapshots()

    def queries(self) -> Sequence[Query]:
        return () if self._snapshots.chosen is None else (AllFiguresQuery(),)

    def take(self, answer: Answer) -> None:
        self._now = answer.value
        self._fill_figures()

    def follow_opening(self) -> None:
        self._now = None
        self._follow_snapshots()

    def showEvent(self, event: QtGui.QShowEvent) -> None:
        super().showEvent(event)
        self._follow_snapshots()

    def _build(self) -> None:
        kept, about = self._snapshots, "Keep the current state as a snapshot (Ctrl+K)"
        self.keep = tool_button("snapshots.keep", "Keep", about, self, kept.keep)
        self.flip = toggle_button("snapshots.flip", "Flip", "Switch between A and B (K)", self)
        about = "Show A on the left and B on the right of a divider (W)"
        self.wipe = toggle_button("snapshots.wipe", "Wipe", about, self)
        about = "Restore the network to A; you can undo this"
        self.back = tool_button("snapshots.back", "Go Back", about, self, kept.go_back)
        self.remove = tool_button("snapshots.remove", "Remove", "Delete A (Del)", self)
        self.flip.clicked.connect(lambda: kept.compare("flip"))
        self.wipe.clicked.connect(lambda: kept.compare("wipe"))
        self.remove.clicked.connect(lambda: kept.remove(kept.chosen))
        self.list = SnapshotList(self._snapshots)
        self.title = ElidedLabel("snapshots.title", "Number of figures that differ", self)
        self.title.setContentsMargins(6, 0, 2, 0)
        self.figures = labelled(
            QtWidgets.QListWidget(self, wordWrap=True), "snapshots.figures",
            "Figures that differ; Ctrl+C copies the selected figure",
            "Figures in the snapshot (A) → current figures (B)",
        )  # fmt: skip
        buttons = (self.keep, self.flip, self.wipe, self.back, self.remove)
        bar = filled(QtWidgets.QHBoxLayout(), *buttons, None, margins=(2, 2, 2, 0), spacing=3)
        line = self.fontMetrics().height()
        self.list.setMinimumHeight(4 * line)
        parts = QtWidgets.QSplitter(Qt.Orientation.Vertical, self, childrenCollapsible=False)
        parts.addWidget(self.list)
        parts.addWidget(self.figures)
        parts.setSizes([5 * line, 15 * line])
        margins = (0, 0, 0, 4)  # the line keeps off the ring of focus
        filled(QtWidgets.QVBoxLayout(self), bar, (parts, 1), self.title, margins=margins, spacing=1)

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


class SnapshotList(QtWidgets.QTreeWidget):
    """The newest first, the current row is A; F2 renames, Del removes, Enter goes back."""

    def __init__(self, snapshots: Snapshots) -> None:
        super().__init__(rootIsDecorated=False)
        self._snapshots = snapshots
        labelled(
            self, "snapshots.list", "Snapshots: F2 renames, Del deletes, Enter restores",
            "The selected snapshot is A. Press F2 to rename this snapshot, Del to delete it or "
            "Enter to restore it",
        )  # fmt: skip
        self.setHeaderLabels(["Snapshot", "Kept"])
        triggers = QtWidgets.QAbstractItemView.EditTrigger
        self.setEditTriggers(triggers.EditKeyPressed | triggers.DoubleClicked)
        self.header().setSectionResizeMode(0, QtWidgets.QHeaderView.ResizeMode.ResizeToContents)
        self.currentItemChanged.connect(self._current_changed)
        self.itemChanged.connect(self._renamed)

    def fill(self) -> None:
        states, chosen = self._snapshots.states[::-1], self._snapshots.chosen
        with QSignalBlocker(self):
            rows = range(self.topLevelItemCount())
            if states != [_state_of(self.topLevelItem(row)) for row in rows]:
                self.clear()
                self.addTopLevelItems([QtWidgets.QTreeWidgetItem() for _ in states])
            for row, state in enumerate(states):
                item = self.topLevelItem(row)
                assert item is not None
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsEditable)
                item.setData(0, _STATE, state)
                item.setText(0, state.name)
                item.setText(1, f"{state.taken:%H:%M:%S}")
                if state is chosen:
                    self.setCurrentItem(item)

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        item, key = self.currentItem(), event.key()
        if item is None or self.state() is QtWidgets.QAbstractItemView.State.EditingState:
            super().keyPressEvent(event)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self._snapshots.remove(_state_of(item))
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._snapshots.go_back(_state_of(item))
        else:
            super().keyPressEvent(event)

    def keyboardSearch(self, search: str) -> None:
        """Letters are shortcuts here, and look nothing up."""

    def _current_changed(self, item: QtWidgets.QTreeWidgetItem | None, _before: object) -> None:
        if item is not None:
            self._snapshots.choose(_state_of(item))

    def _renamed(self, item: QtWidgets.QTreeWidgetItem, _column: int) -> None:
        self._snapshots.rename(_state_of(item), item.text(0))


def _state_of(item: Any) -> Any:
    return item.data(0, _STATE)


class HistoryList(QtWidgets.QListWidget):
    """The present step is bold, undone ones are italic; a click or Enter goes to a step."""

    def __init__(self, session: Session) -> None:
        super().__init__(textElideMode=Qt.TextElideMode.ElideMiddle)
        tip = "Edits of this network; click an edit or press Enter to go back or forward to it"
        labelled(self, "history", "History", tip)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._session = session
        self.itemClicked.connect(self._go)
        self.itemActivated.connect(self._go)
        session.opened.connect(self._follow)
        session.state_changed.connect(self._follow)

    def showEvent(self, event: QtGui.QShowEvent) -> None:
        super().showEvent(event)
        self._follow()

    def sizeHint(self) -> QSize:
        return QSize(45, 40) * self.fontMetrics().averageCharWidth()

    def _go(self, item: QtWidgets.QListWidgetItem) -> None:
        self._session.document.go_to(self.row(item))

    def _follow(self) -> None:
        if not self.isVisible():
            return
        document = self._session.document
        font = self.font()
        self.clear()
        for row in range(document.last + 1):
            saved = row == document.saved and document.path is not None
            item = QtWidgets.QListWidgetItem(
                (document.line(row) or "Start") + ("  (saved)" if saved else "")
            )
            font.setBold(row == document.position)
            font.setItalic(row > document.position)
            item.setFont(font)
            self.addItem(item)
        self.setCurrentRow(document.position)
