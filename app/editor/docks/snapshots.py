"""Snapshots of the open document: what was shown of a state, A, beside the present one, B."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.editor.declared_text import error_text, label_of
from app.editor.docks.tradeoff_view import SideWork
from app.editor.evaluation.changes import content
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Passing, Query
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer, KeptSide, Way
from app.editor.viewers.pixels.picture_query import KeptPicture, PictureQuery
from app.editor.viewers.plot.figures_strip import NONE, figure_text
from app.editor.viewers.plot.plot_export import Data
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.run.readout_tables import number_text, without_rounding
from core.chain.engine import Plan
from core.editing.operations import restored
from core.errors import Cancelled, ImagechainError
from core.evaluation.work import Work
from core.machine import store_bytes
from core.network.network import Network

MOST_CURVES = 8  # of a plot turned to many angles those of the last ones are kept
SHARE = 4  # of what computed values may take, for pictures of snapshots: one part in so many
NOTHING_KEPT = "there are no snapshots yet: Ctrl+K keeps the current state"
_OWNER = "snapshots.kept"

Figures = Mapping[tuple[str, str], tuple[Any, str]]
"""Value and unit of every read-out, by node and name."""


def all_figures(passing: Passing, work: Work) -> Figures:
    """The read-outs of all nodes in the network's order; of those that fail, none."""
    figures: dict[tuple[str, str], tuple[Any, str]] = {}
    for name, planned in passing.plan.nodes.items():
        if planned.error is not None or planned.node.disabled:
            continue
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        if not declared:
            continue
        try:
            values = passing.engine.readouts(passing.plan, name, work)
        except Cancelled:
            raise
        except ImagechainError:  # the node's badge has it
            continue
        for key, value in values.items():
            figures[name, key] = value, planned.unit(declared[key])
    return figures


@dataclass(frozen=True)
class AllFiguresQuery(Query):
    waits: ClassVar[bool] = True

    def key(self, plan: Plan) -> Hashable:
        return tuple((name, content(planned)) for name, planned in plan.nodes.items())

    def answer(self, passing: Passing) -> Figures:
        return all_figures(passing, SideWork(passing.work))


@dataclass(eq=False)
class Source:
    """The network of a snapshot as it was computed, and its plan, which holds no arrays."""

    network: Network
    folder: Path
    plan: Plan | None = None


class Results(NamedTuple):
    pictures: Mapping[str, KeptPicture]
    curves: Mapping[Query, Data | None]
    figures: Figures | None
    missing: Mapping[str, str]


@dataclass(eq=False)
class Snapshot:
    """A state that is kept: the document, and what was shown of it.

    `pictures` are by ``NODE.PORT``, `missing` says of which there is none and why. `curves` are
    what the plot viewer shows for its queries, None where that is nothing. `figures` are None until
    they are computed.
    """

    number: int
    name: str
    taken: datetime
    network: Network
    source: Source
    pictures: dict[str, KeptPicture] = field(default_factory=dict)
    curves: dict[Query, Data | None] = field(default_factory=dict)
    figures: Figures | None = None
    missing: dict[str, str] = field(default_factory=dict)

    def add(self, results: Results) -> None:
        """Take what was computed later; of curves the last few stay."""
        self.pictures |= results.pictures
        self.missing |= results.missing
        curves = {**self.curves, **results.curves}
        self.curves = dict(list(curves.items())[-MOST_CURVES:])
        self.figures = self.figures if results.figures is None else results.figures


@dataclass(frozen=True)
class SnapshotQuery(Query):
    """What is computed of a snapshot, whatever the network has become meanwhile.

    It waits for all that is shown, and stops for whatever comes. What has been shown is in the
    store, and only referred to; what has to be computed leaves the store's room to the next edit.
    """

    waits: ClassVar[bool] = True

    source: Source
    ports: tuple[str, ...] = ()
    curves: tuple[Query, ...] = ()
    figures: bool = False

    def key(self, plan: Plan) -> Hashable:  # noqa: ARG002 - it is of another state
        return self

    def answer(self, passing: Passing) -> Results:
        """What is kept; a picture or curve that fails is left out, with the reason."""
        source = self.source
        if source.plan is None and passing.plan.network is source.network:
            source.plan = passing.plan
        elif source.plan is None:
            source.plan = passing.engine.plan(source.network, folder=source.folder)
        of_state = replace(passing, plan=source.plan, work=SideWork(passing.work), reduced=1)
        pictures: dict[str, KeptPicture] = {}
        curves: dict[Query, Data | None] = {}
        missing: dict[str, str] = {}
        for port in self.ports:
            try:
                pictures[port] = PictureQuery(port).kept_picture(of_state)
            except Cancelled:
                raise
            except ImagechainError as error:
                missing[port] = error_text(error)
        for query in self.curves:
            try:
                curves[query] = query.answer(of_state)
            except Cancelled:
                raise
            except ImagechainError:  # the plot then has the present curves alone
                curves[query] = None
        figures = all_figures(of_state, of_state.work) if self.figures else None
        return Results(pictures, curves, figures, missing)


class Snapshots(QObject):
    """Any number of states of one document; those of another go when it is opened.

    One of them is A, the one that the present, B, is compared with: the newest, until another is
    chosen. Pictures of A and B are compared in one way or the other; without one, B is shown alone.
    The document knows nothing of snapshots: undo leaves them alone.
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
        self.capacity_bytes = store_bytes() // SHARE
        self.states: list[Snapshot] = []  # the oldest first
        self.chosen: Snapshot | None = None
        self.way: Way | None = None
        self._numbers = 0
        self._wanted: dict[SnapshotQuery, Snapshot] = {}
        self._followed: set[int] = set()
        session.opened.connect(self._forget)
        evaluator.answered.connect(self._answered)
        plot.posted.connect(self.follow)
        self.follow()

    def keep(self) -> None:
        session, evaluator = self._session, self._evaluator
        if not session.network.nodes:
            self._say("the network is empty: there is nothing to keep", "advice")
            return
        network = session.plain if evaluator.posted is None else evaluator.posted
        plan = evaluator.plan
        planned = plan if plan is not None and plan.network is network else None
        source = Source(network, session.folder, planned)
        self._numbers += 1
        name = f"Snapshot {self._numbers}"
        state = Snapshot(self._numbers, name, datetime.now(), session.document.network, source)
        self.states.append(state)
        self.chosen = state
        if self.way == "flip":  # it would look as if nothing followed edits
            self.way = None
        ports, curves = tuple(dict.fromkeys(self._ports())), tuple(self._plot.queries())
        self._want(state, SnapshotQuery(source, ports, curves, figures=True))
        self._say(
            f"kept as {name}: K switches between it and the current state, W wipes between the two"
        )
        self._update()

    def choose(self, state: Snapshot) -> None:
        if state is not self.chosen:
            self.chosen = state
            self._drop_pictures()
            self._update()

    def rename(self, state: Snapshot, name: str) -> None:
        state.name = " ".join(name.split()) or state.name
        self._update()

    def remove(self, state: Snapshot | None) -> None:
        """Keep a state no longer; where it was A, the newest left is."""
        if state is None:
            return
        self.states.remove(state)
        self._wanted = {query: of for query, of in self._wanted.items() if of is not state}
        if self.chosen is state:
            self.chosen = self.states[-1] if self.states else None
        if self.chosen is None:
            self.way = None
        self._ask()
        self._update()

    def go_back(self, state: Snapshot | None = None) -> None:
        """Make the document what it was in that state, or in A: a step that can be undone."""
        state = state or self.chosen
        if state is None:
            self._say(NOTHING_KEPT, "advice")
        elif self._session.do(restored(state.network, f"Go back to {state.name}")):
            self._say(f"restored {state.name}; Ctrl+Z undoes it")
        else:
            self._say(f"the network is already as in {state.name}")

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
        for number, viewer in self._images.items():
            if number not in self._followed:
                self._followed.add(number)
                viewer.posted.connect(self.follow)
            viewer.compare_kept(self._side(viewer))
        state, plot = self.chosen, self._plot
        if state is None or not plot.isVisible():
            plot.compare_kept(None)
        else:
            for query in plot.queries():  # one, or none where the selected node has no curves
                self._want_curves(state, query)
                plot.compare_kept(state.curves.get(query), state.name)

    def _side(self, viewer: ImageViewer) -> KeptSide | None:
        state, port = self.chosen, viewer.choices.port
        if state is None or self.way is None or port is None or not viewer.isVisible():
            return None
        missing = ""
        if port in state.missing:
            missing = f"{state.name} has no {port}: {state.missing[port]}"
        elif port not in state.pictures:
            missing = f"{port} of {state.name} is still being computed"
            if not any(port in query.ports for query in self._wanted_of(state)):
                self._want(state, SnapshotQuery(state.source, (port,)))
        name = f"{state.name} · {state.taken:%H:%M:%S}"
        return KeptSide(state.pictures.get(port), name, self.way, missing)

    def _want_curves(self, state: Snapshot, query: Query) -> None:
        wanted = self._wanted_of(state)
        if query in state.curves or any(query in other.curves for other in wanted):
            return
        for other in wanted:  # of an angle that is turned only the last one counts
            if not (other.ports or other.figures):
                del self._wanted[other]
        self._want(state, SnapshotQuery(state.source, curves=(query,)))

    def _ports(self) -> list[str]:
        images = self._images.values()
        seen = [viewer.choices.port for viewer in images if viewer.isVisible()]
        ports = seen or [viewer.choices.port for viewer in images]
        return [port for port in ports if port is not None]

    # --- what is computed --------------------------------------------------------------------

    def _wanted_of(self, state: Snapshot) -> list[SnapshotQuery]:
        return [query for query, of in self._wanted.items() if of is state]

    def _want(self, state: Snapshot, query: SnapshotQuery) -> None:
        self._wanted[query] = state
        self._ask()

    def _ask(self) -> None:
        if self._wanted:
            self._evaluator.ask(_OWNER, tuple(self._wanted))
        else:
            self._evaluator.forget(_OWNER)

    def _answered(self, answer: Any) -> None:
        query = answer.query
        if answer.owner != _OWNER or not isinstance(query, SnapshotQuery):
            return
        state = self._wanted.pop(query, None)
        if state is None:
            return
        self._ask()
        if answer.error is None:
            state.add(answer.value)
        else:  # the network as a whole cannot be planned
            missing = dict.fromkeys(query.ports, str(answer.error))
            state.add(
                Results({}, dict.fromkeys(query.curves), {} if query.figures else None, missing)
            )
        self._drop_pictures()
        self._update()

    def _drop_pictures(self) -> None:
        dropped = drop_pictures(self.states, self.capacity_bytes, self.chosen, self._ports())
        if dropped:
            self._say(
                f"snapshots hold at most {self.capacity_bytes / 2**20:.0f} MiB of pictures: "
                f"those of {', '.join(dropped)} were dropped and will be computed again when "
                "you compare them"
            )

    def _forget(self) -> None:
        count = len(self.states)
        self.states, self.chosen, self.way, self._numbers = [], None, None, 0
        self._wanted.clear()
        self._ask()
        self._update()
        if count:
            gone = "the snapshot was" if count == 1 else f"the {count} snapshots were"
            text = f"{gone} removed with the previous network"
            QTimer.singleShot(0, self, lambda: self._say(text))

    def _update(self) -> None:
        self.follow()
        self.changed.emit()

    def _say(self, text: str, kind: str = "note") -> None:
        self._session.message.emit(kind, text)


def held_bytes(states: Iterable[Snapshot]) -> int:
    """Bytes of the samples that these states hold; what they share counts once."""
    arrays = {
        id(array): array.nbytes
        for state in states
        for picture in state.pictures.values()
        for array in (_owner(picture.samples),)
    }
    return sum(arrays.values())


def _owner(array: np.ndarray) -> np.ndarray:
    while isinstance(array.base, np.ndarray):
        array = array.base
    return array


def drop_pictures(
    states: Sequence[Snapshot],
    capacity_bytes: int,
    chosen: Snapshot | None,
    shown: Collection[str] = (),
) -> list[str]:
    """Drop pictures, the oldest first and those `shown` last, until the rest fits; of whom."""
    dropped = []
    for state in sorted(states, key=lambda state: state is chosen):
        if held_bytes(states) <= capacity_bytes:
            break
        ports = shown if state is chosen else ()
        left = {port: picture for port, picture in state.pictures.items() if port in ports}
        if len(left) < len(state.pictures):
            state.pictures = left
            dropped.append(state.name)
    return dropped


def changed_figures(before: Figures, now: Figures) -> tuple[list[str], int]:
    """A line for each figure that differs in six digits, and how many there are in all."""
    lines, count = [], 0
    for node, name in dict.fromkeys((*now, *before)):
        pair = before.get((node, name)), now.get((node, name))
        digits = [_digits(*figure) if figure else "" for figure in pair]
        count += any(digits)
        if digits[0] != digits[1]:
            shown = [_shown(*figure) if figure else NONE for figure in pair]
            if shown[0] == shown[1]:
                shown = [text or NONE for text in digits]
            lines.append(f"{node} {label_of(name)}: {shown[0]} → {shown[1]}")
    return lines, count


def _digits(value: Any, unit: str) -> str:
    if value is None:
        return ""
    return f"{number_text(without_rounding(value, unit))} {unit}".rstrip()


def _shown(value: Any, unit: str) -> str:
    return number_text(value) if isinstance(value, bool) else figure_text(value, unit)
