"""The network of the window as it is now, as a job for the background."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from app.editor.docks.run_queue import Entry
from app.editor.session import Session
from app.run.job import Job, Kind
from core.errors import NetworkError


def job_of(session: Session, kind: Kind, output: Path, **choices: Any) -> Job:
    """A job of the document as it stands, unsaved changes too.

    Parameters
    ----------
    session : Session
        Has the document, and what was allowed in its dialogs.
    kind, output, choices
        As for `Job`.

    Raises
    ------
    NetworkError, FileError
        If there is nothing to run, or it holds what no file can.
    """
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
    stem = path.stem if path is not None else file_stem(session)
    number = 1
    while True:
        folder = base / (f"{stem}-{kind}" if number == 1 else f"{stem}-{kind}-{number}")
        if folder not in taken and not folder.exists():
            return folder
        number += 1


def file_stem(session: Session) -> str:
    """What a file of a document that was never saved is called after."""
    name = session.network.name or "network"
    return "".join(c if c.isalnum() or c in "-_" else "_" for c in name.lower())


# What the list says of a run, without Qt.

_MINUTE, _HOUR = 60, 3600


def duration(seconds: float) -> str:
    """A time in words, as exact as one can use: ``0.8 s``, ``45 s``, ``3 min``, ``2 h 10 min``."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    if seconds < _MINUTE:
        return f"{math.ceil(seconds)} s"
    if seconds < _HOUR:
        return f"{math.ceil(seconds / _MINUTE)} min"
    hours, minutes = divmod(math.ceil(seconds / _MINUTE), 60)
    return f"{hours} h {minutes} min" if minutes else f"{hours} h"


def state_text(entry: Entry, now: float) -> str:
    """The state of a run in a line."""
    if entry.state == "running":
        parts = [f"{100 * entry.share:.0f} %"]
        left = entry.left_s(now)
        if left is not None:
            parts.append(f"{duration(max(1.0, round(left)))} left")
        return " · ".join([*parts, *filter(None, [entry.doing])])
    if entry.state == "failed":
        return f"failed: {entry.text}"
    if entry.state == "done":
        return " · ".join(filter(None, ["done", duration(entry.seconds), failures_text(entry)]))
    return entry.state


def failures_text(entry: Entry) -> str:
    """How many of several runs could not be made, and why the first of them; empty where all."""
    result = entry.result
    if result is None or not result.failures:
        return ""
    name, why = result.failures[0]
    return f"{len(result.failures)} of {result.runs} failed: {name}: {why}"


def whole_text(entry: Entry, now: float) -> str:
    """All there is to say of a run, in lines."""
    lines = [entry.title, state_text(entry, now), f"Output: {entry.job.output}"]
    if entry.result is not None:
        lines += [f"{name}: {why}" for name, why in entry.result.failures[1:10]]
        lines += entry.result.warnings[:10]
    return "\n".join(lines)
