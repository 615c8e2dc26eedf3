"""Files written whole or not at all, locks on them, and what dead processes have left."""

import contextlib
import functools
import hashlib
import os
import re
import secrets
import shutil
import stat
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from core.errors import FileError


@contextlib.contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give an empty file to write into, which takes the place of `path` when the block succeeds.

    It is in the same folder with the same suffix, so that the final rename stays within one file
    system and writers that choose a format by suffix choose the same one. It must be closed when
    the block ends, and is flushed to the disk before the rename. When the block raises, it is
    removed and what was at `path` before is untouched. A symbolic link is followed: its target is
    replaced. What a killed process has left in the folder is removed.
    """
    target = _target(path)
    mode = _mode_of_existing(target)
    temporary = _create_beside(target)
    try:
        yield temporary
        if mode is not None:
            temporary.chmod(mode)
        _flush_to_disk(temporary)
        temporary.replace(target)
    except OSError as error:
        _remove(temporary)
        raise FileError(f"cannot write {target}: {_reason(error)}") from error
    except BaseException:
        _remove(temporary)
        raise
    _flush_folder(target.parent)


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
    name = f".{target.stem[:40]}.{new_mark()}{target.suffix}"
    temporary = target.with_name(name)
    try:
        # Not tempfile: its files are private (0600), ours follow the umask like any other.
        os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    except FileNotFoundError as error:
        why = "no files can be made in" if target.parent.is_dir() else "there is no folder"
        raise FileError(f"cannot write {target}: {why} {target.parent}") from error
    except OSError as error:
        raise FileError(f"cannot write {target}: {_reason(error)}") from error
    return temporary


def _flush_to_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _flush_folder(folder: Path) -> None:
    """Make the rename itself durable where the system lets a folder be opened (not Windows)."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
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


# Names of temporary files that carry their process, and clearing away those of dead processes.

FOLDER_PREFIX = ".imagechain-"
LOCK = "lock"
"""A file in a temporary folder that its process holds locked."""
ABANDONED_S = 30 * 24 * 3600.0
"""A folder untouched for so long is abandoned, also where its process cannot be known."""

_UNKNOWN = "0" * 8
_MARK = r"([0-9a-f]{8})-([0-9]{1,10})-([0-9a-f]{8})-[0-9a-f]{8}"
_FOLDER = re.compile(re.escape(FOLDER_PREFIX) + _MARK)
_FILE = re.compile(r"\..*\." + _MARK + r"(\.[^.]*)?", re.DOTALL)
_UNMARKED = re.compile(re.escape(FOLDER_PREFIX) + r"[0-9a-f]{12}")  # before folders were marked


def new_mark() -> str:
    """A part of a name that no other process makes: machine, process, and a random number."""
    return f"{_host()}-{os.getpid()}-{_digest(own_token())}-{secrets.token_hex(4)}"


def sweep(folder: Path) -> None:
    """Remove what dead processes of this user have left in a folder.

    Only real files and folders whose names are marked are touched. What a process of another
    machine made is left until it has not been touched for 30 days: whether that one runs is not
    known here. What cannot be removed stays.
    """
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.startswith("."):
                with contextlib.suppress(OSError):
                    _sweep_one(entry)


def _sweep_one(entry: os.DirEntry[str]) -> None:
    marked = _FOLDER.fullmatch(entry.name) or _FILE.fullmatch(entry.name)
    if marked is None and _UNMARKED.fullmatch(entry.name) is None:
        return
    status = entry.stat(follow_symlinks=False)
    if hasattr(os, "geteuid") and status.st_uid != os.geteuid():
        return
    is_folder = entry.name.startswith(FOLDER_PREFIX)
    if not (stat.S_ISDIR if is_folder else stat.S_ISREG)(status.st_mode):
        return  # a link, above all
    if marked is None or marked[1] != _host():
        dead = None
    else:
        dead = _is_dead(int(marked[2]), marked[3], Path(entry.path) if is_folder else None)
    if dead is None:
        dead = time.time() - status.st_mtime > ABANDONED_S
    if dead and is_folder:
        shutil.rmtree(entry.path, ignore_errors=True)
    elif dead:
        Path(entry.path).unlink()


def _is_dead(pid: int, start: str, folder: Path | None) -> bool | None:
    """Whether a process of this machine has ended; None where that cannot be known."""
    # The lock too: machines that are copies of each other may share a drive.
    if folder is not None and (held := is_held(folder / LOCK)) is not None:
        return not held and (start == _UNKNOWN or _digest(start_token(pid)) != start)
    return None if start == _UNKNOWN else _digest(start_token(pid)) != start


@functools.cache
def _host() -> str:
    """The machine, and where it divides its process numbers, as containers do, which part."""
    facts = [os.uname().nodename if hasattr(os, "uname") else os.environ.get("COMPUTERNAME", "")]
    with contextlib.suppress(OSError):
        facts.append(Path("/etc/machine-id").read_bytes().decode("utf-8", "replace").strip())
    with contextlib.suppress(OSError):
        facts.append(str(Path("/proc/self/ns/pid").readlink()))
    return _digest("\n".join(facts))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:8] if text else _UNKNOWN


# Telling whether a process still runs, though its number may have been given to another since.

_PROC = Path("/proc")


def start_token(pid: int) -> str:
    """What distinguishes a process from a later one of the same number; empty where unknown."""
    try:
        # The program's name, in parentheses, may hold spaces and parentheses itself.
        fields = (_PROC / str(pid) / "stat").read_bytes().rpartition(b")")[2].split()
        boot = (_PROC / "sys/kernel/random/boot_id").read_bytes().decode("ascii").strip()
        return f"{boot}:{fields[19].decode('ascii')}"
    except (OSError, IndexError, ValueError):
        return ""


def own_token() -> str:
    """The token of this process."""
    return start_token(os.getpid())


def runs(pid: int, token: str) -> bool:
    """Whether the process of that number and token runs; False where that is unknown."""
    return bool(token) and start_token(pid) == token


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


class FileLock:
    """A lock that is held until it is let go, or the process ends."""

    def __init__(self, path: Path, descriptor: int) -> None:
        self._path = path
        self._descriptor = descriptor

    def let_go(self) -> None:
        """Let go of it, and remove its file."""
        with contextlib.suppress(OSError):
            self._path.unlink()
        with contextlib.suppress(OSError):
            os.close(self._descriptor)
        with contextlib.suppress(OSError):  # where an open file cannot be removed
            self._path.unlink(missing_ok=True)


def take(path: Path) -> FileLock | None:
    """Make a lock file of this process; None where the file system has no locks."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        _try(descriptor)
    except OSError:
        os.close(descriptor)
        return None
    return FileLock(path, descriptor)


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
