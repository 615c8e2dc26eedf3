"""Frames as pages of a TIFF file, classic or big, without compression and in one strip a page.

Every page takes the same number of bytes, so each directory names the next one before that is
written, and the file is written from front to end. Source: Adobe, TIFF Revision 6.0 (1992),
sections 2, 8 and 19; libtiff, BigTIFF design (2007).
"""

from __future__ import annotations

import struct

from nodes.files.frames.frame_series import FrameSeries, metadata_lines

_CLASSIC_END = 1 << 32  # classic TIFF addresses bytes by 32 bits
_ASCII, _SHORT, _LONG, _LONG8 = 2, 3, 4, 16
_SAMPLE_FORMATS = {"u": 1, "i": 2, "f": 3}
_PAGE_OF_SEVERAL = 2
_LEAST_TEXT = 9  # a shorter one would stand in its directory's entry


def needs_bigtiff(series: FrameSeries) -> bool:
    """Whether the file would go beyond what classic TIFF can address."""
    return _size(series, big=False) >= _CLASSIC_END


def tiff_head(series: FrameSeries, *, big: bool | None = None) -> bytes:
    """What stands before the first page: header and description."""
    big = needs_bigtiff(series) if big is None else big
    text = tiff_description(series)
    return tiff_header((16 if big else 8) + len(text), big=big) + text


def tiff_header(first: int, *, big: bool) -> bytes:
    """The first bytes of a file whose first directory is at that place."""
    if big:
        return struct.pack("<2sHHHQ", b"II", 43, 8, 0, first)
    return struct.pack("<2sHI", b"II", 42, first)


def tiff_page(series: FrameSeries, number: int, *, big: bool | None = None) -> bytes:
    """The directory before the samples of a page, counted from 0; that of the next one named."""
    big = needs_bigtiff(series) if big is None else big
    head = tiff_head(series, big=big)
    word = _LONG8 if big else _LONG
    kinds = [
        *directory_entries(series, len(head)),
        (254, _LONG, 1, _PAGE_OF_SEVERAL),
        (273, word, 1, 0),
        (278, _LONG, 1, series.rows),
        (279, word, 1, series.frame_bytes),
    ]
    directory = (16 if big else 6) + (20 if big else 12) * len(kinds)
    page = directory + series.frame_bytes
    start = len(head) + number * page
    following = start + page if number + 1 < series.frames else 0
    entries = b"".join(
        _entry(tag, kind, count, start + directory if tag == 273 else value, big=big)
        for tag, kind, count, value in sorted(kinds)
    )
    if big:
        return struct.pack("<Q", len(kinds)) + entries + struct.pack("<Q", following)
    return struct.pack("<H", len(kinds)) + entries + struct.pack("<I", following)


def directory_entries(series: FrameSeries, first: int) -> list[tuple[int, int, int, int]]:
    """Size, type and description of a page, whose text ends where the first directory begins."""
    text = tiff_description(series)
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


def _entry(tag: int, kind: int, count: int, value: int, *, big: bool) -> bytes:
    # Little-endian, so a short value stands first in its field, zeros behind it.
    return struct.pack("<HHQQ" if big else "<HHII", tag, kind, count, value)


def tiff_description(series: FrameSeries) -> bytes:
    """The metadata as a text that ends in a zero; of an even length, as directories begin."""
    lines = metadata_lines(series)
    if not lines:
        return b""
    text = "\n".join(lines).encode().ljust(_LEAST_TEXT) + b"\0"
    return text + b"\0" * (len(text) % 2)


def _size(series: FrameSeries, *, big: bool) -> int:
    page = len(tiff_page(FrameSeries(1, 1, 1, series.dtype, series.metadata), 0, big=big))
    return len(tiff_head(series, big=big)) + series.frames * (page + series.frame_bytes)
