"""Transmission and path radiance of a path from a file: a CSV of three columns, or a tape7."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

from core.errors import FileError
from nodes.files.common.paths import readable_file
from nodes.files.common.table_cells import begins_with_number, cells_of, line_refused, number_of
from nodes.files.tape7 import is_tape7, tape7_points

Points = tuple[tuple[float, float], ...]
COLUMNS = ("wavelength_um", "transmission", "path_radiance")
_LONGEST_BYTES = 50_000_000
_LARGEST_UM, _LARGEST_RADIANCE = 1e6, 1e30
_ALLOWED = (
    f"a wavelength above 0, at most {_LARGEST_UM:g} µm, a transmission from 0 to 1 and a path "
    "radiance of at least 0"
)


def read_path_table(path: Path) -> tuple[Points, Points]:
    """Transmission and path radiance (W/m²/sr/µm) against wavelength in µm, rising.

    Parameters
    ----------
    path
        MODTRAN's tape7, see `nodes.files.tape7`, or a CSV file whose first line names the columns
        ``wavelength_um``, ``transmission`` and ``path_radiance`` (W/m²/sr/µm), in any order and
        among others; without names, these three alone. Lines that begin with ``#`` are passed over.

    Raises
    ------
    FileError
        The file cannot be read, or a line of it is no row of such a table; names the line.
    """
    file = readable_file(path)
    status = file.stat()
    return _read(file, (status.st_size, status.st_mtime_ns))


@lru_cache(maxsize=16)
def _read(file: Path, stamp: tuple[int, int]) -> tuple[Points, Points]:
    if stamp[0] > _LONGEST_BYTES:
        raise FileError(f"{file}: {stamp[0]} bytes are no table of a path's transmission")
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{file}: is no text: neither tape7 nor CSV") from error
    return tape7_points(lines, file) if is_tape7(lines) else _csv_points(lines, file)


def _csv_points(lines: list[str], file: Path) -> tuple[Points, Points]:
    places: tuple[int, ...] | None = None
    rows: list[tuple[float, ...]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = [cell.strip() for cell in cells_of(line)]
        if places is None and not begins_with_number(line):
            places = _places(cells, file, number)
            continue
        if places is None:
            places = (0, 1, 2)
            if len(cells) != len(COLUMNS):
                raise line_refused(file, number, f"three numbers, {', '.join(COLUMNS)}")
        try:
            place, passed, added = (number_of(cells[index]) for index in places)
        except (ValueError, IndexError):
            raise line_refused(file, number, f"numbers in {', '.join(COLUMNS)}") from None
        if not (0.0 < place <= _LARGEST_UM and 0.0 <= passed <= 1.0):
            raise line_refused(file, number, _ALLOWED)
        if not (0.0 <= added <= _LARGEST_RADIANCE and math.isfinite(added)):
            raise line_refused(file, number, _ALLOWED)
        if rows and place <= rows[-1][0]:
            allowed = f"a wavelength above the one before, {rows[-1][0]:g} µm"
            raise line_refused(file, number, allowed)
        rows.append((place, passed, added))
    if len(rows) < 2:
        raise FileError(f"{file}: has {len(rows)} points; at least 2 make a spectrum")
    return tuple((row[0], row[1]) for row in rows), tuple((row[0], row[2]) for row in rows)


def _places(cells: list[str], file: Path, number: int) -> tuple[int, ...]:
    names = [cell.lower() for cell in cells]
    for name in COLUMNS:
        if names.count(name) != 1:
            raise FileError(
                f"{file}: line {number}: names {names.count(name)} columns {name}; one each of "
                f"{', '.join(COLUMNS)} is needed, or a tape7 with FREQ and TOT TRANS"
            )
    return tuple(names.index(name) for name in COLUMNS)
