"""Strips and tiles packed by deflate, each of which ends in a checksum.

The decoders do not wait for it: a flipped bit gave other samples, or memory never written to.
Source: Deutsch, RFC 1950 (1996), Adler-32.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core.errors import FileError
from nodes.files.common.stored_bytes import StoredBytes, stored_bytes
from nodes.files.tiff_layout import DEFLATES, Block, compression_of, read_tiff_layout

_STEP_BYTES = 1 << 24
_THREADS = 4


def is_deflated(path: Path) -> bool:
    """Whether the first picture of a TIFF file is packed by deflate."""
    with stored_bytes(path) as content:
        return compression_of(content, path) in DEFLATES


def check_deflate(path: Path) -> None:
    """Unpack every strip or tile of the first picture and compare length and checksum.

    Raises
    ------
    FileError
        A block is damaged, has another length than its rows, or lies beyond the end of the file.
    """
    with stored_bytes(path) as content:
        blocks = read_tiff_layout(content, path).blocks
        each_block(lambda block: _unpack(content, block, path, None), blocks)


def each_block(work: Callable[[Block], None], blocks: Iterable[Block]) -> None:
    """Call `work` for each block, in a few threads: unpacking leaves Python's lock free."""
    blocks = tuple(blocks)
    threads = min(_THREADS, os.cpu_count() or 1, len(blocks))
    if threads < 2:
        for block in blocks:
            work(block)
        return
    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(work, blocks):
            pass


def unpacked(content: StoredBytes, block: Block, path: Path) -> bytes:
    """The bytes of a block, whole and with the right checksum.

    Raises
    ------
    FileError
        See `check_deflate`.
    """
    parts: list[bytes] = []
    _unpack(content, block, path, parts)
    return parts[0] if len(parts) == 1 else b"".join(parts)


def _unpack(content: StoredBytes, block: Block, path: Path, parts: list[bytes] | None) -> None:
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
                if parts is not None:
                    parts.append(part)
    except zlib.error as error:
        reason = "its checksum is wrong" if "incorrect data check" in str(error) else str(error)
        raise FileError(f"{where}: {reason}") from error
    if block.lengths and length not in block.lengths:
        raise FileError(f"{where} holds {length} bytes instead of {block.lengths[0]}")
    if not stream.eof:
        raise FileError(f"{where} is cut off: its checksum is missing")
