"""Snapshots of the open document: what was shown of a state, A, beside the present one, B."""

from collections.abc import Hashable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar

from PySide6.QtCore import QObject, QTimer, Signal

from app.editor.declared_text import error_text, label_of
from app.editor.docks.tradeoff_view import SideWork
from app.editor.evaluation.changes import content
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Passing, Query
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer, KeptSide, Way
from app.editor.viewers.picture.picture_query import KeptPicture, PictureQuery
from app.editor.viewers.plot.figures_strip import NONE, figure_text
from app.editor.viewers.plot.plot_viewer import PlotViewer
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
            units = {one.name: planned.unit(one) for one in planned.declaration.readouts}
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
