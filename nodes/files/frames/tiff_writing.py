"""TIFF files without compression, classic or big: frames as pages, or one picture in tiles.

Every page, and every tile, takes the same number of bytes, so a directory names what follows before
that is written, and the file is written from front to end. Programs that show or work on a part of
a large picture read the tiles of that part. Sources: Adobe, TIFF Revision 6.0 (1992), sections 2,
8, 15 and 19; libtiff, BigTIFF design (2007).
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from nodes.files.common.picture_info import metadata_text
from nodes.files.frames.frame_series import FrameSeries

Array = NDArray[Any]
_Entry = tuple[int, int, int, int]  # tag, type, count, value or place

_CLASSIC_END = 1 << 32  # classic TIFF addresses bytes by 32 bits
_ASCII, _SHORT, _LONG, _LONG8 = 2, 3, 4, 16
_SAMPLE_FORMATS = {"u": 1, "i": 2, "f": 3}
_PAGE_OF_SEVERAL = 2
_LEAST_TEXT = 9  # a shorter one would stand in its directory's entry
_LONGEST_PX = 512  # rows and columns of a tile; multiples of 16, as the format has it
_STEP_PX = 16


def tiff_head(series: FrameSeries, *, big: bool | None = None) -> bytes:
    """What stands before the first page: header and description."""
    big = _is_big(series) if big is None else big
    return _header(_description(series), big=big)


def tiff_page(series: FrameSeries, number: int, *, big: bool | None = None) -> bytes:
    """The directory before the samples of a page, counted from 0; that of the next one named."""
    big = _is_big(series) if big is None else big
    head = len(tiff_head(series, big=big))
    known = _known_entries(series, head)
    directory = _directory_bytes(len(known) + 4, big=big)
    page = directory + series.frame_bytes
    start = head + number * page
    word = _LONG8 if big else _LONG
    entries = [
        *known,
        (254, _LONG, 1, _PAGE_OF_SEVERAL),
        (273, word, 1, start + directory),
        (278, _LONG, 1, series.rows),
        (279, word, 1, series.frame_bytes),
    ]
    return _directory(entries, start + page if number + 1 < series.frames else 0, big=big)


def write_tiled_tiff(path: Path, series: FrameSeries, samples: Array) -> None:
    """Write a picture (rows, columns), perhaps on disk, as one page of tiles."""
    side = min(_LONGEST_PX, -(-max(samples.shape) // _STEP_PX) * _STEP_PX)
    try:
        # Not mapped into memory: a disk that is full then ends the process (SIGBUS).
        with path.open("wb") as file:
            file.write(tiled_head(series, side))
            for tile in _tiles(samples, side, series.dtype):
                file.write(tile.data)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error


def tiled_head(series: FrameSeries, side: int, *, big: bool | None = None) -> bytes:
    """What stands before the first tile: header, description, directory, and the tiles' places."""
    count = -(-series.rows // side) * -(-series.columns // side)
    tile_bytes = side * side * series.dtype.itemsize
    text = _description(series)
    number = len(_known_entries(series, len(text))) + 4
    if big is None:
        lists = len(_header(text, big=False)) + _directory_bytes(number, big=False)
        big = lists + count * (8 + tile_bytes) >= _CLASSIC_END
    head = _header(text, big=big)
    word, letter = (_LONG8, "Q") if big else (_LONG, "I")
    lists = len(head) + _directory_bytes(number, big=big)
    list_bytes = count * struct.calcsize(letter)
    start = lists + (2 * list_bytes if count > 1 else 0)
    places = struct.pack(f"<{count}{letter}", *range(start, start + count * tile_bytes, tile_bytes))
    sizes = struct.pack(f"<{count}{letter}", *[tile_bytes] * count)
    entries = [
        *_known_entries(series, len(head)),
        (322, _LONG, 1, side),
        (323, _LONG, 1, side),
        # A single place stands in the entry itself.
        (324, word, count, lists if count > 1 else start),
        (325, word, count, lists + list_bytes if count > 1 else tile_bytes),
    ]
    return head + _directory(entries, 0, big=big) + (places + sizes if count > 1 else b"")


def _tiles(samples: Array, side: int, dtype: np.dtype[Any]) -> Iterator[Array]:
    """The tiles in the order of the file, filled up with zeros at the picture's ends."""
    rows, columns = samples.shape
    for top in range(0, rows, side):
        for left in range(0, columns, side):
            part = samples[top : top + side, left : left + side]
            tile = np.zeros((side, side), dtype)
            tile[: part.shape[0], : part.shape[1]] = part
            yield tile


def _is_big(series: FrameSeries) -> bool:
    """Whether the pages would go beyond what classic TIFF can address."""
    head = len(tiff_head(series, big=False))
    entries = len(_known_entries(series, head)) + 4
    page = _directory_bytes(entries, big=False) + series.frame_bytes
    return head + series.frames * page >= _CLASSIC_END


def _header(text: bytes, *, big: bool) -> bytes:
    """The first bytes of a file, then the description, then comes the first directory."""
    if big:
        return struct.pack("<2sHHHQ", b"II", 43, 8, 0, 16 + len(text)) + text
    return struct.pack("<2sHI", b"II", 42, 8 + len(text)) + text


def _description(series: FrameSeries) -> bytes:
    """The metadata as a text that ends in a zero; of an even length, as directories begin."""
    if not series.metadata:
        return b""
    text = metadata_text(series.metadata).encode().ljust(_LEAST_TEXT) + b"\0"
    return text + b"\0" * (len(text) % 2)


def _known_entries(series: FrameSeries, first: int) -> list[_Entry]:
    """Size, type and description of a page, whose text ends where the first directory begins."""
    text = _description(series)
    entries = [
        (256, _LONG, 1, series.columns),
        (257, _LONG, 1, series.rows),
        (258, _SHORT, 1, 8 * series.dtype.itemsize),
        (259, _SHORT, 1, 1),
        (262, _SHORT, 1, 1),
        (277, _SHORT, 1, 1),
        (284, _SHORT, 1, 1),
        (339, _SHORT, 1, _SAMPLE_FORMATS[series.dtype.kind]),
    ]
    if text:
        entries.append((270, _ASCII, len(text.rstrip(b"\0")) + 1, first - len(text)))
    return entries


def _directory_bytes(entries: int, *, big: bool) -> int:
    return 16 + 20 * entries if big else 6 + 12 * entries


def _directory(entries: list[_Entry], following: int, *, big: bool) -> bytes:
    # Little-endian, so a short value stands first in its field, zeros behind it.
    packed = b"".join(struct.pack("<HHQQ" if big else "<HHII", *entry) for entry in sorted(entries))
    return (
        struct.pack("<Q" if big else "<H", len(entries))
        + packed
        + struct.pack("<Q" if big else "<I", following)
    )
