"""Writing files of frames: what stands before them, between them and beside them.

The samples follow from front to end, so a file of any number of frames takes the memory of one.
"""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from nodes.files.arrays import write_npy_header
from nodes.files.common.file_format import ENVI_FRAMES, ZARR, Format, suffixes
from nodes.files.formats import NPY, TIFF
from nodes.files.frames.frame_series import FrameSeries
from nodes.files.frames.tiff_writing import tiff_head, tiff_page
from nodes.files.headers.envi_header import HEADER_SUFFIX, REAL_TYPES

Array = NDArray[Any]
_BLOCK_SAMPLES = 1 << 24  # written at a time


def _nothing(_series: FrameSeries, _number: int = 0) -> bytes:
    return b""


@dataclass(frozen=True)
class FrameFormat(Format):
    """A format of files of frames.

    Attributes
    ----------
    head
        The bytes before the first frame.
    page
        The bytes before each frame, as many for all of them.
    whole_numbers
        Whether a converter's numbers are stored as integers.
    beside
        Text of the file beside it, of that name and `HEADER_SUFFIX`; None where there is none.
    """

    head: Callable[[FrameSeries], bytes] = _nothing
    page: Callable[[FrameSeries, int], bytes] = _nothing
    whole_numbers: bool = True
    beside: Callable[[FrameSeries], str] | None = None

    def size_bytes(self, series: FrameSeries) -> int:
        page = len(self.page(series, 0)) + series.frame_bytes
        return len(self.head(series)) + series.frames * page

    def stored_type(self, precision: np.dtype[Any], bits: int | None) -> np.dtype[Any]:
        """The type of a picture's samples: integers of a converter of that many bits, else floats.

        Of 16 bits up to 16, of 32 beyond: `precision` holds them all, 24 bits at most.
        """
        if bits is None or not self.whole_numbers:
            return precision.newbyteorder("<")
        return np.dtype("<u2" if bits <= 16 else "<u4")


def header_beside_frames(path: Path) -> Path:
    return path.with_name(path.name + HEADER_SUFFIX)


def _npy_head(series: FrameSeries) -> bytes:
    head = io.BytesIO()
    write_npy_header(head, (series.frames, *series.shape), series.dtype)
    return head.getvalue()


def envi_header_text(series: FrameSeries) -> str:
    """The header of an ENVI file of frames or bands, one after the other (BSQ)."""
    code = next(code for code, name in REAL_TYPES.items() if name == series.dtype.str[1:])
    beside = ", a band each" if series.what == "frames" else ""
    lines = [
        "ENVI",
        f"description = {{{series.what} of Imagechain{beside}}}",
        f"samples = {series.columns}",
        f"lines = {series.rows}",
        f"bands = {series.frames}",
        "header offset = 0",
        "file type = ENVI Standard",
        f"data type = {code}",
        "interleave = bsq",
        "byte order = 0",
    ]
    for key, value in series.metadata.items():
        name = "data units" if key == "unit" else key.replace("_", " ")
        text = f"{{{', '.join(map(repr, value))}}}" if isinstance(value, tuple) else str(value)
        lines.append(f"{name} = {' '.join(text.split())}")
    return "\n".join(lines) + "\n"


FRAME_FORMATS = (
    # Floats, as .npy files of pictures are: whole numbers of 16 bits would wrap round where two
    # frames are subtracted.
    FrameFormat(NPY.name, NPY.suffixes, NPY.description, _npy_head, whole_numbers=False),
    FrameFormat(TIFF.name, TIFF.suffixes, "multi-page TIFF", tiff_head, tiff_page),
    FrameFormat(**vars(ENVI_FRAMES), beside=envi_header_text),
)

STORE = FrameFormat(**vars(ZARR), whole_numbers=False)
"""A picture in a store, which is written by itself: here for its size."""


def frame_format(path: Path) -> FrameFormat | None:
    """The format of a file of frames of that name; None where there is none."""
    return next((kind for kind in FRAME_FORMATS if kind.matches(path)), None)


def frame_suffixes() -> tuple[str, ...]:
    return suffixes(*FRAME_FORMATS)


def write_frames(
    path: Path,
    kind: FrameFormat,
    series: FrameSeries,
    frames: Iterable[Array],
    done: Callable[[int], None] | None = None,
) -> None:
    """Write frames one after the other; `done` is called after each with how many there are."""
    try:
        # Not mapped into memory: a disk that is full then ends the process (SIGBUS).
        with path.open("wb") as file:
            file.write(kind.head(series))
            for number, frame in enumerate(frames):
                file.write(kind.page(series, number))
                step = max(1, _BLOCK_SAMPLES // max(1, frame.shape[1]))
                for top in range(0, len(frame), step):
                    rows = frame[top : top + step]
                    file.write(np.ascontiguousarray(rows, series.dtype).data)
                if done is not None:
                    done(number + 1)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error


def refuse_without_room(files: Sequence[tuple[Path, FrameFormat, FrameSeries]]) -> None:
    """Refuse files of frames for which a disk has no room, before anything is computed."""
    left: dict[int, int] = {}
    for path, kind, series in files:
        folder = next((above for above in path.absolute().parents if above.exists()), None)
        if folder is None:
            continue
        try:
            device = folder.stat().st_dev
            free = left.setdefault(device, shutil.disk_usage(folder).free)
        except OSError as error:
            raise FileError(f"cannot write {path}: {error.strerror or error}") from error
        size = kind.size_bytes(series)
        if size > free:
            raise FileError(
                f"cannot write {path}: {series.size_text} take {_amount(size)}, and its disk has "
                f"room for {_amount(free)}"
            )
        left[device] = free - size


def _amount(size: int) -> str:
    for unit, bytes_of in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= bytes_of:
            return f"{size / bytes_of:.3g} {unit}"
    return f"{size} bytes"
