"""A quantity against wavelength from a CSV file of two columns."""

from __future__ import annotations

import math
from pathlib import Path

from nodes.files.common.table_cells import line_refused, point_rows, read_once, table_lines

Points = tuple[tuple[float, float], ...]
_LARGEST_UM = 1e6


@read_once
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
    """
    columns = f"two columns, µm and {what}"
    lines = table_lines(path, what=f"{what} against wavelength", wanted=f" of {columns}")
    points: list[tuple[float, float]] = []
    allowed = f"two numbers, µm and {what}"
    for number, (place, value) in point_rows(path, lines, (2,), allowed, makes="curve"):
        if not 0.0 < place <= _LARGEST_UM:
            raise line_refused(path, number, f"a wavelength above 0, at most {_LARGEST_UM:g} µm")
        if not (math.isfinite(value) and low <= value <= high):
            raise line_refused(path, number, f"{what} from {low:g} to {high:g}")
        if points and place <= points[-1][0]:
            allowed = f"a wavelength above the one before, {points[-1][0]:g} µm"
            raise line_refused(path, number, allowed)
        points.append((place, value))
    return tuple(points)
