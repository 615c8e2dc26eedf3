"""The runs of a window: those waiting, the one that runs, and those that have ended."""

from __future__ import annotations

import contextlib
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, QTimer, Signal

from app.editor.session import Session
from app.run.job import Job, Kind, Result, Step, job_text, read_message
from app.run.shipped import command, environment
from core.errors import NetworkError
from core.leftovers import sweep
from core.names import in_line

State = Literal["waiting", "running", "stopping", "done", "failed", "cancelled"]
_OVER = ("done", "failed", "cancelled")
# What must be done before the speed is known: in equal pieces, and by nodes that differ.
_SURE_OF_PIECES, _SURE_OF_NODES = 0.04, 0.35
_PIECES = ("sweep", "frames", "files")


@dataclass(frozen=True)
class Entry:
    """A run in the list.

    `begun` is on the monotonic clock, `first` when its first part was begun, and the share done by
    then: what came before was loading. `text` says why it failed.
    """

    number: int
    title: str
    job: Job = field(repr=False)
    state: State = "waiting"
    share: float = 0.0
    doing: str = ""
    begun: float = 0.0
    seconds: float = 0.0
    first: tuple[float, float] | None = None
    text: str = ""
    result: Result | None = field(default=None, repr=False)

    @property
    def is_over(self) -> bool:
        return self.state in _OVER

    @property
    def page(self) -> Path | None:
        return self.result.page if self.result is not None else None

    @property
    def folder(self) -> Path:
        return self.job.output.parent if self.job.kind == "report" else self.job.output

    def left_s(self, now: float) -> float | None:
        """Seconds until it is done, as far as its speed lets one say."""
        if self.state != "running" or self.first is None:
            return None
        began, before = self.first
        done = self.share - before
        if done < (_SURE_OF_PIECES if self.job.kind in _PIECES else _SURE_OF_NODES):
            return None
        return (now - began) * (1 - self.share) / done


class RunQueue(QObject):
    """Carries runs out one after the other, reports at once."""

    changed = Signal(int)  # (number): an entry has another state, or is further
    listed = Signal()  # an entry has been added or removed

    def __init__(self, parent: QObject, *, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(parent)
        self._clock = clock
        self._numbers = itertools.count(1)
        self._entries: dict[int, Entry] = {}
        self._processes: dict[int, RunProcess] = {}
        self._closed = False

    @property
    def entries(self) -> tuple[Entry, ...]:
        return tuple(self._entries.values())

    @property
    def unfinished(self) -> tuple[Entry, ...]:
        return tuple(entry for entry in self.entries if not entry.is_over)

    def entry(self, number: int) -> Entry | None:
        return self._entries.get(number)

    def pids(self) -> tuple[int, ...]:
        return tuple(process.pid for process in self._processes.values())

    def add(self, title: str, job: Job) -> int:
        """Put a run at the end of the list, and begin where nothing else runs; its number."""
        entry = Entry(next(self._numbers), title, job)
        self._entries[entry.number] = entry
        self.listed.emit()
        self._go_on()
        return entry.number

    def cancel(self, number: int) -> None:
        entry = self._entries.get(number)
        if entry is None:
            return
        if entry.state == "waiting":
            self._set(replace(entry, state="cancelled"))
        elif entry.state == "running":
            self._set(replace(entry, state="stopping"))
            self._processes[number].stop()

    def remove(self, number: int) -> None:
        entry = self._entries.get(number)
        if entry is not None and entry.is_over:
            del self._entries[number]
            self.listed.emit()

    def clear(self) -> None:
        self._entries = {entry.number: entry for entry in self.unfinished}
        self.listed.emit()

    def close(self) -> None:
        """Stop what runs and begin nothing more; returns once no process is left."""
        self._closed = True
        for process in list(self._processes.values()):
            process.stop()  # all at once: they clear away side by side
        for process in list(self._processes.values()):
            process.close()

    def _go_on(self) -> None:
        if self._closed:
            return
        busy = any(
            entry.job.kind != "report" and entry.number in self._processes for entry in self.entries
        )
        for entry in self.entries:
            at_once = entry.job.kind == "report"
            if entry.state == "waiting" and (at_once or not busy):
                busy = busy or not at_once
                self._begin(entry)

    def _begin(self, entry: Entry) -> None:
        number = entry.number
        process = self._processes[number] = RunProcess(entry.job, self)
        process.stepped.connect(partial(self._stepped, number))
        process.ended.connect(partial(self._ended, number))
        self._set(replace(entry, state="running", begun=self._clock()))
        process.start()

    def _stepped(self, number: int, step: Any) -> None:
        entry = self._entries.get(number)
        if entry is not None and entry.state == "running":
            first, share = entry.first or (self._clock(), step.share), max(step.share, entry.share)
            self._set(replace(entry, share=share, doing=step.doing, first=first))

    def _ended(self, number: int, end: Any, text: str, result: Any) -> None:
        self._processes.pop(number).deleteLater()
        entry = self._entries[number]  # one that runs is never removed
        seconds = self._clock() - entry.begun
        self._set(replace(entry, state=end, seconds=seconds, text=text, result=result))
        self._go_on()

    def _set(self, entry: Entry) -> None:
        self._entries[entry.number] = entry
        self.changed.emit(entry.number)


# One background run in a process of its own: a crash or a large picture is not the window's.

_PATIENCE_MS = 15_000  # a stop is seen between two blocks of work; then it is ended by force
_CLOSING_MS = 3_000  # the same where the window waits for it
_PREFIX = "imagechain: "


class RunProcess(QObject):
    """Starts the process of a job, and stops it; it stops by itself when its input ends."""

    stepped = Signal(object)  # (step): how far it is
    # (end, text, result): it is "done" with a `Result`, "failed" with a line on why, or
    # "cancelled"; the last signal
    ended = Signal(str, str, object)

    def __init__(self, job: Job, parent: QObject) -> None:
        super().__init__(parent)
        self._job = job
        self._result: Result | None = None
        self._errors = b""
        self._stopping = self._over = False
        self._process = QProcess(self)
        self._process.setProcessEnvironment(python_environment())
        self._process.readyReadStandardOutput.connect(self._read)
        self._process.readyReadStandardError.connect(self._read_errors)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)
        self._force = QTimer(self, singleShot=True)
        self._force.timeout.connect(self._process.kill)

    @property
    def pid(self) -> int:
        return self._process.processId()

    def start(self) -> None:
        program, *words = command("app.command.run_job")
        self._process.start(program, words)
        self._process.write((job_text(self._job) + "\n").encode("ascii"))

    def stop(self) -> None:
        if self._stopping or self._over:
            return
        self._stopping = True
        self._process.closeWriteChannel()
        self._process.terminate()
        self._force.start(_PATIENCE_MS)

    def close(self) -> None:
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
            self._end("failed", f"Python cannot be started: {self._process.errorString()}")

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._read()
        self._read_errors()
        crashed = status == QProcess.ExitStatus.CrashExit
        if crashed:
            self._clear_away()
        if self._result is not None and code == 0 and not crashed:
            self._end("done", result=self._result)
        elif self._stopping:
            self._end("cancelled")
        elif crashed:
            text = f"the system ended its process (signal {code}): memory may have run out"
            self._end("failed", text)
        else:
            self._end("failed", _last_line(self._errors.decode("utf-8", "replace")))

    def _clear_away(self) -> None:
        output = self._job.output
        with contextlib.suppress(OSError):
            sweep(next(folder for folder in (output, *output.parents) if folder.is_dir()))

    def _end(self, end: str, text: str = "", result: Result | None = None) -> None:
        if not self._over:
            self._over = True
            self._force.stop()
            self.ended.emit(end, text, result)


def python_environment() -> QProcessEnvironment:
    made = QProcessEnvironment()
    for name, value in environment().items():
        made.insert(name, value)
    return made


def _last_line(said: str) -> str:
    lines = [line for line in said.splitlines() if line.strip()]
    return in_line(lines[-1].removeprefix(_PREFIX)) if lines else "it stopped without saying why"


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
