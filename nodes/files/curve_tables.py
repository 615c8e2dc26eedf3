"""Quantities against wavelength or frequency from text: CSV files, and MODTRAN's output.

Columns are parted by comma, semicolon, tab or blanks; lines that begin with ``#`` and a first line
of names are passed over. The transmission and path radiance of a path come from a CSV of three
columns, a tape7, or MODTRAN 6's JSON.

A tape7 is MODTRAN's spectral output. A run in the radiance modes (IEMSCT 1 or 2) writes, below the
cards of its input, a line of names::

    FREQ   TOT TRANS  PTH THRML  THRML SCT  SURF EMIS   SOL SCAT  SING SCAT  GRND RFLT  …  TOTAL RAD

and a line for each wavenumber, ended by ``-9999.``; newer versions write TOT_TRANS and so on. Four
of the columns are read, by their names:

- ``FREQ``, wavenumber in cm⁻¹;
- ``TOT TRANS``, transmission of the whole path;
- ``PTH THRML``, emitted by the path and scattered into it, which includes THRML SCT;
- ``SOL SCAT``, sunlight scattered into it, which includes SING SCAT and is blank without the sun.

The last two together are the path radiance; what the surface emits and reflects is left to the
picture. They are in W/cm²/sr per cm⁻¹. With λ = 10⁴/ν µm a cm⁻¹ is λ²/10⁴ µm wide, and a m² has
10⁴ cm²: L_λ = L_ν·10⁸/λ² W/m²/sr/µm. Columns that a mode leaves blank shift no others: numbers
belong to the name they stand under.

MODTRAN 6 writes four parts of the path radiance, emission and scattering apart: THRML_EM,
THRML_SCT, MULT_SCAT, SING_SCAT. Its JSON output has the columns as lists below MODTRAN,
MODTRANOUTPUT, SPECTRA, RADIANCE.

Sources: Berk et al. 2011, MODTRAN 5.2 user's manual; the headings and what they include, Ontar
Corporation, "Tape7 column headers".
"""

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from core.errors import FileError, several
from core.records import dataclass
from nodes.files import table_cells

Points = tuple[tuple[float, float], ...]
_LARGEST_UM = 1e6
_COLUMNS = (
    "frequency (Hz), horizontal power density (mrad²/Hz) and, if different, vertical power "
    "density (mrad²/Hz)"
)


@table_cells.read_once
def read_wavelengths(path: Path, *, what: str, low: float, high: float) -> Points:
    """Points (wavelength in µm, value), rising in wavelength; values from `low` to `high`.

    `what` the values are is for people.
    """
    least = math.ulp(0.0), f"a wavelength above 0 and up to {_LARGEST_UM:g} µm"
    return _points(path, "wavelength", "µm", least, what, low, high)


@table_cells.read_once
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
    lines = table_cells.table_lines(path, what=f"{what} against {against}", wanted=f" of {columns}")
    points: list[tuple[float, float]] = []
    allowed = f"two numbers, {unit} and {what}"
    for number, (place, value) in table_cells.point_rows(path, lines, (2,), allowed, makes="curve"):
        if not least[0] <= place <= _LARGEST_UM:
            raise table_cells.line_refused(path, number, least[1])
        if not (math.isfinite(value) and low <= value <= high):
            raise table_cells.line_refused(
                path, number, f"a value of {what} from {low:g} to {high:g}"
            )
        if points and place <= points[-1][0]:
            allowed = f"a larger {against} than the previous one, {points[-1][0]:g} {unit}"
            raise table_cells.line_refused(path, number, allowed)
        points.append((place, value))
    return tuple(points)


@table_cells.read_once
def read_motion(path: Path) -> tuple[Points, Points]:
    """Points (Hz, mrad²/Hz) of a motion across and along, rising in frequency.

    Two columns hold for both axes.
    """
    lines = table_cells.table_lines(
        path, what="power density", wanted=f" with the columns {_COLUMNS}"
    )
    rows: list[tuple[float, ...]] = []
    allowed = f"two or three numbers: {_COLUMNS}"
    for number, row in table_cells.point_rows(path, lines, (2, 3), allowed, makes="spectrum"):
        if not all(0.0 < value < math.inf for value in row):
            raise table_cells.line_refused(path, number, "finite numbers above 0")
        if rows and row[0] <= rows[-1][0]:
            raise table_cells.line_refused(
                path, number, f"a frequency above the previous one, {rows[-1][0]:g} Hz"
            )
        rows.append(row)
    across = tuple((row[0], row[1]) for row in rows)
    return across, tuple((row[0], row[-1]) for row in rows)


# Transmission and path radiance of a path.

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


@table_cells.read_once
def read_path_table(path: Path) -> tuple[Points, Points]:
    """Transmission and path radiance (W/m²/sr/µm) against wavelength in µm, rising.

    Of MODTRAN's tape7, or of a CSV file whose first line names the columns ``wavelength_um``,
    ``transmission`` and ``path_radiance``, in any order and among others; without names, these
    three alone. Lines that begin with ``#`` are passed over.
    """
    lines = table_cells.table_lines(
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
    places: tuple[int, ...] | None = None
    rows: list[tuple[float, ...]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = [cell.strip() for cell in table_cells.cells_of(line)]
        if places is None and not table_cells.begins_with_number(line):
            places = _places(cells, file, number)
            continue
        if places is None:
            places = (0, 1, 2)
            if len(cells) != len(COLUMNS):
                raise table_cells.line_refused(file, number, f"three numbers: {', '.join(COLUMNS)}")
        try:
            place, passed, added = (table_cells.number_of(cells[index]) for index in places)
        except (ValueError, IndexError):
            raise table_cells.line_refused(
                file, number, f"numbers in the columns {', '.join(COLUMNS)}"
            ) from None
        if not (0.0 < place <= _LARGEST_UM and 0.0 <= passed <= 1.0):
            raise table_cells.line_refused(file, number, _ALLOWED)
        if not (0.0 <= added <= _LARGEST_RADIANCE and math.isfinite(added)):
            raise table_cells.line_refused(file, number, _ALLOWED)
        if rows and place <= rows[-1][0]:
            allowed = f"a wavelength above the previous one, {rows[-1][0]:g} µm"
            raise table_cells.line_refused(file, number, allowed)
        rows.append((place, passed, added))
    if len(rows) < 2:
        raise FileError(f"{file}: {several(len(rows), 'point')}; a spectrum needs at least 2")
    return tuple((row[0], row[1]) for row in rows), tuple((row[0], row[2]) for row in rows)


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
    transmission: list[tuple[float, float]] = []
    radiance: list[tuple[float, float]] = []
    for number, row in _rows(lines, start + 1, names, needed, file):
        wavenumber, passed = row["FREQ"], row["TOT TRANS"]
        added = sum(row.get(name, 0.0) for name in parts)
        if not 0.0 <= passed <= 1.0 + _ROUNDED:
            raise table_cells.line_refused(file, number, "TOT TRANS from 0 to 1")
        if not (wavenumber > 0.0 and 0.0 <= added < math.inf):
            raise table_cells.line_refused(file, number, "FREQ above 0 and radiance of at least 0")
        wavelength = 1e4 / wavenumber
        if transmission and not wavenumber > 1e4 / transmission[-1][0]:
            raise table_cells.line_refused(file, number, "a wavenumber above the previous one")
        transmission.append((wavelength, min(passed, 1.0)))
        radiance.append((wavelength, added * 1e8 / wavelength**2))
    if len(transmission) < 2:
        raise FileError(f"{file}: {several(len(transmission), 'row')}; a spectrum needs at least 2")
    return tuple(reversed(transmission)), tuple(reversed(radiance))


def _rows(
    lines: list[str], first: int, names: list[tuple[str, int]], needed: tuple[str, ...], file: Path
) -> Iterator[tuple[int, dict[str, float]]]:
    """Line numbers, and values by name, up to the end of the run."""
    for index in range(first, len(lines)):
        if not lines[index].strip():
            continue
        row = _row(lines[index], names)
        if row is None:
            raise table_cells.line_refused(
                file, index + 1, "numbers, like all rows from the column names to the final -9999."
            )
        if row.get("FREQ") == _END:
            if _is_tape7(lines[index + 1 :]):
                raise FileError(f"{file}: contains several MODTRAN runs; keep one run per file")
            return
        if any(name not in row for name in needed):
            raise table_cells.line_refused(file, index + 1, ", ".join(needed))
        yield index + 1, row
    raise FileError(f"{file}: ends without -9999.: the run is incomplete")


def _row(line: str, names: list[tuple[str, int]]) -> dict[str, float] | None:
    """Values by name; None for a line that is no row."""
    cells = list(re.finditer(r"\S+", line))
    try:
        values = [table_cells.number_of(_EXPONENT.sub("E", cell.group())) for cell in cells]
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
    columns: tuple[tuple[str, Column], ...]

    def column(self, name: str) -> Column | None:
        return dict(self.columns).get(name)


@table_cells.read_once
def read_mtf_table(path: Path, *, field: int = 0) -> MtfTable:
    """Read a CSV table parted by comma, semicolon, tab or blanks, or Zemax's MTF as text.

    Lines that begin with ``#`` are passed over. `field` counts those of a listing of Zemax from 0,
    without the diffraction limit; its tangential column is the MTF along y, as for a field along y.
    """
    table_cells.refuse_long_table(path, _LONGEST_MTF_BYTES, "MTF against frequency")
    lines = list(enumerate(table_cells.lens_lines(path, what="frequency and MTF columns"), 1))
    if any(_ZEMAX_HEADING.fullmatch(line) for _, line in lines):
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
        if _ZEMAX_HEADING.fullmatch(line):
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
