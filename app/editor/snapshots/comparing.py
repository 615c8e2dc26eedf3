"""The viewers beside A: each shows what was kept of its wire, the plot its curves."""

from __future__ import annotations

from typing import Any, Protocol

from PySide6.QtCore import QObject, QTimer

from app.editor.evaluation.queries import Query
from app.editor.session import Session
from app.editor.snapshots.kept_state import KeptState
from app.editor.snapshots.snapshots import Snapshots
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.picture.kept_side import KeptSide
from app.editor.viewers.plot.plot_export import Data
from app.editor.viewers.plot.plot_viewer import PlotViewer


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
