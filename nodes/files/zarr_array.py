"""Zarr arrays, versions 2 and 3, as pictures, read and written in the memory of a few chunks.

Rows and columns are found by the names of the dimensions where the store gives them, else they are
the first two; a third is that of bands. Samples equal to ``_FillValue`` or ``missing_value``, and
those of a chunk whose file is not there, are NaN; but a store of our own that lacks a file is
damaged. ``scale_factor`` and ``add_offset`` are not applied.
Source: Zarr core specification, version 3.1 (2025); CF Metadata Conventions 1.11, section 2.5.
"""

import contextlib
import importlib.util
import itertools
import math
import os
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.arrays import Array
from core.atomic import flush, sweep, temporary_folder
from core.errors import FileError, how_to_install
from core.machine import Empty
from core.records import dataclass
from nodes.files import picture_info
from nodes.files.picture_info import oversized_file
from nodes.files.stored_bytes import checked_band, first_bytes, readable_file

_ALLOWED = "allowed: a new name, or an existing store to replace"
_MARKS = ("zarr.json", ".zarray", ".zgroup")  # version 3, arrays and groups of version 2
_METADATA = (*_MARKS, ".zattrs", ".zmetadata")


def is_store(path: Path) -> bool:
    try:
        return any((path / mark).is_file() for mark in _MARKS)
    except OSError:  # a name that the system does not take
        return False


def readable_picture(path: str | os.PathLike[str]) -> Path:
    folder = Path(path)
    if not is_store(folder):
        return readable_file(path)
    if not os.access(folder, os.R_OK | os.X_OK):
        raise FileError(f"{path}: no permission to read this folder")
    return folder


def store_state(folder: Path) -> tuple[int, int]:
    """Bytes of all files of a store, and when the last of them or its folders was changed, ns."""
    states = list(_states(folder))
    return sum(one.st_size for _, one in states), max(one.st_mtime_ns for _, one in states)


def count_chunks(folder: Path) -> int:
    return sum(
        stat.S_ISREG(status.st_mode) and path.rpartition(os.sep)[2] not in _METADATA
        for path, status in _states(folder)
    )


@contextlib.contextmanager
def atomic_store(path: Path) -> Iterator[Path]:
    """Give the name of a folder, not there yet, that takes the place of `path` at the end.

    Whatever happens, `path` is whole; what a killed process has left in the folder above is
    removed.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not is_store(target):
        raise FileError(f"cannot write {path}: it exists and is not a Zarr store; {_ALLOWED}")
    if not target.parent.is_dir():
        raise FileError(f"cannot write {path}: there is no folder {path.parent}")
    sweep(target.parent)
    try:
        with temporary_folder(target.parent) as place:
            yield place / "new"
            _exchange(target, place)
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error


def _exchange(target: Path, place: Path) -> None:
    before = place / "old"
    if target.exists():
        target.replace(before)
    try:
        (place / "new").replace(target)
    except OSError:
        if before.exists():
            before.replace(target)
        raise


def _states(folder: Path) -> Iterator[tuple[str, os.stat_result]]:
    """Folders and files by path; a pipe or a device, which could be read for ever, is refused."""
    waiting = [os.fspath(folder)]
    try:
        while waiting:
            current = waiting.pop()
            yield current, Path(current).stat()
            with os.scandir(current) as entries:
                for entry in entries:
                    if entry.is_dir(follow_symlinks=False):
                        waiting.append(entry.path)
                        continue
                    status = entry.stat()
                    if not stat.S_ISREG(status.st_mode):
                        raise FileError(
                            f"{entry.path}: not a regular file; a store contains only files "
                            "and folders"
                        )
                    if too_long := oversized_file(status.st_size):
                        raise FileError(f"{entry.path}: {too_long}")
                    yield entry.path, status
    except OSError as error:
        raise FileError(f"{folder}: {error.strerror or error}") from error


_ROWS = ("y", "row", "rows", "line", "lines", "lat", "latitude", "northing", "along_track")
_COLUMNS = (
    "x", "column", "columns", "col", "sample", "samples", "lon", "longitude", "easting",
    "across_track",
)  # fmt: skip
_V2_NAMES = "_ARRAY_DIMENSIONS"  # as xarray has it
_MISSING = ("_FillValue", "missing_value")
_WHOLE = "every_chunk_written"  # an attribute of our own stores
_SCALING = (("scale_factor", 1.0), ("add_offset", 0.0))
_READ_SAMPLES = 1 << 22  # at a time, at least one chunk
_OTHERS_S = 5.0  # for the chunks that are being read beside one that failed
_CHUNK = 1024  # rows and columns of a chunk that is written


@dataclass(frozen=True)
class _Opened:
    """An array with what is known of it, its dimensions in the order (rows, columns[, bands])."""

    folder: Path
    array: Any
    attributes: Mapping[str, Any]
    axes: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(int(self.array.shape[axis]) for axis in self.axes)

    @property
    def chunks(self) -> tuple[int, ...]:
        return tuple(int(self.array.chunks[axis]) for axis in self.axes)

    @property
    def stored(self) -> tuple[int, ...]:
        """Sizes of what a file holds, in the array's own order: a chunk, or a shard of chunks."""
        return tuple(map(int, self.array.shards or self.array.chunks))

    @property
    def absent(self) -> int:
        grid = zip(map(int, self.array.shape), self.stored, strict=True)
        return max(0, math.prod(-(-size // of) for size, of in grid) - count_chunks(self.folder))

    def files(
        self, rows: slice, columns: slice, band: int
    ) -> Iterator[tuple[str, tuple[slice, slice]]]:
        """Names of the files that hold these samples, and the rows and columns of each."""
        part = [slice(band, band + 1)] * len(self.axes)
        part[self.axes[0]], part[self.axes[1]] = rows, columns
        sizes = self.stored
        along = (
            range(one.start // size, -(-one.stop // size))
            for one, size in zip(part, sizes, strict=True)
        )
        for place in itertools.product(*along):
            first = [index * size for index, size in zip(place, sizes, strict=True)]
            down, across = (
                slice(max(first[axis], part[axis].start), first[axis] + sizes[axis])
                for axis in self.axes[:2]
            )
            yield self.array.metadata.encode_chunk_key(place), (down, across)

    def part(self, rows: slice, columns: slice, band: int) -> Array:
        place: list[Any] = [band] * len(self.axes)
        place[self.axes[0]], place[self.axes[1]] = rows, columns
        samples = np.asarray(self.array[tuple(place)])
        return samples.T if self.axes[0] > self.axes[1] else samples


def read_info(path: Path) -> picture_info.PictureInfo:
    return _info(path, _opened(path))


def read_band(path: Path, band: int = 0, *, empty: Empty = np.empty) -> picture_info.Samples:
    opened = _opened(path)
    info = _info(path, opened)
    if empty is np.empty:
        picture_info.refuse_oversized(info)
    high, wide, *_ = opened.chunks
    dtype = picture_info.delivered_dtype(np.dtype(info.dtype))
    if reason := picture_info.oversized(min(high, info.rows), min(wide, info.columns), dtype):
        raise FileError(f"{path}: a single chunk is too large: {reason}")
    band = checked_band(band, info.bands, path)
    samples = empty((info.rows, info.columns), dtype)
    missing = _missing_value(opened.attributes)
    for rows, columns in _parts(info.rows, info.columns, (high, wide), _READ_SAMPLES):
        absent = list(_absent(opened, rows, columns, band))
        try:
            part = opened.part(rows, columns, band)
        except Exception as error:  # each packing has errors of its own
            _await_other_chunks()
            where = f"rows {rows.start} to {rows.stop}, columns {columns.start} to {columns.stop}"
            raise FileError(f"{path}: {where} cannot be read: {_line(error)}") from error
        samples[rows, columns] = part
        if missing is not None:
            samples[rows, columns][part == missing] = math.nan
        for place in absent:
            samples[place] = math.nan
    return samples


def _absent(
    opened: _Opened, rows: slice, columns: slice, band: int
) -> Iterator[tuple[slice, slice]]:
    """Rows and columns of the chunks whose files are not there; refuses damage seen without them.

    Blosc takes the length of what it unpacks from the chunk, and reads on in memory beyond one that
    was cut short. A shard of no bytes is taken for one that is not there.
    """
    packing = type(next(iter(opened.array.compressors[-1:]), None)).__name__
    is_blosc = opened.array.shards is None and packing.startswith("Blosc")
    for name, place in opened.files(rows, columns, band):
        file = opened.folder / name
        if not file.is_file():
            if opened.attributes.get(_WHOLE) is True:
                raise FileError(f"{opened.folder}: damaged: its chunk {name} is missing")
            yield place
            continue
        length = file.stat().st_size
        whole = int.from_bytes(first_bytes(file, 16)[12:], "little") if is_blosc else length
        if length != whole or not length:
            raise FileError(f"{opened.folder}: damaged: its chunk {name} is truncated")


def write_store(
    path: Path,
    samples: Array,
    metadata: Mapping[str, picture_info.MetadataValue],
    dtype: np.dtype[Any] | None = None,
) -> None:
    """Write a picture, perhaps on disk, as an unpacked Zarr array, which may replace a store."""
    zarr = _library(path)
    rows, columns = samples.shape
    chunk = min(rows, _CHUNK), min(columns, _CHUNK)
    with atomic_store(path) as folder:
        array = zarr.create_array(
            folder,
            shape=samples.shape,
            chunks=chunk,
            dtype=(dtype or samples.dtype).newbyteorder("<"),
            compressors=None,  # noise packs by a tenth, in many times the time
            attributes={
                _WHOLE: True,
                **{"units" if key == "unit" else key: it for key, it in metadata.items()},
            },
            dimension_names=("y", "x"),
            config={"write_empty_chunks": True},  # what is not there was not written
        )
        for part in _parts(rows, columns, chunk, 1):
            array[part] = samples[part]
        for file in filter(Path.is_file, folder.rglob("*")):
            flush(file, os.O_RDONLY)


def check_zarr(path: Path) -> None:
    if importlib.util.find_spec("zarr") is None:
        raise FileError(f"{path}: Zarr needs the package zarr: {how_to_install('zarr')}")


def _library(path: Path) -> Any:
    check_zarr(path)
    import zarr  # 1 s, which nobody else is to pay

    return zarr


def _opened(folder: Path) -> _Opened:
    zarr = _library(folder)
    store_state(folder)  # refuses what could be read for ever
    try:
        stored = zarr.open(folder, mode="r")
        group: Mapping[str, Any] = {}
        if isinstance(stored, zarr.Group):
            group, arrays = stored.attrs.asdict(), dict(stored.arrays())
            pictures = {name: one for name, one in arrays.items() if len(one.shape) in (2, 3)}
            if len(pictures) != 1:
                names = ", ".join(f"{folder.name}/{name}" for name in sorted(pictures)) or "none"
                raise FileError(
                    f"{folder}: a Zarr group; allowed: the path of one array in the group, with 2 "
                    f"or 3 dimensions ({names})"
                )
            (stored,) = pictures.values()
        attributes = {**group, **stored.attrs.asdict()}
        named = getattr(stored.metadata, "dimension_names", None) or attributes.get(_V2_NAMES)
        axes = _axes(folder, stored.shape, named)
        opened = _Opened(folder / stored.path, stored, attributes, axes)
        if min(*opened.chunks, *opened.stored) < 1:
            raise FileError(f"{folder}: damaged: chunk shape {opened.stored}; allowed: all above 0")
        return opened
    except FileError:
        raise
    except Exception as error:  # of a damaged store, or a packing that is not installed
        raise FileError(f"{folder}: cannot be read as a Zarr store: {_line(error)}") from error


def _axes(folder: Path, shape: tuple[int, ...], names: Any) -> tuple[int, ...]:
    picture_info.refuse_shape(folder, shape)
    words = [str(name).lower() for name in names] if isinstance(names, list | tuple) else []
    rows = [axis for axis, word in enumerate(words) if word in _ROWS]
    columns = [axis for axis, word in enumerate(words) if word in _COLUMNS]
    if len(words) != len(shape) or len(rows) != 1 or len(columns) != 1:
        return tuple(range(len(shape)))
    others = {*range(len(shape))} - {*rows, *columns}
    return (*rows, *columns, *others)


def _info(folder: Path, opened: _Opened) -> picture_info.PictureInfo:
    dtype = np.dtype(opened.array.dtype)
    picture_info.refuse_unreal(folder, dtype)
    attributes = opened.attributes
    fields = {
        key: value
        for key, value in attributes.items()
        if isinstance(value, str | int | float) and not isinstance(value, bool)
    }
    rows, columns, *bands = opened.shape
    return picture_info.PictureInfo(
        path=folder,
        rows=rows,
        columns=columns,
        bands=bands[0] if bands else 1,
        dtype=dtype.newbyteorder("=").name,
        kind="zarr",
        not_applied=tuple(
            key for key, neutral in _SCALING if attributes.get(key, neutral) != neutral
        ),
        absent_chunks=opened.absent,
        **picture_info.header_fields(fields, where=str(folder)),
    )


def _await_other_chunks() -> None:
    """Let the library end what it reads beside a chunk that failed, of which it would tell."""
    import asyncio

    from zarr.core.sync import sync

    async def end() -> None:
        if others := asyncio.all_tasks() - {asyncio.current_task()}:
            await asyncio.wait(others, timeout=_OTHERS_S)

    sync(end())


def _missing_value(attributes: Mapping[str, Any]) -> float | None:
    for key in _MISSING:
        value = attributes.get(key)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return value
    return None


def _parts(
    rows: int, columns: int, chunk: tuple[int, int], samples: int
) -> Iterator[tuple[slice, slice]]:
    wide = chunk[1] * max(1, min(-(-columns // chunk[1]), samples // (chunk[0] * chunk[1])))
    high = chunk[0] * max(1, samples // (chunk[0] * wide))
    for top in range(0, rows, high):
        for left in range(0, columns, wide):
            yield slice(top, min(top + high, rows)), slice(left, min(left + wide, columns))


def _line(error: BaseException) -> str:
    return next(iter(str(error).splitlines()), "") or type(error).__name__
