"""One background run in a process of its own: a crash or a large picture is not the window's."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, QTimer, Signal

from app.run.job import Job, job_text
from app.run.job_messages import Result, Step, read_message
from app.run.own_process import command, environment
from core.leftovers import sweep
from core.names import in_line

_PATIENCE_MS = 15_000  # a stop is seen between two blocks of work; then it is ended by force
_CLOSING_MS = 3_000  # the same where the window waits for it
_PREFIX = "imagechain: "
End = Literal["done", "failed", "cancelled"]


@dataclass(frozen=True)
class Ending:
    """How a run ended: with a result, or with a line on why there is none."""

    end: End
    text: str = ""
    result: Result | None = None


class RunProcess(QObject):
    """Starts the process of a job, and stops it.

    The process stops by itself when its input ends, which it does whatever becomes of this one.

    Parameters
    ----------
    job : Job
        What to do.
    parent : QObject
        Qt's owner.

    Signals
    -------
    stepped(step)
        How far it is.
    ended(ending)
        It has ended, by itself or stopped; the last signal.
    """

    stepped = Signal(object)
    ended = Signal(object)

    def __init__(self, job: Job, parent: QObject) -> None:
        super().__init__(parent)
        self._job = job
        self._result: Result | None = None
        self._errors = b""
        self._stopping = self._over = False
        self._process = QProcess(self)
        self._process.setProcessEnvironment(_variables(environment()))
        self._process.readyReadStandardOutput.connect(self._read)
        self._process.readyReadStandardError.connect(self._read_errors)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)
        self._force = QTimer(self)
        self._force.setSingleShot(True)
        self._force.timeout.connect(self._process.kill)

    @property
    def pid(self) -> int:
        """The process's number; 0 where none runs."""
        return self._process.processId()

    def start(self) -> None:
        """Begin."""
        program, *words = command("app.command.job.run_job")
        self._process.start(program, words)
        self._process.write((job_text(self._job) + "\n").encode("ascii"))

    def stop(self) -> None:
        """Let it clear away what it has begun, and end; `ended` comes then."""
        if self._stopping or self._over:
            return
        self._stopping = True
        self._process.closeWriteChannel()
        self._process.terminate()
        self._force.start(_PATIENCE_MS)

    def close(self) -> None:
        """Stop it and wait for its end: nothing of it goes on."""
        self.stop()
        if not self._over and not self._process.waitForFinished(_CLOSING_MS):
            self._process.kill()
            self._process.waitForFinished(_CLOSING_MS)

    def _read(self) -> None:
        while self._process.canReadLine():
            line = bytes(self._process.readLine().data()).decode("utf-8", "replace").rstrip()
            message = read_message(line)
            if isinstance(message, Step):
                self.stepped.emit(message)
            elif message is not None:
                self._result = message

    def _read_errors(self) -> None:
        self._errors += bytes(self._process.readAllStandardError().data())

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._end(Ending("failed", f"Python cannot be started: {self._process.errorString()}"))

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._read()
        self._read_errors()
        crashed = status == QProcess.ExitStatus.CrashExit
        if crashed:
            self._clear_away()
        if self._result is not None and code == 0 and not crashed:
            self._end(Ending("done", "", self._result))
        elif self._stopping:
            self._end(Ending("cancelled"))
        elif crashed:
            text = f"its process was ended by the system (signal {code}): is the memory full?"
            self._end(Ending("failed", text))
        else:
            self._end(Ending("failed", _last_line(self._errors.decode("utf-8", "replace"))))

    def _clear_away(self) -> None:
        """Remove what a process that was killed could not."""
        output = self._job.output
        with contextlib.suppress(OSError):
            sweep(next(folder for folder in (output, *output.parents) if folder.is_dir()))

    def _end(self, ending: Ending) -> None:
        if not self._over:
            self._over = True
            self._force.stop()
            self.ended.emit(ending)


def _variables(names: Iterable[tuple[str, str]] | dict[str, str]) -> QProcessEnvironment:
    made = QProcessEnvironment()
    for name, value in dict(names).items():
        made.insert(name, value)
    return made


def _last_line(said: str) -> str:
    lines = [line for line in said.splitlines() if line.strip()]
    return in_line(lines[-1].removeprefix(_PREFIX)) if lines else "it ended without a word"
