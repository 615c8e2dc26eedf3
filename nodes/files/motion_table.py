"""Power densities of a motion against frequency from a CSV file of two or three columns."""

from __future__ import annotations

import math
from pathlib import Path

from nodes.files.common.table_cells import line_refused, point_rows, read_once, table_lines

Points = tuple[tuple[float, float], ...]
_COLUMNS = "Hz, mrad²/Hz across and, if it differs, mrad²/Hz along"


@read_once
def read_motion(path: Path) -> tuple[Points, Points]:
    """Points (Hz, mrad²/Hz) across and along, rising in frequency.

    Parameters
    ----------
    path
        A CSV file of two or three columns, parted by comma, semicolon, tab or blanks; lines that
        begin with ``#`` and a first line of names are passed over. Two columns hold for both axes.
    """
    lines = table_lines(path, what="power density", wanted=f" of columns, {_COLUMNS}")
    rows: list[tuple[float, ...]] = []
    allowed = f"numbers in columns: {_COLUMNS}"
    for number, row in point_rows(path, lines, (2, 3), allowed, makes="spectrum"):
        if not all(0.0 < value < math.inf for value in row):
            raise line_refused(path, number, "finite numbers above 0")
        if rows and row[0] <= rows[-1][0]:
            raise line_refused(path, number, f"a frequency above {rows[-1][0]:g} Hz, the last")
        rows.append(row)
    across = tuple((row[0], row[1]) for row in rows)
    return across, tuple((row[0], row[-1]) for row in rows)
