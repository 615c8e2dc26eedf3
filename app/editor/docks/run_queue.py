"""The runs of a window: those waiting, the one that runs, and those that have ended."""

import contextlib
import itertools
import time
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, QTimer, Signal

from app.editor.session import Session
from app.run.job import Job, Kind, Result, Step, job_text, read_message
from app.run.terminal import command, environment
from core.atomic import sweep
from core.errors import NetworkError, in_line

State = Literal["waiting", "running", "stopping", "done", "failed", "cancelled"]
_SURE = 0.1  # the share that must be done before the speed is known
_PATIENCE_MS = 15_000  # a stop is seen between two blocks of work; then it is ended by force
_CLOSING_MS = 3_000  # the same where the window waits for it
_PREFIX = "imagechain: "


class Run(QObject):
    """A job in a process of its own, which stops by itself when its input ends.

    `text` says why it failed, `result` is there once it is done.
    """

    changed = Signal()  # it has another state, or is further

    def __init__(self, title: str, job: Job, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.title, self.job = title, job
        self.state: State = "waiting"
        self.step = Step(0.0, "")
        self.begun = self.seconds = 0.0
        self.first: tuple[float, float] | None = None  # moment and share once it was loaded
        self.text = ""
        self.result: Result | None = None
        self._errors = b""
        self._process = QProcess(self)
        self._process.setProcessEnvironment(python_environment())
        self._process.readyReadStandardOutput.connect(self._read)
        self._process.readyReadStandardError.connect(self._read_errors)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)

    @property
    def is_over(self) -> bool:
        return self.state in ("done", "failed", "cancelled")

    @property
    def pid(self) -> int:
        return self._process.processId()

    @property
    def page(self) -> Path | None:
        return self.result.page if self.result is not None else None

    @property
    def folder(self) -> Path:
        return self.job.output.parent if self.job.kind == "report" else self.job.output

    def left_s(self, now: float) -> float | None:
        """Seconds until it is done; None while its speed is not known."""
        began, before = self.first or (now, self.step.share)
        done = self.step.share - before
        return (now - began) * (1 - self.step.share) / done if done >= _SURE else None

    def start(self) -> None:
        self.begun = time.monotonic()
        program, *words = command("app.command.run_job")
        self._process.start(program, words)
        self._process.write((job_text(self.job) + "\n").encode("ascii"))
        self._set("running")

    def stop(self) -> None:
        if self.state == "waiting":
            self._set("cancelled")
        elif self.state == "running":
            self._process.closeWriteChannel()
            self._process.terminate()
            QTimer.singleShot(_PATIENCE_MS, self._process, self._process.kill)
            self._set("stopping")

    def close(self) -> None:
        """Wait until it has stopped."""
        if not self.is_over and not self._process.waitForFinished(_CLOSING_MS):
            self._process.kill()
            self._process.waitForFinished(_CLOSING_MS)

    def _read(self) -> None:
        while self._process.canReadLine():
            line = bytes(self._process.readLine().data()).decode("utf-8", "replace").rstrip()
            message = read_message(line)
            if isinstance(message, Result):
                self.result = message
            elif message is not None and self.state == "running":
                self.step = message
                self.first = self.first or (time.monotonic(), message.share)
                self.changed.emit()

    def _read_errors(self) -> None:
        self._errors += bytes(self._process.readAllStandardError().data())

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._end("failed", f"Python cannot be started: {self._process.errorString()}")

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._read()
        self._read_errors()
        crashed = status == QProcess.ExitStatus.CrashExit
        if crashed:
            self._clear_away()
        if self.result is not None and code == 0 and not crashed:
            self._end("done")
        elif self.state == "stopping":
            self._end("cancelled")
        elif crashed:
            text = f"the system ended the process (signal {code}): memory may have run out"
            self._end("failed", text)
        else:
            lines = self._errors.decode("utf-8", "replace").strip().splitlines()
            said = lines[-1] if lines else "the process stopped without an error message"
            self._end("failed", in_line(said.removeprefix(_PREFIX)))

    def _clear_away(self) -> None:
        output = self.job.output
        with contextlib.suppress(OSError):
            sweep(next(folder for folder in (output, *output.parents) if folder.is_dir()))

    def _end(self, state: State, text: str = "") -> None:
        self.text = text
        self.seconds = time.monotonic() - self.begun
        self._set(state)

    def _set(self, state: State) -> None:
        self.state = state
        self.changed.emit()


class RunQueue(QObject):
    """Carries runs out one after the other, reports at once."""

    changed = Signal(object)  # (run): it has another state, or is further
    listed = Signal()  # a run has been added or removed

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.runs: list[Run] = []
        self._closed = False

    @property
    def unfinished(self) -> list[Run]:
        return [run for run in self.runs if not run.is_over]

    def add(self, title: str, job: Job) -> Run:
        """Put a run at the end of the list, and begin where nothing else runs."""
        run = Run(title, job, self)
        run.changed.connect(lambda: self._follow(run))
        self.runs.append(run)
        self.listed.emit()
        self._go_on()
        return run

    def clear(self) -> None:
        for run in self.runs:
            if run.is_over:
                run.deleteLater()
        self.runs = self.unfinished
        self.listed.emit()

    def close(self) -> None:
        """Stop what runs and begin nothing more; returns once no process is left."""
        self._closed = True
        going = self.unfinished
        for run in going:
            run.stop()  # all at once: they clear away side by side
        for run in going:
            run.close()

    def _follow(self, run: Run) -> None:
        self.changed.emit(run)
        self._go_on()

    def _go_on(self) -> None:
        going = [run for run in self.runs if run.state in ("running", "stopping")]
        busy = any(run.job.kind != "report" for run in going)
        for run in self.runs:
            at_once = run.job.kind == "report"
            if run.state == "waiting" and not self._closed and (at_once or not busy):
                busy = busy or not at_once
                run.start()


def python_environment() -> QProcessEnvironment:
    made = QProcessEnvironment()
    for name, value in environment().items():
        made.insert(name, value)
    return made


# The network of the window as it is now, as a job.


def job_of(session: Session, kind: Kind, output: Path, **choices: Any) -> Job:
    """A job of the document as it stands, unsaved changes too; `choices` as for `Job`."""
    document = session.document
    if not document.network.nodes:
        raise NetworkError("the network has no nodes")
    return Job(
        kind,
        document.text(),
        document.folder.absolute(),
        None if document.path is None else document.path.absolute(),
        output.absolute(),
        chosen=session.chosen_outputs,
        **choices,
    )


def proposed_folder(session: Session, kind: str, taken: set[Path]) -> Path:
    """A folder beside the document's file that is not there yet, and nobody else's to be."""
    path = session.document.path
    base = path.parent.absolute() if path is not None else Path.cwd()
    first = base / f"{session.stem}-{kind}"
    others = (first.with_name(f"{first.name}-{number}") for number in itertools.count(2))
    free = (one for one in itertools.chain([first], others) if one not in taken)
    return next(folder for folder in free if not folder.exists())
