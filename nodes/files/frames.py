"""Writing files of frames, and reading them, one frame at a time, in the memory of one."""

import contextlib
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from core.arrays import Array
from core.atomic import atomic_file, write_text
from core.errors import DataError, FileError
from core.records import dataclass, field
from nodes.files import picture_info
from nodes.files.arrays import fill_plane, is_npy, npy_header, write_npy_header
from nodes.files.envi import band_of, info_of
from nodes.files.envi_header import HEADER_SUFFIX, REAL_TYPES, is_envi, read_layout
from nodes.files.file_format import ENVI_FRAMES, ZARR, Format
from nodes.files.formats import NPY, TIFF, check_finite, read_info
from nodes.files.stored_bytes import StoredBytes, readable_file, stored_bytes
from nodes.files.tiff_reading import TiffLayout, channel_of, directories, tiff_layouts

_BLOCK_SAMPLES = 1 << 24  # written at a time
_CLASSIC_BYTES = (1 << 32) - (1 << 25)  # classic TIFF addresses 4 GiB, directories included
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
    def size_bytes(self) -> int:
        """Of all samples; what stands before them is small."""
        return self.frames * self.rows * self.columns * self.dtype.itemsize

    @property
    def size_text(self) -> str:
        size = f"{self.rows} × {self.columns} samples"
        return size if self.frames == 1 else f"{self.frames} {self.what} of {size}"


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


def _write_samples(file: BinaryIO, series: FrameSeries, frames: Iterable[Array]) -> None:
    for frame in frames:
        step = max(1, _BLOCK_SAMPLES // max(1, frame.shape[1]))
        for top in range(0, len(frame), step):
            file.write(np.ascontiguousarray(frame[top : top + step], series.dtype).data)


def _write_npy(file: BinaryIO, series: FrameSeries, frames: Iterable[Array]) -> None:
    write_npy_header(file, (series.frames, *series.shape), series.dtype)
    _write_samples(file, series, frames)


def _write_tiff(
    file: BinaryIO, series: FrameSeries, frames: Iterable[Any], size_bytes: int = 0, **layout: Any
) -> None:
    """A page for each of the frames, whose samples may come as tiles by a `layout`."""
    # Imported when needed: 70 ms that a run without such files need not pay.
    from tifffile import TiffWriter

    text = picture_info.metadata_text(series.metadata).encode() if series.metadata else None
    how: dict[str, Any] = {"photometric": "minisblack", "description": text, **layout}
    with TiffWriter(
        file, bigtiff=max(size_bytes, series.size_bytes) > _CLASSIC_BYTES, byteorder="<"
    ) as tiff:
        for frame in frames:
            samples = frame if layout else np.ascontiguousarray(frame, series.dtype)
            tiff.write(samples, metadata=None, software=False, **how)


FRAME_FORMATS = (NPY, Format(TIFF.name, TIFF.suffixes, "multi-page TIFF"), ENVI_FRAMES)
_WRITERS = dict(zip(FRAME_FORMATS, (_write_npy, _write_tiff, _write_samples), strict=True))


def holds_frames(path: Path) -> bool:
    return any(kind.matches(path) for kind in FRAME_FORMATS)


def stored_type(path: Path, precision: np.dtype[Any], bits: int | None) -> np.dtype[Any]:
    """Integers of 16 or 32 bits for a converter's numbers, else floats of this precision.

    Floats in .npy files, too, as those of pictures are: whole numbers of 16 bits would wrap round
    where two frames are subtracted; and in stores.
    """
    if bits is None or NPY.matches(path) or ZARR.matches(path):
        return precision.newbyteorder("<")
    return np.dtype("<u2" if bits <= 16 else "<u4")


def write_frames(
    path: Path,
    series: FrameSeries,
    frames: Iterable[Array],
    done: Callable[[int], None] | None = None,
) -> None:
    """Write frames in the format of the suffix, one of `FRAME_FORMATS`."""
    write = next(write for kind, write in _WRITERS.items() if kind.matches(path))

    def counted() -> Iterator[Array]:
        for number, frame in enumerate(frames, 1):
            yield frame
            if done is not None:
                done(number)

    with _written(path) as file:
        write(file, series, counted())


def write_envi(path: Path, series: FrameSeries, bands: Iterable[Array]) -> None:
    """Write an ENVI file, with its header beside it."""
    with atomic_file(path) as temporary, temporary.open("wb") as file:
        _write_samples(file, series, bands)
    write_text(header_beside_frames(path), envi_header_text(series))


def write_tiled_tiff(path: Path, series: FrameSeries, samples: Array) -> None:
    """Write a picture, perhaps on disk, as a page of tiles, filled up with zeros at its ends."""
    rows, columns = samples.shape
    tall, wide = (min(_LONGEST_PX, -(-side // _STEP_PX) * _STEP_PX) for side in samples.shape)
    tiles = (
        np.ascontiguousarray(samples[top : top + tall, left : left + wide], series.dtype)
        for top in range(0, rows, tall)
        for left in range(0, columns, wide)
    )
    layout = {"tile": (tall, wide), "shape": series.shape, "dtype": series.dtype}
    filled = -(-rows // tall) * tall * -(-columns // wide) * wide * series.dtype.itemsize
    with _written(path) as file:
        _write_tiff(file, series, [tiles], size_bytes=filled, **layout)


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
        # NumPy, which writes the samples, does not say why it could not.
        why = error.strerror or "the disk is full, or the file too large for it"
        raise FileError(f"cannot write {path}: {why}") from error


def refuse_without_room(files: Sequence[tuple[Path, FrameSeries]]) -> None:
    """Refuse files of frames for which a disk has no room, before anything is computed."""
    left: dict[int, int] = {}
    for path, series in files:
        folder = next((above for above in path.absolute().parents if above.exists()), None)
        if folder is None:
            continue
        try:
            device = folder.stat().st_dev
            free = left.setdefault(device, shutil.disk_usage(folder).free)
        except OSError as error:
            raise FileError(f"cannot write {path}: {error.strerror or error}") from error
        size = series.size_bytes
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
    frames: int
    rows: int
    columns: int
    dtype: np.dtype[Any]
    unit: str | None
    read: Callable[[], Iterable[picture_info.Samples]] = field(compare=False)

    def each(self) -> Iterator[picture_info.Samples]:
        """The frames in turn, in the precision of `delivered_dtype`, all finite."""
        for number, samples in enumerate(self.read()):
            check_finite(samples, f"{self.path}, frame {number}")
            yield samples


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

    def read() -> Iterator[picture_info.Samples]:
        for number in range(frames):
            frame = np.empty((rows, columns), picture_info.delivered_dtype(dtype))
            fill_plane(frame, path, header, axis=0, index=number)
            yield frame

    return FrameFile(path, frames, rows, columns, dtype, None, read)


def _open_envi(path: Path) -> FrameFile:
    layout = read_layout(path)
    info = info_of(layout)
    size = layout.bands, layout.rows, layout.columns

    def read() -> Iterator[picture_info.Samples]:
        return (band_of(layout, number) for number in range(layout.bands))

    return FrameFile(layout.data, *size, layout.value_dtype, info.unit, read)


def _open_tiff(path: Path) -> FrameFile:
    unit = read_info(path).unit
    with stored_bytes(path) as content:
        frames, first = 0, None
        for layout in _pages(content, path):
            frames += 1
            first = layout if first is None else first
            if _words(layout) != _words(first):
                raise FileError(
                    f"{path}: the frames differ: page {frames} has {_words(layout)}, but the first "
                    f"page has {_words(first)}; allowed: frames of the same size and type"
                )
    if first is None:
        raise FileError(f"{path}: contains no picture")

    def read() -> Iterator[picture_info.Samples]:
        with stored_bytes(path) as content:
            for layout in _pages(content, path):
                yield channel_of(content, layout, path)

    dtype = np.dtype(first.dtype).newbyteorder("=")
    return FrameFile(path, frames, first.rows, first.columns, dtype, unit, read)


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


def _words(layout: TiffLayout) -> str:
    return f"{layout.rows} × {layout.columns} samples of {np.dtype(layout.dtype).name}"


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
