"""Cells of a line of a table of numbers in text."""

from __future__ import annotations

import csv
import re

_MARKS = ",;\t"


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
        raise ValueError(f"{cell!r} is no number")
    return float(cell)


def begins_with_number(line: str) -> bool:
    """Whether the first cell is a number, so that the line is no line of names."""
    first = re.split(f"[{_MARKS}]", line)[0]
    start = first if first != line else (line.split() or [""])[0]
    try:
        number_of(start.strip().strip('"'))
    except ValueError:
        return False
    return True
