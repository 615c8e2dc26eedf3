"""Pictures of tables: time against error; bars and growth are drawn in `speed_charts`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from app.bench.measuring.bench_tables import Chart, Row, Table, figure_text
from app.bench.pages.chart_labels import Label, most_apart, place_labels
from app.bench.pages.chart_looks import COLOURS, DARK, FAINT, HEIGHT, drawing

# No error at all has no place on a logarithmic axis: it is drawn at double precision's rounding.
LEAST = 1e-16
MARKS = "osD^vPX"
ENOUGH_TICKS = 4
FIRST, NEAR_T0 = 0.7, 4.0  # an axis that begins between these begins at the first


def chart_png(table: Table, *, titled: bool = True) -> bytes | None:
    """The table's picture; None where it has none, or nothing was measured."""
    chart = table.chart
    if chart is None:
        return None
    rows = [row for row in table.rows if chart.draws(row)]
    if not rows:
        return None
    title = (chart.title or table.title) if titled else ""
    if chart.kind == "bars":
        from app.bench.pages.speed_charts import bars_png

        return bars_png(rows, title)
    if chart.kind == "growth":
        from app.bench.pages.speed_charts import growth_png

        return growth_png(rows, title)
    return _error_png(chart, rows, title)


def plain_ticks(low: float, high: float) -> list[float]:
    """Round numbers between the ends of a logarithmic axis: powers of ten, more where few."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    ticks: list[float] = []
    for leading in ((1.0,), (1.0, 3.0), (1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0)):
        ticks = [digit * 10.0**power for power in decades for digit in leading]
        ticks = [tick for tick in ticks if low <= tick <= high]
        if len(ticks) >= ENOUGH_TICKS:
            break
    return ticks


def _error_png(chart: Chart, rows: Sequence[Row], title: str) -> bytes:
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        groups.setdefault(row[chart.group] if chart.group else "", []).append(row)
    curves = {
        group: [(float(row[chart.x]), max(float(row[chart.y]), LEAST)) for row in members]
        for group, members in groups.items()
    }
    points = [place for places in curves.values() for place in places]
    with drawing(HEIGHT, title) as (drawn, out):
        axis = drawn.subplots()
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel(chart.x_label)
        axis.set_ylabel(chart.y_label)
        for number, places in enumerate(curves.values()):
            _curve(axis, places, number, joined=chart.lines)
        _limits(axis, chart, points)
        axis.set_xticks(ticks := plain_ticks(*axis.get_xlim()), [f"{tick:g}" for tick in ticks])
        axis.minorticks_off()
        guides = _guides(axis, chart, points)
        drawn.draw_without_rendering()  # settles the layout, by which the words are placed
        names, words = [], []
        for number, (group, places) in enumerate(curves.items()):
            colour = COLOURS[number % len(COLOURS)]
            named = bool(chart.group) and not chart.by_colour
            if named:
                others = [
                    place for other in curves.values() if other is not places for place in other
                ]
                ends = most_apart(axis, places, others)
                names.append(Label(figure_text(group), ends, colour, bold=True))
            if chart.label and not (named and len(places) == 1):
                texts = [row.get(chart.label) for row in groups[group]]
                words += [
                    Label(figure_text(word), (place,), colour if chart.by_colour else DARK)
                    for word, place in zip(texts, places, strict=True)
                    if word is not None
                ]
        lines = [np.array(places) for places in curves.values()] if chart.lines else []
        place_labels(axis, [*names, *words], points, lines, guides, 9.5)
    return bytes(out.getvalue())


def _curve(axis: Any, places: Sequence[tuple[float, float]], number: int, *, joined: bool) -> None:
    axis.plot(
        *zip(*places, strict=True),
        marker=MARKS[number % len(MARKS)],
        color=COLOURS[number % len(COLOURS)],
        ms=7,
        mec="white",
        mew=0.8,
        ls="-" if joined else "none",
        lw=1.4,
        zorder=3,
    )


def _limits(axis: Any, chart: Chart, points: Sequence[tuple[float, float]]) -> None:
    """Room about the points for their names, and never less than two decades of error."""
    x, y = np.log10(np.array(points)).T
    reach_x, reach_y = max(np.ptp(x), 0.5), max(np.ptp(y), 1.6)
    middle_x, middle_y = 0.5 * (x.min() + x.max()), 0.5 * (y.min() + y.max())
    low, high = 10.0 ** (middle_x + reach_x * np.array([-0.62, 0.68]))
    if chart.x == "t0" and FIRST < low < NEAR_T0:
        low = FIRST
    axis.set_xlim(low, high)
    axis.set_ylim(*10.0 ** (middle_y + reach_y * np.array([-0.62, 0.62])))


def _guides(axis: Any, chart: Chart, points: Sequence[tuple[float, float]]) -> list[Any]:
    """The bare round trip, which corner is the good one, and a floor; gives the words."""
    words = [_note(axis, "↙ faster, nearer to the truth", (0.0, 0.0), ("left", "bottom"))]
    low, high = axis.get_xlim()
    if chart.x == "t0" and low < 1.0 < high:
        axis.axvline(1.0, color=FAINT, lw=1.0, ls=(0, (4, 3)), zorder=1)
        place = axis.transAxes.inverted().transform(axis.transData.transform((1.0, 1.0)))[0]
        # The end of the line that is farther from the points beside it.
        heights = axis.transAxes.inverted().transform(axis.transData.transform(points))
        near = heights[np.abs(heights[:, 0] - place) < 0.06][:, 1]
        top = bool(np.sum(near > 0.5) <= np.sum(near <= 0.5))
        ends = ("right", "top") if top else ("right", "bottom")
        words.append(_note(axis, "1 T0: bare round trip", (place, float(top)), ends, upright=True))
    if chart.floor is not None:
        value, text = chart.floor
        axis.axhline(value, color=FAINT, lw=1.0, ls=(0, (1, 2)), zorder=1)
        height = axis.transAxes.inverted().transform(axis.transData.transform((1.0, value)))[1]
        words.append(_note(axis, text, (1.0, height), ("right", "bottom")))
    return words


def _note(
    axis: Any,
    text: str,
    place: tuple[float, float],
    edges: tuple[str, str],
    *,
    upright: bool = False,
) -> Any:
    """Faint words that end at a place given as shares of the axes."""
    right, up = (5 if edges[0] == "left" else -5), (4 if edges[1] == "bottom" else -4)
    return axis.annotate(
        text,
        place,
        xycoords="axes fraction",
        xytext=(right, up),
        textcoords="offset points",
        ha=edges[0],
        va=edges[1],
        rotation=90 if upright else 0,
        fontsize=8.5,
        color=FAINT,
    )
