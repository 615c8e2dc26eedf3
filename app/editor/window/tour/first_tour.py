"""The first tour: six steps on the real window that build `first_steps`, done by the user."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from PySide6.QtCore import QEvent, QObject, QRect, QTimer
from PySide6.QtWidgets import QDockWidget, QMainWindow, QWidget

from app.editor.session import Session
from app.editor.window.docks.viewer_docks import ViewerDocks
from app.editor.window.documents.files import Files
from app.editor.window.documents.remembered_settings import Settings
from app.editor.window.tour.tour_card import PartFrame, TourCard
from app.editor.window.tour.tour_steps import STEPS, Part, TourModel
from app.run.shipped import shipped_networks
from core.network.file import read_network

MODEL = "first_steps"
_END = "That is a whole chain: save it with Ctrl+S, or open others from File, Welcome Page."


class FirstTour(QObject):
    """Shows the steps one after another; each is an ordinary edit, undone like any other.

    Parameters
    ----------
    session, files, settings, viewers
        Those of the window.
    window : QMainWindow
        What it is shown in.
    parts : mapping
        Widgets of the window by what steps call them.
    left : callable
        Called when it is left before anything was built.
    frame : callable
        Has all of the network in sight, before a step that is done on the canvas.
    """

    def __init__(
        self,
        session: Session,
        files: Files,
        settings: Settings,
        viewers: ViewerDocks,
        window: QMainWindow,
        parts: Mapping[Part, QWidget],
        left: Callable[[], None],
        frame: Callable[[], None],
    ) -> None:
        super().__init__(window)
        self._session, self._files, self._settings = session, files, settings
        self._viewers, self._window, self._parts = viewers, window, parts
        self._left, self._frame_all = left, frame
        self._model: TourModel | None = None
        self._number = 0
        self._done = False
        self._soon = self._timer(self._go_on)
        self._moved = self._timer(self._place)
        self.card = TourCard(window)
        self.frame = PartFrame(window)
        self.card.back.connect(self.back)
        self.card.next.connect(self.next)
        self.card.left.connect(self.leave)
        session.changed.connect(self._changed)
        session.opened.connect(self._opened)

    @property
    def running(self) -> bool:
        """Whether it is shown."""
        return self._model is not None

    def begin(self) -> None:
        """Begin with an empty network, after the question about unsaved work."""
        self._settings.toured = True
        self._files.new(self._begin)

    def next(self) -> None:
        """Do the step, where it is not done, and go on."""
        if self._model is None:
            return
        operation = self._model.operation(self._session.network, self._number)
        if operation is None:
            self._show(self._number + 1)
        elif not self._session.do(operation):  # done, it goes on by itself
            return

    def back(self) -> None:
        """Show the step before; what was done stays."""
        self._show(max(self._number - 1, 0))

    def leave(self) -> None:
        """End it; what was built stays."""
        if self.close() and not self._session.network.nodes:
            self._left()

    def close(self) -> bool:
        """End it, whatever the window shows next; whether it was shown."""
        if self._model is None:
            return False
        self._model = None
        self._window.removeEventFilter(self)
        self._viewer().removeEventFilter(self)
        self.card.hide()
        self.frame.surround(None)
        return True

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Follow the window and the viewer that the card stands on."""
        if event.type() in (QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.Hide):
            self._moved.start(0)
        return False

    def _timer(self, target: Callable[[], None]) -> QTimer:
        timer = QTimer(self)
        timer.setSingleShot(True)
        timer.timeout.connect(target)
        return timer

    def _begin(self) -> None:
        file = shipped_networks()[MODEL]
        self._model = TourModel(read_network(file, library=self._session.library))
        self._window.installEventFilter(self)
        self._viewer().installEventFilter(self)
        self._show(0)

    def _changed(self, *_: object) -> None:
        """Go on once the step has been done; a step that was done before waits for Next."""
        if self._model is None or self._number >= len(STEPS):
            return
        done = self._model.is_done(self._session.network, self._number)
        if done and not self._done:
            # Not while the change is still made known to the rest of the window.
            self._soon.start(0)
        self._done = done

    def _go_on(self) -> None:
        model, number = self._model, self._number
        if model is None or number >= len(STEPS):
            return
        if model.is_done(self._session.network, number):
            self._show(number + 1)

    def _opened(self) -> None:
        """Another network was opened: the tour is over."""
        self.close()

    def _show(self, number: int) -> None:
        model = self._model
        if model is None:
            return
        self._number = number
        last = number >= len(STEPS)
        if last:
            place, text, part = "Done", _END, None
        else:
            step = STEPS[number]
            place, text = f"Step {number + 1} of {len(STEPS)}", step.text
            part = self._parts[step.part]
            self._done = model.is_done(self._session.network, number)
            if step.part == "panels":
                self._show_blur(model)
            if step.part == "canvas":
                self._frame_all()
        self.frame.surround(part)
        self.card.show_step(place, text, first=number == 0, last=last)
        self._place()

    def _show_blur(self, model: TourModel) -> None:
        """Have the blur's panel open, and its picture in the first viewer."""
        network = self._session.network
        blur, back = model.name(network, "blur"), model.name(network, "back")
        if blur is not None:
            self._session.select([blur])
        if back is not None:
            self._viewers.look_at(1, f"{back}.image")

    def _viewer(self) -> QDockWidget:
        return self._viewers.docks[1]

    def _place(self) -> None:
        """Stand on the first viewer, beside its picture; without one, on the window."""
        if self._model is None:
            return
        viewer = self._viewer()
        beside = viewer.isVisible() and not viewer.isFloating()
        corner = viewer.geometry() if beside else QRect(self._window.rect())
        self.card.stand_in(corner)
        self.card.raise_()
