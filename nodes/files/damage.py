"""Damage that a picture decoder would not report, or only on stderr."""

from __future__ import annotations

import zlib
from pathlib import Path

from core.errors import FileError
from nodes.files.common.stored_bytes import StoredBytes, stored_bytes
from nodes.files.headers.fits_header import check_sums, read_fits_header

_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_START = b"\xff\xd8\xff"
_JPEG_SCAN = b"\xff\xda"
_JPEG_END = b"\xff\xd9"
_FITS_START = b"SIMPLE  ="


def refuse_damaged(path: Path) -> None:
    """Raise `FileError` for what a checksum or an end marker of the format gives away.

    That is a PNG with a broken chunk, a FITS whose sums do not fit, a JPEG that was cut off: its
    decoder fills what is missing with grey and reports nothing.
    """
    with stored_bytes(path) as content:
        if content[:8] == _PNG_SIGNATURE:
            _check_png(content, path)
        elif content[:9] == _FITS_START:
            check_sums(read_fits_header(path))
        elif content[:3] == _JPEG_START and content.rfind(_JPEG_END) < content.rfind(_JPEG_SCAN):
            raise FileError(f"{path}: this JPEG file is truncated: its end marker is missing")


def png_bit_depth(head: bytes) -> int | None:
    """Bits of a sample of a greyscale PNG given its first bytes; None for every other file."""
    if len(head) < 26 or not head.startswith(_PNG_SIGNATURE) or head[25] not in (0, 4):
        return None
    return head[24]


def _check_png(content: StoredBytes, path: Path) -> None:
    place = len(_PNG_SIGNATURE)
    while place + 12 <= len(content):
        length, kind = content.unpack(">I4s", place)
        end = place + 12 + length
        if end > len(content):
            break
        checksum = 0
        for covered in content.pieces(place + 4, end - 4):
            checksum = zlib.crc32(covered, checksum)
        if checksum != int.from_bytes(content[end - 4 : end], "big"):
            name = kind.decode("ascii", "replace")
            raise FileError(f"{path}: this PNG file is damaged: wrong checksum in chunk {name}")
        if kind == b"IEND":
            return
        place = end
    raise FileError(f"{path}: this PNG file is truncated: its end chunk is missing")
