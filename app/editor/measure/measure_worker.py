"""Work beside the window, one piece at a time, that can be stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Signal

from app.editor.error_text import error_text
from app.editor.evaluation.failures import as_error
from core.errors import Cancelled

Check = Callable[[], None]
Job = Callable[[Check, Callable[[str], None]], Any]
_LONGEST_END_S = 20.0


class MeasureWorker(QObject):
    """Carries out a job in a thread.

    Signals
    -------
    progressed(text)
        What the job has come to.
    done(result)
        It has ended.
    failed(text)
        It could not be carried out.
    cancelled
        It was stopped.
    """

    progressed = Signal(str)
    done = Signal(object)
    failed = Signal(str)
    cancelled = Signal()
    _ended = Signal(object, str, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._stop: threading.Event | None = None
        self._thread: threading.Thread | None = None
        self._ended.connect(self._take)

    @property
    def busy(self) -> bool:
        """Whether a job goes on whose result is wanted."""
        return self._stop is not None

    def start(self, job: Job) -> None:
        """Carry out a job; one that goes on still is stopped, and nothing of it is shown."""
        self.drop()
        stop = threading.Event()
        self._stop = stop
        self._thread = threading.Thread(
            target=self._carry_out, args=(job, stop), name="measure", daemon=True
        )
        self._thread.start()

    def cancel(self) -> None:
        """Stop the job."""
        if self._stop is not None:
            self.drop()
            self.cancelled.emit()

    def drop(self) -> None:
        """Stop the job without a word."""
        if self._stop is not None:
            self._stop.set()
            self._stop = None

    def close(self) -> None:
        """Stop the job, and wait until it has ended."""
        self.drop()
        if self._thread is not None:
            self._thread.join(_LONGEST_END_S)
            self._thread = None

    def _carry_out(self, job: Job, stop: threading.Event) -> None:
        def check() -> None:
            if stop.is_set():
                raise Cancelled("stopped on request")

        def report(text: str) -> None:
            if not stop.is_set():
                self.progressed.emit(text)

        try:
            result, error = job(check, report), ""
        except Exception as raised:
            result, error = None, error_text(as_error(raised))
        if not stop.is_set():
            self._ended.emit(result, error, stop)

    def _take(self, result: Any, error: str, stop: object) -> None:
        if stop is not self._stop:  # another one has begun since
            return
        self._stop = None
        if error:
            self.failed.emit(error)
        else:
            self.done.emit(result)
