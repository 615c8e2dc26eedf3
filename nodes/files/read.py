"""One door to every kind of picture file, and the check of its samples."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError, FileError
from nodes.files import arrays, pictures
from nodes.files.common.paths import checked_band, readable_file
from nodes.files.common.picture_info import PictureInfo, Samples
from nodes.files.headers import envi, envi_header

_BLOCK_SAMPLES = 1 << 20


def read_info(path: str | os.PathLike[str]) -> PictureInfo:
    """Describe a picture file of any supported kind without reading its samples.

    The kind is known by suffix and content: ``.npy`` and text matrices (``.txt``, ``.csv``,
    ``.prn``), ENVI where an ENVI header lies beside the file or is the file, and every other
    by OpenImageIO.

    Raises
    ------
    FileError
        The file is missing, a folder, empty, not readable, damaged or of an unknown format.
    """
    file = readable_file(path)
    match _kind(file):
        case "npy":
            return arrays.read_npy_info(file)
        case "text":
            return arrays.read_matrix_info(file)
        case "envi":
            return envi.read_info(file)
        case _:
            return pictures.read_info(file)


def read_pixels(path: str | os.PathLike[str], band: int = 0) -> Samples:
    """Read one band of a picture file of any supported kind.

    Parameters
    ----------
    path
        See `read_info`.
    band
        Band or channel, counted from 0.

    Returns
    -------
    numpy.ndarray
        (rows, columns), C order, as the numbers the file stores; float64 when it holds doubles,
        integers of 32 or more bits or text, else float32. Samples may be not finite, as those are
        that the header says are missing: see `check_finite`.

    Raises
    ------
    FileError
        As `read_info`, or there is no such band.
    """
    file = readable_file(path)
    match _kind(file):
        case "npy":
            return arrays.read_npy(file, band)
        case "text":
            matrix = arrays.read_matrix(file)
            checked_band(band, 1, file)
            return matrix
        case "envi":
            return envi.read_band(file, band)
        case _:
            return pictures.read_band(file, band)


def check_finite(array: NDArray[Any], name: str, *, advice: str = "") -> None:
    """Refuse samples that are NaN or infinite.

    Works in blocks of rows, so that the memory it takes does not grow with the picture.

    Parameters
    ----------
    array
        (rows, columns).
    name
        What the samples are, for the message.
    advice
        What can be done about it, for the message's end.

    Raises
    ------
    DataError
        Names how many samples are not finite and the row and column of the first.
    """
    step = max(1, _BLOCK_SAMPLES // max(1, array.shape[1]))
    count = 0
    first: tuple[int, int] | None = None
    for start in range(0, array.shape[0], step):
        wrong = ~np.isfinite(array[start : start + step])
        found = int(np.count_nonzero(wrong))
        if found and first is None:
            row, column = divmod(int(np.argmax(wrong)), array.shape[1])
            first = (start + row, column)
        count += found
    if first is not None:
        many = "1 sample is" if count == 1 else f"{count} samples are"
        raise DataError(
            f"{name}: {many} not finite (NaN or infinite), the first "
            f"({array[first]}) at row {first[0]}, column {first[1]}" + (advice and f"; {advice}")
        )


def _kind(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix == ".npy" or arrays.is_npy(path):
        return "npy"
    if suffix == ".hdr":
        # Radiance pictures have the same suffix.
        return "envi" if envi_header.is_envi_header(path) else "picture"
    if suffix in pictures.SUFFIXES:
        return "picture"
    if envi_header.header_beside(path):
        return "envi"
    if suffix in arrays.TEXT_SUFFIXES:
        return "text"
    if suffix in envi_header.DATA_SUFFIXES[2:] or suffix == ".img":
        expected = f"{path.name}.hdr or {path.with_suffix('.hdr').name}"
        raise FileError(f"{path}: its ENVI header is missing; expected {expected} beside it")
    return "picture"
