"""Unsaved work kept in a folder of its own, so that a crash loses none of it.

Each open document with unsaved work has one recovery file there, and beside it a lock that shows
whether its process is alive. Files of such processes are left alone.
"""

import json
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from os.path import realpath
from pathlib import Path
from secrets import token_hex
from typing import Any

from PySide6.QtCore import QFileSystemWatcher, QObject, QTimer, Signal

from app.editor.session import Session
from core import atomic, errors, records
from core.editing.document import Document, mark, mark_of, rebased
from core.editing.wiring import check_new_wires
from core.modules.declaration import Library
from core.network.file import format_network, parse_network
from core.network.network import Network

FORMAT = "imagechain-recovery"
VERSION = 1
SUFFIX, LOCK_SUFFIX = ".recovery", ".lock"


class Autosave:
    """Keeps the unsaved work of one document."""

    def __init__(self, document: Document, folder: Path) -> None:
        self._document = document
        # Its recovery file, which is there only while there is unsaved work.
        self.path = folder / f"{token_hex(8)}{SUFFIX}"
        self._let_go: Callable[[], None] | None = None
        self._written: tuple[Network, Path | None] | None = None

    def write_if_changed(self) -> bool:
        """Write the recovery file if the document has changed since; whether it did.

        Of a document that is saved as it is, there is none. Where it cannot be written, a
        `FileError` or `NetworkError` is raised, and what was kept before is still there.
        """
        document = self._document
        if not document.modified:
            self.finish()
            return False
        network, path = document.network, document.path
        if self._written is not None and self.path.exists():
            before, as_path = self._written
            if before is network and as_path == path:
                return False
        content = {
            "format": FORMAT,
            "version": VERSION,
            "original": str(path.absolute()) if path is not None else None,
            "stored": document.stored if path is not None else None,
            "folder": _here() if path is None else None,
            "time": time.time(),
            "network": format_network(network, library=document.library),
        }
        try:
            self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            if self._let_go is None:  # before the file: without a lock it counts as left behind
                self._let_go = atomic.take(self.path.with_suffix(LOCK_SUFFIX))
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise errors.FileError(f"cannot write to {self.path.parent}: {reason}") from error
        # As ASCII: a path that is no valid Unicode can be written and comes back as it was.
        atomic.write_text(self.path, json.dumps(content, indent=1) + "\n")
        self._written = network, path
        return True

    def finish(self) -> None:
        # The lock is removed last: a file without one counts as left behind.
        if self._written is not None:
            with suppress(OSError):
                self.path.unlink(missing_ok=True)
        if self._let_go is not None:
            self._let_go()
        self._let_go = self._written = None


@records.dataclass(frozen=True)
class Recovered:
    """Work that a process has left behind; `problem` says why it cannot be used.

    `file` is its recovery file, `original` the file it was opened from, `time` in seconds since
    1970. Work that was never saved has no original, and its file names are relative to `folder`.
    `stored` is the mark of what the original file held, None where that was not kept.
    """

    file: Path
    original: Path | None
    time: float
    problem: str = ""
    text: str = records.field(default="", repr=False)
    folder: Path | None = None
    stored: str | None = None

    def document(self, library: Library) -> Document:
        """The work as an unsaved document of its original file; a `NetworkError` if damaged."""
        if self.problem:
            raise errors.NetworkError(f"{self.file}: {self.problem}")
        network = parse_network(self.text, library=library, name_of_source=str(self.file))
        check_new_wires(records.replace(network, links=()), network, library)
        here = _here()
        if self.folder is not None and here is not None:
            network = rebased(network, library, self.folder, Path(here))
        return Document(
            network, library=library, path=self.original, saved=False, stored=self.stored
        )

    def discard(self) -> None:
        """Remove its files; whatever cannot be removed stays."""
        for path in (self.file, self.file.with_suffix(LOCK_SUFFIX)):
            with suppress(OSError):
                path.unlink(missing_ok=True)


def recoverable(folder: Path) -> tuple[Recovered, ...]:
    """What processes that are no more have left in a folder, damaged too, the latest first."""
    with suppress(OSError):
        read = [_read(path) for path in folder.glob(f"*{SUFFIX}") if path.name[0] != "."]
        _sweep(folder)
        found = [work for work in read if work is not None]
        return tuple(sorted(found, key=lambda work: -work.time))
    return ()


def _read(path: Path) -> Recovered | None:
    """What a recovery file holds; None where its process is alive, or the file is gone."""
    if atomic.is_held(path.with_suffix(LOCK_SUFFIX)):
        return None
    try:
        return _recovered(path, json.loads(path.read_bytes()))
    except FileNotFoundError:
        return None
    except OSError as error:
        problem = f"the recovery file cannot be read: {error.strerror or type(error).__name__}"
    except (ValueError, RecursionError) as error:
        problem = f"the recovery file is damaged: {' '.join(str(error).split())[:200]}"
    return Recovered(path, None, time.time(), problem)


def _recovered(path: Path, content: Any) -> Recovered:
    if _get(content, "format", str) != FORMAT or _get(content, "version", int) != VERSION:
        raise ValueError(f"the format is not {FORMAT}, version {VERSION}")
    original, folder = (_path(content, name) for name in ("original", "folder"))
    moment = _get(content, "time", float)
    if not 0 <= moment < 2.0**35:  # a date far off is none that a calendar could show
        raise ValueError("the time saved is not a valid date")
    stored = content.get("stored")  # not kept by earlier versions
    if stored is not None:
        stored = _get(content, "stored", str)
    text = _get(content, "network", str)
    return Recovered(path, original, moment, text=text, folder=folder, stored=stored)


def _path(content: Any, name: str) -> Path | None:
    value = content.get(name)
    if value is not None and (not isinstance(value, str) or "\0" in value):
        raise ValueError(f"{name} is not a file name")
    return Path(value) if value else None


def _here() -> str | None:
    with suppress(OSError):
        return str(Path.cwd())
    return None


def _get(content: Any, name: str, kind: type) -> Any:
    value = content.get(name) if isinstance(content, dict) else None
    if type(value) is not kind:
        raise ValueError(f"{name} is missing")
    return value


def _sweep(folder: Path) -> None:
    for lock in folder.glob(f"*{LOCK_SUFFIX}"):
        if lock.stem.isalnum() and atomic.is_held(lock) is False:
            # Named by core.atomic: the file's name between a dot and what makes it new.
            for half in folder.glob(f".{lock.stem}.*{SUFFIX}"):
                with suppress(OSError):
                    half.unlink()
            if not lock.with_suffix(SUFFIX).exists():
                with suppress(OSError):
                    lock.unlink()


# Keeping unsaved work on the disk while one works, in a thread: flushing a disk can take long.

DELAY_MS = 1000  # from the first change on; with the writing itself less than two seconds


class Autosaver(QObject):
    """Writes the document's recovery file at most a second after each change."""

    failed = Signal(str)  # (text): work could not be kept; emitted once until it works again
    _written = Signal(object)

    def __init__(self, session: Session, folder: Path, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._folder = folder
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="autosave")
        self._autosave = Autosave(session.document, folder)
        self._warned = False
        self._leave_file = False
        self._timer = QTimer(self, singleShot=True, interval=DELAY_MS)
        self._timer.timeout.connect(self._write)
        self._written.connect(self._after)
        session.opened.connect(self._opened)
        session.state_changed.connect(self._follow)
        self._follow()

    def keep(self) -> errors.ImagechainError | None:
        """Write now, and leave the file: the process has to end. Returns what went wrong."""
        self._leave_file = self._session.document.modified
        return self.write()

    def write(self) -> errors.ImagechainError | None:
        error = self._thread.submit(self._autosave.write_if_changed).exception()
        if error is not None and not isinstance(error, errors.ImagechainError):
            raise error
        return error

    def write_now(self, following: Callable[[], None]) -> None:
        """Write at once, then call `following` in the writing thread unless that failed."""
        autosave = self._autosave

        def write_then() -> None:
            autosave.write_if_changed()
            following()

        self._thread.submit(write_then)

    def close(self) -> None:
        """The window is closed: nothing is left to recover, unless `keep` was called."""
        self._timer.stop()
        self._session.opened.disconnect(self._opened)
        self._session.state_changed.disconnect(self._follow)
        if not self._leave_file:
            self._thread.submit(self._autosave.finish)
        self._thread.shutdown(wait=True)

    def _opened(self) -> None:
        self._thread.submit(self._autosave.finish)
        self._autosave = Autosave(self._session.document, self._folder)

    def _follow(self) -> None:
        if not self._session.document.modified:
            self._timer.stop()
            self._thread.submit(self._autosave.finish)
        elif not self._timer.isActive():
            self._timer.start()

    def _write(self) -> None:
        writing = self._thread.submit(self._autosave.write_if_changed)
        # Called in the writing thread; the signal arrives in the window's.
        writing.add_done_callback(lambda done: self._written.emit(done.exception()))

    def _after(self, error: object) -> None:
        if isinstance(error, errors.ImagechainError) and not self._warned:
            self.failed.emit(f"unsaved work will be lost if the editor crashes: {error}")
        self._warned = error is not None


# What others do to the document's file, said when it happens.

_WATCH_MS = 200
_OF_NAME = 16  # letters of a lock that stand for its file


class FileWatch(QObject):
    """Says when the document's file is open in another window, or another program changes it.

    A window holds a lock, named after the file, in the folder that all windows watch.
    """

    def __init__(self, session: Session, folder: Path, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._folder = session, folder
        self._document, self._path = session.document, session.document.path
        self._let_go: Callable[[], None] | None = None
        self._own = self._said = ""  # name of the lock, mark of the file that was said last
        self._shared = self._warned = False
        self._watcher = QFileSystemWatcher(self)
        self._soon = QTimer(self, singleShot=True, interval=_WATCH_MS)
        self._soon.timeout.connect(self._look)
        for changed in (self._watcher.fileChanged, self._watcher.directoryChanged):
            changed.connect(lambda _: self._soon.start())
        session.opened.connect(self._follow)
        session.state_changed.connect(self._follow)

    def close(self) -> None:
        self._soon.stop()
        if self._let_go is not None:
            self._let_go()
        self._let_go = None

    def _follow(self) -> None:
        document, before = self._session.document, (self._document, self._path)
        if before == (document, document.path):
            if self._warned:  # it may have been saved over
                self._soon.start()
            return
        self.close()
        self._document, self._path = document, document.path
        self._said, self._shared, self._warned = document.stored, False, False
        watched = (*self._watcher.files(), *self._watcher.directories())
        if watched:
            self._watcher.removePaths(watched)
        if self._path is not None:
            name = mark(realpath(self._path).encode("utf-8", "surrogateescape"))[:_OF_NAME]
            self._own = f"{name}{token_hex(8)}{LOCK_SUFFIX}"
            with suppress(OSError):
                self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
                self._let_go = atomic.take(self._folder / self._own)
            self._watcher.addPaths([str(self._folder), str(self._path.parent)])
            self._soon.start()

    def _look(self) -> None:
        path, document, say = self._path, self._document, self._session.message.emit
        if path is None:
            return
        self._watcher.addPath(str(path))  # one that was written anew is another file
        locks = self._folder.glob(f"{self._own[:_OF_NAME]}*{LOCK_SUFFIX}")
        shared = any(atomic.is_held(lock) for lock in locks if lock.name != self._own)
        if shared and not self._shared:
            say("warning", f"{path.name} is also open in another window")
        self._shared = shared
        if (now := mark_of(path)) != self._said:
            self._said, done = now, document.disagreement()
            if done or self._warned:
                text = f"another program has {done} {path.name}: Save will ask you what to do"
                say("warning", text if done else "")
            self._warned = bool(done)
