"""Opening a page of the handbook in the browser; its pages are made where there are none yet."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, QTimer, QUrl
from PySide6.QtGui import QDesktopServices

from app.editor.session import Session
from app.run.own_process import command, environment
from core.names import in_line

_PATIENCE_MS = 2_500  # pages that are there already take less
_CLOSING_MS = 3_000


class HandbookOpening(QObject):
    """Has a process of its own find a page, and write the pages first if need be.

    Parameters
    ----------
    session : Session
        Where to say what becomes of it.
    parent : QObject
        Qt's owner.
    """

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._process = QProcess(self)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)
        self._long = QTimer(self)
        self._long.setSingleShot(True)
        self._long.timeout.connect(self._say_that_it_takes_long)
        self._closed = False

    def open(self, word: str = "") -> None:
        """Open the page of a module, or the first; at once the one that was wanted last."""
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._session.message.emit("note", "the handbook is being opened")
            return
        variables = QProcessEnvironment()
        for name, value in environment().items():
            variables.insert(name, value)
        self._process.setProcessEnvironment(variables)
        program, *words = command("app.command.cli", "handbook", "--path", *filter(None, [word]))
        self._process.start(program, words)
        self._long.start(_PATIENCE_MS)

    def close(self) -> None:
        """Stop what is being written; nothing of it goes on."""
        self._closed = True
        self._long.stop()
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._process.terminate()
            if not self._process.waitForFinished(_CLOSING_MS):
                self._process.kill()
                self._process.waitForFinished(_CLOSING_MS)

    def _say_that_it_takes_long(self) -> None:
        self._session.message.emit("note", "the handbook's pages are being made, once")

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._long.stop()
        printed = bytes(self._process.readAllStandardOutput().data()).decode().strip()
        errors = bytes(self._process.readAllStandardError().data()).decode("utf-8", "replace")
        if self._closed:
            return
        if code or status == QProcess.ExitStatus.CrashExit or not printed:
            reason = in_line(errors.strip().removeprefix("imagechain: ")) or "its process was ended"
            self._session.message.emit("error", f"the handbook is not opened: {reason}")
        elif QDesktopServices.openUrl(QUrl.fromLocalFile(str(Path(printed)))):
            self._session.message.emit("note", f"the handbook is in the browser: {printed}")
        else:
            self._session.message.emit("error", f"no browser opens {printed}")

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._long.stop()
            reason = self._process.errorString()
            self._session.message.emit("error", f"Python cannot be started: {reason}")
