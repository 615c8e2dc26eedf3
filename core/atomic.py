"""Files that are either the old ones or the new ones, never half of each."""

import contextlib
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from core.errors import FileError
from core.leftovers import new_mark, sweep


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
        raise FileError(f"cannot write {text}: it names a folder, not a file")
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
        return "it is a folder; give a file name, for example one in that folder"
    kind = _KINDS.get(stat.S_IFMT(mode), "special file")
    return f"it is a {kind}, not a regular file; allowed: a new name, or a regular file to replace"


def _mode_of_existing(target: Path) -> int | None:
    """Permissions of the file to be replaced; None where there is none."""
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
        raise FileError(f"cannot write {target}: there is no folder {target.parent}") from error
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
