"""A quantity against wavelength from a CSV file of two columns."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

from core.errors import FileError
from nodes.files.common.paths import readable_file
from nodes.files.common.table_cells import begins_with_number, cells_of, line_refused, number_of

Points = tuple[tuple[float, float], ...]
_LONGEST_BYTES = 10_000_000
_LARGEST_UM = 1e6


def read_wavelengths(path: Path, *, what: str, low: float, high: float) -> Points:
    """Points (wavelength in µm, value), rising in wavelength.

    Parameters
    ----------
    path
        A CSV file: µm and value, parted by comma, semicolon, tab or blanks; lines that begin with
        ``#`` and a first line of names are passed over.
    what
        For people: what the values are.
    low, high
        Least and greatest value allowed.

    Raises
    ------
    FileError
        The file cannot be read, or a line of it is not two such numbers; names the line.
    """
    file = readable_file(path)
    status = file.stat()
    return _read(file, what, low, high, (status.st_size, status.st_mtime_ns))


@lru_cache(maxsize=64)
def _read(file: Path, what: str, low: float, high: float, stamp: tuple[int, int]) -> Points:
    if stamp[0] > _LONGEST_BYTES:
        raise FileError(f"{file}: {stamp[0]} bytes are no table of {what} against wavelength")
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{file}: is no text of two columns, µm and {what}") from error
    points: list[tuple[float, float]] = []
    named = False
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = [cell for cell in cells_of(line) if cell.strip()]
        try:
            place, value = (number_of(cell) for cell in cells)
        except ValueError:
            # A first line that begins with a number is damaged data, not names.
            if points or named or begins_with_number(line):
                raise line_refused(file, number, f"two numbers, µm and {what}") from None
            named = True  # a line of names on top
            continue
        if not 0.0 < place <= _LARGEST_UM:
            raise line_refused(file, number, f"a wavelength above 0, at most {_LARGEST_UM:g} µm")
        if not (math.isfinite(value) and low <= value <= high):
            raise line_refused(file, number, f"{what} from {low:g} to {high:g}")
        if points and place <= points[-1][0]:
            allowed = f"a wavelength above the one before, {points[-1][0]:g} µm"
            raise line_refused(file, number, allowed)
        points.append((place, value))
    if len(points) < 2:
        raise FileError(f"{file}: has {len(points)} points; at least 2 make a curve")
    return tuple(points)
