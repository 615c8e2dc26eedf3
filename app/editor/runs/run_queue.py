"""The runs of a window: those waiting, the one that runs, and those that have ended."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Literal

from PySide6.QtCore import QObject, Signal

from app.editor.runs.run_process import Ending, RunProcess
from app.run.job import Job
from app.run.job_messages import Result

State = Literal["waiting", "running", "stopping", "done", "failed", "cancelled"]
_OVER = ("done", "failed", "cancelled")
# What must be done before the speed is known: in equal pieces, and by nodes that differ.
_SURE_OF_PIECES, _SURE_OF_NODES = 0.04, 0.35
_PIECES = ("sweep", "frames", "files")


@dataclass(frozen=True)
class Entry:
    """A run in the list.

    Parameters
    ----------
    number : int
        Which one it is, never another's.
    title : str
        What it does, in a few words.
    job : Job
        What it does.
    state : str
        What has become of it.
    share : float
        How much of it is done.
    doing : str
        What is being made.
    begun, seconds : float
        When it began on the monotonic clock, and how long it took in all.
    first : (float, float) or None
        When its first part was begun, and the share done by then: what came before was loading.
    text : str
        Why it failed.
    result : Result or None
        What it has made.
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
        """Whether nothing more becomes of it."""
        return self.state in _OVER

    @property
    def page(self) -> Path | None:
        """The report or trade-off it has written."""
        return self.result.page if self.result is not None else None

    @property
    def folder(self) -> Path:
        """Where its files are."""
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
    """Carries runs out one after the other, reports at once.

    Signals
    -------
    changed(number)
        An entry has another state, or is further.
    listed
        An entry has been added or removed.
    """

    changed = Signal(int)
    listed = Signal()

    def __init__(self, parent: QObject, *, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(parent)
        self._clock = clock
        self._numbers = itertools.count(1)
        self._entries: dict[int, Entry] = {}
        self._processes: dict[int, RunProcess] = {}
        self._closed = False

    @property
    def entries(self) -> tuple[Entry, ...]:
        """All of them, the first one that was added first."""
        return tuple(self._entries.values())

    @property
    def unfinished(self) -> tuple[Entry, ...]:
        """Those that wait or run."""
        return tuple(entry for entry in self.entries if not entry.is_over)

    def entry(self, number: int) -> Entry | None:
        """The entry of that number; None where it was removed."""
        return self._entries.get(number)

    def pids(self) -> tuple[int, ...]:
        """The numbers of the processes that run."""
        return tuple(process.pid for process in self._processes.values())

    def add(self, title: str, job: Job) -> int:
        """Put a run at the end of the list, and begin where nothing else runs; its number."""
        entry = Entry(next(self._numbers), title, job)
        self._entries[entry.number] = entry
        self.listed.emit()
        self._go_on()
        return entry.number

    def cancel(self, number: int) -> None:
        """Take back a run that waits, or stop the one that runs."""
        entry = self._entries.get(number)
        if entry is None:
            return
        if entry.state == "waiting":
            self._set(replace(entry, state="cancelled"))
        elif entry.state == "running":
            self._set(replace(entry, state="stopping"))
            self._processes[number].stop()

    def remove(self, number: int) -> None:
        """Take one that has ended off the list; its files stay."""
        entry = self._entries.get(number)
        if entry is not None and entry.is_over:
            del self._entries[number]
            self.listed.emit()

    def clear(self) -> None:
        """Take all that have ended off the list."""
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

    def _stepped(self, number: int, step: object) -> None:
        entry = self._entries.get(number)
        share, doing = getattr(step, "share", 0.0), getattr(step, "doing", "")
        if entry is not None and entry.state == "running":
            first = entry.first or (self._clock(), share)
            self._set(replace(entry, share=max(share, entry.share), doing=doing, first=first))

    def _ended(self, number: int, ending: Ending) -> None:
        self._processes.pop(number).deleteLater()
        entry = self._entries[number]  # one that runs is never removed
        seconds = self._clock() - entry.begun
        self._set(
            replace(
                entry, state=ending.end, seconds=seconds, text=ending.text, result=ending.result
            )
        )
        self._go_on()

    def _set(self, entry: Entry) -> None:
        self._entries[entry.number] = entry
        self.changed.emit(entry.number)
