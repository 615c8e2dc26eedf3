"""Results of a benchmark: tables that the terminal, the JSON file and the page share."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from app.tables import columns

Row = Mapping[str, Any]
NONE = "-"


@dataclass(frozen=True)
class Chart:
    """How to draw a table: names of the columns along, up, beside the points and of one colour."""

    x: str
    y: str
    x_label: str
    y_label: str
    label: str = ""
    group: str = ""
    lines: bool = False


@dataclass(frozen=True)
class Table:
    """Rows of figures and what they say.

    Parameters
    ----------
    name, title : str
        For programs and for people.
    heads : mapping of column to its head
        Columns in order; rows may hold more, for the JSON file.
    rows : tuple of mapping
        Plain values by column; a missing one is none.
    text : str
        What it shows: for a choice, its default and why.
    chart : Chart, optional
        Its picture.
    """

    name: str
    title: str
    heads: Mapping[str, str]
    rows: tuple[Row, ...]
    text: str = ""
    chart: Chart | None = None

    def facts(self) -> dict[str, Any]:
        """For the JSON file."""
        return {
            "name": self.name,
            "title": self.title,
            "columns": dict(self.heads),
            "rows": [dict(row) for row in self.rows],
            "text": self.text,
        }

    def cells(self) -> list[list[str]]:
        """Rows as texts."""
        return [[figure_text(row.get(name)) for name in self.heads] for row in self.rows]

    def numeric(self) -> list[int]:
        """Indices of the columns that hold numbers."""
        return [
            index
            for index, name in enumerate(self.heads)
            if any(isinstance(row.get(name), int | float) for row in self.rows)
        ]


def figure_text(value: Any) -> str:
    """A measured figure in three digits: more would be noise."""
    if value is None:
        return NONE
    if isinstance(value, float):
        return "0" if value == 0 else f"{value:.3g}".replace("e-0", "e-").replace("e+0", "e+")
    return str(value)


def terminal_text(table: Table) -> str:
    """The table and its sentence for a terminal."""
    rows = [list(table.heads.values()), *table.cells()]
    lines = [table.title, columns(rows, right=table.numeric())]
    if table.text:
        lines.append(textwrap.fill(table.text, 100))
    return "\n".join(lines)


def verdict(value: float, reach: float | None, aim: float | None) -> str:
    """Whether a figure meets its targets, and by what factor it misses them."""
    if reach is None:
        return ""
    if value > reach:
        return f"missed: {value / reach:.2f} × reach"
    if aim is None or value <= aim:
        return "met" if aim is None else "met, aim too"
    return f"met; {value / aim:.2f} × aim"
