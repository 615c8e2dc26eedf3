"""A trade-off as a picture: each figure in a panel of its own, over the same abscissa."""

from __future__ import annotations

import math
from typing import Any

from app.report.drawing.picture_drawing import COLOURS, figure
from app.report.drawing.printed_numbers import number
from app.tradeoff.tradeoff_figures import Figure
from app.tradeoff.tradeoff_results import Results, shown_value
from app.tradeoff.values import is_number

_ACROSS = 3
_LOG_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
_LONGEST = 28  # letters of a line of a title
_FAILED = "#b3261e"
_MOST_MARKED = 40  # points that still stand apart


def trade_off_png(results: Results) -> bytes:
    """The picture; gaps where figures have no value, a dashed line at the present value."""
    across = min(_ACROSS, len(results.figures))
    down = -(-len(results.figures) // across)
    with figure(max(4.6, 3.4 * across), 2.3 * down + 0.7) as (drawn, out):
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
            drawn.legend(
                handles=handles,
                loc="outside lower center",
                ncols=min(8, len(results.curves)),
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
    for index, curve in enumerate(results.curves):
        heights = [point.figures.get(shown.text, math.nan) for point in curve.points]
        heights = [height if math.isfinite(height) else math.nan for height in heights]
        finite += [height for height in heights if not math.isnan(height)]
        label = "_" if results.second is None else shown_value(curve.second)
        style = "-" if numeric else ":"
        marker = "o" if len(places) <= _MOST_MARKED or not numeric else ""
        colour = COLOURS[index % len(COLOURS)]
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
