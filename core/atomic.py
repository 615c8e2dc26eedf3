"""Files written whole or not at all, locks on them, and what dead processes have left."""

import contextlib
import os
import re
import secrets
import shutil
import stat
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from core.errors import FileError


@contextlib.contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give an empty file to write into, which takes the place of `path` when the block succeeds.

    It is in the same folder with the same suffix, so that the final rename stays within one file
    system and writers that choose a format by suffix choose the same one. It must be closed when
    the block ends, and is flushed to the disk before the rename. When the block raises, it is
    removed and what was at `path` before is untouched. A symbolic link is followed: its target is
    replaced. What killed processes have left in the folder is removed, in time.
    """
    target = _target(path)
    mode = _mode_of_existing(target)
    temporary = _create_beside(target)
    try:
        yield temporary
        if mode is not None:
            temporary.chmod(mode)
        flush(temporary, os.O_RDWR)
        temporary.replace(target)
    except OSError as error:
        _remove(temporary)
        raise FileError(f"cannot write {target}: {_reason(error)}") from error
    except BaseException:
        _remove(temporary)
        raise
    with contextlib.suppress(OSError):  # the rename itself, where a folder can be opened
        flush(target.parent, os.O_RDONLY)


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write `content` to `path` by way of `atomic_file`, with the same errors."""
    with atomic_file(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: str | os.PathLike[str], content: str) -> None:
    """Write `content` as UTF-8 with line feeds by way of `atomic_file`, with the same errors."""
    write_bytes(path, content.encode())


def _target(path: str | os.PathLike[str]) -> Path:
    text = os.fspath(path)
    if not text:
        raise FileError("cannot write: the path is empty")
    if "\0" in text:
        raise FileError(f"cannot write {text!r}: the path contains a null character")
    if text.endswith(("/", os.sep)):
        raise FileError(f"cannot write {text}: the path names a folder, not a file")
    return Path(os.path.realpath(text))


_KINDS = {
    stat.S_IFIFO: "named pipe (FIFO)",
    stat.S_IFSOCK: "socket",
    stat.S_IFCHR: "character device",
    stat.S_IFBLK: "block device",
}


def no_regular_file(mode: int) -> str:
    """Why what has this `st_mode` cannot be replaced, and what can; empty for a regular file."""
    if stat.S_ISREG(mode):
        return ""
    if stat.S_ISDIR(mode):
        return "the path is a folder; give a file name, for example one in that folder"
    kind = _KINDS.get(stat.S_IFMT(mode), "special file")
    return (
        f"the path is a {kind}, not a regular file; allowed: a new name, or a regular file to "
        "replace"
    )


def _mode_of_existing(target: Path) -> int | None:
    try:
        status = target.stat()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise FileError(f"cannot write {target}: {_reason(error)}") from error
    if unfit := no_regular_file(status.st_mode):
        raise FileError(f"cannot write {target}: {unfit}")
    # A rename needs no permission on the old file: without this a read-only file would be lost.
    if not os.access(target, os.W_OK):
        raise FileError(f"cannot write {target}: the file is read-only")
    return stat.S_IMODE(status.st_mode)


def _create_beside(target: Path) -> Path:
    sweep(target.parent)
    # The name is cut: a target near the file system's longest name leaves no room for more.
    name = f".{target.stem[:40]}{FOLDER_PREFIX}{new_mark()}{target.suffix}"
    temporary = target.with_name(name)
    try:
        # Not tempfile: its files are private (0600), ours follow the umask like any other.
        os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    except FileNotFoundError as error:
        why = "files cannot be created in" if target.parent.is_dir() else "there is no folder"
        raise FileError(f"cannot write {target}: {why} {target.parent}") from error
    except OSError as error:
        raise FileError(f"cannot write {target}: {_reason(error)}") from error
    return temporary


def flush(path: Path, mode: int) -> None:
    """Have the system write a file to the disk, where a full one shows at the latest."""
    descriptor = os.open(path, mode)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _remove(path: Path) -> None:
    # A failing removal must not hide the error that led here.
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)


def _reason(error: OSError) -> str:
    return error.strerror or str(error) or type(error).__name__


# What killed processes have left, and clearing it away.

FOLDER_PREFIX = ".imagechain-"
LOCK = "lock"
"""A file in a temporary folder that its process holds locked."""
OLD_S, ABANDONED_S = 24 * 3600.0, 30 * 24 * 3600.0
"""Files untouched for so long are of no living process; folders that were never locked."""

_MARKED = re.compile(rf"(\..*)?{re.escape(FOLDER_PREFIX)}[0-9a-f]{{16}}(\.[^.]*)?", re.DOTALL)


def new_mark() -> str:
    """A part of a name that nobody else makes."""
    return secrets.token_hex(8)


def sweep(folder: Path) -> None:
    """Remove what dead processes of this user have left in a folder.

    Only real files and folders whose names are marked are touched. A folder is dead when nobody
    holds its lock, a file after a day. What cannot be removed stays.
    """
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if _MARKED.fullmatch(entry.name):
                with contextlib.suppress(OSError):
                    _sweep_one(entry)


def _sweep_one(entry: os.DirEntry[str]) -> None:
    status = entry.stat(follow_symlinks=False)  # of a link, above all, nothing is removed
    if hasattr(os, "geteuid") and status.st_uid != os.geteuid():
        return
    age = time.time() - status.st_mtime
    if not entry.name.startswith(FOLDER_PREFIX):
        if stat.S_ISREG(status.st_mode) and age > OLD_S:
            Path(entry.path).unlink()
    elif stat.S_ISDIR(status.st_mode):
        lock = Path(entry.path, LOCK)
        was_locked = is_held(lock) is False and lock.stat().st_size > 0
        if was_locked or (age > ABANDONED_S and not is_held(lock)):
            shutil.rmtree(entry.path, ignore_errors=True)


# Locks on files that the system lets go of when their process ends, however it ends.

if sys.platform == "win32":
    import msvcrt

    def _try(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _try(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


_PLAIN = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


def take(path: Path) -> Callable[[], None] | None:
    """Make a lock file of this process; None where another has it, or there are no locks.

    What is given back lets go of the lock, and removes its file; the process' end does so too.
    """
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | _PLAIN, 0o600)
        try:
            _try(descriptor)
            if is_there := _is_at(path, descriptor):
                os.write(descriptor, b"\n")  # an empty one is not locked yet
        except OSError:
            os.close(descriptor)
            return None
        if is_there:
            break
        os.close(descriptor)  # whoever had the lock before has removed the file opened here

    def let_go() -> None:
        _remove(path)
        with contextlib.suppress(OSError):
            os.close(descriptor)
        if sys.platform == "win32":  # where an open file cannot be removed
            _remove(path)

    return let_go


def _is_at(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


@contextlib.contextmanager
def temporary_folder(folder: Path) -> Iterator[Path]:
    """A new folder inside another, locked by this process and gone at the end."""
    place = folder / f"{FOLDER_PREFIX}{new_mark()}"
    place.mkdir()
    let_go = None
    try:
        let_go = take(place / LOCK)
        yield place
    finally:
        if let_go is not None:
            let_go()
        shutil.rmtree(place, ignore_errors=True)


@contextlib.contextmanager
def in_turn(path: Path, wait_s: float = 10.0) -> Iterator[None]:
    """Hold a lock that others wait for; its file stays.

    Where it cannot be had, as on file systems without locks, the block runs without it.
    """
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | _PLAIN, 0o600)
    except OSError:
        yield
        return
    try:
        end = time.monotonic() + wait_s
        while time.monotonic() < end:
            try:
                _try(descriptor)
                break
            except (BlockingIOError, PermissionError):
                time.sleep(0.01)
            except OSError:
                break
        yield
    finally:
        os.close(descriptor)


def is_held(path: Path) -> bool | None:
    """Whether a living process holds a lock; None where there is no such file."""
    try:
        # No link and no pipe: such a name would open another file.
        descriptor = os.open(path, os.O_RDWR | _PLAIN)
    except OSError:
        return None
    try:
        _try(descriptor)
    except BlockingIOError:
        return True
    except OSError as error:
        return isinstance(error, PermissionError) or None  # PermissionError: held, on Windows
    finally:
        os.close(descriptor)
    return False
