"""A study as a picture: curves of one parameter, heat maps of two, scatter plots of more."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.report.drawing.picture_drawing import (
    COLOURS,
    by_rows,
    family_colours,
    figure,
    legend_columns,
    legend_height_in,
    number,
)
from app.report.html_page import Block, Drawn, Grid, Heading, html_page
from app.run.readout_tables import number_text, warned_points
from app.study.study_points import Axis
from app.study.study_request import StudyRows
from app.tradeoff.tradeoff_figures import Figure
from app.tradeoff.tradeoff_results import ROUNDING, shown_value
from core.atomic import write_bytes, write_text
from core.names import printable
from nodes.files.formats import PNG

MOST_FIGURES, MOST_ACROSS = 12, 8
"""Figures and parameters that are drawn; more could not be read."""
_ACROSS = 3
_MOST_CURVES, _MOST_NAMES = 8, 12
_LOG_FROM = 100.0
_FAILED = "#b3261e"
_LONGEST = 30


def study_png(result: StudyRows) -> bytes:
    """The picture of what varies: pictures that are gone over are the curves of one parameter."""
    study = result.study
    axes = [axis for axis in study.axes if len(axis.values) > 1] or list(study.axes[:1])
    varied = [axis for axis in axes if not axis.is_files]
    shown = _with_values(result)
    if not shown:
        return _nothing(result)
    if len(varied) <= 1 and len(axes) <= 2:
        return _curves(result, axes, shown)
    if len(axes) == 2 and _is_grid(result):
        return _maps(result, axes, shown)
    return _scatter(result, axes[:MOST_ACROSS], shown)


def _curves(result: StudyRows, axes: Sequence[Axis], shown: Sequence[int]) -> bytes:
    """Each figure over one parameter; a curve for each picture, if there are several."""
    along = next((axis for axis in axes if not axis.is_files), axes[0])
    others = [axis for axis in axes if axis is not along]
    families = others[0].values if others else (None,)
    across, down = _panels(len(shown))
    drawn_families = families[:_MOST_CURVES]
    width = max(4.6, 3.6 * across)
    names = [_short(str(others[0].shown(value))) for value in drawn_families if others]
    legend = legend_height_in(names, width) if names else 0.2
    with figure(width, 2.4 * down + 0.3 + legend) as (drawn, out):
        _say_left_out(drawn, result, shown)
        panels = drawn.subplots(down, across, squeeze=False).ravel()
        for panel, number in zip(panels, shown, strict=False):
            colours = family_colours(len(drawn_families))
            for colour, value in zip(colours, drawn_families, strict=True):
                rows = _where(result, others, value)
                places, heights = _curve(result, along, rows, number)
                label = "_" if not others else _short(str(others[0].shown(value)))
                marker = "o" if len(places) <= 40 else ""
                style = "-" if along.is_numeric else ":"
                panel.plot(places, heights, style, marker=marker, markersize=3, color=colour,
                           label=label)  # fmt: skip
                _gaps(panel, places, heights)
            _title(panel, result.study.figures[number])
            _abscissa(panel, along)
            _ordinate(panel)
        for panel in panels[len(shown) :]:
            panel.set_visible(False)
        if others:
            title = others[0].label
            if len(families) > len(drawn_families):
                title += f" (the first {len(drawn_families)} of {len(families)})"
            handles = [line for line in panels[0].get_lines() if line.get_label()[0] != "_"]
            columns = legend_columns(names, width)
            drawn.legend(handles=by_rows(handles, columns), loc="outside lower center",
                         ncols=columns, title=title, fontsize=8.0)  # fmt: skip
    return out.getvalue()


def _maps(result: StudyRows, axes: Sequence[Axis], shown: Sequence[int]) -> bytes:
    """Each figure by its colour over two parameters; a point that has failed stays white."""
    across, down = _panels(len(shown))
    x, y = axes[1], axes[0]
    ranks = [_ranks(x), _ranks(y)]
    numbers = [result.study.axes.index(x), result.study.axes.index(y)]
    with figure(max(4.8, 3.9 * across), 3.0 * down + 0.3) as (drawn, out):
        _say_left_out(drawn, result, shown)
        panels = drawn.subplots(down, across, squeeze=False).ravel()
        for panel, number in zip(panels, shown, strict=False):
            heights = np.full((len(y.values), len(x.values)), np.nan)
            for row in result.rows:
                point = result.study.points[row.place]
                value = row.figures[number]
                if value is not None and math.isfinite(value):
                    heights[ranks[1][point[numbers[1]]], ranks[0][point[numbers[0]]]] = value
            cells = _cells(x), _cells(y)
            mesh = panel.pcolormesh(*cells, heights, cmap="viridis", norm=_norm(heights))
            panel.grid(visible=False)
            bar = drawn.colorbar(mesh, ax=panel)
            bar.set_label(result.study.figures[number].unit, fontsize=8.5)
            _title(panel, result.study.figures[number])
            _map_axis(panel.xaxis, panel.set_xscale, x)
            _map_axis(panel.yaxis, panel.set_yscale, y)
            panel.set_xlabel(_head(x))
            panel.set_ylabel(_head(y))
        for panel in panels[len(shown) :]:
            panel.set_visible(False)
    return out.getvalue()


def _scatter(result: StudyRows, axes: Sequence[Axis], shown: Sequence[int]) -> bytes:
    figures = result.study.figures
    wide, high = len(axes), len(shown)
    with figure(max(4.6, 2.4 * wide + 0.6), 1.9 * high + 0.6) as (drawn, out):
        _say_left_out(drawn, result, shown)
        panels = drawn.subplots(high, wide, squeeze=False, sharex="col", sharey="row")
        for line, number in zip(panels, shown, strict=True):
            for panel, axis in zip(line, axes, strict=True):
                place = result.study.axes.index(axis)
                ranks = _ranks(axis)
                xs, ys = [], []
                for row in result.rows:
                    value = row.figures[number]
                    if value is None or not math.isfinite(value):
                        continue
                    at = result.study.points[row.place][place]
                    xs.append(at if axis.is_numeric else ranks[at])
                    ys.append(value)
                alpha = max(0.08, min(0.9, 300.0 / max(1, len(xs))))
                panel.plot(xs, ys, ".", markersize=3, color=COLOURS[0], alpha=alpha)
            words = (_short(figures[number].node), figures[number].name, figures[number].unit)
            line[0].set_ylabel("\n".join(filter(None, words)), fontsize=8.0)
            _ordinate(line[0])
        for panel, axis in zip(panels[-1], axes, strict=True):
            _abscissa(panel, axis)
    return out.getvalue()


def _nothing(result: StudyRows) -> bytes:
    with figure(5.0, 1.6) as (drawn, out):
        panel = drawn.subplots()
        panel.set_axis_off()
        count = len(result.rows)
        panel.text(0.5, 0.5, f"none of the {count} points has a figure", ha="center", va="center")
    return out.getvalue()


def _with_values(result: StudyRows) -> list[int]:
    """The figures that have a value at some point; of many the first that vary."""
    spread: dict[int, bool] = {}
    for place in range(len(result.study.figures)):
        values = [row.figures[place] for row in result.rows]
        finite = [value for value in values if value is not None and math.isfinite(value)]
        if finite:
            low, high = min(finite), max(finite)
            spread[place] = high - low > ROUNDING * max(abs(low), abs(high))
    if len(spread) <= MOST_FIGURES:
        return list(spread)
    return sorted(sorted(spread, key=lambda place: not spread[place])[:MOST_FIGURES])


def _say_left_out(drawn: Any, result: StudyRows, shown: Sequence[int]) -> None:
    every = len(result.study.figures)
    if len(shown) == MOST_FIGURES < every:
        text = f"{len(shown)} of {every} figures; choose others with --figure"
        drawn.suptitle(text, fontsize=8.5, color="#555555")


def _is_grid(result: StudyRows) -> bool:
    axes = result.study.axes
    return math.prod(len(axis.values) for axis in axes) == len(result.rows) and all(
        len(axis.values) <= 1000 for axis in axes
    )


def _where(result: StudyRows, others: Sequence[Axis], value: Any) -> list[Any]:
    if not others:
        return list(result.rows)
    place = result.study.axes.index(others[0])
    return [row for row in result.rows if result.study.points[row.place][place] == value]


def _curve(
    result: StudyRows, along: Axis, rows: Sequence[Any], number: int
) -> tuple[list[Any], list[float]]:
    place, ranks = result.study.axes.index(along), _ranks(along)
    points = []
    for row in rows:
        at = result.study.points[row.place][place]
        value = row.figures[number]
        points.append(
            (at if along.is_numeric else ranks[at], value if _finite(value) else math.nan)
        )
    points.sort(key=lambda point: point[0])
    return [point[0] for point in points], [point[1] for point in points]


def _gaps(panel: Any, places: Sequence[Any], heights: Sequence[float]) -> None:
    gaps = [place for place, height in zip(places, heights, strict=True) if math.isnan(height)]
    if gaps:
        low = panel.get_xaxis_transform()
        panel.plot(gaps, [0.0] * len(gaps), "x", transform=low, color=_FAILED, clip_on=False)


def _abscissa(panel: Any, axis: Axis) -> None:
    panel.set_xlabel(_head(axis), fontsize=8.5)
    if not axis.is_numeric:
        _names(panel.xaxis, axis, turned=True)
    elif axis.log:
        panel.set_xscale("log")
    else:
        panel.ticklabel_format(axis="x", scilimits=(-3, 4), useMathText=True, useOffset=False)


def _names(ticks: Any, axis: Axis, *, turned: bool) -> None:
    step = -(-len(axis.values) // _MOST_NAMES)
    places = range(0, len(axis.values), step)
    words = [_short(_word(axis, axis.values[place]), 14) for place in places]
    ticks.set_ticks(list(places), words, fontsize=7.5, rotation=40 if turned else 0,
                    ha="right")  # fmt: skip


def _map_axis(ticks: Any, set_scale: Any, axis: Axis) -> None:
    if not axis.is_numeric:
        _names(ticks, axis, turned=ticks.axis_name == "x")
    elif axis.log:
        set_scale("log")


def _norm(heights: Any) -> Any:
    """Decades where the figure goes over many; one colour where it does not move."""
    from matplotlib.colors import LogNorm, Normalize

    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if low > 0 and high > _LOG_FROM * low:
        return LogNorm(low, high)
    if high - low <= ROUNDING * max(abs(low), abs(high)):
        reach = 0.1 * abs(low) or 1.0
        return Normalize(low - reach, high + reach)
    return Normalize(low, high)


def _cells(axis: Axis) -> Any:
    """Where a map's cells end: half-way between the values."""
    if not axis.is_numeric:
        return np.arange(len(axis.values) + 1) - 0.5
    places = np.sort(np.array(axis.values, dtype=float))
    places = np.log(places) if axis.log else places
    if len(places) == 1:
        cells = np.array([places[0] - 0.5, places[0] + 0.5])
    else:
        middle = (places[1:] + places[:-1]) / 2
        first, last = 2 * places[0] - middle[0], 2 * places[-1] - middle[-1]
        cells = np.concatenate([[first], middle, [last]])
    return np.exp(cells) if axis.log else cells


def _ranks(axis: Axis) -> dict[Any, int]:
    values = sorted(axis.values) if axis.is_numeric else axis.values
    return {value: rank for rank, value in enumerate(values)}


def _ordinate(panel: Any) -> None:
    lines = panel.get_lines()
    marked = any(line.get_marker() == "x" for line in lines)
    heights = [h for line in lines if line.get_marker() != "x" for h in line.get_ydata()]
    finite = [float(h) for h in heights if math.isfinite(h)]
    if not marked and finite and min(finite) > 0 and max(finite) > _LOG_FROM * min(finite):
        panel.set_yscale("log")
    elif finite and max(finite) - min(finite) <= ROUNDING * max(map(abs, finite)):
        # A figure that does not move: not its rounding blown up to the full height.
        reach = 0.1 * abs(finite[0]) or 1.0
        panel.set_ylim(finite[0] - reach, finite[0] + reach)
        panel.set_yticks([finite[0]], [number_text(float(f"{finite[0]:.4g}"))])
    else:
        panel.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True, useOffset=False)


def _title(panel: Any, shown: Figure) -> None:
    panel.set_title(f"{_short(shown.node)}\n{_short(shown.name)}", fontsize=8.5)
    if shown.unit:
        panel.set_ylabel(shown.unit, fontsize=8.5)


def _panels(count: int) -> tuple[int, int]:
    across = min(_ACROSS, count)
    return across, -(-count // across)


def _head(axis: Axis) -> str:
    return f"{_short(axis.label)} ({axis.unit})" if axis.unit else _short(axis.label)


def _word(axis: Axis, value: Any) -> str:
    shown = axis.shown(value)
    return str(shown).rpartition("/")[2] if axis.is_files else shown_value(shown)


def _short(text: str, longest: int = _LONGEST) -> str:
    return text if len(text) <= longest else f"{text[: longest - 1]}…"


def _finite(value: float | None) -> bool:
    return value is not None and math.isfinite(value)


# The summary of a study: its picture, alone or on a page that needs no other file.

_MOST_FAILED = 50


def write_summary(result: StudyRows, path: Path) -> None:
    if PNG.matches(path):
        write_bytes(path, study_png(result))
    else:
        write_text(path, printable(summary_page(result)))


def summary_page(result: StudyRows) -> str:
    study = result.study
    caption = (
        f"Figures of {len(result.rows)} points; a cross, or white on a map, marks a point "
        "at which the figure has no value."
    )
    blocks: list[Block] = [
        Heading(1, f"{study.name or 'Image chain'}: study"),
        Drawn(study_png(result), caption, caption),
        Heading(2, "What varies"),
        Grid(("parameter", "values", "from", "to"), [_varied(axis) for axis in study.axes]),
        Heading(2, "Figures"),
        _figures(result),
    ]
    failed = result.failed
    if failed:
        rows = [(str(row.place + 1), row.error) for row in failed[:_MOST_FAILED]]
        if len(failed) > _MOST_FAILED:
            rows.append(("", f"and {len(failed) - _MOST_FAILED} more"))
        blocks += [Heading(2, f"{len(failed)} points failed"), Grid(("point", "why"), rows)]
    lines = warned_points([row.warnings for row in result.rows])
    if lines:
        blocks += [Heading(2, lines[0].rstrip(":")), Grid(("warning",), [(x,) for x in lines[1:]])]
    return html_page(f"{study.name or 'Image chain'}: study", blocks)


def _varied(axis: Axis) -> tuple[str, str, str, str]:
    head = f"{axis.label} ({axis.unit})" if axis.unit else axis.label
    ends = sorted(axis.values) if axis.is_numeric else axis.values
    first, last = (shown_value(axis.shown(value)) for value in (ends[0], ends[-1]))
    return head, str(len(axis.values)), first, last


def _figures(result: StudyRows) -> Block:
    rows = []
    for place, asked in enumerate(result.study.figures):
        known = [(row.figures[place], row.place + 1) for row in result.rows]
        values = sorted((value, point) for value, point in known if value is not None)
        head = f"{asked.text} ({asked.unit})" if asked.unit else asked.text
        if not values and asked.by_default:
            continue
        if not values:
            rows.append((head, "0", "", "", "", "", "", asked.meaning))
            continue
        (least, low), (most, high) = values[0], values[-1]
        middle = statistics.median(value for value, _ in values)
        cells = [number(value, asked.unit) for value in (least, middle, most)]
        rows.append((head, str(len(values)), cells[0], str(low), cells[1], cells[2], str(high),
                     asked.meaning))  # fmt: skip
    heads = ("figure", "values", "least", "at point", "median", "most", "at point", "meaning")
    return Grid(heads, rows, numbers=range(1, 7))
