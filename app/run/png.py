"""The picture every run writes: 8-bit grey PNG, without loading a picture library."""

from __future__ import annotations

import math
import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.uint8]
_BLOCK_SAMPLES = 1 << 18
_SAMPLES_READ = 1 << 22


def grey_levels(low: float, high: float, samples: NDArray[Any]) -> Grey:
    """Samples as 0 (`low` and below) to 255 (`high` and above); mid grey where these are equal."""
    if not high > low:
        return np.full(samples.shape, 128, np.uint8)
    levels = np.empty(samples.shape, np.uint8)
    # The difference of the largest numbers overflows, halves of the smallest ones vanish.
    part = 1.0 if math.isfinite(high - low) else 0.5
    # By rows, so that a large picture is never held in double precision as a whole.
    step = max(1, _BLOCK_SAMPLES // samples.shape[1])
    for start in range(0, samples.shape[0], step):
        rows = slice(start, start + step)
        clipped = np.clip(samples[rows].astype(np.float64), low, high)
        shares = (clipped * part - low * part) / (high * part - low * part)
        levels[rows] = np.rint(shares * 255.0)
    return levels


def robust_limits(samples: NDArray[Any]) -> tuple[float, float]:
    """Values for black and white that a few odd samples do not move: the 0.1 % quantiles.

    Where all but a few samples are alike, as in a picture of a point, the extremes. Of a large
    picture every n-th row and column is read.
    """
    every = max(1, round((samples.size / _SAMPLES_READ) ** 0.5))
    sampled = samples[::every, ::every]
    low, high = (float(limit) for limit in np.percentile(sampled, (0.1, 99.9)))
    if not high > low:
        low, high = float(samples.min()), float(samples.max())
    return low, high


def encode_png(levels: Grey) -> bytes:
    """Bytes of a grey PNG file (ISO/IEC 15948)."""
    rows, columns = levels.shape
    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    # Each row is stored as differences to the row above (filter 2): half the size of plain rows.
    above = np.zeros_like(levels)
    above[1:] = levels[:-1]
    lines = np.empty((rows, columns + 1), np.uint8)
    lines[:, 0] = 2
    np.subtract(levels, above, out=lines[:, 1:])
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        (
            _chunk(b"IHDR", header),
            _chunk(b"IDAT", zlib.compress(lines.tobytes(), 3)),
            _chunk(b"IEND", b""),
        )
    )


def _chunk(name: bytes, content: bytes) -> bytes:
    check = zlib.crc32(name + content)
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", check)
