"""How the first picture of a TIFF file is cut into strips or tiles, and where each of them lies.

Source: Adobe, TIFF Revision 6.0 (1992), sections 3 and 15.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from core.errors import FileError
from nodes.files.common.stored_bytes import StoredBytes, stored_bytes
from nodes.files.tiff_directory import Tags, byte_order, read_tags

NONE, DEFLATES = 1, (8, 32946)
_UNPREDICTED = {NONE: "no compression", 32773: "PackBits"}
_COLUMNS, _ROWS, _BITS, _COMPRESSION, _COLOUR = 256, 257, 258, 259, 262
_BIT_ORDER, _CHANNELS, _PLANAR, _PREDICTOR, _FORMAT = 266, 277, 284, 317, 339
_STRIPS, _STRIP_ROWS, _STRIP_SIZES = 273, 278, 279
_TILE_COLUMNS, _TILE_ROWS, _TILES, _TILE_SIZES = 322, 323, 324, 325
_GREY, _RGB, _SUBSAMPLED = 1, 2, 6
_KINDS = {1: "u", 2: "i", 3: "f"}
_NUMPY_KINDS = ("u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", "f2", "f4", "f8")


@dataclass(frozen=True)
class Block:
    """A strip or tile: the rows and first column it covers, its place, what it may unpack to.

    `lengths` are in bytes, the one it should have first; none where a block has no fixed length.
    """

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
    """The picture, its samples and its blocks.

    `block_channels` are those of a block, 1 where each channel has blocks of its own (`separate`).
    `numpy_kind` is that of whole-byte samples which are the numbers they stand for, with the
    file's byte order; None for colour maps, white as 0, packed bits and the like.
    """

    order: str
    rows: int
    columns: int
    wide: int
    channels: int
    block_channels: int
    separate: bool
    tiled: bool
    compression: int
    predictor: int
    numpy_kind: str | None
    blocks: tuple[Block, ...]


def compression_of(content: StoredBytes, path: Path) -> int:
    """Number of the compression; errors as `read_tiff_layout`."""
    try:
        return read_tags(content).get(_COMPRESSION, (NONE,))[0]
    except (KeyError, IndexError, struct.error) as error:
        raise FileError(f"{path}: this TIFF file is damaged: its directory: {error}") from error


def refuse_predictor(path: Path) -> None:
    """Refuse differences between neighbours in a packing that has none.

    TIFF 6.0 defines the predictor for LZW, and the library undoes it for that, deflate, LZMA and
    Zstandard; where the tag stands with PackBits or without compression it is passed over. Other
    programs write and read differences there, and nothing in the file shows which it is.

    Raises
    ------
    FileError
        Naming predictor and packing; or that the directory is damaged.
    """
    with stored_bytes(path) as content:
        packing = _UNPREDICTED.get(compression_of(content, path))
        predictor = next(iter(read_tags(content).get(_PREDICTOR, ())), 1)
    if packing is not None and predictor != 1:
        raise FileError(
            f"{path}: predictor {predictor} with {packing} cannot be read: programs differ on what "
            "that means; allowed: predictor 1, or deflate or LZW"
        )


def read_tiff_layout(content: StoredBytes, path: Path, directory: int | None = None) -> TiffLayout:
    """Read a directory, the first one if its place is not given.

    Raises
    ------
    FileError
        It is damaged, or incomplete.
    """
    try:
        return _layout(byte_order(content), read_tags(content, directory))
    except KeyError as error:
        what = f"tag {error} is missing or damaged"
        raise FileError(f"{path}: this TIFF file is damaged: {what}") from error
    except (IndexError, ValueError, OverflowError, struct.error) as error:
        raise FileError(f"{path}: this TIFF file is damaged: its directory: {error}") from error


def _layout(order: str, tags: Tags) -> TiffLayout:
    rows, columns, all_channels = tags[_ROWS][0], tags[_COLUMNS][0], tags.get(_CHANNELS, (1,))[0]
    bits = tags.get(_BITS, (1,))
    separate = tags.get(_PLANAR, (1,))[0] == 2 and all_channels > 1
    tiled = _TILE_ROWS in tags
    if tiled:
        high, wide, full = tags[_TILE_ROWS][0], tags[_TILE_COLUMNS][0], tags[_TILE_ROWS][0]
        places, sizes = tags[_TILES], tags[_TILE_SIZES]
    else:
        full, wide = tags.get(_STRIP_ROWS, (rows,))[0], columns
        high = min(full, rows)
        places, sizes = tags[_STRIPS], tags[_STRIP_SIZES]
    if min(rows, columns, all_channels, high, wide) < 1:
        raise ValueError(
            f"{rows} × {columns} × {all_channels} samples in blocks of {high} × {wide}"
        )
    down, across = -(-rows // high), -(-columns // wide)
    planes = all_channels if separate else 1
    count = down * across * planes
    if len(places) < count or len(sizes) < count:
        raise ValueError(f"{min(len(places), len(sizes))} strips or tiles instead of {count}")
    a_column = sum(bits) if len(bits) == all_channels else bits[0] * all_channels
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
        blocks.append(Block(number, *place, lengths))
    return TiffLayout(
        order=order,
        rows=rows,
        columns=columns,
        wide=wide,
        channels=all_channels,
        block_channels=1 if separate else all_channels,
        separate=separate,
        tiled=tiled,
        compression=tags.get(_COMPRESSION, (NONE,))[0],
        predictor=tags.get(_PREDICTOR, (1,))[0],
        numpy_kind=_numpy_kind(tags, bits, all_channels),
        blocks=tuple(blocks),
    )


def _numpy_kind(tags: Tags, bits: tuple[int, ...], channels: int) -> str | None:
    formats = tags.get(_FORMAT, (1,))
    plain = tags.get(_COLOUR, (_GREY,))[0] in (_GREY, _RGB) and tags.get(_BIT_ORDER, (1,))[0] == 1
    uniform = len(set(bits)) == len(set(formats)) == 1 and len(bits) in (1, channels)
    if not plain or not uniform or bits[0] % 8 or formats[0] not in _KINDS:
        return None
    kind = f"{_KINDS[formats[0]]}{bits[0] // 8}"
    return kind if kind in _NUMPY_KINDS else None
