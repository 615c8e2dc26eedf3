"""Arrays without a picture format: ``.npy``, plain text matrices and curves as CSV."""

from __future__ import annotations

import io
import math
import os
import tokenize
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.atomic import atomic_file, write_text
from core.errors import DataError, FileError, several
from core.machine import Empty
from core.records import dataclass
from nodes.files import picture_info
from nodes.files.file_format import CSV
from nodes.files.stored_bytes import checked_band, first_bytes, readable_file, stored_bytes
from nodes.files.table_cells import csv_columns, line_refused

if TYPE_CHECKING:
    from core.chain.wires import CurveData

# numpy evaluates the header as a Python literal, and lets pass whatever that raises.
_HEADER_FAULTS = (
    OSError,
    ValueError,
    EOFError,
    SyntaxError,
    TypeError,
    OverflowError,
    FloatingPointError,  # of numpy's own products of sizes, where a run lets none overflow
    RecursionError,
    tokenize.TokenError,
)
_NPY_MAGIC = b"\x93NUMPY"
_BLOCK_SAMPLES = 1 << 18  # read at a time, so that they stay in a core's cache
_LONGEST_HEADER = 1 << 16
_VERSIONS: Mapping[tuple[int, int], Callable[..., Any]] = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def is_npy(path: Path) -> bool:
    return first_bytes(path, len(_NPY_MAGIC)) == _NPY_MAGIC


def read_npy_info(path: Path) -> picture_info.PictureInfo:
    header = npy_header(path)
    return _info(path, header.shape, header.dtype, "npy")


def read_npy(path: Path, band: int = 0, *, empty: Empty = np.empty) -> picture_info.Samples:
    header = npy_header(path)
    info = _info(path, header.shape, header.dtype, "npy")
    if empty is np.empty:
        picture_info.refuse_oversized(info)
    band = checked_band(band, info.bands, path)
    read = empty(header.shape[:2], picture_info.delivered_dtype(header.dtype))
    fill_plane(read, path, header, axis=2, index=band)
    return read


def write_npy(path: str | os.PathLike[str], array: ArrayLike) -> None:
    """Write a real array: float32 as it is, every other type as float64; C order."""
    samples = _real(array)
    # ascontiguousarray would make a single number 1-D.
    samples = np.asarray(samples, order="C")
    with atomic_file(path) as temporary, temporary.open("wb") as file:
        write_npy_header(file, samples.shape, samples.dtype)
        # Not by numpy's own writer, whose error does not say why the system refused.
        file.write(samples.data)


def write_npy_header(file: BinaryIO, shape: tuple[int, ...], dtype: np.dtype[Any]) -> None:
    descr = np.lib.format.dtype_to_descr(dtype)
    fields = {"descr": descr, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, fields)


def write_npy_picture(
    path: Path, stored: NDArray[Any], metadata: Mapping[str, picture_info.MetadataValue]
) -> None:
    """Write samples (rows, columns, channels), one channel as (rows, columns), without metadata."""
    write_npy(path, stored[:, :, 0] if stored.shape[2] == 1 else stored)


def read_matrix_info(path: Path) -> picture_info.PictureInfo:
    """Read the size of a text matrix, for which all of it must be read."""
    matrix = read_matrix(path)
    return _info(path, matrix.shape, matrix.dtype, "text")


def read_matrix(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """Read numbers parted by blanks or commas; lines that begin with ``#`` are comments."""
    file = readable_file(path)
    try:
        picture_info.refuse_oversized_text(file)
        text = file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(f"{file}: not a text file with numbers") from error
    except OSError as error:
        raise FileError(f"{file}: {error.strerror or error}") from error
    lines = [line.strip() for line in text.splitlines()]
    rows = [line for line in lines if line and not line.startswith("#")]
    if not rows:
        raise FileError(f"{file}: contains no numbers")
    separator = "," if "," in rows[0] else None
    try:
        return np.loadtxt(rows, dtype=np.float64, delimiter=separator, ndmin=2)
    except ValueError:  # which quotes the file
        raise _faulty_line(lines, separator, file) from None


def _faulty_line(lines: list[str], separator: str | None, path: Path) -> FileError:
    columns = 0
    for number, line in enumerate(lines, 1):
        cells = line.partition("#")[0].split(separator)
        try:
            [float(cell) for cell in cells]
        except ValueError:
            if line and not line.startswith("#"):
                return FileError(f"{path}: not a matrix of numbers; line {number} contains text")
            continue
        columns = columns or len(cells)
        if cells and len(cells) != columns:
            allowed = f"{columns} numbers, as in the first row, not {len(cells)}"
            return line_refused(path, number, allowed)
    return FileError(f"{path}: not a matrix of numbers")


def read_matrix_band(path: Path, band: int = 0, *, empty: Empty = np.empty) -> picture_info.Samples:
    matrix = read_matrix(path)
    checked_band(band, 1, path)
    return matrix


def write_matrix(path: str | os.PathLike[str], array: ArrayLike) -> None:
    """Write a matrix, or a single row, as plain numbers, which MathCad's READPRN reads.

    Each is the shortest text that reads back to the same bits, parted by commas in ``.csv``, else
    by blanks. `DataError` where the array is not real, not 2-D, empty or not finite.
    """
    samples = np.atleast_2d(_real(array))
    if samples.ndim != 2 or samples.size == 0:
        raise DataError(f"an array of shape {samples.shape} is not a matrix of (rows, columns)")
    wrong = ~np.isfinite(samples)
    if wrong.any():
        place = tuple(int(index) for index in np.argwhere(wrong)[0])
        raise DataError(
            f"the matrix has {several(int(wrong.sum()), 'non-finite sample')}, the first at {place}"
        )
    separator = "," if CSV.matches(Path(os.fspath(path))) else " "
    lines = io.StringIO()
    for row in samples:
        lines.write(separator.join(_numbers(row)) + "\n")
    write_text(path, lines.getvalue())


def write_curves(
    path: str | os.PathLike[str], curves: CurveData, columns: Mapping[str, ArrayLike]
) -> None:
    """Write curves as CSV: a line of names, then a line for each sample of their `columns` (n,).

    The first column is the axis, or the names of bars. Each number reads back to the same bits.
    """
    names, values = list(columns), [_numbers(_real(column)) for column in columns.values()]
    if curves.bars and names:
        names[0], values[0] = curves.x_label or "name", list(curves.bars)
    write_text(path, csv_columns(zip(names, values, strict=True)))


@dataclass(frozen=True)
class NpyHeader:
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    fortran_order: bool
    offset_bytes: int


def npy_header(path: Path) -> NpyHeader:
    with stored_bytes(path) as content:
        if content[: len(_NPY_MAGIC)] != _NPY_MAGIC:
            raise FileError(f"{path}: not a .npy file; it must begin with \\x93NUMPY")
        start = io.BytesIO(content[:_LONGEST_HEADER])
        length = len(content)
    try:
        read = _VERSIONS.get(np.lib.format.read_magic(start))
        if read is None:
            raise ValueError("its version is unknown")
        shape, fortran_order, dtype = read(start)
    except _HEADER_FAULTS as error:
        raise FileError(f"{path}: damaged or truncated: its header cannot be read") from error
    if dtype.hasobject:
        raise FileError(f"{path}: contains Python objects; allowed: an array of numbers")
    needed = start.tell() + math.prod(shape) * dtype.itemsize
    if min(shape, default=0) < 0 or needed > length:
        raise FileError(
            f"{path}: damaged or truncated: {length} bytes cannot hold an array of shape {shape}"
        )
    return NpyHeader(shape, dtype, fortran_order, start.tell())


def fill_plane(
    plane: NDArray[Any], path: Path, header: NpyHeader, *, axis: Literal[0, 2], index: int
) -> None:
    """Fill (rows, columns) from an index of an array's first or last axis; of two, with all."""
    shape = header.shape
    if header.fortran_order:  # in C order the axes are the other way round
        shape, plane, axis = shape[::-1], plane.T, 0 if axis else 2
    lines, wide, every = (*shape, 1)[:3]
    first, part = 0, 0
    if len(shape) == 3 and axis == 0:
        (_, lines, wide), every = shape, 1
        first = index * lines * wide
    elif len(shape) == 3:
        part = index
    line = wide * every
    if reason := picture_info.oversized(1, line, header.dtype):
        raise FileError(f"{path}: a single row is too large: {reason}")
    step = max(1, _BLOCK_SAMPLES // max(1, line))
    as_stored = every == 1 and plane.dtype == header.dtype and plane.flags.c_contiguous
    block = np.empty((min(step, lines), line), header.dtype)
    with stored_bytes(path) as content:
        for top in range(0, lines, step):
            rows = plane[top : top + step] if as_stored else block[: min(step, lines - top)]
            content.fill(rows, header.offset_bytes + (first + top * line) * header.dtype.itemsize)
            if not as_stored:
                plane[top : top + step] = rows[:, part::every]


def whole_npy(path: Path) -> NDArray[Any]:
    header = npy_header(path)
    shape = header.shape[::-1] if header.fortran_order else header.shape
    array = np.empty(shape, header.dtype)
    with stored_bytes(path) as content:
        content.fill(array, header.offset_bytes)
    return array.T if header.fortran_order else array


def _info(
    path: Path, shape: tuple[int, ...], dtype: np.dtype[Any], kind: str
) -> picture_info.PictureInfo:
    picture_info.refuse_unreal(path, dtype)
    picture_info.refuse_shape(path, shape)
    return picture_info.PictureInfo(
        path=path,
        rows=shape[0],
        columns=shape[1],
        bands=shape[2] if len(shape) == 3 else 1,
        dtype=dtype.newbyteorder("=").name,
        kind=kind,
    )


def _real(array: ArrayLike) -> NDArray[Any]:
    samples = np.asarray(array)
    if samples.dtype.kind not in "buif":
        raise DataError(f"samples of type {samples.dtype} cannot be written; allowed: real numbers")
    wanted = np.float32 if samples.dtype == np.float32 else np.float64
    return samples.astype(wanted, copy=False)


def _numbers(row: NDArray[Any]) -> list[str]:
    """Shortest texts that give back the same bits in the row's own precision."""
    if row.dtype == np.float32:
        return [str(text) for text in row.astype(str)]
    return [repr(value) for value in row.tolist()]
