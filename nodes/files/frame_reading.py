"""Reading files of frames one frame at a time, in the memory of one.

``.npy`` of (frames, rows, columns), TIFF of a page each, ENVI of a band each.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.errors import DataError, FileError
from nodes.files.arrays import fill_plane, is_npy, npy_header
from nodes.files.common.picture_info import (
    Samples,
    delivered_dtype,
    oversized,
    refuse_shape,
    refuse_unreal,
)
from nodes.files.common.stored_bytes import StoredBytes, readable_file, stored_bytes
from nodes.files.envi import band_of, info_of
from nodes.files.envi_header import is_envi, read_layout
from nodes.files.formats import NPY, TIFF
from nodes.files.read import check_finite, read_info
from nodes.files.tiff_reading import TiffLayout, channel_of, directories, tiff_layouts

_READ = ".npy (frames, rows, columns), TIFF with one page per frame, ENVI with one band per frame"


@dataclass(frozen=True)
class FrameFile:
    """A file of frames of one size; `path` is that of the data, `dtype` that of stored samples."""

    path: Path
    kind: Literal["npy", "tiff", "envi"]
    frames: int
    rows: int
    columns: int
    dtype: np.dtype[Any]
    unit: str | None

    def each(self) -> Iterator[Samples]:
        """The frames in turn, in the precision of `delivered_dtype`, all finite."""
        read = {"npy": self._of_npy, "tiff": self._of_tiff, "envi": self._of_envi}[self.kind]
        for number, samples in enumerate(read()):
            check_finite(samples, f"{self.path}, frame {number}")
            yield samples

    def _of_npy(self) -> Iterator[Samples]:
        header = npy_header(self.path)
        for number in range(self.frames):
            frame = np.empty((self.rows, self.columns), delivered_dtype(header.dtype))
            fill_plane(frame, self.path, header, axis=0, index=number)
            yield frame

    def _of_envi(self) -> Iterator[Samples]:
        layout = read_layout(self.path)
        for number in range(self.frames):
            yield band_of(layout, number)

    def _of_tiff(self) -> Iterator[Samples]:
        with stored_bytes(self.path) as content:
            for layout in _pages(content, self.path):
                yield channel_of(content, layout, self.path)


def open_frames(path: Path) -> FrameFile:
    file = readable_file(path)
    if NPY.matches(file) or is_npy(file):
        found = _npy(file)
    elif TIFF.matches(file):
        found = _tiff(file)
    elif is_envi(file):
        found = _envi(file)
    else:
        raise FileError(f"{path}: frames cannot be read from this file; allowed: {_READ}")
    if reason := oversized(found.rows, found.columns, delivered_dtype(found.dtype)):
        raise FileError(f"{path}: {reason}")
    return found


def tiff_pages(path: Path) -> int:
    file = readable_file(path)
    with stored_bytes(file) as content:
        return sum(1 for _ in directories(content, file))


def _npy(path: Path) -> FrameFile:
    header = npy_header(path)
    shape, dtype = header.shape, header.dtype
    refuse_unreal(path, dtype)
    refuse_shape(path, shape, "(frames, rows, columns)")
    frames, rows, columns = shape if len(shape) == 3 else (1, *shape)
    return FrameFile(path, "npy", frames, rows, columns, dtype, None)


def _envi(path: Path) -> FrameFile:
    layout = read_layout(path)
    info = info_of(layout)
    size = layout.bands, layout.rows, layout.columns
    return FrameFile(layout.data, "envi", *size, layout.value_dtype, info.unit)


def _tiff(path: Path) -> FrameFile:
    unit = read_info(path).unit
    with stored_bytes(path) as content:
        frames, first = 0, None
        for layout in _pages(content, path):
            frames += 1
            first = layout if first is None else first
            if _shape(layout) != _shape(first):
                raise FileError(
                    f"{path}: the frames differ: page {frames} has {_words(layout)}, but the first "
                    f"page has {_words(first)}; allowed: frames of the same size and type"
                )
    if first is None:
        raise FileError(f"{path}: contains no picture")
    return FrameFile(
        path, "tiff", frames, first.rows, first.columns, np.dtype(first.numpy_kind), unit
    )


def _pages(content: StoredBytes, path: Path) -> Iterator[TiffLayout]:
    """How each page is cut into strips, once it is known to be a plain picture of one channel."""
    for number, layout in enumerate(tiff_layouts(content, path), start=1):
        if layout.channels != 1 or not layout.is_plain:
            raise FileError(
                f"{path}: page {number} has channels = {layout.channels}, compression = "
                f"{layout.compression}; allowed: one channel of plain numbers, uncompressed or "
                "deflate"
            )
        yield layout


def _shape(layout: TiffLayout) -> tuple[object, ...]:
    return layout.rows, layout.columns, layout.numpy_kind


def _words(layout: TiffLayout) -> str:
    kind = np.dtype(layout.numpy_kind).name
    return f"{layout.rows} × {layout.columns} samples of {kind}"


def check_one_camera(files: Sequence[FrameFile], *, of_one: str) -> None:
    """Refuse files of which no noise in time can be had, or of several cameras (`DataError`).

    `of_one` is said of a file with a single frame.
    """
    first = files[0]
    for file in files:
        if file.frames < 2:
            raise DataError(f"{file.path}: contains a single frame; {of_one} needs 2 or more")
        if (file.rows, file.columns) != (first.rows, first.columns):
            raise DataError(
                f"{file.path}: contains frames of {file.rows} × {file.columns} samples, but "
                f"{first.path} has {first.rows} × {first.columns}: give files from the same camera"
            )
