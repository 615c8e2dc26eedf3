"""Quantities against wavelength or frequency from CSV files of two or three columns.

Columns are parted by comma, semicolon, tab or blanks; lines that begin with ``#`` and a first line
of names are passed over.
"""

from __future__ import annotations

import math
from pathlib import Path

from nodes.files.common.table_cells import line_refused, point_rows, read_once, table_lines

Points = tuple[tuple[float, float], ...]
_LARGEST_UM = 1e6
_COLUMNS = "Hz, horizontal mrad²/Hz and, if it differs, vertical mrad²/Hz"


@read_once
def read_wavelengths(path: Path, *, what: str, low: float, high: float) -> Points:
    """Points (wavelength in µm, value), rising in wavelength; values from `low` to `high`.

    `what` the values are is for people.
    """
    least = math.ulp(0.0), f"a wavelength above 0, at most {_LARGEST_UM:g} µm"
    return _points(path, "wavelength", "µm", least, what, low, high)


@read_once
def read_heights(path: Path, *, unit: str, what: str, low: float, high: float) -> Points:
    """Points (height in the field, value), rising from 0 or above; `unit` is that of heights."""
    least = 0.0, f"a height from 0 to {_LARGEST_UM:g} {unit}"
    return _points(path, "height", unit, least, what, low, high)


def _points(
    path: Path,
    place_name: str,
    unit: str,
    least: tuple[float, str],
    what: str,
    low: float,
    high: float,
) -> Points:
    columns = f"two columns, {unit} and {what}"
    lines = table_lines(path, what=f"{what} against {place_name}", wanted=f" of {columns}")
    points: list[tuple[float, float]] = []
    allowed = f"two numbers, {unit} and {what}"
    for number, (place, value) in point_rows(path, lines, (2,), allowed, makes="curve"):
        if not least[0] <= place <= _LARGEST_UM:
            raise line_refused(path, number, least[1])
        if not (math.isfinite(value) and low <= value <= high):
            raise line_refused(path, number, f"{what} from {low:g} to {high:g}")
        if points and place <= points[-1][0]:
            allowed = f"a {place_name} above the previous one, {points[-1][0]:g} {unit}"
            raise line_refused(path, number, allowed)
        points.append((place, value))
    return tuple(points)


@read_once
def read_motion(path: Path) -> tuple[Points, Points]:
    """Points (Hz, mrad²/Hz) of a motion across and along, rising in frequency.

    Two columns hold for both axes.
    """
    lines = table_lines(path, what="power density", wanted=f" of columns, {_COLUMNS}")
    rows: list[tuple[float, ...]] = []
    allowed = f"numbers in columns: {_COLUMNS}"
    for number, row in point_rows(path, lines, (2, 3), allowed, makes="spectrum"):
        if not all(0.0 < value < math.inf for value in row):
            raise line_refused(path, number, "finite numbers above 0")
        if rows and row[0] <= rows[-1][0]:
            raise line_refused(
                path, number, f"a frequency above the previous one, {rows[-1][0]:g} Hz"
            )
        rows.append(row)
    across = tuple((row[0], row[1]) for row in rows)
    return across, tuple((row[0], row[-1]) for row in rows)
