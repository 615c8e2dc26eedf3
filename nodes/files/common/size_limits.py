"""Pictures that do not fit: refused by what their header claims, before memory is allocated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import FileError
from core.machine import usable_bytes
from nodes.files.common.picture_info import PictureInfo, delivered_dtype

# A picture and one copy of it, which every step needs, fit the machine.
_SHARE = 0.5
_LONGEST_TEXT = 1 << 29
# The most that a byte can become, by compression: of deflate 258 bytes for 2 bits, of PackBits 128
# for 2 bytes, of LZW 4096 for 12 bits. Others have no such bound.
_DEFLATE = 1032
_MOST_BYTES: Mapping[str, float] = {
    "none": 1.0,
    "zip": _DEFLATE,
    "zips": _DEFLATE,
    "packbits": 64.0,
    "lzw": 4096 / 1.5,
}


def refuse_oversized(info: PictureInfo, *, available_bytes: int | None = None) -> None:
    """Refuse a picture one band of which takes more than half of the memory the process may use."""
    dtype = delivered_dtype(np.dtype(info.dtype))
    if reason := oversized(info.rows, info.columns, dtype, available_bytes=available_bytes):
        raise FileError(f"{info.path}: {reason}")


def oversized(
    rows: int, columns: int, dtype: np.dtype[Any], *, available_bytes: int | None = None
) -> str:
    """Why a picture does not fit, with what it needs and what is allowed; empty where it does."""
    memory = usable_bytes() if available_bytes is None else available_bytes
    needed = rows * columns * dtype.itemsize
    if not memory or needed <= _SHARE * memory:
        return ""
    return (
        f"{rows} × {columns} samples need {_gb(needed)}; allowed on this machine: "
        f"{_gb(_SHARE * memory)}, half of the memory this process may use"
    )


def oversized_file(length: int) -> str:
    """Why a file that is read whole does not fit; empty where it does."""
    memory = usable_bytes()
    if not memory or length <= _SHARE * memory:
        return ""
    return (
        f"a file of {_gb(length)}; allowed on this machine: {_gb(_SHARE * memory)}, half of the "
        "memory this process may use"
    )


def refuse_oversized_text(path: Path) -> None:
    """Refuse a text of more than 512 MB, or of more than a quarter of the memory to be used.

    It is held twice, whole and in lines, before a number of it is read, which takes minutes.
    """
    length, memory = path.stat().st_size, usable_bytes()
    most = min(_LONGEST_TEXT, _SHARE * memory / 2) if memory else _LONGEST_TEXT
    if length > most:
        raise FileError(
            f"{path}: a text file of {_gb(length)}; allowed: {_gb(most)}; store so many samples "
            "as .npy"
        )


def refuse_impossible(info: PictureInfo, *, compression: str, bits: int) -> None:
    """Refuse a header that claims more samples of so many bits than the file can unpack to.

    A compression without a bound passes.
    """
    most = _DEFLATE if info.kind == "png" else _MOST_BYTES.get(compression)
    if most is None:
        return
    length = info.path.stat().st_size
    claimed = info.rows * info.columns * info.bands * bits / 8
    if claimed > most * length:
        raise FileError(
            f"{info.path}: damaged: {info.rows} × {info.columns} × {info.bands} samples of "
            f"{bits} bits cannot come from a file of {length} bytes"
        )


def _gb(size: float) -> str:
    return f"{size / 1e9:.3g} GB"
