"""Tables of numbers in text: cells, lines, and rows of numbers below a line of names."""

import codecs
import csv
import io
import re
from collections.abc import Callable, Iterable
from functools import lru_cache, wraps
from itertools import zip_longest
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, TypeVar

from core.errors import FileError

P = ParamSpec("P")
T = TypeVar("T")

_MARKS = ",;\t"
_WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_FILES_REMEMBERED = 32
_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what a formula begins with


def csv_lines(rows: Iterable[Iterable[Any]]) -> str:
    """Rows as CSV, in which a spreadsheet takes no text for a formula."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([text_cell(cell) for cell in row] for row in rows)
    return text.getvalue()


def csv_columns(columns: Iterable[tuple[str, Iterable[Any]]]) -> str:
    """Columns below their names as CSV; the cells that a shorter one lacks are empty."""
    columns = list(columns)
    cells = zip_longest(*(values for _, values in columns))
    return csv_lines([[name for name, _ in columns], *cells])


def csv_figures(rows: Iterable[Iterable[Any]]) -> str:
    """Figures as CSV: name, value, unit and meaning of each."""
    return csv_lines([("name", "value", "unit", "meaning"), *rows])


def text_cell(cell: Any) -> Any:
    """A cell that a spreadsheet would run as a formula behind an apostrophe, others as they are.

    Source: OWASP, CSV Injection.
    """
    if not isinstance(cell, str) or not cell.startswith(_FORMULA):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


def plain_cell(cell: str) -> str:
    return cell[1:] if cell.startswith("'") and cell[1:].startswith(_FORMULA) else cell


def cells_of(line: str) -> list[str]:
    """Cells parted by the first of comma, semicolon, tab, blanks; one if it is no row."""
    separator = next((mark for mark in _MARKS if mark in line), None)
    if separator is None:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator))
    except csv.Error:  # a cell longer than any number
        return [line]


def number_of(cell: str) -> float:
    """The number that a cell is, else `ValueError`: 0_6, 6 in Python, is a slip for 0.6."""
    if "_" in cell or not cell.isascii():
        raise ValueError("is not a number")
    return float(cell)


def line_refused(file: Path, number: int, allowed: str) -> FileError:
    """The fault of a line, which is not quoted: the file may be any that the user can read."""
    return FileError(f"{file}: line {number}: must contain {allowed}")


def begins_with_number(line: str) -> bool:
    first = re.split(f"[{_MARKS}]", line)[0]
    start = first if first != line else (line.split() or [""])[0]
    try:
        number_of(start.strip().strip('"'))
    except ValueError:
        return False
    return True


def read_once(read: Callable[Concatenate[Path, P], T]) -> Callable[Concatenate[Path, P], T]:
    """Read a file again only once its length or time of change is another."""

    @lru_cache(maxsize=_FILES_REMEMBERED)
    def read_state(file: Path, _state: tuple[int, int], *args: P.args, **kwargs: P.kwargs) -> T:
        return read(file, *args, **kwargs)

    @wraps(read)
    def read_path(path: Path, /, *args: P.args, **kwargs: P.kwargs) -> T:
        # What only writes CSV need not load numpy.
        from nodes.files.stored_bytes import readable_file

        file = readable_file(path.absolute())
        status = file.stat()
        state = (status.st_size, status.st_mtime_ns)
        return read_state(file, state, *args, **kwargs)  # type: ignore[arg-type]

    return read_path


def refuse_long_table(file: Path, most_bytes: int, what: str) -> None:
    length = file.stat().st_size
    if length > most_bytes:
        raise FileError(
            f"{file}: {length} bytes; a table of {what} may have at most {most_bytes} bytes"
        )


def table_lines(file: Path, *, what: str, wanted: str, most_bytes: int = 10_000_000) -> list[str]:
    refuse_long_table(file, most_bytes, what)
    try:
        return file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{file}: not a text file{wanted}") from error


def numbers_of(cells: Iterable[str]) -> tuple[float, ...] | None:
    try:
        return tuple(map(number_of, cells))
    except ValueError:
        return None


def lens_lines(path: Path, *, what: str) -> list[str]:
    """Lines of a text of optical programs: UTF-8, UTF-16 with its mark or without, Latin-1."""
    from nodes.files.picture_info import refuse_oversized_text

    refuse_oversized_text(path)
    try:
        text = _decoded(path.read_bytes())
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{path}: not a text file with {what}") from error
    if any(ord(sign) < 32 and sign not in "\t\n\r\f\x1a" for sign in text):
        raise FileError(f"{path}: not a text file with {what}")
    return text.rstrip("\x1a").splitlines()


def _decoded(content: bytes) -> str:
    if content.startswith(_WIDE):
        return content.decode("utf-16")
    if content[1:2] == b"\0" and content[3:4] in (b"\0", b""):
        return content.decode("utf-16-le")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # µ of older programs; whatever is no text shows by its control characters.
        return content.decode("latin-1")
