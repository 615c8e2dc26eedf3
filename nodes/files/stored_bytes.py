"""Checks of a path, and bytes of a file, read when needed and never mapped into memory.

A mapped file that another program cuts short ends the process (SIGBUS).
"""

import contextlib
import os
import stat
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError

_STEP_BYTES = 1 << 20


class StoredBytes:
    """A file as a sequence of bytes, which several threads may read."""

    def __init__(self, path: Path, file: BinaryIO) -> None:
        self.path = path
        self._file = file
        self._length = os.fstat(file.fileno()).st_size
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, part: slice) -> bytes:
        start, stop, _ = part.indices(self._length)
        with self._lock:
            self._file.seek(start)
            return self._file.read(max(0, stop - start))

    def unpack(self, form: str, place: int) -> tuple[Any, ...]:
        """Numbers as `struct` has them; `struct.error` beyond the end of the file."""
        return struct.unpack(form, self[place : place + struct.calcsize(form)])

    def pieces(self, start: int, stop: int) -> Iterator[bytes]:
        """The bytes between two places in turn, so that they are never in memory together."""
        for place in range(start, stop, _STEP_BYTES):
            yield self[place : min(stop, place + _STEP_BYTES)]

    def rfind(self, wanted: bytes) -> int:
        for start in range((self._length - 1) // _STEP_BYTES * _STEP_BYTES, -1, -_STEP_BYTES):
            found = self[start : start + _STEP_BYTES + len(wanted) - 1].rfind(wanted)
            if found >= 0:
                return start + found
        return -1

    def fill(self, samples: NDArray[Any], place: int) -> None:
        """Fill a contiguous array with the bytes from `place` on, which must be there."""
        left = samples.reshape(-1).view(np.uint8).data
        with self._lock:
            self._file.seek(place)
            while left:
                count = self._file.readinto(left)  # type: ignore[attr-defined]
                if not count:
                    raise FileError(f"{self.path}: ends before its last sample")
                left = left[count:]


@contextlib.contextmanager
def stored_bytes(path: Path) -> Iterator[StoredBytes]:
    """Open a regular file, no pipe or device, also where another program put it there meanwhile."""
    # Without O_NONBLOCK a pipe would be waited for.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        with os.fdopen(os.open(path, flags), "rb") as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise FileError(f"{path}: not a regular file")
            yield StoredBytes(path, file)
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error


def readable_file(path: str | os.PathLike[str]) -> Path:
    """The path, once it is known to be a regular, readable file that is not empty."""
    text = os.fspath(path)
    if not text:
        raise FileError("no file to read: the path is empty")
    if "\0" in text:
        raise FileError(f"{text!r}: the path contains a null character")
    status = _status(text)
    if stat.S_ISDIR(status.st_mode):
        raise FileError(f"{text}: a folder, not a file")
    # Opening a pipe would wait for ever.
    if not stat.S_ISREG(status.st_mode):
        raise FileError(f"{text}: not a regular file")
    if not os.access(text, os.R_OK):
        raise FileError(f"{text}: no permission to read this file")
    if status.st_size == 0:
        raise FileError(f"{text}: the file is empty")
    return Path(text)


def is_file(path: Path) -> bool:
    """Whether a regular file is there; `Path.is_file` raises for a name that is too long."""
    try:
        return path.is_file()
    except OSError:
        return False


def _status(text: str) -> os.stat_result:
    try:
        return Path(text).stat()
    except FileNotFoundError as error:
        raise FileError(f"{text}: no such file") from error
    except OSError as error:
        raise FileError(f"{text}: {error.strerror or error}") from error


def first_bytes(path: Path, count: int) -> bytes:
    with stored_bytes(path) as content:
        return content[:count]


def checked_band(band: int, bands: int, path: Path) -> int:
    """Return `band` as a plain int once it is one of the file's `bands`, counted from 0."""
    allowed = "0" if bands == 1 else f"0 to {bands - 1}"
    if isinstance(band, bool) or int(band) != band or not 0 <= band < bands:
        raise FileError(f"{path}: there is no band {band!r}; allowed: {allowed}")
    return int(band)
