"""Unsaved work kept in a folder of its own, so that a crash loses none of it.

Each open document with unsaved work has one recovery file there, and beside it a lock that shows
whether its process is alive. Files of such processes are left alone.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import threading
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from core.atomic import write_text
from core.editing.document import Document, rebased
from core.editing.links import check_new_wires
from core.errors import FileError, NetworkError
from core.file_lock import FileLock, is_held, take
from core.modules.library_type import Library
from core.network.file import format_network
from core.network.network import Network
from core.network.parsing import parse_network
from core.process_token import own_token, runs

FORMAT = "imagechain-recovery"
VERSION = 1
SUFFIX, LOCK_SUFFIX = ".recovery", ".lock"
LARGEST = 64 * 2**20  # bytes; four times what a network's text may have


class Autosave:
    """Keeps the unsaved work of one document. Its methods may be called from any thread.

    Parameters
    ----------
    document : Document
        What is kept.
    folder : Path
        Where; made when needed, for the user's eyes only.
    """

    def __init__(self, document: Document, folder: Path) -> None:
        self._document = document
        self._file = folder / f"{secrets.token_hex(8)}{SUFFIX}"
        self._lock: FileLock | None = None
        self._written: tuple[Network, Path | None] | None = None
        self._busy = threading.Lock()

    @property
    def path(self) -> Path:
        """Its recovery file, which is there only while there is unsaved work."""
        return self._file

    def write_if_changed(self) -> bool:
        """Write the recovery file if the document has changed since; whether it did.

        Of a document that is saved as it is, there is none.

        Raises
        ------
        FileError
            If it cannot be written: what was kept before is still there.
        NetworkError
            If the network holds what no file can.
        """
        with self._busy:
            if not self._document.modified:
                self._remove()
                return False
            state = self._document.network, self._document.path
            if self._written is not None and self._unchanged(*state):
                return False
            self._write(*state)
            self._written = state
            return True

    def finish(self) -> None:
        """Remove the recovery file: the work is saved, or given up on purpose."""
        with self._busy:
            self._remove()

    def _unchanged(self, network: Network, path: Path | None) -> bool:
        written = self._written
        return (
            written is not None
            and written[0] is network
            and written[1] == path
            and self._file.exists()
        )

    def _write(self, network: Network, path: Path | None) -> None:
        content = {
            "format": FORMAT,
            "version": VERSION,
            "original": str(path.absolute()) if path is not None else None,
            "stored": self._document.stored if path is not None else None,
            "folder": _here() if path is None else None,
            "pid": os.getpid(),
            "started": own_token(),
            "time": time.time(),
            "network": format_network(network, library=self._document.library),
        }
        self._prepare()
        # As ASCII: a path that is no valid Unicode can be written and comes back as it was.
        write_text(self._file, json.dumps(content, indent=1) + "\n")

    def _prepare(self) -> None:
        """Make the folder and the lock before the file: without a lock it counts as left behind."""
        folder = self._file.parent
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if self._lock is None:
                self._lock = take(self._file.with_suffix(LOCK_SUFFIX))
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise FileError(f"cannot write in {folder}: {reason}") from error

    def _remove(self) -> None:
        # The lock is removed last: a file without one counts as left behind.
        if self._written is not None or self._lock is not None:
            with contextlib.suppress(OSError):
                self._file.unlink(missing_ok=True)
        if self._lock is not None:
            self._lock.let_go()
        self._lock = self._written = None


@dataclass(frozen=True)
class Recovered:
    """Work that a process has left behind.

    Parameters
    ----------
    file : Path
        Its recovery file.
    original : Path or None
        The file it was opened from; None where it was never saved.
    time : float
        When it was kept, in seconds since 1970.
    problem : str
        Why it cannot be used, empty where it can.
    text : str
        The text of its network file.
    folder : Path or None
        What file names are relative to in work that was never saved.
    stored : str or None
        The mark of what the original file held, None where that was not kept.
    """

    file: Path
    original: Path | None
    time: float
    problem: str = ""
    text: str = field(default="", repr=False)
    folder: Path | None = None
    stored: str | None = None

    def document(self, library: Library) -> Document:
        """The work as an unsaved document of its original file.

        In work that was never saved, file names are made relative to the present folder.

        Raises
        ------
        NetworkError
            If the file is damaged, or holds no network that can be worked on.
        """
        if self.problem:
            raise NetworkError(f"{self.file}: {self.problem}")
        network = parse_network(self.text, library=library, name_of_source=str(self.file))
        check_new_wires(replace(network, links=()), network, library)
        here = _here()
        if self.folder is not None and here is not None:
            moved = rebased(network, library, self.folder, Path(here))
            network = moved.apply(network) if moved is not None else network
        return Document(
            network, library=library, path=self.original, saved=False, stored=self.stored
        )

    def discard(self) -> None:
        """Remove its files; whatever cannot be removed stays."""
        for path in (self.file, self.file.with_suffix(LOCK_SUFFIX)):
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)


def recoverable(folder: Path) -> tuple[Recovered, ...]:
    """The work that processes which are no more have left in a folder, the latest first.

    A damaged file is among it, with its `problem`. Locks and half written files of such processes
    are cleared away.
    """
    with contextlib.suppress(OSError):
        recovered = [
            _read(path) for path in folder.glob(f"*{SUFFIX}") if not path.name.startswith(".")
        ]
        _sweep(folder)
        return tuple(sorted((work for work in recovered if work is not None), key=_age))
    return ()


def _age(work: Recovered) -> float:
    return -work.time


def _read(path: Path) -> Recovered | None:
    """What a recovery file holds; None where its process is alive, or the file is gone."""
    held = is_held(path.with_suffix(LOCK_SUFFIX))
    if held:
        return None
    try:
        status = path.stat()
    except OSError:
        return None
    try:
        if status.st_size > LARGEST:
            raise ValueError("it is too large")
        content = json.loads(path.read_bytes())
        if held is None and runs(_get(content, "pid", int), _get(content, "started", str)):
            return None
        return _recovered(path, content)
    except FileNotFoundError:
        return None
    except OSError as error:
        problem = f"it cannot be read: {error.strerror or type(error).__name__}"
    except (ValueError, RecursionError) as error:
        problem = f"the recovery file is damaged: {' '.join(str(error).split())[:200]}"
    return Recovered(path, None, status.st_mtime, problem)


def _recovered(path: Path, content: Any) -> Recovered:
    if _get(content, "format", str) != FORMAT:
        raise ValueError(f"its format is not {FORMAT}")
    if _get(content, "version", int) != VERSION:
        raise ValueError("it is of another version")
    original, folder = (_path(content, name) for name in ("original", "folder"))
    moment = _get(content, "time", float)
    # A date far off is none that a calendar could show.
    if not 0 <= moment < 2.0**35:
        raise ValueError("time is no date")
    stored = content.get("stored")  # not kept by earlier versions
    if stored is not None and not isinstance(stored, str):
        raise ValueError("stored is no text")
    text = _get(content, "network", str)
    return Recovered(path, original, moment, text=text, folder=folder, stored=stored)


def _path(content: Any, name: str) -> Path | None:
    value = content.get(name)
    if value is not None and (not isinstance(value, str) or "\0" in value):
        raise ValueError(f"{name} is no file name")
    return Path(value) if value else None


def _here() -> str | None:
    """The present folder, unless it has been removed."""
    with contextlib.suppress(OSError):
        return str(Path.cwd())
    return None


def _get(content: Any, name: str, kind: type) -> Any:
    value = content.get(name) if isinstance(content, dict) else None
    if type(value) is not kind:
        raise ValueError(f"it has no {name}")
    return value


def _sweep(folder: Path) -> None:
    """Clear away what ended processes left beside their recovery files."""
    for lock in folder.glob(f"*{LOCK_SUFFIX}"):
        if lock.stem.isalnum() and is_held(lock) is False:
            # Named by core.atomic: the file's name between a dot and what makes it new.
            for half in folder.glob(f".{lock.stem}.*{SUFFIX}"):
                with contextlib.suppress(OSError):
                    half.unlink()
            if not lock.with_suffix(SUFFIX).exists():
                with contextlib.suppress(OSError):
                    lock.unlink()
