"""Writing files of frames, and reading them, one frame at a time, in the memory of one.

A TIFF is not compressed, classic or big. Every page, and every tile, takes the same number of
bytes, so a directory names what follows before that is written. Sources: Adobe, TIFF Revision 6.0
(1992), sections 2, 8, 15 and 19; libtiff, BigTIFF design (2007).
"""

import contextlib
import io
import os
import shutil
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError, FileError
from core.records import dataclass, field
from nodes.files import picture_info
from nodes.files.arrays import fill_plane, is_npy, npy_header, write_npy_header
from nodes.files.envi import band_of, info_of
from nodes.files.envi_header import HEADER_SUFFIX, REAL_TYPES, is_envi, read_layout
from nodes.files.file_format import ENVI_FRAMES, ZARR, Format, suffixes
from nodes.files.formats import NPY, TIFF, check_finite, read_info
from nodes.files.stored_bytes import StoredBytes, readable_file, stored_bytes
from nodes.files.tiff_reading import TiffLayout, channel_of, directories, tiff_layouts

Array = NDArray[Any]
_Entry = tuple[int, int, int, int]  # of a TIFF's directory: tag, type, count, value or place

_BLOCK_SAMPLES = 1 << 24  # written at a time
_CLASSIC_END = 1 << 32  # classic TIFF addresses bytes by 32 bits
_ASCII, _SHORT, _LONG, _LONG8 = 2, 3, 4, 16
_SAMPLE_FORMATS = {"u": 1, "i": 2, "f": 3}
_PAGE_OF_SEVERAL = 2
_LEAST_TEXT = 9  # a shorter one would stand in its directory's entry
_LONGEST_PX = 512  # rows and columns of a tile; multiples of 16, as the format has it
_STEP_PX = 16


@dataclass(frozen=True)
class FrameSeries:
    """Frames of one size and type.

    `metadata` are texts and numbers of all frames, as `write_picture` takes them; a tuple is a list
    with a number for each frame. `what` they are: bands of wavelength are written as frames are.
    """

    frames: int
    rows: int
    columns: int
    dtype: np.dtype[Any]
    metadata: Mapping[str, picture_info.MetadataValue | tuple[float, ...]] = field(
        default_factory=dict
    )
    what: str = "frames"

    @property
    def shape(self) -> tuple[int, int]:
        return self.rows, self.columns

    @property
    def frame_bytes(self) -> int:
        return self.rows * self.columns * self.dtype.itemsize

    @property
    def size_text(self) -> str:
        size = f"{self.rows} × {self.columns} samples"
        return size if self.frames == 1 else f"{self.frames} {self.what} of {size}"


class _Tiff:
    """Parts of a little-endian TIFF; a `big` one has places of 8 bytes."""

    def __init__(self, series: FrameSeries, *, big: bool) -> None:
        self.big, self.word = big, _LONG8 if big else _LONG
        text = b""
        if series.metadata:
            text = picture_info.metadata_text(series.metadata).encode().ljust(_LEAST_TEXT) + b"\0"
        even = text + b"\0" * (len(text) % 2)  # as directories begin
        before = 16 if big else 8
        first = before + len(even)
        head = (b"II", 43, 8, 0, first) if big else (b"II", 42, first)
        self.head = struct.pack("<2sHHHQ" if big else "<2sHI", *head) + even
        self._entries: list[_Entry] = [
            (256, _LONG, 1, series.columns),
            (257, _LONG, 1, series.rows),
            (258, _SHORT, 1, 8 * series.dtype.itemsize),
            (259, _SHORT, 1, 1),
            (262, _SHORT, 1, 1),
            *([(270, _ASCII, len(text), before)] if text else []),
            (277, _SHORT, 1, 1),
            (284, _SHORT, 1, 1),
            (339, _SHORT, 1, _SAMPLE_FORMATS[series.dtype.kind]),
        ]
        count = len(self._entries) + 4
        self.directory_bytes = 16 + 20 * count if big else 6 + 12 * count

    def directory(self, entries: Sequence[_Entry], following: int = 0) -> bytes:
        """A directory with four more entries, and the place of the one that follows."""
        every = sorted([*self._entries, *entries])
        # Little-endian, so a short value stands first in its field, zeros behind it.
        form, count, place = ("<HHQQ", "<Q", "<Q") if self.big else ("<HHII", "<H", "<I")
        packed = b"".join(struct.pack(form, *entry) for entry in every)
        return struct.pack(count, len(every)) + packed + struct.pack(place, following)


def _tiff(series: FrameSeries, big: bool | None, blocks: int, block_bytes: int) -> _Tiff:
    """A TIFF that is big, if not given, where classic TIFF could not address all of it."""
    classic = _Tiff(series, big=False)
    end = len(classic.head) + blocks * (classic.directory_bytes + block_bytes)
    return _Tiff(series, big=True) if (end >= _CLASSIC_END if big is None else big) else classic


def tiff_head(series: FrameSeries, *, big: bool | None = None) -> bytes:
    return _tiff(series, big, series.frames, series.frame_bytes).head


def tiff_page(series: FrameSeries, number: int, *, big: bool | None = None) -> bytes:
    """The directory before the samples of a page, counted from 0; that of the next one named."""
    tiff = _tiff(series, big, series.frames, series.frame_bytes)
    page = tiff.directory_bytes + series.frame_bytes
    start = len(tiff.head) + number * page
    entries = [
        (254, _LONG, 1, _PAGE_OF_SEVERAL),
        (273, tiff.word, 1, start + tiff.directory_bytes),
        (278, _LONG, 1, series.rows),
        (279, tiff.word, 1, series.frame_bytes),
    ]
    return tiff.directory(entries, start + page if number + 1 < series.frames else 0)


def tiled_head(series: FrameSeries, side: int, *, big: bool | None = None) -> bytes:
    """What stands before the first tile: header, description, directory, and the tiles' places."""
    count = -(-series.rows // side) * -(-series.columns // side)
    tile_bytes = side * side * series.dtype.itemsize
    tiff = _tiff(series, big, 1, count * (8 + tile_bytes))
    letter = "Q" if tiff.big else "I"
    lists = len(tiff.head) + tiff.directory_bytes
    list_bytes = count * struct.calcsize(letter)
    start = lists + (2 * list_bytes if count > 1 else 0)
    places = struct.pack(f"<{count}{letter}", *range(start, start + count * tile_bytes, tile_bytes))
    sizes = struct.pack(f"<{count}{letter}", *[tile_bytes] * count)
    entries = [
        (322, _LONG, 1, side),
        (323, _LONG, 1, side),
        # A single place stands in the entry itself.
        (324, tiff.word, count, lists if count > 1 else start),
        (325, tiff.word, count, lists + list_bytes if count > 1 else tile_bytes),
    ]
    return tiff.head + tiff.directory(entries) + (places + sizes if count > 1 else b"")


def envi_header_text(series: FrameSeries) -> str:
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


def header_beside_frames(path: Path) -> Path:
    return path.with_name(path.name + HEADER_SUFFIX)


def _nothing(_series: FrameSeries, _number: int = 0) -> bytes:
    return b""


def _npy_head(series: FrameSeries) -> bytes:
    head = io.BytesIO()
    write_npy_header(head, (series.frames, *series.shape), series.dtype)
    return head.getvalue()


@dataclass(frozen=True)
class FrameFormat(Format):
    head: Callable[[FrameSeries], bytes] = _nothing  # bytes before the first frame
    page: Callable[[FrameSeries, int], bytes] = _nothing  # before each, as many for all of them
    whole_numbers: bool = True  # whether a converter's numbers are stored as integers
    # text of the file beside it, of that name and `HEADER_SUFFIX`
    beside: Callable[[FrameSeries], str] | None = None

    def size_bytes(self, series: FrameSeries) -> int:
        page = len(self.page(series, 0)) + series.frame_bytes
        return len(self.head(series)) + series.frames * page

    def stored_type(self, precision: np.dtype[Any], bits: int | None) -> np.dtype[Any]:
        """Integers of 16 or 32 bits for a converter's numbers, else floats of this precision."""
        if bits is None or not self.whole_numbers:
            return precision.newbyteorder("<")
        return np.dtype("<u2" if bits <= 16 else "<u4")


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
    with _written(path) as file:
        file.write(kind.head(series))
        for number, frame in enumerate(frames):
            file.write(kind.page(series, number))
            step = max(1, _BLOCK_SAMPLES // max(1, frame.shape[1]))
            for top in range(0, len(frame), step):
                rows = frame[top : top + step]
                file.write(np.ascontiguousarray(rows, series.dtype).data)
            if done is not None:
                done(number + 1)


def write_tiled_tiff(path: Path, series: FrameSeries, samples: Array) -> None:
    """Write a picture, perhaps on disk, as a page of tiles, filled up with zeros at its ends."""
    rows, columns = samples.shape
    side = min(_LONGEST_PX, -(-max(samples.shape) // _STEP_PX) * _STEP_PX)
    with _written(path) as file:
        file.write(tiled_head(series, side))
        for top in range(0, rows, side):
            for left in range(0, columns, side):
                part = samples[top : top + side, left : left + side]
                tile = np.zeros((side, side), series.dtype)
                tile[: part.shape[0], : part.shape[1]] = part
                file.write(tile.data)


@contextlib.contextmanager
def _written(path: Path) -> Iterator[BinaryIO]:
    """A file that is on the disk in the end, where a full one shows at the latest."""
    try:
        # Not mapped into memory: a disk that is full then ends the process (SIGBUS).
        with path.open("wb") as file:
            yield file
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
                f"cannot write {path}: {series.size_text} take {_amount(size)}, but only "
                f"{_amount(free)} of disk space is free"
            )
        left[device] = free - size


def _amount(size: int) -> str:
    for unit, bytes_of in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= bytes_of:
            return f"{size / bytes_of:.3g} {unit}"
    return f"{size} bytes"


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

    def each(self) -> Iterator[picture_info.Samples]:
        """The frames in turn, in the precision of `delivered_dtype`, all finite."""
        read = {"npy": self._of_npy, "tiff": self._of_tiff, "envi": self._of_envi}[self.kind]
        for number, samples in enumerate(read()):
            check_finite(samples, f"{self.path}, frame {number}")
            yield samples

    def _of_npy(self) -> Iterator[picture_info.Samples]:
        header = npy_header(self.path)
        for number in range(self.frames):
            frame = np.empty((self.rows, self.columns), picture_info.delivered_dtype(header.dtype))
            fill_plane(frame, self.path, header, axis=0, index=number)
            yield frame

    def _of_envi(self) -> Iterator[picture_info.Samples]:
        layout = read_layout(self.path)
        for number in range(self.frames):
            yield band_of(layout, number)

    def _of_tiff(self) -> Iterator[picture_info.Samples]:
        with stored_bytes(self.path) as content:
            for layout in _pages(content, self.path):
                yield channel_of(content, layout, self.path)


def open_frames(path: Path) -> FrameFile:
    file = readable_file(path)
    if NPY.matches(file) or is_npy(file):
        found = _open_npy(file)
    elif TIFF.matches(file):
        found = _open_tiff(file)
    elif is_envi(file):
        found = _open_envi(file)
    else:
        raise FileError(f"{path}: frames cannot be read from this file; allowed: {_READ}")
    if reason := picture_info.oversized(
        found.rows, found.columns, picture_info.delivered_dtype(found.dtype)
    ):
        raise FileError(f"{path}: {reason}")
    return found


def tiff_pages(path: Path) -> int:
    file = readable_file(path)
    with stored_bytes(file) as content:
        return sum(1 for _ in directories(content, file))


def _open_npy(path: Path) -> FrameFile:
    header = npy_header(path)
    shape, dtype = header.shape, header.dtype
    picture_info.refuse_unreal(path, dtype)
    picture_info.refuse_shape(path, shape, "(frames, rows, columns)")
    frames, rows, columns = shape if len(shape) == 3 else (1, *shape)
    return FrameFile(path, "npy", frames, rows, columns, dtype, None)


def _open_envi(path: Path) -> FrameFile:
    layout = read_layout(path)
    info = info_of(layout)
    size = layout.bands, layout.rows, layout.columns
    return FrameFile(layout.data, "envi", *size, layout.value_dtype, info.unit)


def _open_tiff(path: Path) -> FrameFile:
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
    """Refuse single frames, of which `of_one` is said, and several cameras (`DataError`)."""
    first = files[0]
    for file in files:
        if file.frames < 2:
            raise DataError(f"{file.path}: contains a single frame; {of_one} needs 2 or more")
        if (file.rows, file.columns) != (first.rows, first.columns):
            raise DataError(
                f"{file.path}: contains frames of {file.rows} × {file.columns} samples, but "
                f"{first.path} has {first.rows} × {first.columns}: give files from the same camera"
            )
