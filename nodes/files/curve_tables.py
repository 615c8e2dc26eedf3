"""Quantities against wavelength or frequency from text: CSV, MODTRAN's output, Zemax' listings.

A tape7, of a run of MODTRAN in the radiance modes (IEMSCT 1 or 2), has a line of names below the
cards of its input, and a line for each wavenumber, ended by ``-9999.``. Read are FREQ in cm⁻¹, TOT
TRANS, and for the path radiance PTH THRML, which includes THRML SCT, and SOL SCAT, which includes
SING SCAT and is blank without the sun; of MODTRAN 6, whose JSON has the columns as lists, THRML_EM,
THRML_SCT, MULT_SCAT and SING_SCAT. They are in W/cm²/sr per cm⁻¹. With λ = 10⁴/ν µm a cm⁻¹ is
λ²/10⁴ µm wide, and a m² has 10⁴ cm²: L_λ = L_ν·10⁸/λ² W/m²/sr/µm. Columns that a mode leaves blank
shift no others: numbers belong to the name they stand under.

Sources: Berk et al. 2011, MODTRAN 5.2 user's manual; Ontar Corporation, "Tape7 column headers".
"""

import json
import math
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from core.errors import FileError, several
from core.records import dataclass
from nodes.files.table_cells import (
    begins_with_number,
    cells_of,
    lens_lines,
    line_refused,
    number_of,
    numbers_of,
    read_once,
    refuse_long_table,
    table_lines,
)

Points = tuple[tuple[float, float], ...]
Row = tuple[float, ...]
Check = tuple[float, float, str]
"""Least and largest number of a column, and what is allowed in words."""
_ABOVE_0 = math.ulp(0.0)
_FINITE = sys.float_info.max
_LARGEST_UM = 1e6
_COLUMNS = (
    "frequency (Hz), horizontal power density (mrad²/Hz) and, if different, vertical power "
    "density (mrad²/Hz)"
)


def _rising(
    file: Path,
    rows: Iterable[tuple[int, Row]],
    checks: Sequence[Check],
    rising: str,
    makes: str,
    what: str = "point",
) -> list[Row]:
    """Two rows or more, each with the number of its line, whose first number rises."""
    table: list[Row] = []
    for number, row in rows:
        for value, (low, high, allowed) in zip(row, checks, strict=False):
            if not low <= value <= high:
                raise line_refused(file, number, allowed)
        if table and row[0] <= table[-1][0]:
            raise line_refused(file, number, rising.format(table[-1][0]))
        table.append(row)
    if len(table) < 2:
        raise FileError(f"{file}: {several(len(table), what)}; a {makes} needs at least 2")
    return table


def _rows_of(
    file: Path, lines: Iterable[str], widths: Sequence[int], allowed: str
) -> Iterator[tuple[int, Row]]:
    """Numbers of each line, all as many as the first, below names and comments, and its own."""
    rows, is_named = 0, False
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        numbers = numbers_of(cell for cell in cells_of(line) if cell.strip())
        # A first line that begins with a number is damaged data, not names.
        if numbers is None and not (rows or is_named or begins_with_number(line)):
            is_named = True
            continue
        if numbers is None or len(numbers) not in widths:
            raise line_refused(file, number, allowed)
        widths, rows = (len(numbers),), rows + 1
        yield number, numbers


@read_once
def read_wavelengths(path: Path, *, what: str, low: float, high: float) -> Points:
    """Points (wavelength in µm, value), rising; `what` the values are is for people."""
    least = _ABOVE_0, f"a wavelength above 0 and up to {_LARGEST_UM:g} µm"
    return _points(path, "wavelength", "µm", least, what, low, high)


@read_once
def read_heights(path: Path, *, unit: str, what: str, low: float, high: float) -> Points:
    """Points (height in the field, value), rising from 0 or above; `unit` is that of heights."""
    against = "angle" if unit == "deg" else "height"
    least = 0.0, f"a non-negative {against} up to {_LARGEST_UM:g} {unit}"
    return _points(path, against, unit, least, what, low, high)


def _points(
    path: Path, against: str, unit: str, least: tuple[float, str], what: str, *ends: float
) -> Points:
    low, high = ends
    columns = f"two columns, {unit} and {what}"
    lines = table_lines(path, what=f"{what} against {against}", wanted=f" of {columns}")
    rows = _rows_of(path, lines, (2,), f"two numbers, {unit} and {what}")
    checks = (
        (least[0], _LARGEST_UM, least[1]),
        (low, high, f"a value of {what} from {low:g} to {high:g}"),
    )
    rising = f"a larger {against} than the previous one, {{:g}} {unit}"
    return tuple((place, value) for place, value in _rising(path, rows, checks, rising, "curve"))


@read_once
def read_motion(path: Path) -> tuple[Points, Points]:
    """Points (Hz, mrad²/Hz) across and along, rising; two columns hold for both axes."""
    lines = table_lines(path, what="power density", wanted=f" with the columns {_COLUMNS}")
    numbers = _rows_of(path, lines, (2, 3), f"two or three numbers: {_COLUMNS}")
    checks = ((_ABOVE_0, _FINITE, "finite numbers above 0"),) * 3
    rising = "a frequency above the previous one, {:g} Hz"
    rows = _rising(path, numbers, checks, rising, "spectrum")
    across = tuple((row[0], row[1]) for row in rows)
    return across, tuple((row[0], row[-1]) for row in rows)


COLUMNS = ("wavelength_um", "transmission", "path_radiance")
_LONGEST_BYTES = 50_000_000
_LARGEST_RADIANCE = 1e30
_ALLOWED = (
    f"a wavelength above 0 and up to {_LARGEST_UM:g} µm, a transmission from 0 to 1, and a path "
    "radiance of at least 0"
)

_NAMES = (
    *("FREQ", "TOT TRANS", "PTH THRML", "THRML SCT", "SURF EMIS", "SOL SCAT", "SING SCAT"),
    *("GRND RFLT", "DRCT RFLT", "TOTAL RAD", "REF SOL", "SOL@OBS", "DEPTH", "DIR EM", "TOA SUN"),
)
_HEADING = re.compile("|".join(name.replace(" ", "[ _]") for name in _NAMES) + r"|\S+")
_EXPONENT = re.compile(r"(?<=[\d.])(?=[-+]\d{3}$)")  # Fortran writes 1E-105 as 1.000-105
# Parts of the path radiance, of which a table has at least the first: MODTRAN 4 and 5, MODTRAN 6.
_PARTS = ("PTH THRML", "SOL SCAT"), ("THRML EM", "THRML SCT", "MULT SCAT", "SING SCAT")
_END = -9999.0
_FARTHEST = 4  # characters between the end of a number and that of its name
_ROUNDED = 1e-4  # by which a transmission written with few digits may exceed 1


@read_once
def read_path_table(path: Path) -> tuple[Points, Points]:
    """Transmission and path radiance (W/m²/sr/µm) against wavelength in µm, rising.

    Of MODTRAN's tape7, or of a CSV file whose first line names the columns ``wavelength_um``,
    ``transmission`` and ``path_radiance``, in any order and among others; without names, these
    three alone. Lines that begin with ``#`` are passed over.
    """
    lines = table_lines(
        path,
        what="a path's transmission",
        wanted=", so neither a tape7 nor a CSV file",
        most_bytes=_LONGEST_BYTES,
    )
    if lines and lines[0].lstrip().startswith("{"):
        lines = _json_table("".join(lines), path)
    return _tape7_points(lines, path) if _is_tape7(lines) else _csv_points(lines, path)


def _json_table(text: str, file: Path) -> list[str]:
    """Of MODTRAN 6's output in JSON, the lines that its tape7 would have."""
    try:
        (case,) = json.loads(text)["MODTRAN"]
        columns = case["MODTRANOUTPUT"]["SPECTRA"]["RADIANCE"]
        wanted = ("FREQ", "TOT_TRANS", *(part.replace(" ", "_") for part in _PARTS[1]))
        names = [name for name in wanted if name in columns]
        rows = zip(*(columns[name] for name in names), strict=True)
        return [" ".join(names), *(" ".join(map(str, row)) for row in rows), f"{_END}"]
    except (ValueError, TypeError, LookupError, RecursionError) as error:
        raise FileError(
            f"{file}: not the JSON output of a single MODTRAN 6 radiance run; that output has "
            "lists of equal length under MODTRAN, MODTRANOUTPUT, SPECTRA, RADIANCE"
        ) from error


def _csv_points(lines: list[str], file: Path) -> tuple[Points, Points]:
    ends = (_ABOVE_0, _LARGEST_UM), (0.0, 1.0), (0.0, _LARGEST_RADIANCE)
    checks = [(low, high, _ALLOWED) for low, high in ends]
    rising = "a wavelength above the previous one, {:g} µm"
    rows = _rising(file, _csv_rows(lines, file), checks, rising, "spectrum")
    return tuple((row[0], row[1]) for row in rows), tuple((row[0], row[2]) for row in rows)


def _csv_rows(lines: list[str], file: Path) -> Iterator[tuple[int, Row]]:
    places: tuple[int, ...] | None = None
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
                raise line_refused(file, number, f"three numbers: {', '.join(COLUMNS)}")
        try:
            yield number, tuple(number_of(cells[index]) for index in places)
        except (ValueError, IndexError):
            raise line_refused(
                file, number, f"numbers in the columns {', '.join(COLUMNS)}"
            ) from None


def _places(cells: list[str], file: Path, number: int) -> tuple[int, ...]:
    names = [cell.lower() for cell in cells]
    for name in COLUMNS:
        if names.count(name) != 1:
            raise FileError(
                f"{file}: line {number}: {names.count(name)} columns are named {name}; allowed: "
                f"one each of {', '.join(COLUMNS)}, or a tape7 with FREQ and TOT TRANS"
            )
    return tuple(names.index(name) for name in COLUMNS)


def _is_tape7(lines: list[str]) -> bool:
    return any(_is_heading(line) for line in lines)


def _tape7_points(lines: list[str], file: Path) -> tuple[Points, Points]:
    start = next(number for number, line in enumerate(lines) if _is_heading(line))
    names = [(_plain(m.group()), m.end()) for m in _HEADING.finditer(lines[start])]
    known = [name for name, _ in names]
    parts = next((parts for parts in _PARTS if parts[0] in known), _PARTS[0])
    needed = ("FREQ", "TOT TRANS", parts[0])
    for name in needed:
        if known.count(name) != 1:
            raise FileError(
                f"{file}: line {start + 1}: {known.count(name)} columns are named {name}; a "
                "radiance tape7 (IEMSCT 1 or 2) has one each of FREQ, TOT TRANS and PTH THRML"
            )
    of_light = "FREQ above 0 and radiance of at least 0"
    checks = (
        (_ABOVE_0, _FINITE, of_light),
        (0.0, 1.0 + _ROUNDED, "TOT TRANS from 0 to 1"),
        (0.0, _FINITE, of_light),
    )
    numbers = (
        (number, (row["FREQ"], row["TOT TRANS"], sum(row.get(name, 0.0) for name in parts)))
        for number, row in _rows(lines, start + 1, names, needed, file)
    )
    rising = "a wavenumber above the previous one"
    rows = _rising(file, numbers, checks, rising, "spectrum", "row")[::-1]
    places = [1e4 / wavenumber for wavenumber, *_ in rows]
    passed = (min(row[1], 1.0) for row in rows)
    added = (row[2] * 1e8 / place**2 for row, place in zip(rows, places, strict=True))
    return tuple(zip(places, passed, strict=True)), tuple(zip(places, added, strict=True))


def _rows(
    lines: list[str], first: int, names: list[tuple[str, int]], needed: tuple[str, ...], file: Path
) -> Iterator[tuple[int, dict[str, float]]]:
    """Line numbers, and values by name, up to the end of the run."""
    for index in range(first, len(lines)):
        if not lines[index].strip():
            continue
        row = _row(lines[index], names)
        if row is None:
            raise line_refused(
                file, index + 1, "numbers, like all rows from the column names to the final -9999."
            )
        if row.get("FREQ") == _END:
            if _is_tape7(lines[index + 1 :]):
                raise FileError(f"{file}: contains several MODTRAN runs; keep one run per file")
            return
        if any(name not in row for name in needed):
            raise line_refused(file, index + 1, ", ".join(needed))
        yield index + 1, row
    raise FileError(f"{file}: ends without -9999.: the run is incomplete")


def _row(line: str, names: list[tuple[str, int]]) -> dict[str, float] | None:
    cells = list(re.finditer(r"\S+", line))
    try:
        values = [number_of(_EXPONENT.sub("E", cell.group())) for cell in cells]
    except ValueError:
        return None
    if values and values[0] == _END:
        return {"FREQ": _END}
    if len(cells) == len(names):
        return dict(zip([name for name, _ in names], values, strict=True))
    row: dict[str, float] = {}
    for cell, value in zip(cells, values, strict=True):
        name, end = min(names, key=lambda one: abs(one[1] - cell.end()))
        if abs(end - cell.end()) > _FARTHEST or name in row:
            return None
        row[name] = value
    return row


def _is_heading(line: str) -> bool:
    words = line.upper().replace("_", " ")
    return "FREQ" in words and "TOT TRANS" in words


def _plain(name: str) -> str:
    return name.upper().replace("_", " ")


Column = tuple[float, ...]
MTF_COLUMNS = ("mtf", "mtf_x", "mtf_y", "radial")
PHASE_COLUMNS = ("phase", "phase_x", "phase_y")
LARGEST_MTF = 2.0  # sharpened pictures exceed 1; percent begin above

_LONGEST_MTF_BYTES = 10_000_000
_LARGEST_FREQUENCY = 1e9
_LARGEST_PHASE = 1e6
_ALIASES = {"spatial_frequency": "frequency", "mtf_radial": "radial"}
_NAME = re.compile(r"([^()\[\]]*)(?:[(\[]([^()\[\]]*)[)\]])?\s*")
_UNITS = {
    "mm": "cyc/mm", "millimeter": "cyc/mm", "mrad": "cyc/mrad", "milliradian": "cyc/mrad",
    "pixel": "cyc/pixel", "px": "cyc/pixel", "pix": "cyc/pixel", "p": "cyc/pixel",
}  # fmt: skip
_CYCLES = ("cyc", "cycles", "cycle", "cy", "c", "lp", "1")
_ZEMAX_HEADING = re.compile(r"\s*spatial frequency\s+tangential\s+sagittal\s*", re.IGNORECASE)
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
    columns: Mapping[str, Column]


@read_once
def read_mtf_table(path: Path, *, field: int = 0) -> MtfTable:
    """Read a CSV table parted by comma, semicolon, tab or blanks, or Zemax's MTF as text.

    Lines that begin with ``#`` are passed over. `field` counts those of a listing of Zemax from 0,
    without the diffraction limit; its tangential column is the MTF along y, as for a field along y.
    """
    refuse_long_table(path, _LONGEST_MTF_BYTES, "MTF against frequency")
    lines = list(enumerate(lens_lines(path, what="frequency and MTF columns"), 1))
    if any(_ZEMAX_HEADING.fullmatch(line) for _, line in lines):
        return _zemax(path, lines, field)
    rows = [(n, line) for n, line in lines if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise FileError(f"{path}: contains no table of MTF against frequency")
    (number, heading), *rows = rows
    names, units = _names(path, number, heading)
    frequencies, *columns = _columns(path, rows, names, units)
    named = dict(zip(names[1:], columns, strict=True))
    for name, unit in zip(names[1:], units[1:], strict=True):
        if unit == "deg":
            named[name] = tuple(map(math.radians, named[name]))
    return MtfTable(path, units[0] or None, frequencies, named)


def unit_of(text: str) -> str | None:
    """A unit of frequency by one of its names, such as ``lp/mm``; None for another."""
    cycles, _, per = text.lower().replace(" per ", "/").replace("_per_", "/").partition("/")
    return _UNITS.get(per.strip()) if cycles.strip() in _CYCLES else None


def _names(file: Path, number: int, line: str) -> tuple[list[str], list[str]]:
    """Names of the columns, frequency first, and their units as far as they are named."""
    names, units = [], []
    for cell in cells_of(line):
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
        raise line_refused(
            file, number,
            "column names: frequency with its unit, then mtf, or mtf_x and mtf_y, or radial; "
            "then, if known, phase, or phase_x and phase_y",
        )  # fmt: skip
    if not set(names) & set(MTF_COLUMNS):
        raise line_refused(file, number, "column names, at least one of them for an MTF")
    for alone, prefix in (("mtf", "mtf_"), ("phase", "phase_")):
        others = [name for name in names if name.startswith(prefix)]
        others += ["radial"] if alone == "mtf" and "radial" in names else []
        if alone in names and others:
            wanted = f"column names with either {alone} or {others[0]}, not both"
            raise line_refused(file, number, wanted)
    if units[0]:
        unit = unit_of(units[0])
        if unit is None:
            raise line_refused(file, number, "a frequency in cyc/mm, cyc/mrad or cyc/pixel")
        units[0] = unit
    for place, name in enumerate(names[1:], 1):
        allowed = ("", "rad", "deg") if name in PHASE_COLUMNS else ("", "1")
        if units[place] not in allowed:
            wanted = "a phase in rad or deg" if name in PHASE_COLUMNS else "an MTF without a unit"
            raise line_refused(file, number, wanted)
    return names, units


def _check_of(name: str, unit: str) -> Check:
    if name == "frequency":
        return 0.0, _LARGEST_FREQUENCY, f"a frequency from 0 to {_LARGEST_FREQUENCY:g}"
    if name in PHASE_COLUMNS:
        what = f"a phase between −{_LARGEST_PHASE:g} and {_LARGEST_PHASE:g} {unit or 'rad'}"
        return -_LARGEST_PHASE, _LARGEST_PHASE, what
    allowed = (
        f"an MTF from 0 to {LARGEST_MTF:g}; write a negative lobe as a phase of π, and divide "
        "percentages by 100"
    )
    return 0.0, LARGEST_MTF, allowed


def _columns(
    file: Path, rows: Sequence[tuple[int, str]], names: Sequence[str], units: Sequence[str]
) -> list[Column]:
    def numbered() -> Iterator[tuple[int, Row]]:
        for number, line in rows:
            numbers = numbers_of(cells_of(line))
            if numbers is None or len(numbers) != len(names):
                wanted = f"{len(names)} numbers: {', '.join(names)}"
                raise line_refused(file, number, wanted)
            yield number, numbers

    checks = [_check_of(*pair) for pair in zip(names, units, strict=True)]
    rising = "a frequency above the previous one, {:g}"
    return list(zip(*_rising(file, numbered(), checks, rising, "curve"), strict=True))


def _zemax(file: Path, lines: Sequence[tuple[int, str]], field: int) -> MtfTable:
    unit: str | None = None
    fields: list[list[tuple[int, str]]] = []
    is_inside = is_limit = False
    for number, line in lines:
        stated = _ZEMAX_UNIT.search(line)
        if stated:
            unit = unit_of(stated[1])
        if line.lower().startswith("field:"):
            is_limit = "diffraction limit" in line.lower()
        if _ZEMAX_HEADING.fullmatch(line):
            # The limit is what the lens would do without its aberrations, and no field of it.
            is_inside = not is_limit
            fields += [[]] if is_inside else []
        elif is_inside and numbers_of(cells_of(line)) and line.strip():
            fields[-1].append((number, line))
        elif line.strip():
            is_inside = False
    if field >= len(fields):
        allowed = {0: "none", 1: "0"}.get(len(fields), f"0 to {len(fields) - 1}")
        raise FileError(f"{file}: there is no field {field} in this listing; allowed: {allowed}")
    names = ("frequency", "mtf_y", "mtf_x")
    frequencies, tangential, sagittal = _columns(file, fields[field], names, ("",) * 3)
    return MtfTable(file, unit, frequencies, {"mtf_x": sagittal, "mtf_y": tangential})
