"""Pictures of tables: time against error, and curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from app.bench.tables import Row, Table, figure_text
from app.report.drawing import COLOURS, figure

# No error at all has no place on a logarithmic axis: it is drawn at double precision's rounding.
LEAST = 1e-16
MARKS = "osD^vPX"


def chart_png(table: Table) -> bytes | None:
    """The table's picture; None where it has none, or nothing was measured."""
    chart = table.chart
    if chart is None:
        return None
    rows = [row for row in table.rows if _is_number(row.get(chart.x), row.get(chart.y))]
    if not rows:
        return None
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        groups.setdefault(row[chart.group] if chart.group else "", []).append(row)
    with figure(8.2, 4.4 + 0.22 * -(-len(groups) // 3)) as (drawn, out):
        axis = drawn.subplots()
        for number, (group, members) in enumerate(groups.items()):
            x = [float(row[chart.x]) for row in members]
            y = [max(float(row[chart.y]), LEAST) for row in members]
            axis.plot(
                x,
                y,
                marker=MARKS[number % len(MARKS)],
                color=COLOURS[number % len(COLOURS)],
                ms=5.5,
                ls="-" if chart.lines else "none",
                lw=1.1,
                label=figure_text(group) if chart.group else None,
            )
            if chart.label:
                _name(axis, x, y, [row.get(chart.label) for row in members])
        axis.set_xscale("log", base=2 if chart.x == "size" else 10)
        if not (chart.lines and chart.x == "size"):
            axis.set_yscale("log")
        else:
            axis.set_ylim(bottom=0)
            axis.set_xticks([row["size"] for row in rows], [f"{row['size']}²" for row in rows])
        axis.margins(x=0.14, y=0.12)
        axis.set_xlabel(chart.x_label)
        axis.set_ylabel(chart.y_label)
        if chart.group:
            drawn.legend(loc="outside lower center", ncols=3, fontsize=8.5)
    return out.getvalue()


def _is_number(*values: Any) -> bool:
    return all(isinstance(value, int | float) and math.isfinite(value) for value in values)


def _name(axis: Any, x: Sequence[float], y: Sequence[float], names: Sequence[Any]) -> None:
    for place, name in zip(zip(x, y, strict=True), names, strict=True):
        if name is None:
            continue
        axis.annotate(
            figure_text(name),
            place,
            xytext=(5, 4),
            textcoords="offset points",
            fontsize=7.5,
            color="#444444",
        )
