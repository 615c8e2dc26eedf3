"""TIFF files that are read without OpenImageIO: packed by deflate, or some of 64-bit samples.

OpenImageIO 3.2 takes damaged deflate for whole, and delivers doubles in tiles, or in a single row,
as whatever lay in memory: its tile path unpacks samples of up to 32 bits only. Classic and big
TIFF, both byte orders, strips and tiles, every predictor. Source: Adobe, TIFF Revision 6.0 (1992),
sections 2, 14 and 15; Adobe, TIFF Technical Note 3 (2005), floating-point predictor.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from core.scratch import Empty
from nodes.files.common.picture_info import PictureInfo, Samples, delivered_dtype
from nodes.files.common.stored_bytes import StoredBytes, stored_bytes
from nodes.files.tiff_deflate import each_block, unpacked
from nodes.files.tiff_layout import DEFLATES, NONE, Block, TiffLayout, read_tiff_layout


def read_plain_tiff(info: PictureInfo, band: int, *, empty: Empty = np.empty) -> Samples | None:
    """Read one channel of the first picture of a TIFF file.

    Parameters
    ----------
    info
        The file and the size that it is to have.
    band
        Channel, counted from 0.
    empty
        Makes the array to be filled in, perhaps on disk.

    Returns
    -------
    numpy.ndarray or None
        (rows, columns), single or double precision by `delivered_dtype`. None where samples are
        not the numbers they stand for: colour maps, white as 0, packed bits.

    Raises
    ------
    FileError
        The file is damaged or compressed in another way than deflate.
    """
    return read_channel(info.path, (info.rows, info.columns, info.bands), band, empty=empty)


def read_channel(
    path: Path, expected: tuple[int, int, int], band: int, *, empty: Empty = np.empty
) -> Samples | None:
    """Read one channel of a picture of that many rows, columns and channels; else as above."""
    with stored_bytes(path) as content:
        layout = read_tiff_layout(content, path)
        if layout.compression not in (NONE, *DEFLATES):
            raise FileError(
                f"{path}: 64-bit samples in tiles or a single row cannot be read from TIFF "
                f"compression {layout.compression}; allowed: none or deflate"
            )
        if not is_plain(layout):
            return None
        size = layout.rows, layout.columns, layout.channels
        if size != expected:
            raise FileError(f"{path}: this TIFF file is damaged: it gives two sizes")
        return channel_of(content, layout, path, band, empty=empty)


def channel_of(
    content: StoredBytes,
    layout: TiffLayout,
    path: Path,
    band: int = 0,
    *,
    empty: Empty = np.empty,
) -> Samples:
    """Read one channel of a picture whose layout has been checked; errors as above."""
    kind = np.dtype(layout.numpy_kind)
    stored_kind = np.dtype(f"{layout.order}{layout.numpy_kind}")
    channel = empty((layout.rows, layout.columns), delivered_dtype(kind))
    channel.fill(np.nan)

    def read(block: Block) -> None:
        raw = _raw(content, layout, block, path)
        shape = (block.rows, layout.wide, layout.block_channels)
        samples = _unpredicted(raw, shape, layout.predictor, stored_kind)
        part = channel[block.top : block.top + block.rows, block.left : block.left + layout.wide]
        own = 0 if layout.separate else band
        part[...] = samples[: part.shape[0], : part.shape[1], own]

    each_block(read, (b for b in layout.blocks if not layout.separate or b.plane == band))
    return channel


def is_plain(layout: TiffLayout) -> bool:
    """Whether the samples are the numbers they stand for, packed in a way that is read here."""
    if layout.compression not in (NONE, *DEFLATES) or layout.numpy_kind is None:
        return False
    return layout.predictor in _predictors(layout.numpy_kind)


def _predictors(kind: str) -> tuple[int, ...]:
    return (1, 2, 3) if kind.startswith("f") else (1, 2)


def _raw(content: StoredBytes, layout: TiffLayout, block: Block, path: Path) -> bytes:
    """Bytes of the rows of a block."""
    expected = block.lengths[0]
    if layout.compression != NONE:
        return unpacked(content, block, path)[:expected]
    raw = content[block.place : block.place + min(block.size, expected)]
    if len(raw) != expected:
        raise FileError(
            f"{path}: this TIFF file is damaged: strip or tile {block.number} holds {len(raw)} "
            f"bytes instead of {expected}"
        )
    return raw


def _unpredicted(
    raw: bytes, shape: tuple[int, int, int], predictor: int, kind: np.dtype[Any]
) -> NDArray[Any]:
    """Undo the differences between neighbours that make a row compress better."""
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
