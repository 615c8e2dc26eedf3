"""TIFF files that are read without OpenImageIO: packed by deflate, or some of 64-bit samples.

OpenImageIO 3.2 takes damaged deflate for whole, and delivers doubles in tiles, or in a single row,
as whatever lay in memory. Sources: Adobe, TIFF Revision 6.0 (1992), sections 2, 3, 14 and 15;
Adobe, TIFF Technical Note 3 (2005), floating-point predictor; libtiff, BigTIFF design (2007);
Deutsch, RFC 1950 (1996), Adler-32.
"""

import contextlib
import os
import struct
import zlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from core.machine import Empty
from core.records import dataclass
from nodes.files.picture_info import Samples, delivered_dtype
from nodes.files.stored_bytes import StoredBytes, stored_bytes

Tags = dict[int, tuple[int, ...]]

_INTEGERS = {1: "B", 3: "H", 4: "I", 16: "Q"}
_NONE, _DEFLATES = 1, (8, 32946)
_UNPREDICTED = {_NONE: "no compression", 32773: "PackBits"}
_COLUMNS, _ROWS, _BITS, _COMPRESSION, _COLOUR = 256, 257, 258, 259, 262
_BIT_ORDER, _CHANNELS, _PLANAR, _PREDICTOR, _FORMAT = 266, 277, 284, 317, 339
_STRIPS, _STRIP_ROWS, _STRIP_SIZES = 273, 278, 279
_TILE_COLUMNS, _TILE_ROWS, _TILES, _TILE_SIZES = 322, 323, 324, 325
_GREY, _RGB, _SUBSAMPLED = 1, 2, 6
_KINDS = {1: "u", 2: "i", 3: "f"}
_NUMPY_KINDS = ("u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", "f2", "f4", "f8")
_STEP_BYTES = 1 << 24
_THREADS = 4


@dataclass(frozen=True)
class _Block:
    """A strip or tile; `lengths`, bytes it may unpack to: the usual first, none if any."""

    number: int
    plane: int
    top: int
    left: int
    rows: int
    place: int
    size: int
    lengths: tuple[int, ...]


@dataclass(frozen=True)
class TiffLayout:
    """A picture, its samples and its blocks, of which each channel may have its own (`separate`).

    `dtype` is that of whole-byte samples which are the numbers they stand for; None for colour
    maps, white as 0, packed bits and the like.
    """

    rows: int
    columns: int
    wide: int
    channels: int
    separate: bool
    compression: int
    predictor: int
    dtype: np.dtype[Any] | None
    blocks: tuple[_Block, ...]

    @property
    def is_plain(self) -> bool:
        if self.compression not in (_NONE, *_DEFLATES) or self.dtype is None:
            return False
        return self.predictor in ((1, 2, 3) if self.dtype.kind == "f" else (1, 2))


def read_plain_tiff(
    path: Path, expected: tuple[int, int, int], band: int, *, empty: Empty = np.empty
) -> Samples | None:
    """One channel of the first picture; None where samples are not the numbers they stand for."""
    with stored_bytes(path) as content:
        layout = read_tiff_layout(content, path)
        if layout.compression not in (_NONE, *_DEFLATES):
            raise FileError(
                f"{path}: 64-bit samples in tiles or a single row cannot be read with TIFF "
                f"compression {layout.compression}; allowed: none or deflate"
            )
        if not layout.is_plain:
            return None
        if (layout.rows, layout.columns, layout.channels) != expected:
            raise FileError(f"{path}: this TIFF file is damaged: it states two different sizes")
        return channel_of(content, layout, path, band, empty=empty)


def channel_of(
    content: StoredBytes, layout: TiffLayout, path: Path, band: int = 0, *, empty: Empty = np.empty
) -> Samples:
    dtype = np.dtype(layout.dtype)
    channel = empty((layout.rows, layout.columns), delivered_dtype(dtype))
    channel.fill(np.nan)

    def read(block: _Block) -> None:
        raw = _raw(content, layout, block, path)
        shape = (block.rows, layout.wide, 1 if layout.separate else layout.channels)
        samples = _unpredicted(raw, shape, layout.predictor, dtype)
        part = channel[block.top : block.top + block.rows, block.left : block.left + layout.wide]
        own = 0 if layout.separate else band
        part[...] = samples[: part.shape[0], : part.shape[1], own]

    _each_block(read, (b for b in layout.blocks if not layout.separate or b.plane == band))
    return channel


def check_deflate(path: Path) -> None:
    """Compare length and checksum of every strip or tile, for which the decoders do not wait."""
    with stored_bytes(path) as content:

        def check(block: _Block) -> None:
            for _ in _unpacked(content, block, path):
                pass

        _each_block(check, read_tiff_layout(content, path).blocks)


def is_deflated(path: Path) -> bool:
    """Whether the first picture is packed by deflate; an ambiguous predictor is refused.

    TIFF 6.0 defines the predictor for LZW, and the library undoes it for that, deflate, LZMA and
    Zstandard; where the tag stands with PackBits or without compression it is passed over. Other
    programs write and read differences there, and nothing in the file shows which it is.
    """
    with stored_bytes(path) as content:
        try:
            tags = _read_tags(content)
            compression = tags.get(_COMPRESSION, (_NONE,))[0]
        except (KeyError, IndexError, struct.error) as error:
            raise FileError(f"{path}: this TIFF file has a damaged directory: {error}") from error
    packing, predictor = _UNPREDICTED.get(compression), next(iter(tags.get(_PREDICTOR, ())), 1)
    if packing is not None and predictor != 1:
        raise FileError(
            f"{path}: predictor {predictor} with {packing} cannot be read, because programs "
            "write this combination in different ways; allowed: predictor 1, or "
            "deflate or LZW compression"
        )
    return compression in _DEFLATES


def tiff_layouts(content: StoredBytes, path: Path) -> Iterator[TiffLayout]:
    for place in directories(content, path):
        yield read_tiff_layout(content, path, place)


def read_tiff_layout(content: StoredBytes, path: Path, directory: int | None = None) -> TiffLayout:
    """Read a directory, the first one if its place is not given."""
    try:
        return _layout(_byte_order(content), _read_tags(content, directory))
    except KeyError as error:
        what = f"tag {error} is missing or damaged"
        raise FileError(f"{path}: this TIFF file is damaged: {what}") from error
    except (IndexError, ValueError, OverflowError, struct.error) as error:
        raise FileError(f"{path}: this TIFF file has a damaged directory: {error}") from error


def directories(content: StoredBytes, path: Path) -> Iterator[int]:
    try:
        order = _byte_order(content)
        word, counter, width, entry_size = _widths(content, order)
        (place,) = content.unpack(order + word, width)
        seen = set()
        while place:
            if place in seen:
                raise ValueError("the directories form a loop")
            seen.add(place)
            yield place
            (count,) = content.unpack(order + counter, place)
            after = place + struct.calcsize(order + counter) + count * entry_size
            (place,) = content.unpack(order + word, after)
    except (KeyError, ValueError, struct.error) as error:
        raise FileError(f"{path}: this TIFF file has damaged directories: {error}") from error


def _byte_order(content: StoredBytes) -> str:
    return {b"II": "<", b"MM": ">"}[content[:2]]


def _widths(content: StoredBytes, order: str) -> tuple[str, str, int, int]:
    """Formats of places and counts, bytes of a value in an entry, and of an entry."""
    big = content.unpack(order + "H", 2)[0] == 43
    return ("Q", "Q", 8, 20) if big else ("I", "H", 4, 12)


def _read_tags(content: StoredBytes, directory: int | None = None) -> Tags:
    """Integer tags of a directory by number; those with unreadable values are left out."""
    order = _byte_order(content)
    word, counter, width, entry_size = _widths(content, order)
    if directory is None:
        (directory,) = content.unpack(order + word, width)
    (count,) = content.unpack(order + counter, directory)
    tags: Tags = {}
    for index in range(count):
        entry = directory + struct.calcsize(order + counter) + index * entry_size
        tag, kind, length = content.unpack(f"{order}HH{word}", entry)
        if kind not in _INTEGERS or length > len(content):
            continue
        place = entry + 4 + width
        if length * struct.calcsize(order + _INTEGERS[kind]) > width:
            (place,) = content.unpack(order + word, place)
        with contextlib.suppress(struct.error):  # beyond the end of the file
            # As libtiff does where a tag stands twice: the first one counts.
            tags.setdefault(tag, content.unpack(f"{order}{length}{_INTEGERS[kind]}", place))
    return tags


def _layout(order: str, tags: Tags) -> TiffLayout:
    rows, columns, channels = tags[_ROWS][0], tags[_COLUMNS][0], tags.get(_CHANNELS, (1,))[0]
    bits = tags.get(_BITS, (1,))
    separate = tags.get(_PLANAR, (1,))[0] == 2 and channels > 1
    tiled = _TILE_ROWS in tags
    if tiled:
        high, wide, full = tags[_TILE_ROWS][0], tags[_TILE_COLUMNS][0], tags[_TILE_ROWS][0]
        places, sizes = tags[_TILES], tags[_TILE_SIZES]
    else:
        full, wide = tags.get(_STRIP_ROWS, (rows,))[0], columns
        high = min(full, rows)
        places, sizes = tags[_STRIPS], tags[_STRIP_SIZES]
    if min(rows, columns, channels, high, wide) < 1:
        raise ValueError(f"{rows} × {columns} × {channels} samples in blocks of {high} × {wide}")
    down, across = -(-rows // high), -(-columns // wide)
    count = down * across * (channels if separate else 1)
    if len(places) < count or len(sizes) < count:
        raise ValueError(f"{min(len(places), len(sizes))} strips or tiles instead of {count}")
    a_column = sum(bits) if len(bits) == channels else bits[0] * channels
    row_bytes = -(-wide * (bits[0] if separate else a_column) // 8)
    fixed = tags.get(_COLOUR, (_GREY,))[0] != _SUBSAMPLED
    blocks = []
    for number in range(count):
        plane, inside = divmod(number, down * across)
        top, left = high * (inside // across), wide * (inside % across)
        lines = high if tiled else min(high, rows - top)
        # Some programs fill the last strip up to the rows of the others.
        lengths = (lines * row_bytes, high * row_bytes, full * row_bytes) if fixed else ()
        place = (plane, top, left, lines, places[number], sizes[number])
        blocks.append(_Block(number, *place, lengths))
    return TiffLayout(
        rows=rows,
        columns=columns,
        wide=wide,
        channels=channels,
        separate=separate,
        compression=tags.get(_COMPRESSION, (_NONE,))[0],
        predictor=tags.get(_PREDICTOR, (1,))[0],
        dtype=_dtype(tags, order, bits, channels),
        blocks=tuple(blocks),
    )


def _dtype(tags: Tags, order: str, bits: tuple[int, ...], channels: int) -> np.dtype[Any] | None:
    formats = tags.get(_FORMAT, (1,))
    plain = tags.get(_COLOUR, (_GREY,))[0] in (_GREY, _RGB) and tags.get(_BIT_ORDER, (1,))[0] == 1
    uniform = len(set(bits)) == len(set(formats)) == 1 and len(bits) in (1, channels)
    if not plain or not uniform or bits[0] % 8 or formats[0] not in _KINDS:
        return None
    kind = f"{_KINDS[formats[0]]}{bits[0] // 8}"
    return np.dtype(order + kind) if kind in _NUMPY_KINDS else None


def _each_block(work: Callable[[_Block], None], blocks: Iterable[_Block]) -> None:
    """Call `work` for each block, in a few threads: unpacking leaves Python's lock free."""
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(min(_THREADS, os.cpu_count() or 1)) as pool:
        for _ in pool.map(work, blocks):
            pass


def _raw(content: StoredBytes, layout: TiffLayout, block: _Block, path: Path) -> bytes:
    expected = block.lengths[0]
    if layout.compression != _NONE:
        return b"".join(_unpacked(content, block, path))[:expected]
    raw = content[block.place : block.place + min(block.size, expected)]
    if len(raw) != expected:
        raise FileError(
            f"{path}: this TIFF file is damaged: strip or tile {block.number} holds {len(raw)} "
            f"bytes instead of {expected}"
        )
    return raw


def _unpacked(content: StoredBytes, block: _Block, path: Path) -> Iterator[bytes]:
    """The parts of a block packed by deflate; an error at the end where it is not whole."""
    where = f"{path}: this TIFF file is damaged: strip or tile {block.number}"
    if block.place + block.size > len(content):
        raise FileError(f"{where} lies beyond the end of the file")
    # Bounded, so that a few damaged bytes cannot use up all memory.
    most = max(block.lengths, default=None)
    stream, length = zlib.decompressobj(), 0
    try:
        for packed in content.pieces(block.place, block.place + block.size):
            left = packed
            while left and not stream.eof and (most is None or length <= most):
                part = stream.decompress(left, _STEP_BYTES)
                length += len(part)
                left = stream.unconsumed_tail
                yield part
    except zlib.error as error:
        reason = "its checksum is wrong" if "incorrect data check" in str(error) else str(error)
        raise FileError(f"{where}: {reason}") from error
    if block.lengths and length not in block.lengths:
        raise FileError(f"{where} holds {length} bytes instead of {block.lengths[0]}")
    if not stream.eof:
        raise FileError(f"{where} is cut off: its checksum is missing")


def _unpredicted(
    raw: bytes, shape: tuple[int, int, int], predictor: int, kind: np.dtype[Any]
) -> NDArray[Any]:
    rows, columns, channels = shape
    size = kind.itemsize
    if predictor == 1:
        return np.frombuffer(raw, kind).reshape(shape)
    if predictor == 2:  # differences of the samples' bits as integers
        bits = np.frombuffer(raw, f"{kind.byteorder}u{size}").reshape(shape)
        return np.cumsum(bits, axis=1, dtype=f"u{size}").view(kind.newbyteorder("="))
    # Differences of bytes, all rows' most significant bytes first.
    steps = np.frombuffer(raw, np.uint8).reshape(rows, -1, channels)
    octets = np.cumsum(steps, axis=1, dtype=np.uint8).reshape(rows, size, columns * channels)
    values = np.empty((rows, columns * channels, size), np.uint8)
    for place in range(size):  # a fifth of the time of a transposed copy
        values[:, :, place] = octets[:, place]
    return values.view(f">{kind.kind}{size}").reshape(shape)
