"""A picture as a TIFF file in tiles, classic or big, without compression.

Programs that show or work on a part of a large picture read the tiles of that part. All tiles take
the same number of bytes, so the directory comes first and the file is written from front to end, in
the memory of a tile. Source: Adobe, TIFF Revision 6.0 (1992), section 15; libtiff, BigTIFF design
(2007).
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
from nodes.files.frames.frame_series import FrameSeries
from nodes.files.frames.tiff_frames import directory_entries, tiff_description, tiff_header

Array = NDArray[Any]

_LONGEST_PX = 512  # rows and columns of a tile; multiples of 16, as the format has it
_STEP_PX = 16
_CLASSIC_END = 1 << 32
_LONG, _LONG8 = 4, 16
_WIDTH, _HEIGHT, _PLACES, _SIZES = 322, 323, 324, 325
_OF_STRIPS = (254, 273, 278, 279)  # a page of several, and where its strips lie


def write_tiled_tiff(path: Path, series: FrameSeries, samples: Array) -> None:
    """Write a picture, perhaps on disk, as one page of tiles.

    Parameters
    ----------
    path
        The file.
    series
        Its size, what type its samples are stored in, and what is known of them: one frame.
    samples
        (rows, columns).

    Raises
    ------
    FileError
        If it cannot be written.
    """
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
    if big is None:
        classic = len(tiled_head(series, side, big=False)) + count * tile_bytes
        big = classic >= _CLASSIC_END
    text = tiff_description(series)
    first = (16 if big else 8) + len(text)
    word, letter = (_LONG8, "Q") if big else (_LONG, "I")
    known = [entry for entry in directory_entries(series, first) if entry[0] not in _OF_STRIPS]
    number = len(known) + 4
    lists = first + (16 + 20 * number if big else 6 + 12 * number)
    list_bytes = count * struct.calcsize(letter)
    start = lists + (2 * list_bytes if count > 1 else 0)
    places = struct.pack(f"<{count}{letter}", *range(start, start + count * tile_bytes, tile_bytes))
    sizes = struct.pack(f"<{count}{letter}", *[tile_bytes] * count)
    entries = [
        *known,
        (_WIDTH, _LONG, 1, side),
        (_HEIGHT, _LONG, 1, side),
        # A single place stands in the entry itself.
        (_PLACES, word, count, lists if count > 1 else start),
        (_SIZES, word, count, lists + list_bytes if count > 1 else tile_bytes),
    ]
    packed = b"".join(struct.pack("<HHQQ" if big else "<HHII", *entry) for entry in sorted(entries))
    directory = struct.pack("<Q" if big else "<H", number) + packed + struct.pack(f"<{letter}", 0)
    return tiff_header(first, big=big) + text + directory + (places + sizes if count > 1 else b"")


def _tiles(samples: Array, side: int, dtype: np.dtype[Any]) -> Iterator[Array]:
    """The tiles in the order of the file, filled up with zeros at the picture's ends."""
    rows, columns = samples.shape
    for top in range(0, rows, side):
        for left in range(0, columns, side):
            part = samples[top : top + side, left : left + side]
            tile = np.zeros((side, side), dtype)
            tile[: part.shape[0], : part.shape[1]] = part
            yield tile
