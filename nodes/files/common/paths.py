"""Checks of a path before a reader sees it."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from core.errors import FileError
from nodes.files.common.stored_bytes import stored_bytes


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
    """Whether a regular file is there; nothing is under a name that the system does not take.

    Of such a name, one letter too long say, `Path.is_file` raises.
    """
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
