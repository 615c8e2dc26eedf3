"""Tiled TIFF files of 64-bit floats, which OpenImageIO 3.2 delivers as whatever lay in memory.

Its tile path unpacks samples of up to 32 bits only and reports no error for others. Classic and
big TIFF, both byte orders, uncompressed or deflate, every predictor; other compressions are
refused. Source: Adobe, TIFF Revision 6.0 (1992), sections 2 and 15; Adobe, TIFF Technical Note 3
(2005), floating-point predictor.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError

_INTEGERS = {1: "B", 3: "H", 4: "I", 16: "Q"}
_COLUMNS, _ROWS, _COMPRESSION, _CHANNELS, _PLANAR, _PREDICTOR = 256, 257, 259, 277, 284, 317
_TILE_COLUMNS, _TILE_ROWS, _PLACES, _SIZES = 322, 323, 324, 325
_NONE, _DEFLATES = 1, (8, 32946)

_Tags = dict[int, tuple[int, ...]]


def read_tiled_doubles(path: Path, band: int) -> NDArray[np.float64]:
    """Read one channel of the first picture of a tiled TIFF file of doubles.

    Returns
    -------
    numpy.ndarray
        (rows, columns), float64.

    Raises
    ------
    FileError
        The file is damaged or compressed in another way than deflate.
    """
    try:
        with (
            path.open("rb") as file,
            mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content,
        ):
            return _channel(content, band, path)
    except (OSError, ValueError, KeyError, IndexError, struct.error, zlib.error) as error:
        raise FileError(f"{path}: this tiled TIFF file is damaged: {error}") from error


def _channel(content: mmap.mmap, band: int, path: Path) -> NDArray[np.float64]:
    order = {b"II": "<", b"MM": ">"}[content[:2]]
    tags = _tags(content, order)
    compression = tags.get(_COMPRESSION, (_NONE,))[0]
    if compression not in (_NONE, *_DEFLATES):
        raise FileError(
            f"{path}: tiles of doubles in TIFF compression {compression} cannot be read; "
            "allowed: none or deflate, or strips instead of tiles"
        )
    rows, columns = tags[_ROWS][0], tags[_COLUMNS][0]
    high, wide = tags[_TILE_ROWS][0], tags[_TILE_COLUMNS][0]
    across, down = -(-columns // wide), -(-rows // high)
    separate = tags.get(_PLANAR, (1,))[0] == 2
    channels = 1 if separate else tags.get(_CHANNELS, (1,))[0]
    first = band * across * down if separate else 0
    channel = np.empty((rows, columns))
    for tile in range(across * down):
        place, size = tags[_PLACES][first + tile], tags[_SIZES][first + tile]
        packed = content[place : place + size]
        expected = high * wide * channels * 8
        # Bounded, so that a few damaged bytes cannot ask for all memory.
        raw = packed if compression == _NONE else zlib.decompressobj().decompress(packed, expected)
        if len(raw) != expected:
            raise ValueError(f"tile {tile} holds {len(raw)} bytes instead of {expected}")
        samples = _unpredicted(raw, (high, wide, channels), tags.get(_PREDICTOR, (1,))[0], order)
        y, x = high * (tile // across), wide * (tile % across)
        part = channel[y : y + high, x : x + wide]
        part[...] = samples[: part.shape[0], : part.shape[1], 0 if separate else band]
    return channel


def _tags(content: mmap.mmap, order: str) -> _Tags:
    """Integer tags of the first directory by number."""
    big = struct.unpack_from(order + "H", content, 2)[0] == 43
    word, counter, width, entry_size = ("Q", "Q", 8, 20) if big else ("I", "H", 4, 12)
    (directory,) = struct.unpack_from(order + word, content, 8 if big else 4)
    (count,) = struct.unpack_from(order + counter, content, directory)
    tags: _Tags = {}
    for index in range(count):
        entry = directory + struct.calcsize(order + counter) + index * entry_size
        tag, kind, length = struct.unpack_from(f"{order}HH{word}", content, entry)
        if kind not in _INTEGERS:
            continue
        place = entry + 4 + width
        if length * struct.calcsize(order + _INTEGERS[kind]) > width:
            (place,) = struct.unpack_from(order + word, content, place)
        if length > len(content):
            raise ValueError(f"tag {tag} claims {length} values")
        tags[tag] = struct.unpack_from(f"{order}{length}{_INTEGERS[kind]}", content, place)
    return tags


def _unpredicted(
    raw: bytes, shape: tuple[int, int, int], predictor: int, order: str
) -> NDArray[np.float64]:
    """Undo the differences between neighbours that make a row compress better."""
    rows, columns, channels = shape
    if predictor == 1:
        return np.frombuffer(raw, order + "f8").reshape(shape).astype(np.float64)
    if predictor == 2:  # differences of the samples' bits as integers
        bits = np.frombuffer(raw, order + "u8").reshape(shape)
        return np.cumsum(bits, axis=1, dtype=np.uint64).view(np.float64)
    if predictor == 3:  # differences of bytes, all rows' most significant bytes first
        steps = np.frombuffer(raw, np.uint8).reshape(rows, -1, channels)
        octets = np.cumsum(steps, axis=1, dtype=np.uint8).reshape(rows, 8, columns * channels)
        values = np.ascontiguousarray(octets.swapaxes(1, 2)).view(">f8")
        return values.reshape(shape).astype(np.float64)
    raise ValueError(f"predictor {predictor} is unknown")
