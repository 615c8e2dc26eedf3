"""The formats of picture files: suffixes, readers, writers and sample types.

A new one is a file with its `read_info`, `read_band` and, where it can be written, a writer, and a
line in `PICTURES`. Reading and writing, Write Image's choice of formats, the command line's
suffixes and help, and the dialogs of the editor follow.
"""

import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, FileError, ParameterError, several
from core.machine import Empty
from core.records import dataclass
from nodes.files import arrays, envi, envi_header, pictures, zarr_array
from nodes.files.file_format import BLANKS, CSV, ZARR, Format, suffixes
from nodes.files.picture_info import MetadataValue, PictureInfo, Samples
from nodes.files.zarr_array import is_store, readable_picture

DIGITAL_NUMBER = "DN"
"""Unit of a converter's numbers, which integer files hold as they are."""

SAMPLE_TYPES: Mapping[str, np.dtype[Any]] = MappingProxyType(
    {
        "half": np.dtype(np.float16),
        "float": np.dtype(np.float32),
        "double": np.dtype(np.float64),
        "uint8": np.dtype(np.uint8),
        "uint16": np.dtype(np.uint16),
    }
)
_BLOCK_ROWS = 256


def as_picture(array: ArrayLike) -> NDArray[Any]:
    """Real samples as (rows, columns, channels), not empty; else `DataError`."""
    samples = np.asarray(array)
    if samples.dtype.kind not in "buif":
        raise DataError(
            f"samples of type {samples.dtype} cannot be written as a picture; allowed: real numbers"
        )
    if samples.ndim == 2:
        samples = samples[:, :, None]
    if samples.ndim != 3 or samples.size == 0:
        raise DataError(
            f"an array of shape {np.shape(array)} cannot be written as a picture; "
            "allowed: (rows, columns) or (rows, columns, channels), not empty"
        )
    return samples


def as_stored(
    samples: NDArray[Any], dtype: str, low: float | None, high: float | None
) -> NDArray[Any]:
    """Samples (rows, columns, channels) in the type of that name in `SAMPLE_TYPES`, C order.

    For the integer types `low` and `high` become 0 and the largest integer (linear, nearest,
    clipped); without them the samples must be whole numbers within the range already.
    """
    kind = SAMPLE_TYPES[dtype]
    if kind.kind == "u":
        stored = np.empty(samples.shape, kind)
        for top in range(0, len(samples), _BLOCK_ROWS):  # as doubles they take four times as much
            stored[top : top + _BLOCK_ROWS] = _as_integers(
                samples[top : top + _BLOCK_ROWS], kind, low, high, top
            )
        return stored
    if low is not None or high is not None:
        raise ParameterError(
            "low, high",
            (low, high),
            f"leave low and high empty with dtype {dtype}; only uint8 and uint16 are scaled",
        )
    return _as_floats(samples, kind)


def integer_type(samples: NDArray[Any], unit: str, allowed: tuple[str, ...]) -> str | None:
    """The integer type that holds numbers of a converter as they are; None where none does."""
    if unit != DIGITAL_NUMBER or "uint16" not in allowed:
        return None
    top = np.iinfo(np.uint16).max
    for start in range(0, samples.shape[0], _BLOCK_ROWS):
        rows = samples[start : start + _BLOCK_ROWS]
        if rows.min() < 0 or rows.max() > top or (rows != np.rint(rows)).any():
            return None
    return "uint16"


def _as_floats(samples: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    if samples.dtype == dtype:
        return np.ascontiguousarray(samples)
    with np.errstate(over="ignore", invalid="ignore"):
        stored = np.ascontiguousarray(samples, dtype=dtype)
    largest = float(np.finfo(dtype).max)
    overflowed = np.isinf(stored) & np.isfinite(samples)
    if overflowed.any():
        row, column, _ = np.argwhere(overflowed)[0]
        raise DataError(
            f"the range of {dtype}, ±{largest:.6g}, is too small for "
            f"{several(int(overflowed.sum()), 'sample')}, the first at row {row}, column {column}"
        )
    return stored


def _as_integers(
    samples: NDArray[Any], dtype: np.dtype[Any], low: float | None, high: float | None, first: int
) -> NDArray[Any]:
    top = np.iinfo(dtype).max
    values = samples.astype(np.float64)
    if not np.isfinite(values).all():
        row, column, _ = np.argwhere(~np.isfinite(values))[0]
        raise DataError(
            f"the sample at row {first + row}, column {column} is not finite and cannot be stored "
            f"as {dtype}"
        )
    if low is None and high is None:
        wrong = (values != np.rint(values)) | (values < 0) | (values > top)
        if wrong.any():
            row, column, _ = np.argwhere(wrong)[0]
            raise DataError(
                f"sample {values[row, column].ravel()[0]:g} at row {first + row}, column {column} "
                f"does not fit {dtype} (whole numbers, 0 to {top}); give low and high to scale the "
                "samples"
            )
        return values.astype(dtype)
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high - low)):
        raise ParameterError("low, high", (low, high), "two finite numbers or none")
    if not high > low:
        raise ParameterError("high", high, f"above low = {low:g}")
    # Clipped first: a sample far outside the range could overflow in the division.
    values = (np.clip(values, low, high) - low) / (high - low)
    return np.rint(values * top).astype(dtype)


@dataclass(frozen=True)
class PictureFormat(Format):
    """A format of picture files.

    `read_band` reads one band, counted from 0, as the numbers that the file stores, into an array
    of the precision of `delivered_dtype` that `empty` makes. `write` takes samples (rows, columns,
    channels) of one of `dtypes`, of which the most precise integer is last.
    """

    read_info: Callable[[Path], PictureInfo]
    read_band: Callable[..., Samples]
    write: Callable[[Path, NDArray[Any], Mapping[str, MetadataValue]], None] | None = None
    dtypes: tuple[str, ...] = ()
    recognizes: Callable[[Path], bool] | None = None  # though the suffix is another
    plain: bool = False  # samples, and no picture that others would show

    @property
    def stores_floats(self) -> bool:
        return bool({"float", "double"} & set(self.dtypes))

    def claims(self, path: Path) -> bool:
        return self.matches(path) or (self.recognizes is not None and self.recognizes(path))


_OIIO = (pictures.read_info, pictures.read_band)
_ENVI_DATA = tuple(suffix for suffix in envi_header.DATA_SUFFIXES if suffix)
MATRICES = (CSV, BLANKS)
NPY = PictureFormat(
    "npy", (".npy",), ".npy", arrays.read_npy_info, arrays.read_npy, arrays.write_npy_picture,
    ("float", "double"), recognizes=arrays.is_npy, plain=True,
)  # fmt: skip
TIFF = PictureFormat(
    "tif", (".tif", ".tiff"), "TIFF", *_OIIO, pictures.write_by_oiio,
    ("float", "double", "uint8", "uint16"),
)  # fmt: skip
PNG = PictureFormat("png", (".png",), "PNG", *_OIIO, pictures.write_by_oiio, ("uint8", "uint16"))
# The first that claims a file reads it.
PICTURES: tuple[PictureFormat, ...] = (
    PictureFormat(
        ZARR.name, ZARR.suffixes, ZARR.description, zarr_array.read_info, zarr_array.read_band,
        recognizes=is_store,
    ),
    NPY,
    PictureFormat("exr", (".exr",), "EXR", *_OIIO, pictures.write_by_oiio, ("float", "half")),
    TIFF,
    PNG,
    PictureFormat("jpg", (".jpg", ".jpeg"), "JPEG", *_OIIO),
    PictureFormat("jp2", (".jp2",), "JPEG 2000", *_OIIO),
    PictureFormat("bmp", (".bmp",), "BMP", *_OIIO),
    PictureFormat("fits", (".fits", ".fit"), "FITS", *_OIIO),
    PictureFormat(
        "envi", _ENVI_DATA, "ENVI", envi.read_info, envi.read_band, recognizes=envi_header.is_envi
    ),
    PictureFormat("hdr", (".hdr",), "HDR", *_OIIO),
    PictureFormat(
        "text", suffixes(*MATRICES), "plain text", arrays.read_matrix_info,
        arrays.read_matrix_band,
    ),
    PictureFormat("other", (), "others by content", *_OIIO, recognizes=lambda _: True),
)  # fmt: skip
# Those that can be written, pictures before plain samples.
WRITTEN = tuple(sorted((one for one in PICTURES if one.write), key=lambda one: one.plain))
SAVED: tuple[Format, ...] = (*WRITTEN, CSV)


def readable_formats() -> str:
    *names, last = (picture_format.description for picture_format in PICTURES)
    return f"{', '.join(names)} and {last}"


def format_of(path: Path) -> PictureFormat:
    return next(picture_format for picture_format in PICTURES if picture_format.claims(path))


def written_format(path: Path) -> PictureFormat | None:
    return next((one for one in WRITTEN if one.matches(path)), None)


def write_picture(
    path: str | os.PathLike[str],
    array: ArrayLike,
    *,
    dtype: str = "float",
    low: float | None = None,
    high: float | None = None,
    metadata: Mapping[str, MetadataValue] | None = None,
) -> None:
    """Write a picture (rows, columns[, channels]) atomically; the same samples give the same bytes.

    Floats read back bit for bit. For `uint8` and `uint16`, `low` and `high` become 0 and 255 or
    65535 (linear, nearest, clipped); without them the samples must be such whole numbers.
    `metadata` are what `read_info` finds again: ``unit``, ``focal_length_mm``, ``fov_x_deg``,
    ``fov_y_deg``.
    """
    file = Path(os.fspath(path))
    suffix, kind = file.suffix.lower(), written_format(file)
    if kind is None or kind.write is None:
        allowed = ", ".join(suffixes(*WRITTEN))
        raise FileError(f"{path}: unknown picture suffix {suffix!r}; allowed: {allowed}")
    if dtype not in kind.dtypes:
        allowed = f"one of {', '.join(kind.dtypes)} for the suffix {suffix}"
        raise ParameterError("dtype", dtype, allowed)
    kind.write(file, as_stored(as_picture(array), dtype, low, high), metadata or {})


_BLOCK_SAMPLES = 1 << 20


def read_info(path: str | os.PathLike[str]) -> PictureInfo:
    """Describe a picture file, of a kind known by suffix, content or header, without samples."""
    file = readable_picture(path)
    return format_of(file).read_info(file)


def read_pixels(path: str | os.PathLike[str], band: int = 0, *, empty: Empty = np.empty) -> Samples:
    """Read one band of a picture file, counted from 0, into an array that `empty` makes.

    (rows, columns) in C order, as the file stores them, perhaps not finite; float64 of doubles,
    integers of 32 or more bits and text, else float32.
    """
    file = readable_picture(path)
    return format_of(file).read_band(file, band, empty=empty)


def check_finite(array: NDArray[Any], name: str, *, advice: str = "") -> None:
    """Refuse samples (rows, columns) that are NaN or infinite, by blocks; `advice` is added."""
    step = max(1, _BLOCK_SAMPLES // max(1, array.shape[1]))
    count = 0
    first: tuple[int, int] | None = None
    for start in range(0, array.shape[0], step):
        wrong = ~np.isfinite(array[start : start + step])
        bad_samples = int(np.count_nonzero(wrong))
        if bad_samples and first is None:
            row, column = divmod(int(np.argmax(wrong)), array.shape[1])
            first = (start + row, column)
        count += bad_samples
    if first is not None:
        many = "1 sample is" if count == 1 else f"{count} samples are"
        raise DataError(
            f"{name}: {many} not finite (NaN or infinite), the first "
            f"({array[first]}) at row {first[0]}, column {first[1]}" + (advice and f"; {advice}")
        )
