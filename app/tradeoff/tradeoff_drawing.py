"""A trade-off as a picture: each figure in a panel of its own, over the same abscissa."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from app.report.drawing.picture_drawing import (
    by_rows,
    family_colours,
    figure,
    legend_columns,
    legend_height_in,
    number,
)
from app.report.html_page import Block, Drawn, Grid, Heading, html_page
from app.run.readout_tables import columns, exact, number_text, without_rounding
from app.tradeoff.tradeoff_figures import Figure
from app.tradeoff.tradeoff_results import Results, shown_value
from app.tradeoff.values import Variation, is_number
from nodes.files.common.table_cells import csv_lines

_ACROSS = 3
_LOG_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
_LONGEST = 28  # letters of a line of a title
_FAILED = "#b3261e"
_MOST_MARKED = 40  # points that still stand apart


def trade_off_png(results: Results) -> bytes:
    """The picture; gaps where figures have no value, a dashed line at the present value."""
    across = min(_ACROSS, len(results.figures))
    down = -(-len(results.figures) // across)
    width = max(4.6, 3.4 * across)
    names = [shown_value(curve.second) for curve in results.curves if results.second is not None]
    legend = legend_height_in(names, width) if names else 0.0
    with figure(width, 2.3 * down + 0.3 + legend) as (drawn, out):
        axes = drawn.subplots(down, across, squeeze=False, sharex=True).ravel()
        for place, axis in enumerate(axes):
            if place >= len(results.figures):
                axis.set_visible(False)
                continue
            _panel(axis, results, results.figures[place])
            if place + across >= len(results.figures):
                axis.tick_params(labelbottom=True)
                axis.set_xlabel(_with_unit(results.varied.text, results.varied.unit))
        if results.second is not None:
            title = _with_unit(results.second.text, results.second.unit)
            handles = [line for line in axes[0].get_lines() if line.get_label()[0] != "_"]
            columns_ = legend_columns(names, width)
            drawn.legend(
                handles=by_rows(handles, columns_),
                loc="outside lower center",
                ncols=columns_,
                title=title,
                fontsize=8.5,
            )
    return out.getvalue()


def _panel(axis: Any, results: Results, shown: Figure) -> None:
    values = results.varied.values
    numeric = results.varied.is_numeric
    places = list(values) if numeric else list(range(len(values)))
    axis.set_title(f"{_short(shown.node)}\n{_short(shown.name)}", fontsize=8.5)
    if shown.unit:
        axis.set_ylabel(shown.unit, fontsize=8.5)
    finite = []
    colours = family_colours(len(results.curves))
    for colour, curve in zip(colours, results.curves, strict=True):
        heights = [point.figures.get(shown.text, math.nan) for point in curve.points]
        heights = [height if math.isfinite(height) else math.nan for height in heights]
        finite += [height for height in heights if not math.isnan(height)]
        label = "_" if results.second is None else shown_value(curve.second)
        style = "-" if numeric else ":"
        marker = "o" if len(places) <= _MOST_MARKED or not numeric else ""
        gaps = [place for place, height in zip(places, heights, strict=True) if math.isnan(height)]
        if gaps:  # at the bottom, so that the axis reaches the values that failed too
            low = axis.get_xaxis_transform()
            axis.plot(gaps, [0.0] * len(gaps), "x", transform=low, color=_FAILED, clip_on=False)
        axis.plot(places, heights, style, marker=marker, markersize=3, color=colour, label=label)
    if not numeric:
        axis.set_xticks(places, [shown_value(value) for value in values])
        axis.margins(x=0.12)
    elif results.varied.log:
        axis.set_xscale("log")
    else:
        axis.ticklabel_format(axis="x", scilimits=(-3, 4), useMathText=True, useOffset=False)
    if finite and min(finite) > 0 and max(finite) > _LOG_FROM * min(finite):
        axis.set_yscale("log")
    elif finite and max(finite) - min(finite) <= 1e-9 * max(map(abs, finite)):
        _level(axis, finite[0])
    else:
        axis.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True, useOffset=False)
    _mark_present(axis, results)


def _level(axis: Any, height: float) -> None:
    """A figure that does not move: its value in words, not rounding blown up to the full height."""
    reach = 0.1 * abs(height) or 1.0
    axis.set_ylim(height - reach, height + reach)
    axis.set_yticks([height], [number(float(f"{height:.4g}"))])


def _mark_present(axis: Any, results: Results) -> None:
    value = results.present
    if not (results.varied.is_numeric and is_number(value)):
        return
    if min(results.varied.values) <= value <= max(results.varied.values):
        axis.axvline(value, color="#555555", linewidth=0.9, linestyle="--", zorder=1)


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def _with_unit(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


# A trade-off as a page that needs no other file.


def page(results: Results) -> str:
    title = f"{results.network or 'Image chain'}: trade-off"
    caption = f"Figures of merit against {results.varied.text}"
    caption += f", a curve for each {results.second.text}." if results.second else "."
    if results.present is not None:
        present = shown_value(results.present, results.varied.unit)
        caption += f" The value in the network is {present}"
        caption += " (dashed line)." if results.varied.is_numeric else "."
    if results.failures():
        caption += (
            " A cross marks a value at which the figure could not be computed; see the gaps below."
        )
    blocks = [
        Heading(1, title),
        Drawn(trade_off_png(results), caption, caption),
        Heading(2, "Figures"),
        Grid(
            ("figure", "unit", "meaning"),
            [(figure.text, figure.unit, figure.meaning) for figure in results.figures],
        ),
        Heading(2, "Values"),
        _values(results),
        *_listed("Gaps", results.failures()),
        *_listed("Warnings", results.warnings()),
    ]
    return html_page(title, blocks)


def _values(results: Results) -> Block:
    heads = [_with_unit(shown.text, shown.unit) for shown in _shown(results)]
    rows = []
    for curve, point in results.rows():
        cells = [shown_value(point.value), *([shown_value(curve.second)] if results.second else [])]
        rows.append([*cells, *(number(point.figures.get(f.text), f.unit) for f in results.figures)])
    return Grid(heads, rows, numbers=range(len(heads)))


def _shown(results: Results) -> list[Variation | Figure]:
    return [*results.axes, *results.figures]


def _listed(title: str, lines: list[tuple[str, str]]) -> list[Block]:
    return [Heading(2, title), Grid(("where", "why"), lines)] if lines else []


# A trade-off as text: the table of the terminal, CSV and JSON.

_GAP = 2  # between columns
_MOST_REASONS = 12


def table(results: Results, width: int | None = None) -> str:
    """Heads of node, name and unit above the values; broken into blocks no wider than `width`."""
    axis_columns = [_axis_column(axis, results, place) for place, axis in enumerate(results.axes)]
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
    lines = [f"{place}: {reason}" for place, reason in results.failures()]
    if len(lines) > _MOST_REASONS:
        lines[_MOST_REASONS - 1 :] = [f"and {len(lines) - _MOST_REASONS + 1} more gaps"]
    return lines


def csv_text(results: Results) -> str:
    """A row for each point in full precision; gaps are empty, reasons and warnings at the end."""
    names = [shown.text for shown in _shown(results)]
    lines: list[list[Any]] = [[*names, "failed", "warnings"]]
    for curve, point in results.rows():
        values = [point.value, *([curve.second] if results.second else [])]
        values += [point.figures.get(figure.text) for figure in results.figures]
        reasons = dict.fromkeys(
            point.reasons[f.text] for f in results.figures if f.text in point.reasons
        )
        notes = ("; ".join(reasons), "; ".join(point.warnings))
        lines.append([*(exact(value) for value in values), *notes])
    return csv_lines(lines)


def trade_off_facts(results: Results) -> dict[str, Any]:
    figures = [figure.text for figure in results.figures]
    return {
        "network": results.network,
        "vary": [
            {"parameter": axis.text, "unit": axis.unit, "values": axis.values}
            for axis in results.axes
        ],
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


def _axis_column(axis: Variation, results: Results, number: int) -> list[str]:
    values = [(point.value, curve.second)[number] for curve, point in results.rows()]
    return [*(axis.node, axis.parameter.name, axis.unit), *(shown_value(value) for value in values)]


def _cell(value: float | None, unit: str) -> str:
    return number_text(without_rounding(value, unit))


def _fits(block: Sequence[Sequence[str]], width: int | None) -> bool:
    if width is None:
        return True
    return sum(max(map(len, column)) + _GAP for column in block) - _GAP <= width
