"""Results of a benchmark: tables that the terminal, the JSON file and the page share."""

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.run.readout_tables import columns

Row = Mapping[str, Any]
NONE = "-"
T0_HEADS = {"t0": "T0", "ms": "ms"}


@dataclass(frozen=True)
class Chart:
    """How to draw a table: its columns ``t0`` and ``error``, or a bar for each row in T0.

    `error` says what the error is, without it bars are drawn; `label` and `group` are columns of
    the words beside the points and of what has a colour, and a line if `lines`, of its own; `where`
    chooses rows by a column's value; `by_colour` writes the words in colour and names no group.
    """

    error: str = ""
    label: str = ""
    group: str = ""
    lines: bool = True
    title: str = ""
    where: tuple[str, Any] | None = None
    by_colour: bool = False

    def draws(self, row: Row) -> bool:
        values = (row.get(name) for name in (("t0", "error") if self.error else ("value", "ms")))
        finite = all(isinstance(one, int | float) and math.isfinite(one) for one in values)
        return finite and (self.where is None or row.get(self.where[0]) == self.where[1])


@dataclass(frozen=True)
class Table:
    """Rows of figures by column, and a text on them: for a choice, its default and why."""

    name: str
    title: str
    heads: Mapping[str, str]
    rows: Sequence[Row]
    text: str = ""
    chart: Chart | None = None

    def facts(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "title": self.title,
            "columns": dict(self.heads),
            "rows": [dict(row) for row in self.rows],
            "text": self.text,
        }

    def cells(self) -> list[list[str]]:
        return [[figure_text(row.get(name)) for name in self.heads] for row in self.rows]

    def numeric(self) -> list[int]:
        return [
            index
            for index, name in enumerate(self.heads)
            if any(isinstance(row.get(name), int | float) for row in self.rows)
        ]

    def terminal(self) -> str:
        rows = [list(self.heads.values()), *self.cells()]
        lines = [self.title, columns(rows, right=self.numeric())]
        return "\n".join([*lines, *([textwrap.fill(self.text, 100)] if self.text else [])])


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


def verdict(value: float, reach: float | None, aim: float | None = None) -> str:
    if reach is None:
        return ""
    if value > reach:
        ratio = value / reach
        return f"missed: {ratio:.2f} × limit" if ratio >= 1.005 else f"missed: {ratio:.4f} × limit"
    if aim is None or value <= aim:
        return "met" if aim is None else "met, target too"
    return f"met; {value / aim:.2f} × target"


def judged(value: float, reach: float | None, aim: float | None = None) -> dict[str, Any]:
    return {"reach": reach, "aim": aim, "verdict": verdict(value, reach, aim)}
