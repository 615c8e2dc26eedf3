"""Results of a benchmark: tables that the terminal, the JSON file and the page share."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from app.run.readout_tables import columns

Row = Mapping[str, Any]
NONE = "-"


@dataclass(frozen=True)
class Chart:
    """How to draw a table.

    Parameters
    ----------
    x, y : str
        Columns along and up.
    x_label, y_label : str
        What they are, with units.
    label, group : str
        Columns of the words beside the points, and of what has a colour and a name of its own.
    lines : bool
        Whether the points of a group are joined.
    kind : "error", "growth" or "bars"
        Time against error; over the size; or a bar for each row.
    title : str
        In place of the table's.
    where : (column, value), optional
        Which rows are drawn, where not all.
    by_colour : bool
        Words in the colours of their groups, which are not named themselves.
    floor : (value, text), optional
        A line across, and its text: errors below it mean nothing.
    """

    x: str
    y: str
    x_label: str
    y_label: str
    label: str = ""
    group: str = ""
    lines: bool = False
    kind: Literal["error", "growth", "bars"] = "error"
    title: str = ""
    where: tuple[str, Any] | None = None
    by_colour: bool = False
    floor: tuple[float, str] | None = None

    def draws(self, row: Row) -> bool:
        """Whether a row is in the picture."""
        chosen = self.where is None or row.get(self.where[0]) == self.where[1]
        return chosen and all(_is_finite(row.get(name)) for name in (self.x, self.y))


@dataclass(frozen=True)
class Table:
    """Rows of figures and a text on them.

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
    brief : tuple of str
        Columns of its short form; without any it has none.
    brief_where : (column, value), optional
        Rows of the short form, where not all.
    """

    name: str
    title: str
    heads: Mapping[str, str]
    rows: tuple[Row, ...]
    text: str = ""
    chart: Chart | None = None
    brief: tuple[str, ...] = ()
    brief_where: tuple[str, Any] | None = None

    def shortened(self) -> Table | None:
        """The short form, if it has one."""
        if not self.brief:
            return None
        where = self.brief_where
        rows = tuple(row for row in self.rows if where is None or row.get(where[0]) == where[1])
        return replace(self, heads={name: self.heads[name] for name in self.brief}, rows=rows)

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
        short = f"{value:.3g}"
        if 1e3 <= abs(float(short)) < 1e6:
            return f"{float(short):.0f}"
        return "0" if value == 0 else short.replace("e-0", "e-").replace("e+0", "e")
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
        ratio = value / reach
        return f"missed: {ratio:.2f} × reach" if ratio >= 1.005 else f"missed: {ratio:.4f} × reach"
    if aim is None or value <= aim:
        return "met" if aim is None else "met, aim too"
    return f"met; {value / aim:.2f} × aim"


def _is_finite(value: Any) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)
