"""Cells of a line of a table of numbers in text."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from core.errors import FileError

_MARKS = ",;\t"
_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what a formula begins with


def csv_lines(rows: Iterable[Iterable[Any]]) -> str:
    """Rows as CSV, in which a spreadsheet takes no text for a formula."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([text_cell(cell) for cell in row] for row in rows)
    return text.getvalue()


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
    """What `text_cell` made a cell of."""
    return cell[1:] if cell.startswith("'") and cell[1:].startswith(_FORMULA) else cell


def cells_of(line: str) -> list[str]:
    """Cells of a line, parted by comma, semicolon, tab or blanks: the first of these in it.

    A line that is no row of such a table is one cell.
    """
    separator = next((mark for mark in _MARKS if mark in line), None)
    if separator is None:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator))
    except csv.Error:  # a cell longer than any number
        return [line]


def number_of(cell: str) -> float:
    """The number that a cell is.

    Raises
    ------
    ValueError
        It is none, or in Python's own writing alone: 0_6 is 6 there, and a slip for 0.6 in a table.
    """
    if "_" in cell or not cell.isascii():
        raise ValueError("is no number")
    return float(cell)


def line_refused(file: Path, number: int, allowed: str) -> FileError:
    """The fault of a line, which is not quoted: the file may be any that the user can read."""
    return FileError(f"{file}: line {number}: must be {allowed}")


def begins_with_number(line: str) -> bool:
    """Whether the first cell is a number, so that the line is no line of names."""
    first = re.split(f"[{_MARKS}]", line)[0]
    start = first if first != line else (line.split() or [""])[0]
    try:
        number_of(start.strip().strip('"'))
    except ValueError:
        return False
    return True
