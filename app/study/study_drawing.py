"""A study as a picture: curves of one parameter, heat maps of two, scatter plots of more."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.report.drawing.picture_drawing import COLOURS, figure, number
from app.report.html_page import Block, Drawn, Grid, Heading, html_page
from app.run.readout_tables import warned_points, with_unit
from app.study.study_request import StudyRows
from app.tradeoff.tradeoff_drawing import (
    LOG_FROM,
    abscissa,
    curves_png,
    is_finite,
    ordinate,
    ranks_of,
    say,
    set_title,
    short_text,
    value_text,
    write_names,
)
from app.tradeoff.tradeoff_results import ROUNDING
from app.tradeoff.values import Variation
from core.atomic import write_bytes, write_text
from core.names import printable
from nodes.files.formats import PNG

MOST_FIGURES, MOST_ACROSS = 12, 8
"""Figures and parameters that are drawn; more could not be read."""
_ACROSS = 3
_MOST_CURVES = 8


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


def _curves(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int]) -> bytes:
    """Each figure over one parameter; a curve for each picture, if there are several."""
    along = next((axis for axis in axes if not axis.is_files), axes[0])
    others = [axis for axis in axes if axis is not along]
    families = others[0].values if others else (None,)
    at, ranks = result.study.axes.index(along), ranks_of(along)
    curves = []
    for value in families[:_MOST_CURVES]:
        points = [
            (result.study.points[row.place][at], row) for row in _where(result, others, value)
        ]
        points.sort(key=lambda point: ranks[point[0]])
        heights = [[row.figures[place] for _, row in points] for place in shown]
        name = short_text(str(others[0].shown(value))) if others else ""
        curves.append((name, [place for place, _ in points], heights))
    title = others[0].text if others else ""
    if len(families) > _MOST_CURVES:
        title += f" (the first {_MOST_CURVES} of {len(families)})"
    figures = [result.study.figures[place] for place in shown]
    return curves_png(figures, along, curves, title, note=_left_out(result, shown))


def _maps(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int]) -> bytes:
    """Each figure by its colour over two parameters; a point that has failed stays white."""
    across = min(_ACROSS, len(shown))
    down = -(-len(shown) // across)
    x, y = axes[1], axes[0]
    ranks = [ranks_of(x), ranks_of(y)]
    numbers = [result.study.axes.index(x), result.study.axes.index(y)]
    with figure(max(4.8, 3.9 * across), 3.0 * down + 0.3) as (drawn, out):
        say(drawn, _left_out(result, shown))
        panels = drawn.subplots(down, across, squeeze=False).ravel()
        for panel, number in zip(panels, shown, strict=False):
            heights = np.full((len(y.values), len(x.values)), np.nan)
            for row in result.rows:
                point = result.study.points[row.place]
                value = row.figures[number]
                if is_finite(value):
                    heights[ranks[1][point[numbers[1]]], ranks[0][point[numbers[0]]]] = value
            cells = _cells(x), _cells(y)
            mesh = panel.pcolormesh(*cells, heights, cmap="viridis", norm=_norm(heights))
            panel.grid(visible=False)
            bar = drawn.colorbar(mesh, ax=panel)
            bar.set_label(result.study.figures[number].unit, fontsize=8.5)
            set_title(panel, result.study.figures[number])
            _map_axis(panel.xaxis, panel.set_xscale, x)
            _map_axis(panel.yaxis, panel.set_yscale, y)
            panel.set_xlabel(x.title)
            panel.set_ylabel(y.title)
        for panel in panels[len(shown) :]:
            panel.set_visible(False)
    return out.getvalue()


def _scatter(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int]) -> bytes:
    figures = result.study.figures
    wide, high = len(axes), len(shown)
    with figure(max(4.6, 2.4 * wide + 0.6), 1.9 * high + 0.6) as (drawn, out):
        say(drawn, _left_out(result, shown))
        panels = drawn.subplots(high, wide, squeeze=False, sharex="col", sharey="row")
        for line, number in zip(panels, shown, strict=True):
            every: list[float] = []
            for panel, axis in zip(line, axes, strict=True):
                place = result.study.axes.index(axis)
                ranks = ranks_of(axis)
                xs, ys = [], []
                for row in result.rows:
                    value = row.figures[number]
                    if not is_finite(value):
                        continue
                    at = result.study.points[row.place][place]
                    xs.append(at if axis.is_numeric else ranks[at])
                    ys.append(value)
                alpha = max(0.08, min(0.9, 300.0 / max(1, len(xs))))
                panel.plot(xs, ys, ".", markersize=3, color=COLOURS[0], alpha=alpha)
                every += ys
            words = (short_text(figures[number].node), figures[number].name, figures[number].unit)
            line[0].set_ylabel("\n".join(filter(None, words)), fontsize=8.0)
            ordinate(line[0], every)
        for panel, axis in zip(panels[-1], axes, strict=True):
            abscissa(panel, axis)
            panel.set_xlabel(axis.title, fontsize=8.5)
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
        finite = [value for value in values if is_finite(value)]
        if finite:
            low, high = min(finite), max(finite)
            spread[place] = high - low > ROUNDING * max(abs(low), abs(high))
    if len(spread) <= MOST_FIGURES:
        return list(spread)
    return sorted(sorted(spread, key=lambda place: not spread[place])[:MOST_FIGURES])


def _left_out(result: StudyRows, shown: Sequence[int]) -> str:
    every = len(result.study.figures)
    if not len(shown) == MOST_FIGURES < every:
        return ""
    return f"{len(shown)} of {every} figures; choose others with --figure"


def _is_grid(result: StudyRows) -> bool:
    axes = result.study.axes
    return math.prod(len(axis.values) for axis in axes) == len(result.rows) and all(
        len(axis.values) <= 1000 for axis in axes
    )


def _where(result: StudyRows, others: Sequence[Variation], value: Any) -> list[Any]:
    if not others:
        return list(result.rows)
    place = result.study.axes.index(others[0])
    return [row for row in result.rows if result.study.points[row.place][place] == value]


def _map_axis(ticks: Any, set_scale: Any, axis: Variation) -> None:
    if not axis.is_numeric:
        write_names(ticks, axis, turned=ticks.axis_name == "x")
    elif axis.log:
        set_scale("log")


def _norm(heights: Any) -> Any:
    """Decades where the figure goes over many; one colour where it does not move."""
    from matplotlib.colors import LogNorm, Normalize

    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if low > 0 and high > LOG_FROM * low:
        return LogNorm(low, high)
    if high - low <= ROUNDING * max(abs(low), abs(high)):
        reach = 0.1 * abs(low) or 1.0
        return Normalize(low - reach, high + reach)
    return Normalize(low, high)


def _cells(axis: Variation) -> Any:
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


def _varied(axis: Variation) -> tuple[str, str, str, str]:
    ends = sorted(axis.values) if axis.is_numeric else axis.values
    first, last = (value_text(axis, value) for value in (ends[0], ends[-1]))
    return axis.title, str(len(axis.values)), first, last


def _figures(result: StudyRows) -> Block:
    rows = []
    for place, asked in enumerate(result.study.figures):
        known = [(row.figures[place], row.place + 1) for row in result.rows]
        values = sorted((value, point) for value, point in known if value is not None)
        head = with_unit(asked.text, asked.unit)
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
