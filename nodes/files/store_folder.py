"""Zarr stores as folders: known by what lies in them, without the library that reads them."""

import contextlib
import os
import shutil
import stat
from collections.abc import Iterator
from pathlib import Path

from core.atomic import FOLDER_PREFIX, LOCK, new_mark, sweep, take
from core.errors import FileError
from nodes.files.common.picture_info import oversized_file
from nodes.files.common.stored_bytes import readable_file

_ALLOWED = "allowed: a new name, or an existing store to replace"
_MARKS = ("zarr.json", ".zarray", ".zgroup")  # version 3, arrays and groups of version 2
_METADATA = (*_MARKS, ".zattrs", ".zmetadata")


def is_store(path: Path) -> bool:
    try:
        return any((path / mark).is_file() for mark in _MARKS)
    except OSError:  # a name that the system does not take
        return False


def readable_picture(path: str | os.PathLike[str]) -> Path:
    folder = Path(path)
    if not is_store(folder):
        return readable_file(path)
    if not os.access(folder, os.R_OK | os.X_OK):
        raise FileError(f"{path}: no permission to read this folder")
    return folder


def store_state(folder: Path) -> tuple[int, int]:
    """Bytes of all files of a store, and when the last of them or its folders was changed, ns."""
    states = list(_states(folder))
    return sum(one.st_size for _, one in states), max(one.st_mtime_ns for _, one in states)


def count_chunks(folder: Path) -> int:
    """How many files of samples are in the folder of an array."""
    return sum(
        stat.S_ISREG(status.st_mode) and path.rpartition(os.sep)[2] not in _METADATA
        for path, status in _states(folder)
    )


@contextlib.contextmanager
def atomic_store(path: Path) -> Iterator[Path]:
    """Give the name of a folder, not there yet, that takes the place of `path` at the end.

    When the block raises, it is removed and what was at `path` is untouched, as `atomic_file` has
    it. What a killed process has left in the folder above is removed.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not is_store(target):
        raise FileError(f"cannot write {path}: it exists and is not a Zarr store; {_ALLOWED}")
    if not target.parent.is_dir():
        raise FileError(f"cannot write {path}: there is no folder {path.parent}")
    sweep(target.parent)
    place = target.parent / f"{FOLDER_PREFIX}{new_mark()}"
    lock = None
    try:
        place.mkdir()
        lock = take(place / LOCK)
        yield place / "new"
        _exchange(target, place)
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        if lock is not None:
            lock.let_go()
        shutil.rmtree(place, ignore_errors=True)


def _exchange(target: Path, place: Path) -> None:
    before = place / "old"
    if target.exists():
        target.replace(before)
    try:
        (place / "new").replace(target)
    except OSError:
        if before.exists():
            before.replace(target)
        raise


def _states(folder: Path) -> Iterator[tuple[str, os.stat_result]]:
    """Folders and files by path; a pipe or a device, which could be read for ever, is refused."""
    waiting = [os.fspath(folder)]
    try:
        while waiting:
            current = waiting.pop()
            yield current, Path(current).stat()
            with os.scandir(current) as entries:
                for entry in entries:
                    if entry.is_dir(follow_symlinks=False):
                        waiting.append(entry.path)
                        continue
                    status = entry.stat()
                    if not stat.S_ISREG(status.st_mode):
                        raise FileError(
                            f"{entry.path}: not a regular file; a store contains only files "
                            "and folders"
                        )
                    if too_long := oversized_file(status.st_size):
                        raise FileError(f"{entry.path}: {too_long}")
                    yield entry.path, status
    except OSError as error:
        raise FileError(f"{folder}: {error.strerror or error}") from error
