"""MTF against frequency from a CSV file with a line of names, or from a listing of Zemax."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from core.errors import FileError
from core.records import dataclass
from nodes.files.common import table_cells

Column = tuple[float, ...]
MTF_COLUMNS = ("mtf", "mtf_x", "mtf_y", "radial")
PHASE_COLUMNS = ("phase", "phase_x", "phase_y")
LARGEST_MTF = 2.0  # sharpened pictures exceed 1; percent begin above

_LONGEST_BYTES = 10_000_000
_LARGEST_FREQUENCY = 1e9
_LARGEST_PHASE = 1e6
_ALIASES = {"spatial_frequency": "frequency", "mtf_radial": "radial"}
_NAME = re.compile(r"([^()\[\]]*)(?:[(\[]([^()\[\]]*)[)\]])?\s*")
_UNITS = {
    "mm": "cyc/mm", "millimeter": "cyc/mm", "mrad": "cyc/mrad", "milliradian": "cyc/mrad",
    "pixel": "cyc/pixel", "px": "cyc/pixel", "pix": "cyc/pixel", "p": "cyc/pixel",
}  # fmt: skip
_CYCLES = ("cyc", "cycles", "cycle", "cy", "c", "lp", "1")
_HEADING = re.compile(r"\s*spatial frequency\s+tangential\s+sagittal\s*", re.IGNORECASE)
_ZEMAX_UNIT = re.compile(r"spatial frequency units are (cycles per \w+)", re.IGNORECASE)


@dataclass(frozen=True)
class MtfTable:
    """Columns of a file: those there are of `MTF_COLUMNS`, and of `PHASE_COLUMNS` in radians.

    `unit` is ``cyc/mm``, ``cyc/mrad`` or ``cyc/pixel`` as the file names it, None where it does
    not; `frequencies` rise from 0 or above.
    """

    file: Path
    unit: str | None
    frequencies: Column
    columns: tuple[tuple[str, Column], ...]

    def column(self, name: str) -> Column | None:
        return dict(self.columns).get(name)


@table_cells.read_once
def read_mtf_table(path: Path, *, field: int = 0) -> MtfTable:
    """Read a CSV table parted by comma, semicolon, tab or blanks, or Zemax's MTF as text.

    Lines that begin with ``#`` are passed over. `field` counts those of a listing of Zemax from 0,
    without the diffraction limit; its tangential column is the MTF along y, as for a field along y.
    """
    table_cells.refuse_long_table(path, _LONGEST_BYTES, "MTF against frequency")
    lines = list(enumerate(table_cells.lens_lines(path, what="frequency and MTF columns"), 1))
    if any(_HEADING.fullmatch(line) for _, line in lines):
        return _zemax(path, lines, field)
    rows = [(n, line) for n, line in lines if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise FileError(f"{path}: contains no table of MTF against frequency")
    (number, heading), *rows = rows
    names, units = _names(path, number, heading)
    checks = [_check_of(name, unit) for name, unit in zip(names, units, strict=True)]
    frequencies, *columns = _columns(path, rows, names, checks)
    named = dict(zip(names[1:], columns, strict=True))
    for name, unit in zip(names[1:], units[1:], strict=True):
        if unit == "deg":
            named[name] = tuple(map(math.radians, named[name]))
    return MtfTable(path, units[0] or None, frequencies, tuple(sorted(named.items())))


def unit_of(text: str) -> str | None:
    """A unit of frequency by one of its names, such as ``lp/mm``; None for another."""
    cycles, _, per = text.lower().replace(" per ", "/").replace("_per_", "/").partition("/")
    return _UNITS.get(per.strip()) if cycles.strip() in _CYCLES else None


def _names(file: Path, number: int, line: str) -> tuple[list[str], list[str]]:
    """Names of the columns, frequency first, and their units as far as they are named."""
    names, units = [], []
    for cell in table_cells.cells_of(line):
        match = _NAME.fullmatch(cell.strip().strip('"'))
        name, unit = (match[1], match[2] or "") if match else (cell, "")
        name = name.strip().lower().replace(" ", "_")
        if name.startswith("frequency_"):  # frequency_cyc_per_mm
            name, unit = "frequency", name.removeprefix("frequency_")
        names.append(_ALIASES.get(name, name))
        units.append(unit.strip())
    known = {*MTF_COLUMNS, *PHASE_COLUMNS}
    wrong = next((name for name in names[1:] if name not in known), None)
    repeated = len(set(names)) != len(names)
    if names[0] != "frequency" or len(names) < 2 or wrong is not None or repeated:
        raise table_cells.line_refused(
            file, number,
            "column names: frequency with its unit, then mtf, or mtf_x and mtf_y, or radial; "
            "then, if known, phase, or phase_x and phase_y",
        )  # fmt: skip
    if not set(names) & set(MTF_COLUMNS):
        raise table_cells.line_refused(
            file, number, "column names, at least one of them for an MTF"
        )
    for alone, prefix in (("mtf", "mtf_"), ("phase", "phase_")):
        others = [name for name in names if name.startswith(prefix)]
        others += ["radial"] if alone == "mtf" and "radial" in names else []
        if alone in names and others:
            wanted = f"column names with either {alone} or {others[0]}, not both"
            raise table_cells.line_refused(file, number, wanted)
    if units[0]:
        unit = unit_of(units[0])
        if unit is None:
            raise table_cells.line_refused(
                file, number, "a frequency in cyc/mm, cyc/mrad or cyc/pixel"
            )
        units[0] = unit
    for place, name in enumerate(names[1:], 1):
        allowed = ("", "rad", "deg") if name in PHASE_COLUMNS else ("", "1")
        if units[place] not in allowed:
            wanted = "a phase in rad or deg" if name in PHASE_COLUMNS else "an MTF without a unit"
            raise table_cells.line_refused(file, number, wanted)
    return names, units


Check = tuple[Callable[[float], bool], str]


def _check_of(name: str, unit: str) -> Check:
    if name == "frequency":
        allowed = f"a frequency from 0 to {_LARGEST_FREQUENCY:g}"
        return (lambda value: 0.0 <= value <= _LARGEST_FREQUENCY), allowed
    if name in PHASE_COLUMNS:
        what = f"a phase between −{_LARGEST_PHASE:g} and {_LARGEST_PHASE:g} {unit or 'rad'}"
        return (lambda value: abs(value) <= _LARGEST_PHASE), what
    allowed = (
        f"an MTF from 0 to {LARGEST_MTF:g}; write a negative lobe as a phase of π, and divide "
        "percentages by 100"
    )
    return (lambda value: 0.0 <= value <= LARGEST_MTF), allowed


def _columns(
    file: Path, rows: Sequence[tuple[int, str]], names: Sequence[str], checks: Sequence[Check]
) -> list[Column]:
    table: list[tuple[float, ...]] = []
    for number, line in rows:
        numbers = table_cells.numbers_of(table_cells.cells_of(line))
        if numbers is None or len(numbers) != len(names):
            wanted = f"{len(names)} numbers: {', '.join(names)}"
            raise table_cells.line_refused(file, number, wanted)
        for value, (is_allowed, allowed) in zip(numbers, checks, strict=True):
            if not is_allowed(value):
                raise table_cells.line_refused(file, number, allowed)
        if table and numbers[0] <= table[-1][0]:
            wanted = f"a frequency above the previous one, {table[-1][0]:g}"
            raise table_cells.line_refused(file, number, wanted)
        table.append(numbers)
    if len(table) < 2:
        points = "1 point" if len(table) == 1 else f"{len(table)} points"
        raise FileError(f"{file}: {points}; a curve needs at least 2")
    return list(zip(*table, strict=True))


def _zemax(file: Path, lines: Sequence[tuple[int, str]], field: int) -> MtfTable:
    """One field of Zemax's listing: below each heading rows of frequency and two MTFs."""
    unit: str | None = None
    fields: list[list[tuple[int, str]]] = []
    is_inside = is_limit = False
    for number, line in lines:
        stated = _ZEMAX_UNIT.search(line)
        if stated:
            unit = unit_of(stated[1])
        if line.lower().startswith("field:"):
            is_limit = "diffraction limit" in line.lower()
        if _HEADING.fullmatch(line):
            # The limit is what the lens would do without its aberrations, and no field of it.
            is_inside = not is_limit
            fields += [[]] if is_inside else []
        elif is_inside and table_cells.numbers_of(table_cells.cells_of(line)) and line.strip():
            fields[-1].append((number, line))
        elif line.strip():
            is_inside = False
    if field >= len(fields):
        allowed = {0: "none", 1: "0"}.get(len(fields), f"0 to {len(fields) - 1}")
        raise FileError(f"{file}: there is no field {field} in this listing; allowed: {allowed}")
    names = ("frequency", "mtf_y", "mtf_x")
    checks = [_check_of(name, "") for name in names]
    frequencies, tangential, sagittal = _columns(file, fields[field], names, checks)
    columns: Mapping[str, Column] = {"mtf_x": sagittal, "mtf_y": tangential}
    return MtfTable(file, unit, frequencies, tuple(columns.items()))
