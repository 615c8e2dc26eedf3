"""A study as a picture: curves of one parameter, heat maps of two, scatter plots of more."""

import math
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.report.drawing.picture_drawing import COLOURS, figure, number
from app.report.html_page import Block, Drawn, Grid, Heading, html_page
from app.run.overrides import Variation
from app.run.terminal import warned_points, with_unit
from app.study.study_request import StudyRows
from app.tradeoff import tradeoff_drawing as drawing
from app.tradeoff.tradeoff_results import ROUNDING
from core.atomic import write_bytes, write_text
from core.errors import printable, several
from nodes.files.formats import PNG

MOST_FIGURES, MOST_ACROSS = 12, 8
"""Figures and parameters that are drawn; more could not be read."""
_ACROSS = 3
_MOST_CURVES = 8


def study_png(result: StudyRows) -> bytes:
    """The picture of what varies: pictures that are gone over are the curves of one parameter."""
    study = result.study
    axes = [axis for axis in study.axes if len(axis.values) > 1] or list(study.axes[:1])
    shown = _with_values(result)
    grid = math.prod(len(axis.values) for axis in study.axes) == len(result.rows)
    if not shown:
        draw: Any = _nothing
    elif len(axes) <= 2 and sum(not axis.is_files for axis in axes) <= 1:
        draw = _curves
    elif len(axes) == 2 and grid and all(len(axis.values) <= 1000 for axis in axes):
        draw = _maps
    else:
        draw = _scatter
    every = len(study.figures)
    left_out = len(shown) == MOST_FIGURES < every
    note = (
        f"{len(shown)} of {every} figures; choose other figures with --figure" if left_out else ""
    )
    png: bytes = draw(result, axes[:MOST_ACROSS], shown, note)
    return png


def _curves(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int], note: str) -> bytes:
    """Each figure over one parameter; a curve for each picture, if there are several."""
    along = next((axis for axis in axes if not axis.is_files), axes[0])
    others = [axis for axis in axes if axis is not along]
    families = others[0].values if others else (None,)
    places, ranks = _values(result, along), drawing.ranks_of(along)
    family = _values(result, others[0]) if others else [None] * len(result.rows)
    curves = []
    for value in families[:_MOST_CURVES]:
        points = [n for n, one in enumerate(family) if one == value]
        points.sort(key=lambda number: ranks[places[number]])
        heights = [[result.rows[number].figures[place] for number in points] for place in shown]
        name = drawing.short_text(str(others[0].shown(value))) if others else ""
        curves.append((name, [places[number] for number in points], heights))
    title = others[0].text if others else ""
    if len(families) > _MOST_CURVES:
        title += f" (the first {_MOST_CURVES} of {len(families)})"
    figures = [result.study.figures[place] for place in shown]
    return drawing.curves_png(figures, along, curves, title, note=note)


def _maps(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int], note: str) -> bytes:
    """Each figure by its colour over two parameters; a point that has failed stays white."""
    across = min(_ACROSS, len(shown))
    down = -(-len(shown) // across)
    y, x = axes
    ranks = [drawing.ranks_of(axis) for axis in axes]
    rows, columns = ([of[v] for v in _values(result, a)] for a, of in zip(axes, ranks, strict=True))
    with figure(max(4.8, 3.9 * across), 3.0 * down + 0.3) as (drawn, out):
        drawing.say(drawn, note)
        panels = drawn.subplots(down, across, squeeze=False).ravel()
        for panel, number in zip(panels, shown, strict=False):
            heights = np.full((len(y.values), len(x.values)), np.nan)
            heights[rows, columns] = _heights(result, number)
            cells = _cells(x), _cells(y)
            mesh = panel.pcolormesh(*cells, heights, cmap="viridis", norm=_norm(heights))
            panel.grid(visible=False)
            bar = drawn.colorbar(mesh, ax=panel)
            bar.set_label(result.study.figures[number].unit, fontsize=8.5)
            drawing.set_title(panel, result.study.figures[number])
            scales = panel.set_xscale, panel.set_yscale
            for ticks, scale, axis in zip((panel.xaxis, panel.yaxis), scales, (x, y), strict=True):
                if not axis.is_numeric:
                    drawing.write_names(ticks, axis, turned=axis is x)
                elif axis.log:
                    scale("log")
            panel.set_xlabel(x.title)
            panel.set_ylabel(y.title)
        for panel in panels[len(shown) :]:
            panel.set_visible(False)
    return out.getvalue()


def _scatter(
    result: StudyRows, axes: Sequence[Variation], shown: Sequence[int], note: str
) -> bytes:
    figures = result.study.figures
    wide, high = len(axes), len(shown)
    with figure(max(4.6, 2.4 * wide + 0.6), 1.9 * high + 0.6) as (drawn, out):
        drawing.say(drawn, note)
        panels = drawn.subplots(high, wide, squeeze=False, sharex="col", sharey="row")
        for line, number in zip(panels, shown, strict=True):
            heights = _heights(result, number)
            known = np.flatnonzero(np.isfinite(heights))
            for panel, axis in zip(line, axes, strict=True):
                values, ranks = _values(result, axis), drawing.ranks_of(axis)
                xs = [values[at] if axis.is_numeric else ranks[values[at]] for at in known]
                alpha = max(0.08, min(0.9, 300.0 / max(1, len(xs))))
                panel.plot(xs, heights[known], ".", markersize=3, color=COLOURS[0], alpha=alpha)
            asked = figures[number]
            words = (drawing.short_text(asked.node), asked.name, asked.unit)
            line[0].set_ylabel("\n".join(filter(None, words)), fontsize=8.0)
            drawing.ordinate(line[0], heights[known].tolist())
        for panel, axis in zip(panels[-1], axes, strict=True):
            drawing.abscissa(panel, axis)
            panel.set_xlabel(axis.title, fontsize=8.5)
    return out.getvalue()


def _nothing(result: StudyRows, *_: object) -> bytes:
    with figure(5.0, 1.6) as (drawn, out):
        panel = drawn.subplots()
        panel.set_axis_off()
        count = len(result.rows)
        text = f"no figure has a value at any of the {count} points"
        panel.text(0.5, 0.5, text, ha="center", va="center")
    return out.getvalue()


def _values(result: StudyRows, axis: Variation) -> list[Any]:
    place = result.study.axes.index(axis)
    return [result.study.points[row.place][place] for row in result.rows]


def _heights(result: StudyRows, figure: int) -> NDArray[np.float64]:
    """A figure in each row; NaN where it has no finite value."""
    heights = np.array([row.figures[figure] for row in result.rows], dtype=np.float64)
    return np.where(np.isfinite(heights), heights, np.nan)


def _with_values(result: StudyRows) -> list[int]:
    """The figures that have a value at some point; of many the first that vary."""
    flat: dict[int, bool] = {}
    for place in range(len(result.study.figures)):
        heights = _heights(result, place)
        if not np.isnan(heights).all():
            low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
            flat[place] = high - low <= ROUNDING * max(abs(low), abs(high))
    return sorted(sorted(flat, key=flat.__getitem__)[:MOST_FIGURES])


def _norm(heights: Any) -> Any:
    """Decades where the figure goes over many; one colour where it does not move."""
    from matplotlib.colors import LogNorm, Normalize

    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if low > 0 and high > drawing.LOG_FROM * low:
        return LogNorm(low, high)
    if high - low <= ROUNDING * max(abs(low), abs(high)):
        reach = 0.1 * abs(low) or 1.0
        return Normalize(low - reach, high + reach)
    return Normalize(low, high)


def _cells(axis: Variation) -> Any:
    """Where a map's cells end: half-way between the values."""
    places = np.sort(axis.values) if axis.is_numeric else np.arange(len(axis.values))
    places = np.log(places) if axis.log else places
    middle = (places[1:] + places[:-1]) / 2
    cells = [2 * places[0] - middle[0], *middle, 2 * places[-1] - middle[-1]]
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
        f"Figures at {several(len(result.rows), 'point')}; a cross, or white on a map, marks "
        "a point where the figure has no value."
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
        blocks += [
            Heading(2, f"{several(len(failed), 'point')} failed"),
            Grid(("point", "why"), rows),
        ]
    lines = warned_points([row.warnings for row in result.rows])
    if lines:
        blocks += [Heading(2, lines[0].rstrip(":")), Grid(("warning",), [(x,) for x in lines[1:]])]
    return html_page(f"{study.name or 'Image chain'}: study", blocks)


def _varied(axis: Variation) -> tuple[str, str, str, str]:
    ends = sorted(axis.values) if axis.is_numeric else axis.values
    first, last = (drawing.value_text(axis, value) for value in (ends[0], ends[-1]))
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
