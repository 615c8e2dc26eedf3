"""A matrix of numbers in text, below the lines of words that optical design programs write."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from nodes.files.common.table_cells import cells_of, line_refused, number_of
from nodes.files.lens_text import lens_lines

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
class Listing:
    """A matrix and the lines above it.

    Attributes
    ----------
    header
        Lines of words, without the empty ones; none in a plain matrix.
    matrix
        (rows, columns), the first row at the top; NaN where the text has it.
    """

    header: tuple[str, ...]
    matrix: NDArray[np.float64]

    @property
    def wavelength_um(self) -> float | None:
        """Wavelength that the header names, as in ``0.5500 µm at 0.00 (deg)``."""
        return self._length(_WAVELENGTH)

    @property
    def spacing_um(self) -> float | None:
        """Distance of the samples that the header names, as in ``Data spacing is 0.422 µm``."""
        return self._length(_SPACING)

    def _length(self, pattern: re.Pattern[str]) -> float | None:
        for line in self.header:
            match = pattern.search(line)
            if match:
                number, unit = (group for group in match.groups() if group is not None)
                return float(number) * _MICROMETRES.get(unit.lower(), 1.0)
        return None


def read_listing(path: Path) -> Listing:
    """Read a text matrix with or without a header, such as Zemax's wavefront map or PSF.

    Parameters
    ----------
    path
        Text in UTF-8 or, as Zemax writes it, UTF-16; numbers parted by blanks, commas or tabs.
        Lines that begin with ``#`` count as header.

    Raises
    ------
    FileError
        It is no text, holds no matrix, or rows of unequal length; names the line.
    """
    lines = [line.strip() for line in lens_lines(path, what="a matrix of numbers")]
    header: list[str] = []
    rows: list[NDArray[np.float64]] = []
    for number, line in enumerate(lines, 1):
        if not line:
            continue
        values = None if line.startswith("#") else _numbers(line)
        if values is None and not rows:
            header.append(line)
        elif values is None:
            raise line_refused(path, number, f"{len(rows[0])} numbers, as the rows above")
        elif rows and len(values) != len(rows[0]):
            raise FileError(
                f"{path}: line {number} has {len(values)} numbers; allowed: {len(rows[0])}, as the "
                "rows above"
            )
        else:
            rows.append(values)
    if not rows:
        raise FileError(f"{path}: holds no matrix of numbers")
    matrix = np.array(rows, np.float64)
    size = next((match for match in map(_GRID.search, reversed(header)) if match), None)
    # FFT listings name the grid of the pupil too: the last of them is that of the matrix.
    if size and (int(size[2]), int(size[1])) != matrix.shape:
        raise FileError(
            f"{path}: its header names {size[1]} by {size[2]} samples, and {matrix.shape[1]} by "
            f"{matrix.shape[0]} are there"
        )
    return Listing(tuple(header), matrix)


def _numbers(line: str) -> NDArray[np.float64] | None:
    """Numbers of a line; at once as an array, of which a large file needs a fifth of the memory."""
    try:
        return np.array([number_of(cell) for cell in cells_of(line) if cell.strip()], np.float64)
    except ValueError:
        return None
