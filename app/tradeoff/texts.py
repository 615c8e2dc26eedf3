"""A trade-off as text: the table of the terminal, CSV and JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from app.run.readout_tables import columns, jsonable, number_text, without_rounding
from app.tradeoff.tradeoff_results import Results, shown_value
from app.tradeoff.values import Variation
from nodes.files.common.table_cells import csv_lines

_GAP = 2  # between columns
_MOST_REASONS = 12


def table(results: Results, width: int | None = None) -> str:
    """Heads of node, name and unit above the values; broken into blocks no wider than `width`."""
    axes = [results.varied, *([results.second] if results.second else [])]
    axis_columns = [_axis_column(axis, results, number) for number, axis in enumerate(axes)]
    others = [
        [
            *(figure.node, figure.name, figure.unit),
            *(_cell(point.figures.get(figure.text), figure.unit) for _, point in results.rows()),
        ]
        for figure in results.figures
    ]
    blocks = []
    while others:
        block = [*axis_columns]
        while others and (len(block) == len(axis_columns) or _fits([*block, others[0]], width)):
            block.append(others.pop(0))
        rows = list(zip(*block, strict=True))
        blocks.append(columns(rows, right=range(len(block))))
    return "\n\n".join(blocks)


def failures(results: Results) -> list[str]:
    """One line for each place that has no figure, and why; of many, the first."""
    lines = [f"{place}: {reason}" for place, reason in results.failures()]
    if len(lines) > _MOST_REASONS:
        lines[_MOST_REASONS - 1 :] = [f"and {len(lines) - _MOST_REASONS + 1} more gaps"]
    return lines


def csv_text(results: Results) -> str:
    """A row for each point in full precision; what is not there is empty, its reason at the end.

    Behind it the warnings.
    """
    heads = [
        results.varied.text,
        *([results.second.text] if results.second else []),
        *(figure.text for figure in results.figures),
        "failed",
        "warnings",
    ]
    lines: list[list[Any]] = [heads]
    for curve, point in results.rows():
        values = [point.value, *([curve.second] if results.second else [])]
        values += [point.figures.get(figure.text) for figure in results.figures]
        reasons = dict.fromkeys(
            point.reasons[f.text] for f in results.figures if f.text in point.reasons
        )
        notes = ("; ".join(reasons), "; ".join(point.warnings))
        lines.append([*(_exact(value) for value in values), *notes])
    return csv_lines(lines)


def json_text(results: Results) -> str:
    """All that is known, for programs."""
    figures = [figure.text for figure in results.figures]
    facts = {
        "network": results.network,
        "vary": [_variation(axis) for axis in (results.varied, results.second) if axis is not None],
        "present": results.present,
        "figures": [
            {"name": figure.text, "unit": figure.unit, "meaning": figure.meaning}
            for figure in results.figures
        ],
        "curves": [
            {
                **({"second": curve.second} if results.second is not None else {}),
                "points": [
                    {
                        "value": point.value,
                        "figures": {name: point.figures.get(name) for name in figures},
                        "failed": {n: r for n, r in point.reasons.items() if n in figures},
                        "warnings": list(point.warnings),
                    }
                    for point in curve.points
                ],
            }
            for curve in results.curves
        ],
    }
    return json.dumps(jsonable(facts), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _variation(varied: Variation) -> dict[str, Any]:
    return {"parameter": varied.text, "unit": varied.unit, "values": varied.values}


def _axis_column(axis: Variation, results: Results, number: int) -> list[str]:
    values = [(point.value, curve.second)[number] for curve, point in results.rows()]
    return [
        *(axis.node, axis.parameter.name, axis.unit),
        *(shown_value(value) for value in values),
    ]


def _cell(value: float | None, unit: str) -> str:
    return number_text(without_rounding(value, unit))


def _fits(block: Sequence[Sequence[str]], width: int | None) -> bool:
    if width is None:
        return True
    return sum(max(map(len, column)) + _GAP for column in block) - _GAP <= width


def _exact(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else value
