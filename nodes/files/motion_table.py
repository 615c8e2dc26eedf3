"""Power densities of a motion against frequency from a CSV file of two or three columns."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

from core.errors import FileError
from nodes.files.common.paths import readable_file
from nodes.files.common.table_cells import begins_with_number, cells_of, line_refused, number_of

Points = tuple[tuple[float, float], ...]
_LONGEST_BYTES = 10_000_000
_COLUMNS = "Hz, mrad²/Hz across and, if it differs, mrad²/Hz along"


def read_motion(path: Path) -> tuple[Points, Points]:
    """Points (Hz, mrad²/Hz) across and along, rising in frequency.

    Parameters
    ----------
    path
        A CSV file of two or three columns, parted by comma, semicolon, tab or blanks; lines that
        begin with ``#`` and a first line of names are passed over. Two columns hold for both axes.

    Raises
    ------
    FileError
        The file cannot be read, or a line of it is not such numbers above 0; names the line.
    """
    file = readable_file(path)
    status = file.stat()
    return _read(file, (status.st_size, status.st_mtime_ns))


@lru_cache(maxsize=64)
def _read(file: Path, stamp: tuple[int, int]) -> tuple[Points, Points]:
    if stamp[0] > _LONGEST_BYTES:
        raise FileError(f"{file}: {stamp[0]} bytes are no table of power density")
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{file}: is no text of columns, {_COLUMNS}") from error
    rows: list[tuple[float, ...]] = []
    named = False
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        numbers = _numbers(line)
        # A first line that begins with a number is damaged data, not names.
        if numbers is None and not rows and not named and not begins_with_number(line):
            named = True  # a line of names on top
            continue
        wanted = {len(rows[0])} if rows else {2, 3}
        if numbers is None or len(numbers) not in wanted:
            raise line_refused(file, number, f"numbers in columns: {_COLUMNS}")
        if not all(0.0 < value < math.inf for value in numbers):
            raise line_refused(file, number, "finite numbers above 0")
        if rows and numbers[0] <= rows[-1][0]:
            raise line_refused(file, number, f"a frequency above {rows[-1][0]:g} Hz, the last")
        rows.append(numbers)
    if len(rows) < 2:
        raise FileError(f"{file}: has {len(rows)} points; at least 2 make a spectrum")
    across = tuple((row[0], row[1]) for row in rows)
    return across, tuple((row[0], row[-1]) for row in rows)


def _numbers(line: str) -> tuple[float, ...] | None:
    try:
        return tuple(number_of(cell) for cell in cells_of(line) if cell.strip())
    except ValueError:
        return None
