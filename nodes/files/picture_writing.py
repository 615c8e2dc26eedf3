"""Writing of EXR, TIFF and PNG pictures by OpenImageIO, whole or not at all."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.atomic import atomic_file
from core.errors import DataError, FileError, ParameterError
from nodes.files.common.quiet import quiet_stderr
from nodes.files.damage import refuse_damaged

DTYPES: Mapping[str, tuple[str, ...]] = {
    ".exr": ("float", "half"),
    ".tif": ("float", "double", "uint8", "uint16"),
    ".tiff": ("float", "double", "uint8", "uint16"),
    ".png": ("uint8", "uint16"),
}
_NUMPY: Mapping[str, np.dtype[Any]] = {
    "half": np.dtype(np.float16),
    "float": np.dtype(np.float32),
    "double": np.dtype(np.float64),
    "uint8": np.dtype(np.uint8),
    "uint16": np.dtype(np.uint16),
}
# Measured on 4096² floats: zip costs TIFF 2.4 s against 0.3 s and saves a tenth.
_COMPRESSION = {".exr": "zips", ".tif": "none", ".tiff": "none"}
_ROWS_COMPARED = 256
_BIGTIFF_BYTES = 4_000_000_000  # classic TIFF ends at 2³² bytes, directory included

# OpenImageIO 3.2 says so after every TIFF without Exif data, all of whose samples are in place.
_FALSE_ALARM = "failed TIFFWriteCustomDirectory() of the Exif data"

MetadataValue = str | int | float


def write_picture(
    path: str | os.PathLike[str],
    array: ArrayLike,
    *,
    dtype: str = "float",
    low: float | None = None,
    high: float | None = None,
    metadata: Mapping[str, MetadataValue] | None = None,
) -> None:
    """Write a picture atomically; the same samples give the same bytes.

    Float and double samples read back bit for bit. For `uint8` and `uint16`, `low` and `high`
    are the values that become black and white (0 and 255 or 65535; linear, nearest, clipped);
    without them the samples must be whole numbers within the range already.

    Parameters
    ----------
    path
        Ends in ``.exr``, ``.tif``, ``.tiff`` or ``.png``.
    array
        (rows, columns) or (rows, columns, channels), real.
    dtype
        ``float``, ``half``, ``double``, ``uint8`` or ``uint16``, as far as the format holds it
        (`DTYPES`).
    low, high
        Display range for the integer types.
    metadata
        Texts and numbers, written into the picture's description as ``key = value`` lines, where
        `read_info` finds ``unit``, ``focal_length_mm``, ``fov_x_deg`` and ``fov_y_deg``.

    Raises
    ------
    ParameterError
        `dtype`, `low` or `high` cannot be used.
    DataError
        No picture, or samples that do not fit the type.
    FileError
        Unknown suffix, or the file cannot be written.
    """
    suffix = Path(os.fspath(path)).suffix.lower()
    if suffix not in DTYPES:
        raise FileError(f"{path}: unknown picture suffix {suffix!r}; allowed: {', '.join(DTYPES)}")
    if dtype not in DTYPES[suffix]:
        allowed = f"a {suffix} file holds {', '.join(DTYPES[suffix])}"
        raise ParameterError("dtype", dtype, allowed)
    samples = _as_picture(array)
    if dtype.startswith("uint"):
        stored = _as_integers(samples, _NUMPY[dtype], low, high)
    elif low is not None or high is not None:
        raise ParameterError("low, high", (low, high), f"none with dtype {dtype}: uint8 or uint16")
    else:
        stored = _as_floats(samples, _NUMPY[dtype])
    with atomic_file(path) as temporary:
        _write(temporary, Path(os.fspath(path)), stored, dtype, suffix, metadata or {})


def _as_picture(array: ArrayLike) -> NDArray[Any]:
    samples = np.asarray(array)
    if samples.dtype.kind not in "buif":
        raise DataError(f"samples of type {samples.dtype} cannot be written as a picture: not real")
    if samples.ndim == 2:
        # OpenImageIO takes a bare 2-D array for its transpose.
        samples = samples[:, :, None]
    if samples.ndim != 3 or samples.size == 0:
        raise DataError(
            f"an array of shape {np.shape(array)} cannot be written as a picture; "
            "allowed: (rows, columns) or (rows, columns, channels), not empty"
        )
    return samples


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
            f"{int(overflowed.sum())} samples are beyond ±{largest:.6g}, the range of {dtype}, "
            f"the first at row {row}, column {column}"
        )
    return stored


def _as_integers(
    samples: NDArray[Any], dtype: np.dtype[Any], low: float | None, high: float | None
) -> NDArray[Any]:
    top = np.iinfo(dtype).max
    values = samples.astype(np.float64)
    if not np.isfinite(values).all():
        row, column, _ = np.argwhere(~np.isfinite(values))[0]
        raise DataError(f"sample at row {row}, column {column} is not finite: no {dtype} for it")
    if low is None and high is None:
        wrong = (values != np.rint(values)) | (values < 0) | (values > top)
        if wrong.any():
            row, column, _ = np.argwhere(wrong)[0]
            raise DataError(
                f"sample {values[row, column].ravel()[0]:g} at row {row}, column {column} is no "
                f"{dtype} (whole, 0 to {top}); give low and high to scale"
            )
        return values.astype(dtype)
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high - low)):
        raise ParameterError("low, high", (low, high), "two finite numbers or none")
    if not high > low:
        raise ParameterError("high", high, f"above low = {low:g}")
    # Clipped first: a sample far outside the range could overflow in the division.
    values = (np.clip(values, low, high) - low) / (high - low)
    return np.rint(values * top).astype(dtype)


def _write(
    temporary: Path,
    path: Path,
    stored: NDArray[Any],
    dtype: str,
    suffix: str,
    metadata: Mapping[str, MetadataValue],
) -> None:
    # Imported when needed: 30 ms that a run without picture files need not pay.
    import OpenImageIO

    rows, columns, channels = stored.shape
    spec = OpenImageIO.ImageSpec(columns, rows, channels, dtype)
    spec.attribute("oiio:UnassociatedAlpha", 1)  # four channels are samples, not a cut-out
    spec.attribute("DateTime", "")  # else the clock gets into the file
    if suffix in _COMPRESSION:
        spec.attribute("compression", _COMPRESSION[suffix])
    if stored.nbytes > _BIGTIFF_BYTES:
        spec.attribute("tiff:bigtiff", 1)
    if metadata:
        lines = [f"{key} = {' '.join(str(value).split())}" for key, value in metadata.items()]
        spec.attribute("ImageDescription", "\n".join(lines))
    with quiet_stderr():
        output = OpenImageIO.ImageOutput.create(suffix.removeprefix("."))
        if output is None:
            raise FileError(f"cannot write {path}: {OpenImageIO.geterror()}")
        opened = output.open(os.fspath(temporary), spec)
        written = opened and output.write_image(stored)
        closed = output.close()
        # A PNG on a full disk reports success and leaves only the message.
        complaint = _complaint(output.geterror()).replace(os.fspath(temporary), str(path))
        whole = written and closed and not complaint and _reads_as(temporary, stored)
    if not whole:
        raise FileError(f"cannot write {path}: {complaint or 'the disk may be full'}")


def _complaint(messages: str) -> str:
    """First line of the library's messages that tells of a fault."""
    lines = (line.strip() for line in messages.splitlines())
    return next((line for line in lines if line and line != _FALSE_ALARM), "")


def _reads_as(file: Path, stored: NDArray[Any]) -> bool:
    """Whether the file gives back every bit.

    The libraries' last flush fails unseen on a full disk: EXR and PNG files lost their end
    without a word until they were read back.
    """
    import OpenImageIO

    try:
        refuse_damaged(file)
    except FileError:
        return False
    wishes = OpenImageIO.ImageSpec()
    wishes.attribute("oiio:UnassociatedAlpha", 1)
    picture = OpenImageIO.ImageInput.open(os.fspath(file), wishes)
    if picture is None:
        OpenImageIO.geterror()  # fetched, or it is printed when the process ends
        return False
    spec = picture.spec()
    same = (spec.height, spec.width, spec.nchannels) == stored.shape
    for start in range(0, stored.shape[0] if same else 0, _ROWS_COMPARED):
        end = min(start + _ROWS_COMPARED, stored.shape[0])
        block = picture.read_scanlines(start, end, 0, 0, spec.nchannels, spec.format)
        # As bytes: a NaN is not equal to itself.
        same = same and block is not None and block.tobytes() == stored[start:end].tobytes()
    picture.geterror()
    picture.close()
    return same
