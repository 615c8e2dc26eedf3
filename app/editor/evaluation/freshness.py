"""Whether what a part of the window shows is of the network as it stands."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import PassDone
from app.editor.evaluation.tasks import computes_alike
from app.editor.session import Session

OLD_AFTER_MS = 250  # an answer sooner than that is no older than the picture


class Freshness(QObject):
    """Follows edits and full passes: a preview of the pictures leaves all else as it was.

    Signals
    -------
    changed(old)
        Whether what is shown is of the network before the last edit.
    """

    changed = Signal(bool)

    def __init__(self, session: Session, evaluator: Evaluator, parent: QObject) -> None:
        super().__init__(parent)
        self._evaluator = evaluator
        self._edit = 0
        self.is_old = False
        self._late = QTimer(self, singleShot=True, interval=OLD_AFTER_MS)
        self._late.timeout.connect(self._grow_old)
        session.changed.connect(self._edited)
        session.opened.connect(self._opened)
        evaluator.pass_done.connect(self._pass_done)

    def catch_up(self, generation: int) -> None:
        """What is shown is of that state of the window, by its number."""
        if generation >= self._edit:
            self._late.stop()
            self._set(False)

    def _edited(self, before: Any, after: Any) -> None:
        if computes_alike(before, after):
            return
        self._edit = self._evaluator.generation
        if not self._late.isActive() and not self.is_old:
            self._late.start()

    def _opened(self) -> None:
        self._late.stop()
        self._set(False)

    def _pass_done(self, done: Any) -> None:
        """All that a full pass had to answer has been."""
        if isinstance(done, PassDone) and done.reduced == 1 and not done.cancelled:
            self.catch_up(done.generation)

    def _grow_old(self) -> None:
        self._set(True)

    def _set(self, old: bool) -> None:
        if old != self.is_old:
            self.is_old = old
            self.changed.emit(old)
