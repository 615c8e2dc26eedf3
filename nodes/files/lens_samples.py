"""Samples of a lens' file: a picture of any kind, an array, complex too, or a listing.

A listing is a matrix of numbers in text, below the lines of words that optical design programs
write.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from core.records import dataclass
from nodes.files.arrays import is_npy, npy_header, whole_npy
from nodes.files.common.file_format import BLANKS, CSV
from nodes.files.common.stored_bytes import checked_band, readable_file
from nodes.files.common.table_cells import cells_of, lens_lines, line_refused, numbers_of
from nodes.files.formats import read_info, read_pixels

LARGEST_SIDE = 8192
_TEXTS = (*CSV.suffixes, *BLANKS.suffixes, ".dat")
_GRID = re.compile(r"(?:pupil|image) grid size:?\s*(\d+)\s*by\s*(\d+)", re.IGNORECASE)
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[Ee][-+]?\d+)?)"
_LENGTH = r"(nm|µm|μm|um|microns?|micrometers?|mm|millimeters?)"
_SHORT = r"(nm|µm|μm|um|microns?|micrometers?)"
# As Zemax has it, at the start of a line: other lengths may be "at" something too.
_WAVELENGTH = re.compile(
    rf"^\s*{_NUMBER}\s*{_SHORT}\s+at\b|\bwavelength:?\s*{_NUMBER}\s*{_SHORT}", re.IGNORECASE
)
_SPACING = re.compile(rf"data spacing is\s+{_NUMBER}\s*{_LENGTH}", re.IGNORECASE)
_MICROMETRES = {"nm": 1e-3, "mm": 1e3, "millimeter": 1e3, "millimeters": 1e3}


@dataclass(frozen=True)
class LensSamples:
    """What a file holds: its size, and what a listing's header names, None where it does not.

    One of its `bands` or channels is read.
    """

    rows: int
    columns: int
    is_complex: bool = False
    wavelength_um: float | None = None
    spacing_um: float | None = None
    bands: int = 1


def describe_lens_samples(path: Path, band: int = 0) -> LensSamples:
    file = readable_file(path)
    if _is_listing(file):
        checked_band(band, 1, file)
        matrix, wavelength_um, spacing_um = read_listing(file)
        rows, columns = matrix.shape
        return _within_limits(file, LensSamples(rows, columns, False, wavelength_um, spacing_um))
    header = npy_header(file) if is_npy(file) else None
    if header is not None and header.dtype.kind == "c":
        if len(header.shape) != 2 or 0 in header.shape:
            raise FileError(
                f"{file}: contains a complex array of shape {header.shape}; allowed: (rows, "
                "columns)"
            )
        checked_band(band, 1, file)
        return _within_limits(file, LensSamples(*header.shape, is_complex=True))
    info = read_info(file)
    checked_band(band, info.bands, file)
    return _within_limits(file, LensSamples(info.rows, info.columns, bands=info.bands))


def read_lens_samples(path: Path, band: int = 0) -> NDArray[Any]:
    """Read samples, row 0 at the top: float64, or complex128; some may be not finite."""
    described = describe_lens_samples(path, band)
    if _is_listing(path):
        return read_listing(path)[0]
    if described.is_complex:
        return whole_npy(path).astype(np.complex128, order="C")
    return np.asarray(read_pixels(path, band), np.float64)


def _is_listing(path: Path) -> bool:
    return path.suffix.lower() in _TEXTS and not is_npy(path)


def _within_limits(path: Path, samples: LensSamples) -> LensSamples:
    if max(samples.rows, samples.columns) > LARGEST_SIDE:
        raise FileError(
            f"{path}: {samples.columns} × {samples.rows} samples; at most {LARGEST_SIDE} on a "
            "side are allowed: crop the array around its middle"
        )
    return samples


def _length_um(header: list[str], pattern: re.Pattern[str]) -> float | None:
    for match in filter(None, map(pattern.search, header)):
        number, unit = (group for group in match.groups() if group is not None)
        return float(number) * _MICROMETRES.get(unit.lower(), 1.0)
    return None


def read_listing(path: Path) -> tuple[NDArray[np.float64], float | None, float | None]:
    """Read a text matrix with or without a header, such as Zemax's wavefront map or PSF.

    UTF-8 or, as Zemax writes it, UTF-16; numbers parted by blanks, commas or tabs. Lines that begin
    with ``#`` count as header. The matrix, NaN where the text has it; then the wavelength and the
    spacing in µm, None where the header does not name it.
    """
    lines = [line.strip() for line in lens_lines(path, what="a matrix of numbers")]
    header: list[str] = []
    rows: list[NDArray[np.float64]] = []
    for number, line in enumerate(lines, 1):
        if not line:
            continue
        values = None if line.startswith("#") else numbers_of(filter(str.strip, cells_of(line)))
        if values is None and not rows:
            header.append(line)
        elif values is None:
            raise line_refused(path, number, f"{len(rows[0])} numbers, as in the rows above")
        elif rows and len(values) != len(rows[0]):
            raise FileError(
                f"{path}: line {number} has {len(values)} numbers; allowed: {len(rows[0])}, as in "
                "the rows above"
            )
        else:
            rows.append(np.array(values))  # a fifth of the memory of the tuple
    if not rows:
        raise FileError(f"{path}: contains no matrix of numbers")
    matrix = np.array(rows, np.float64)
    size = next((match for match in map(_GRID.search, reversed(header)) if match), None)
    # FFT listings name the grid of the pupil too: the last of them is that of the matrix.
    if size and (int(size[2]), int(size[1])) != matrix.shape:
        raise FileError(
            f"{path}: its header gives {size[1]} by {size[2]} samples, but the file has "
            f"{matrix.shape[1]} by {matrix.shape[0]}"
        )
    return matrix, _length_um(header, _WAVELENGTH), _length_um(header, _SPACING)
