"""Writing of EXR, TIFF, PNG and the like by OpenImageIO, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.atomic import atomic_file
from core.errors import FileError
from nodes.files.common.picture_info import MetadataValue, metadata_text
from nodes.files.common.quiet import quiet_stderr
from nodes.files.common.stored_samples import SAMPLE_TYPES
from nodes.files.damage import refuse_damaged
from nodes.files.tiff_reading import read_plain_tiff

# Measured on 4096² floats: zip costs TIFF 2.4 s against 0.3 s and saves a tenth.
_COMPRESSION: Mapping[str, str] = MappingProxyType({"openexr": "zips", "tiff": "none"})
_ROWS_COMPARED = 256
_BIGTIFF_BYTES = 4_000_000_000  # classic TIFF ends at 2³² bytes, directory included

# OpenImageIO 3.2 says so after every TIFF without Exif data, all of whose samples are in place.
_FALSE_ALARM = "failed TIFFWriteCustomDirectory() of the Exif data"


def write_by_oiio(path: Path, stored: NDArray[Any], metadata: Mapping[str, MetadataValue]) -> None:
    """Write samples as they are, in the format of the path's suffix; same samples, same bytes.

    Parameters
    ----------
    path
        The file.
    stored
        (rows, columns, channels), of one of `SAMPLE_TYPES`.
    metadata
        Written into the picture's description as ``key = value`` lines.
    """
    with atomic_file(path) as temporary:
        _write(temporary, path, stored, metadata)


def _write(
    temporary: Path,
    path: Path,
    stored: NDArray[Any],
    metadata: Mapping[str, MetadataValue],
) -> None:
    # Imported when needed: 30 ms that a run without picture files need not pay.
    import OpenImageIO

    with quiet_stderr():
        output = OpenImageIO.ImageOutput.create(path.suffix.removeprefix(".").lower())
        if output is None:
            raise FileError(f"cannot write {path}: {OpenImageIO.geterror()}")
        spec = _spec(stored, metadata, str(output.format_name()))
        opened = output.open(os.fspath(temporary), spec)
        written = opened and output.write_image(stored)
        closed = output.close()
        # A PNG on a full disk reports success and leaves only the message.
        complaint = _complaint(output.geterror()).replace(os.fspath(temporary), str(path))
        whole = written and closed and not complaint and _reads_as(temporary, stored)
    if not whole:
        raise FileError(f"cannot write {path}: {complaint or 'the disk may be full'}")


def _spec(stored: NDArray[Any], metadata: Mapping[str, MetadataValue], format_name: str) -> Any:
    import OpenImageIO

    rows, columns, channels = stored.shape
    dtype = next(name for name, kind in SAMPLE_TYPES.items() if kind == stored.dtype)
    spec = OpenImageIO.ImageSpec(columns, rows, channels, dtype)
    spec.attribute("oiio:UnassociatedAlpha", 1)  # four channels are samples, not a cut-out
    spec.attribute("DateTime", "")  # else the clock gets into the file
    if format_name in _COMPRESSION:
        spec.attribute("compression", _COMPRESSION[format_name])
    if stored.nbytes > _BIGTIFF_BYTES:
        spec.attribute("tiff:bigtiff", 1)
    if metadata:
        spec.attribute("ImageDescription", metadata_text(metadata))
    return spec


def _complaint(messages: str) -> str:
    """First line of the library's messages that reports a fault."""
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
        if stored.shape[0] == 1 and stored.dtype == np.float64:  # which the library misreads
            return _same_row(file, stored)
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


def _same_row(file: Path, stored: NDArray[Any]) -> bool:
    """Whether a TIFF of a single row of doubles has every bit of them."""
    rows = (read_plain_tiff(file, stored.shape, band) for band in range(stored.shape[2]))
    return all(
        row is not None and row.tobytes() == stored[:, :, band].tobytes()
        for band, row in enumerate(rows)
    )
