"""The snapshots of the open document: kept, named, compared with the present, gone back to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime
from typing import Any, Protocol

from PySide6.QtCore import QObject, QTimer, Signal

from app.editor.docks.snapshot_states import KeepQuery, KeptResults, KeptState, Source, bounded
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Query
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.picture.kept_side import KeptSide, Way
from app.editor.viewers.plot.plot_export import Data
from app.editor.viewers.plot.plot_viewer import PlotViewer
from core.editing.operations import Restored
from core.machine import store_bytes

OWNER = "snapshots.kept"
SHARE = 4
"""Snapshots keep at most this part of what computed values may take, in pictures."""


class Snapshots(QObject):
    """Any number of states of one document; those of another go when it is opened.

    One of them is A, the one that the present, B, is compared with: the newest, until another is
    chosen. The document knows nothing of them: undo leaves them alone.

    Parameters
    ----------
    session : Session
        The open document.
    evaluator : Evaluator
        Collects what is kept, in moments when nothing else is computed.
    parent : QObject
        Qt's owner.
    capacity_bytes : int, optional
        Most bytes of pictures that are kept; by default a quarter of what computed values may take.

    Attributes
    ----------
    shown : frozenset of str
        Ports that are on display: their pictures of A are not dropped.

    Signals
    -------
    changed
        The list, what was computed of a state, which one is A, or how it is compared.
    """

    changed = Signal()

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator,
        parent: QObject,
        capacity_bytes: int | None = None,
    ) -> None:
        super().__init__(parent)
        self._session = session
        self._evaluator = evaluator
        self.capacity_bytes = store_bytes() // SHARE if capacity_bytes is None else capacity_bytes
        self._states: tuple[KeptState, ...] = ()
        self._chosen: int | None = None
        self._numbers = 0
        self._way: Way | None = None
        self._wanted: dict[KeepQuery, int] = {}
        self.shown: frozenset[str] = frozenset()
        session.opened.connect(self._forget)
        evaluator.answered.connect(self._answered)

    @property
    def states(self) -> tuple[KeptState, ...]:
        """The states that are kept, the oldest first."""
        return self._states

    @property
    def chosen(self) -> KeptState | None:
        """The one that the present is compared with."""
        return self.state(self._chosen)

    @property
    def way(self) -> Way | None:
        """How pictures are compared now; None where B is shown alone."""
        return self._way

    def state(self, number: int | None) -> KeptState | None:
        """The state of that number; None where there is none."""
        return next((state for state in self._states if state.number == number), None)

    def keep(self, ports: Iterable[str], curves: Iterable[Query]) -> KeptState:
        """Keep the present state with these pictures and curves; it is A from now on."""
        session, evaluator = self._session, self._evaluator
        posted, plan = evaluator.posted, evaluator.plan
        network = session.plain if posted is None else posted
        planned = plan if plan is not None and plan.network is network else None
        source = Source(network, session.folder, planned)
        self._numbers += 1
        state = KeptState(
            self._numbers,
            f"Snapshot {self._numbers}",
            datetime.now(),
            session.document.network,
            session.network,
            KeptResults(source),
        )
        self._states = (*self._states, state)
        self._chosen = state.number
        if self._way == "flip":  # it would look as if nothing followed edits
            self._way = None
        query = KeepQuery(source, tuple(dict.fromkeys(ports)), tuple(curves), figures=True)
        self._wanted[query] = state.number
        self._ask()
        session.message.emit(
            "note", f"kept as {state.name}: K flips to it and back, W wipes between it and now"
        )
        self.changed.emit()
        return state

    def choose(self, number: int) -> None:
        """Compare the present with that state."""
        if number != self._chosen and self.state(number) is not None:
            self._chosen = number
            self._bound()
            self.changed.emit()

    def rename(self, number: int, name: str) -> None:
        """Give a state another name; an empty one is not taken."""
        name = " ".join(name.split())
        state = self.state(number)
        if state is not None and name:
            self._put(replace(state, name=name))
        self.changed.emit()

    def remove(self, number: int) -> None:
        """Keep a state no longer; where it was A, the newest left is."""
        self._states = tuple(state for state in self._states if state.number != number)
        self._wanted = {query: of for query, of in self._wanted.items() if of != number}
        if self._chosen == number:
            self._chosen = self._states[-1].number if self._states else None
        if self._chosen is None:
            self._way = None
        self._ask()
        self.changed.emit()

    def go_back(self, number: int | None = None) -> None:
        """Make the document what it was in that state, or in A: a step that can be undone."""
        state = self.chosen if number is None else self.state(number)
        session = self._session
        if state is None:
            self._say_none()
        elif session.do(Restored(state.network, f"Go back to {state.name}")):
            session.message.emit("note", f"back at {state.name}; Ctrl+Z undoes it")
        else:
            session.message.emit("note", f"the network is as in {state.name} already")

    def flip(self) -> None:
        """Show A in the place of B, or B again."""
        self._compare(None if self._way == "flip" else "flip")

    def wipe(self) -> None:
        """Show A and B on both sides of a wipe, or B alone again."""
        self._compare(None if self._way == "wipe" else "wipe")

    def want_picture(self, port: str) -> str:
        """Have a picture of A; why there is none, or empty where it is there."""
        state = self.chosen
        if state is None or port in state.results.pictures:
            return ""
        if (why := state.results.missing.get(port)) is not None:
            return f"{state.name} has no {port}: {why}"
        if not any(port in query.ports for query in self._of(state)):
            self._want(state, KeepQuery(state.results.source, (port,)))
        return f"{port} of {state.name} is being computed"

    def want_curve(self, query: Query) -> None:
        """Have the curves of A that answer a query of the plot viewer."""
        state = self.chosen
        if state is None or query in state.results.curves:
            return
        if not any(query in wanted.curves for wanted in self._of(state)):
            for other in self._of(state):  # of an angle that is turned only the last one counts
                if not (other.ports or other.figures):
                    del self._wanted[other]
            self._want(state, KeepQuery(state.results.source, (), (query,)))

    def _compare(self, way: Way | None) -> None:
        if self.chosen is None:
            self._say_none()
            return
        self._way = way
        self.changed.emit()

    def _say_none(self) -> None:
        self._session.message.emit("advice", "nothing is kept yet: Ctrl+K keeps the present state")

    def _of(self, state: KeptState) -> list[KeepQuery]:
        return [query for query, number in self._wanted.items() if number == state.number]

    def _want(self, state: KeptState, query: KeepQuery) -> None:
        self._wanted[query] = state.number
        self._ask()

    def _ask(self) -> None:
        if self._wanted:
            self._evaluator.ask(OWNER, tuple(self._wanted))
        else:
            self._evaluator.forget(OWNER)

    def _answered(self, answer: Any) -> None:
        if answer.owner != OWNER or answer.query not in self._wanted:
            return
        query: KeepQuery = answer.query
        state = self.state(self._wanted.pop(query))
        self._ask()
        if state is None:
            return
        results = answer.value
        if not isinstance(results, KeptResults):  # the network as a whole cannot be planned
            results = KeptResults(
                state.results.source,
                curves=dict.fromkeys(query.curves),
                figures=() if query.figures else None,
                missing=dict.fromkeys(query.ports, str(answer.error)),
            )
        self._put(replace(state, results=state.results.joined(results)))
        self._bound()
        self.changed.emit()

    def _put(self, changed: KeptState) -> None:
        self._states = tuple(
            changed if state.number == changed.number else state for state in self._states
        )

    def _bound(self) -> None:
        """Drop pictures beyond what may be kept, and say so."""
        self._states, dropped = bounded(self._states, self.capacity_bytes, self._chosen, self.shown)
        if dropped:
            names = ", ".join(dropped)
            self._session.message.emit(
                "note",
                f"snapshots keep {self.capacity_bytes / 2**20:.0f} MiB of pictures: some of "
                f"{names} are dropped, and computed again when compared",
            )

    def _forget(self) -> None:
        """Another document is open: what was kept of the last one goes with it."""
        count = len(self._states)
        self._states, self._chosen, self._way, self._numbers = (), None, None, 0
        self._wanted.clear()
        self._evaluator.forget(OWNER)
        self.changed.emit()
        if count:
            text = "the snapshot" if count == 1 else f"the {count} snapshots"
            QTimer.singleShot(
                0, self, lambda: self._say(f"{text} of the last network went with it")
            )

    def _say(self, text: str) -> None:
        self._session.message.emit("note", text)


class Viewers(Protocol):
    """The viewers of the window."""

    images: dict[int, ImageViewer]
    plot: PlotViewer

    @property
    def made(self) -> Any:
        """Signals that a viewer has been made."""


class Comparing(QObject):
    """Has the viewers compare with the state that is A, each its own wire.

    Parameters
    ----------
    session : Session
        The open document.
    snapshots : Snapshots
        The states.
    viewers : Viewers
        The viewers by number, and the plot.
    """

    def __init__(self, session: Session, snapshots: Snapshots, viewers: Viewers) -> None:
        super().__init__(snapshots)
        self._session = session
        self._snapshots = snapshots
        self._viewers = viewers
        self._followed: set[int] = set()
        snapshots.changed.connect(self.follow)
        viewers.plot.posted.connect(self.follow)
        # A viewer that is made is in its place a moment later.
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self.follow)
        viewers.made.connect(self._follow_soon)
        self.follow()

    def keep(self) -> None:
        """Keep the present state, with what the viewers show of it."""
        if not self._session.network.nodes:
            self._session.message.emit("advice", "the network is empty: there is nothing to keep")
            return
        self._snapshots.keep(self._ports(), self._curves())

    def follow(self, *_: object) -> None:
        """Show beside the present what A has of it; what it lacks is computed in a quiet moment."""
        images = self._viewers.images
        self._snapshots.shown = frozenset(self._ports())
        for number, viewer in images.items():
            if number not in self._followed:
                self._followed.add(number)
                viewer.posted.connect(self.follow)
            viewer.compare_kept(self._side(viewer))
            if self._snapshots.chosen is None:
                viewer.forget_kept()
        self._viewers.plot.compare_kept(*self._kept_curves())

    def _follow_soon(self, _made: object) -> None:
        self._soon.start()

    def _side(self, viewer: ImageViewer) -> KeptSide | None:
        state, way, port = self._snapshots.chosen, self._snapshots.way, viewer.choices.port
        if state is None or way is None or port is None or not viewer.isVisible():
            return None
        missing = self._snapshots.want_picture(port)
        return KeptSide(state.results.pictures.get(port), _name(state), way, missing)

    def _kept_curves(self) -> tuple[Data | None, str]:
        state, plot = self._snapshots.chosen, self._viewers.plot
        if state is None or not plot.isVisible():
            return None, ""
        curves = state.results.curves
        for query in plot.queries():
            self._snapshots.want_curve(query)
            return curves.get(query), state.name
        return None, ""

    def _ports(self) -> list[str]:
        """Wires on display; without any, those that the viewers would show."""
        images = self._viewers.images.values()
        seen = [viewer.choices.port for viewer in images if viewer.isVisible()]
        ports = seen or [viewer.choices.port for viewer in images]
        return [port for port in ports if port is not None]

    def _curves(self) -> list[Query]:
        return list(self._viewers.plot.queries())


def _name(state: KeptState) -> str:
    return f"{state.name} · {state.time}"
