"""Keeping unsaved work on the disk while one works, in a thread: flushing a disk can take long."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from app.editor.recovery.recovery_files import Autosave
from app.editor.session import Session
from core.errors import ImagechainError

DELAY_MS = 1000  # from the first change on; with the writing itself less than two seconds


class Autosaver(QObject):
    """Writes the document's recovery file at most a second after each change.

    Signals
    -------
    failed(text)
        Work could not be kept; emitted once until it works again.
    """

    failed = Signal(str)
    _written = Signal(object)

    def __init__(self, session: Session, folder: Path, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._folder = folder
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="autosave")
        self._autosave = Autosave(session.document, folder)
        self._warned = False
        self._leave_file = False
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(DELAY_MS)
        self._timer.timeout.connect(self._write)
        self._written.connect(self._after)
        session.changed.connect(self._begin)
        session.opened.connect(self._opened)
        session.state_changed.connect(self._saved)
        self._begin()

    def keep(self) -> ImagechainError | None:
        """Write now, and leave the file: the process has to end. Returns what went wrong."""
        self._leave_file = self._session.document.modified
        return self.write()

    def write(self) -> ImagechainError | None:
        """Write now, and wait until it is on the disk. Returns what went wrong."""
        error = self._thread.submit(self._autosave.write_if_changed).exception()
        if error is not None and not isinstance(error, ImagechainError):
            raise error
        return error

    def write_now(self, following: Callable[[], None]) -> None:
        """Write at once, then call `following` in the writing thread unless that failed."""
        self._thread.submit(self._write_then, self._autosave, following)

    def close(self) -> None:
        """The window is closed: nothing is left to recover, unless `keep` was called."""
        self._timer.stop()
        self._session.changed.disconnect(self._begin)
        self._session.opened.disconnect(self._opened)
        self._session.state_changed.disconnect(self._saved)
        if not self._leave_file:
            self._thread.submit(self._autosave.finish)
        self._thread.shutdown(wait=True)

    @staticmethod
    def _write_then(autosave: Autosave, following: Callable[[], None]) -> None:
        autosave.write_if_changed()
        following()

    def _begin(self, *_: object) -> None:
        if self._session.document.modified and not self._timer.isActive():
            self._timer.start()

    def _opened(self) -> None:
        self._timer.stop()
        self._thread.submit(self._autosave.finish)
        self._autosave = Autosave(self._session.document, self._folder)
        self._begin()

    def _saved(self) -> None:
        if not self._session.document.modified:
            self._timer.stop()
            self._thread.submit(self._autosave.finish)

    def _write(self) -> None:
        self._thread.submit(self._autosave.write_if_changed).add_done_callback(self._emit_written)

    def _emit_written(self, done: Future[bool]) -> None:
        """In the writing thread: pass the outcome to the window's."""
        self._written.emit(done.exception())

    def _after(self, error: object) -> None:
        if isinstance(error, ImagechainError) and not self._warned:
            self.failed.emit(f"unsaved work is not kept against a crash: {error}")
        self._warned = error is not None
