"""Trade-offs and studies as pictures, as pages and as text."""

import math
import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.report import html_page as html
from app.report.drawing import picture_drawing as drawing
from app.run import terminal as tables
from app.run.overrides import Variation, is_number
from app.study.study_rows import Column, StudyRows, csv_of
from app.tradeoff.tradeoff_results import Figure, Point, Results, moves, shown_value
from core.atomic import write_bytes, write_text
from core.errors import printable, several
from nodes.files.file_format import CSV, JSON, PNG

_ACROSS = 3
LOG_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
_LONGEST = 28  # letters of a line of a title
_FAILED = "#b3261e"
_MOST_MARKED = 40  # points that still stand apart
_MOST_NAMES = 12
Curve = tuple[str, Sequence[Any], Sequence[Sequence[float | None]]]
"""A curve's name, the values along it, and at these every figure."""


def trade_off_content(results: Results, path: Path) -> str | bytes:
    if CSV.matches(path):
        return printable(csv_text(results))
    if JSON.matches(path):
        return tables.json_text(trade_off_facts(results), indent=1)
    return trade_off_png(results) if PNG.matches(path) else printable(page(results))


def trade_off_png(results: Results) -> bytes:
    curves = []
    for points in results.curves:
        heights = [[p.figures.get(shown.text) for p in points] for shown in results.figures]
        name = "".join(map(shown_value, points[0].values[:-1]))
        curves.append((name, [point.values[-1] for point in points], heights))
    title = "".join(axis.title for axis in results.axes[:-1])
    return curves_png(results.figures, results.along, curves, title, present=results.present)


def curves_png(
    figures: Sequence[Figure],
    along: Variation,
    curves: Sequence[Curve],
    title: str = "",
    *,
    note: str = "",
    present: Any = None,
) -> bytes:
    """Each figure in a panel of its own; `title` is that of the curves' names."""
    across = min(_ACROSS, len(figures))
    down = -(-len(figures) // across)
    width = max(4.6, 3.4 * across)
    names = [name for name, *_ in curves if title]
    legend = drawing.legend_height_in(names, width) if names else 0.0
    marked = along.is_numeric and is_number(present)
    marked = marked and min(along.values) <= present <= max(along.values)
    with drawing.figure(width, 2.3 * down + 0.3 + legend) as (drawn, out):
        say(drawn, note)
        panels = drawn.subplots(down, across, squeeze=False, sharex=True).ravel()
        for place, (panel, shown) in enumerate(zip(panels, figures, strict=False)):
            set_title(panel, shown)
            _draw(panel, along, [(name, at, heights[place]) for name, at, heights in curves])
            if marked:
                panel.axvline(present, color="#555555", linewidth=0.9, linestyle="--", zorder=1)
            if place + across >= len(figures):
                panel.tick_params(labelbottom=True)
                panel.set_xlabel(along.title)
        for panel in panels[len(figures) :]:
            panel.set_visible(False)
        if names:
            handles = [line for line in panels[0].get_lines() if line.get_label()[0] != "_"]
            count = drawing.legend_columns(names, width)
            drawn.legend(
                handles=drawing.by_rows(handles, count), ncols=count, title=title,
                loc="outside lower center", fontsize=8.5,
            )  # fmt: skip
    return out.getvalue()


def _draw(panel: Any, along: Variation, curves: Sequence[tuple[str, Any, Any]]) -> None:
    ranks = ranks_of(along)
    every = []
    for colour, (name, values, figures) in zip(
        drawing.family_colours(len(curves)), curves, strict=True
    ):
        places = [value if along.is_numeric else ranks[value] for value in values]
        heights = np.array(figures, np.float64)
        heights = np.where(np.isfinite(heights), heights, math.nan).tolist()
        every += heights
        gaps = [place for place, height in zip(places, heights, strict=True) if math.isnan(height)]
        if gaps:  # at the bottom, so that the axis reaches the values that failed too
            low = panel.get_xaxis_transform()
            panel.plot(gaps, [0.0] * len(gaps), "x", transform=low, color=_FAILED, clip_on=False)
        marker = "o" if len(places) <= _MOST_MARKED or not along.is_numeric else ""
        style = "-" if along.is_numeric else ":"
        panel.plot(
            places, heights, style, marker=marker, markersize=3, color=colour, label=name or "_"
        )
    abscissa(panel, along)
    ordinate(panel, every)


def say(drawn: Any, note: str) -> None:
    if note:
        drawn.suptitle(note, fontsize=8.5, color="#555555")


def set_title(panel: Any, shown: Figure) -> None:
    panel.set_title(f"{short_text(shown.node)}\n{short_text(shown.name)}", fontsize=8.5)
    if shown.unit:
        panel.set_ylabel(shown.unit, fontsize=8.5)


def abscissa(panel: Any, along: Variation) -> None:
    if not along.is_numeric:
        write_names(panel.xaxis, along, turned=len(along.values) > _ACROSS)
        panel.margins(x=0.12)
    elif along.log:
        panel.set_xscale("log")
    else:
        panel.ticklabel_format(axis="x", scilimits=(-3, 4), useMathText=True, useOffset=False)


def ordinate(panel: Any, heights: Sequence[float]) -> None:
    """Decades where the figure goes over many."""
    finite = [height for height in heights if math.isfinite(height)]
    if finite and min(finite) > 0 and max(finite) > LOG_FROM * min(finite):
        panel.set_yscale("log")
    elif finite and not moves(min(finite), max(finite)):
        # A figure that does not move: not its rounding blown up to the full height.
        reach = 0.1 * abs(finite[0]) or 1.0
        panel.set_ylim(finite[0] - reach, finite[0] + reach)
        panel.set_yticks([finite[0]], [drawing.number(tables.four_digits(finite[0]))])
    else:
        panel.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True, useOffset=False)


def write_names(ticks: Any, along: Variation, *, turned: bool) -> None:
    """The values that are no numbers, at their ranks; of many some."""
    places = range(0, len(along.values), -(-len(along.values) // _MOST_NAMES))
    words = [short_text(value_text(along, along.values[place]), 14) for place in places]
    ticks.set_ticks(
        list(places), words, fontsize=7.5, rotation=40 if turned else 0,
        ha="right" if turned else "center",
    )  # fmt: skip


def value_text(along: Variation, value: Any) -> str:
    shown = along.shown(value)
    return str(shown).rpartition("/")[2] if along.is_files else shown_value(shown)


def ranks_of(along: Variation) -> dict[Any, int]:
    values = sorted(along.values) if along.is_numeric else along.values
    return {value: rank for rank, value in enumerate(values)}


def short_text(text: str, longest: int = _LONGEST) -> str:
    return text if len(text) <= longest else f"{text[: longest - 1]}…"


# A trade-off as a page that needs no other file.


def page(results: Results) -> str:
    title = f"{results.network or 'Image chain'}: trade-off"
    caption = f"Figures of merit against {results.along.text}"
    caption += "".join(f", with one curve for each value of {a.text}" for a in results.axes[:-1])
    caption += "."
    if results.present is not None:
        present = shown_value(results.present, results.along.unit)
        caption += f" The value in the network is {present}"
        caption += " (dashed line)." if results.along.is_numeric else "."
    if results.failures():
        caption += (
            " A cross marks a value at which the figure could not be computed; the reasons are "
            "listed below."
        )
    blocks = [
        html.drawn(trade_off_png(results), caption, caption),
        html.heading(2, "Figures"),
        html.grid(
            ("figure", "unit", "meaning"), [(f.text, f.unit, f.meaning) for f in results.figures]
        ),
        html.heading(2, "Values"),
        _value_grid(results),
        _listed("Gaps", results.failures()),
        _listed("Warnings", results.warnings()),
    ]
    return html.page(title, blocks)


def _columns(results: Results) -> list[tuple[Variation | Figure, list[Any]]]:
    points = results.points
    values = zip(*(point.values for point in points), strict=True)
    axes = zip(results.axes, map(list, values), strict=True)
    figures = ((one, [point.figures.get(one.text) for point in points]) for one in results.figures)
    return [*reversed([*axes]), *figures]


def _value_grid(results: Results) -> str:
    columns = _columns(results)
    cells = [
        [
            drawing.number(v, shown.unit) if isinstance(shown, Figure) else shown_value(v)
            for v in values
        ]
        for shown, values in columns
    ]
    heads = [tables.with_unit(shown.text, shown.unit) for shown, _ in columns]
    return html.grid(heads, list(zip(*cells, strict=True)), numbers=range(len(heads)))


def _listed(title: str, lines: list[tuple[str, str]]) -> str:
    return html.heading(2, title) + html.grid(("where", "why"), lines) if lines else ""


# A trade-off as text: the table of the terminal, CSV and JSON.

_GAP = 2  # between columns
_MOST_REASONS = 12


def table(results: Results, width: int | None = None) -> str:
    """Heads of node, name and unit above the values; broken into blocks no wider than `width`."""
    every = []
    for shown, values in _columns(results):
        if isinstance(shown, Figure):
            texts = (tables.number_text(tables.without_rounding(v, shown.unit)) for v in values)
            every.append([shown.node, shown.name, shown.unit, *texts])
        else:
            every.append([shown.node, shown.parameter.name, shown.unit, *map(shown_value, values)])
    axis_columns, others = every[: len(results.axes)], every[len(results.axes) :]
    blocks = []
    while others:
        block = [*axis_columns]
        while others and (len(block) == len(axis_columns) or _fits([*block, others[0]], width)):
            block.append(others.pop(0))
        rows = list(zip(*block, strict=True))
        blocks.append(tables.columns(rows, right=range(len(block))))
    return "\n\n".join(blocks)


def failures(results: Results) -> list[str]:
    lines = [f"{place}: {reason}" for place, reason in results.failures()]
    if len(lines) > _MOST_REASONS:
        lines[_MOST_REASONS - 1 :] = [f"and {several(len(lines) - _MOST_REASONS + 1, 'more gap')}"]
    return lines


def csv_text(results: Results) -> str:
    """A row for each point in full precision; gaps are empty, reasons and warnings at the end."""
    columns = [Column(shown.text, "", values) for shown, values in _columns(results)]
    columns.append(Column("failed", "", ["; ".join(results.reasons(p)) for p in results.points]))
    columns.append(Column("warnings", "", ["; ".join(p.warnings) for p in results.points]))
    return csv_of(columns)


def trade_off_facts(results: Results) -> dict[str, Any]:
    names = [figure.text for figure in results.figures]

    def at(point: Point) -> dict[str, Any]:
        figures = {name: point.figures.get(name) for name in names}
        failed = {name: why for name, why in point.reasons.items() if name in names}
        told = {"failed": failed, "warnings": point.warnings}
        return {"value": point.values[-1], "figures": figures, **told}

    return {
        "network": results.network,
        "vary": [
            {"parameter": a.text, "unit": a.unit, "values": a.values}
            for a in reversed(results.axes)
        ],
        "present": results.present,
        "figures": [
            {"name": f.text, "unit": f.unit, "meaning": f.meaning} for f in results.figures
        ],
        "curves": [
            dict(zip(("second",), points[0].values[:-1], strict=False))
            | {"points": list(map(at, points))}
            for points in results.curves
        ],
    }


def _fits(block: Sequence[Sequence[str]], width: int | None) -> bool:
    if width is None:
        return True
    return sum(max(map(len, column)) + _GAP for column in block) - _GAP <= width


MOST_FIGURES, MOST_ACROSS = 12, 8
"""Figures and parameters that are drawn; more could not be read."""
_MOST_CURVES = 8


def study_png(result: StudyRows) -> bytes:
    """The picture of what varies: pictures that are gone over are the curves of one parameter."""
    study = result.study
    axes = [axis for axis in study.axes if len(axis.values) > 1] or list(study.axes[:1])
    shown = _with_values(result)
    grid = math.prod(len(axis.values) for axis in study.axes) == len(result.rows)
    if not shown:
        draw: Callable[..., bytes] = _nothing
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
    return draw(result, axes[:MOST_ACROSS], shown, note)


def _curves(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int], note: str) -> bytes:
    """Each figure over one parameter; a curve for each picture, if there are several."""
    along = next((axis for axis in axes if not axis.is_files), axes[0])
    others = [axis for axis in axes if axis is not along]
    families = others[0].values if others else (None,)
    places, ranks = _values(result, along), ranks_of(along)
    family = _values(result, others[0]) if others else [None] * len(result.rows)
    curves = []
    for value in families[:_MOST_CURVES]:
        points = [n for n, one in enumerate(family) if one == value]
        points.sort(key=lambda number: ranks[places[number]])
        heights = [[result.rows[number].figures[place] for number in points] for place in shown]
        name = short_text(str(others[0].shown(value))) if others else ""
        curves.append((name, [places[number] for number in points], heights))
    title = others[0].text if others else ""
    if len(families) > _MOST_CURVES:
        title += f" (the first {_MOST_CURVES} of {len(families)})"
    figures = [result.study.figures[place] for place in shown]
    return curves_png(figures, along, curves, title, note=note)


def _maps(result: StudyRows, axes: Sequence[Variation], shown: Sequence[int], note: str) -> bytes:
    """Each figure by its colour over two parameters; a point that has failed stays white."""
    across = min(_ACROSS, len(shown))
    down = -(-len(shown) // across)
    y, x = axes
    ranks = [ranks_of(axis) for axis in axes]
    rows, columns = ([of[v] for v in _values(result, a)] for a, of in zip(axes, ranks, strict=True))
    with drawing.figure(max(4.8, 3.9 * across), 3.0 * down + 0.3) as (drawn, out):
        say(drawn, note)
        panels = drawn.subplots(down, across, squeeze=False).ravel()
        for panel, number in zip(panels, shown, strict=False):
            heights = np.full((len(y.values), len(x.values)), np.nan)
            heights[rows, columns] = _heights(result, number)
            cells = _cells(x), _cells(y)
            mesh = panel.pcolormesh(*cells, heights, cmap="viridis", norm=_norm(heights))
            panel.grid(visible=False)
            bar = drawn.colorbar(mesh, ax=panel)
            bar.set_label(result.study.figures[number].unit, fontsize=8.5)
            set_title(panel, result.study.figures[number])
            scales = panel.set_xscale, panel.set_yscale
            for ticks, scale, axis in zip((panel.xaxis, panel.yaxis), scales, (x, y), strict=True):
                if not axis.is_numeric:
                    write_names(ticks, axis, turned=axis is x)
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
    with drawing.figure(max(4.6, 2.4 * wide + 0.6), 1.9 * high + 0.6) as (drawn, out):
        say(drawn, note)
        panels = drawn.subplots(high, wide, squeeze=False, sharex="col", sharey="row")
        for line, number in zip(panels, shown, strict=True):
            heights = _heights(result, number)
            known = np.flatnonzero(np.isfinite(heights))
            for panel, axis in zip(line, axes, strict=True):
                values, ranks = _values(result, axis), ranks_of(axis)
                xs = [values[at] if axis.is_numeric else ranks[values[at]] for at in known]
                alpha = max(0.08, min(0.9, 300.0 / max(1, len(xs))))
                panel.plot(
                    xs, heights[known], ".", markersize=3, color=drawing.COLOURS[0], alpha=alpha
                )
            asked = figures[number]
            words = (short_text(asked.node), asked.name, asked.unit)
            line[0].set_ylabel("\n".join(filter(None, words)), fontsize=8.0)
            ordinate(line[0], heights[known].tolist())
        for panel, axis in zip(panels[-1], axes, strict=True):
            abscissa(panel, axis)
            panel.set_xlabel(axis.title, fontsize=8.5)
    return out.getvalue()


def _nothing(result: StudyRows, *_: object) -> bytes:
    with drawing.figure(5.0, 1.6) as (drawn, out):
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
            flat[place] = not moves(float(np.nanmin(heights)), float(np.nanmax(heights)))
    return sorted(sorted(flat, key=flat.__getitem__)[:MOST_FIGURES])


def _norm(heights: Any) -> Any:
    """Decades where the figure goes over many; one colour where it does not move."""
    from matplotlib.colors import LogNorm, Normalize

    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if low > 0 and high > LOG_FROM * low:
        return LogNorm(low, high)
    if not moves(low, high):
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
    blocks = [
        html.drawn(study_png(result), caption, caption),
        html.heading(2, "What varies"),
        html.grid(("parameter", "values", "from", "to"), [_varied(axis) for axis in study.axes]),
        html.heading(2, "Figures"),
        _figures(result),
    ]
    failed = result.failed
    if failed:
        rows = [(str(row.place + 1), row.error) for row in failed[:_MOST_FAILED]]
        if len(failed) > _MOST_FAILED:
            rows.append(("", f"and {len(failed) - _MOST_FAILED} more"))
        blocks += [
            html.heading(2, f"{several(len(failed), 'point')} failed"),
            html.grid(("point", "why"), rows),
        ]
    lines = tables.warned_points([row.warnings for row in result.rows])
    if lines:
        blocks += [
            html.heading(2, lines[0].rstrip(":")),
            html.grid(("warning",), [(x,) for x in lines[1:]]),
        ]
    return html.page(f"{study.name or 'Image chain'}: study", blocks)


def _varied(axis: Variation) -> tuple[str, str, str, str]:
    ends = sorted(axis.values) if axis.is_numeric else axis.values
    first, last = (value_text(axis, value) for value in (ends[0], ends[-1]))
    return axis.title, str(len(axis.values)), first, last


def _figures(result: StudyRows) -> str:
    rows = []
    for place, asked in enumerate(result.study.figures):
        known = [(row.figures[place], row.place + 1) for row in result.rows]
        values = sorted((value, point) for value, point in known if value is not None)
        head = tables.with_unit(asked.text, asked.unit)
        if not values and asked.by_default:
            continue
        if not values:
            rows.append((head, "0", "", "", "", "", "", asked.meaning))
            continue
        (least, low), (most, high) = values[0], values[-1]
        middle = statistics.median(value for value, _ in values)
        cells = [drawing.number(value, asked.unit) for value in (least, middle, most)]
        rows.append((head, str(len(values)), cells[0], str(low), cells[1], cells[2], str(high),
                     asked.meaning))  # fmt: skip
    heads = ("figure", "values", "least", "at point", "median", "most", "at point", "meaning")
    return html.grid(heads, rows, numbers=range(1, 7))
