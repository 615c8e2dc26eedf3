"""Whether a picture's file leaves out what the eye would not miss."""

from __future__ import annotations

from pathlib import Path

from nodes.files.common.paths import first_bytes

_ALWAYS = ("jpeg",)
_LOSSY_PACKING = ("jpeg", "webp", "pxr24", "b44", "b44a", "dwaa", "dwab", "lossy")
_HEADERS = 1 << 16  # bytes, that hold the main header
_CODING_STYLE = b"\xff\x52\x00"  # marker, and the first byte of the length
_WAVELETS_AT = 13  # bytes from that marker on
_IRREVERSIBLE = 0


def leaves_out(path: Path, *, kind: str, compression: str) -> bool:
    """Whether samples of a file are others than those that were stored in it.

    Parameters
    ----------
    path : Path
        The file.
    kind : str
        Its format by its content, such as ``jpeg``.
    compression : str
        How its samples are packed, as its header words it.

    Notes
    -----
    Source: ITU-T T.800, table A.20 (JPEG 2000: irreversible wavelets are those of 9 and 7 taps);
    RFC 9649 (WebP: a chunk named VP8L has no loss).
    """
    if kind in _ALWAYS or compression.partition(":")[0].lower() in _LOSSY_PACKING:
        return True
    if kind == "webp":
        return b"VP8L" not in first_bytes(path, _HEADERS)
    if kind == "jpeg2000":
        start = first_bytes(path, _HEADERS)
        place = start.find(_CODING_STYLE)
        return place >= 0 and start[place + _WAVELETS_AT :][:1] == bytes([_IRREVERSIBLE])
    return False
