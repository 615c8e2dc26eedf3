"""The network of the window as it is now, as a job for the background."""

from __future__ import annotations

from pathlib import Path
from typing import Any

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
