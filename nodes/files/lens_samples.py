"""Samples of a lens' file: a picture of any kind, an array, complex too, or a listing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from nodes.files.arrays import is_npy, npy_header, whole_npy
from nodes.files.common.file_format import BLANKS, CSV
from nodes.files.common.paths import checked_band, readable_file
from nodes.files.listing import read_listing
from nodes.files.read import read_info, read_pixels

LARGEST_SIDE = 8192
_TEXTS = (*CSV.suffixes, *BLANKS.suffixes, ".dat")


@dataclass(frozen=True)
class LensSamples:
    """What a file holds.

    Attributes
    ----------
    rows, columns
        Size.
    is_complex
        Whether the samples are complex numbers.
    wavelength_um, spacing_um
        As a listing's header names them; None where nothing is named.
    bands
        Bands or channels of the file, of which one is read.
    """

    rows: int
    columns: int
    is_complex: bool = False
    wavelength_um: float | None = None
    spacing_um: float | None = None
    bands: int = 1


def describe_lens_samples(path: Path, band: int = 0) -> LensSamples:
    """Describe a file of samples; errors as `read_lens_samples`."""
    file = readable_file(path)
    if _is_listing(file):
        checked_band(band, 1, file)
        listing = read_listing(file)
        rows, columns = listing.matrix.shape
        named = (listing.wavelength_um, listing.spacing_um)
        return _within_limits(file, LensSamples(rows, columns, False, *named))
    header = npy_header(file) if is_npy(file) else None
    if header is not None and header.dtype.kind == "c":
        if len(header.shape) != 2 or 0 in header.shape:
            raise FileError(
                f"{file}: holds a complex array of shape {header.shape}; allowed: (rows, columns)"
            )
        checked_band(band, 1, file)
        return _within_limits(file, LensSamples(*header.shape, is_complex=True))
    info = read_info(file)
    checked_band(band, info.bands, file)
    return _within_limits(file, LensSamples(info.rows, info.columns, bands=info.bands))


def read_lens_samples(path: Path, band: int = 0) -> NDArray[Any]:
    """Read samples, row 0 at the top.

    Returns
    -------
    numpy.ndarray
        (rows, columns), float64, or complex128 of a complex ``.npy``. Some may be not finite.

    Raises
    ------
    FileError
        As of `nodes.files.read.read_pixels`; or a side of more than 8192 samples.
    """
    described = describe_lens_samples(path, band)
    if _is_listing(path):
        return read_listing(path).matrix
    if described.is_complex:
        return whole_npy(path).astype(np.complex128, order="C")
    return np.asarray(read_pixels(path, band), np.float64)


def _is_listing(path: Path) -> bool:
    return path.suffix.lower() in _TEXTS and not is_npy(path)


def _within_limits(path: Path, samples: LensSamples) -> LensSamples:
    if max(samples.rows, samples.columns) > LARGEST_SIDE:
        raise FileError(
            f"{path}: {samples.columns} × {samples.rows} samples; allowed: {LARGEST_SIDE} on a "
            "side: cut it about its middle"
        )
    return samples
