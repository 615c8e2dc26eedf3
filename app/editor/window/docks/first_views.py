"""Showing what is most useful of a network that has just been opened: its picture first."""

from __future__ import annotations

from PySide6.QtCore import QObject

from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.editor.window.docks.viewer_docks import ViewerDocks
from app.editor.window.documents.first_look import FirstLook, first_look


class FirstViews(QObject):
    """Follows what is opened.

    The picture is looked at as soon as the network is planned, before anything is computed. What
    stands beside it comes with the end of that pass: a viewer of its own takes 0.1 s to make, in
    which the picture would wait.

    Parameters
    ----------
    session : Session
        The document.
    evaluator : Evaluator
        Plans and computes.
    viewers : ViewerDocks
        Where it is shown.
    """

    def __init__(self, session: Session, evaluator: Evaluator, viewers: ViewerDocks) -> None:
        super().__init__(viewers)
        self._session = session
        self._evaluator = evaluator
        self._viewers = viewers
        self._due = False
        self._beside: FirstLook | None = None
        session.opened.connect(self._opened)
        evaluator.planned.connect(self._planned)
        evaluator.pass_done.connect(self._pass_done)

    def _opened(self) -> None:
        self._due = True
        self._beside = None

    def _planned(self, _plan: object) -> None:
        plan = self._evaluator.plan
        if not self._due or plan is None or not plan.network.nodes:
            return  # an empty network waits for its first nodes
        self._due = False
        self._beside = look = first_look(plan)
        if look.pictures:
            self._viewers.look_at(1, look.pictures[0])
        if look.front > 1:
            self._look_beside()

    def _pass_done(self, done: object) -> None:
        if self._due:
            self._planned(done)
        elif self._beside is not None:
            self._viewers.images[1].canvas.viewport().repaint()  # before the others are made
            self._look_beside()

    def _look_beside(self) -> None:
        look, self._beside = self._beside, None
        if look is None:
            return
        self._viewers.look_beside(look)
        if look.node is not None and not self._session.selection:
            self._session.select([look.node])
