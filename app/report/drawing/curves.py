"""Curves and bars that nodes make, and the MTF and PTF of the stages, for reports."""

from collections.abc import Sequence
from itertools import cycle
from textwrap import wrap
from typing import Any, Literal

import numpy as np

from app.report.drawing import picture_drawing as drawing
from app.run import terminal
from app.run.evaluation import Evaluation
from app.run.transfer_chain import Chain, Responses, StageCurve, StageResponse
from core.chain.engine import realize
from core.chain.wires import Curve, CurveData

MOST = 12
_BESIDE = 2
_LINE = 0.21  # inches that a bar or a row of a legend is high
Named = tuple[str, CurveData]


def node_curves(evaluation: Evaluation) -> list[Named]:
    """Every curve output that no link leaves, by its port, in the network's order."""
    curves = []
    for name, output in evaluation.plan.network.unlinked_outputs(evaluation.engine.library):
        value = evaluation.plan.nodes[name].outputs.get(output)
        if isinstance(value, Curve):
            curves.append((f"{name}.{output}", realize(value, evaluation.work)))
    return curves


def curve_facts(evaluation: Evaluation) -> list[dict[str, Any]]:
    names = ("title", "x_label", "y_label", "bars", "log_y", "log_x")
    return [
        {
            "port": port,
            **terminal.values_of(data, *names),
            "series": [terminal.values_of(series, "label", "x", "y") for series in data.series],
        }
        for port, data in node_curves(evaluation)
    ]


def curves_png(curves: list[Named]) -> bytes:
    rows = [curves[at : at + _BESIDE] for at in range(0, len(curves), _BESIDE)]
    heights = [max(_height(data) for _, data in row) for row in rows]
    with drawing.figure(10.0, sum(heights)) as (drawn, out):
        axes = drawn.subplots(len(rows), _BESIDE, squeeze=False, height_ratios=heights)
        for axis in axes.ravel()[len(curves) :]:
            axis.set_visible(False)
        for axis, (port, data) in zip(axes.ravel(), curves, strict=False):
            draw_on(axis, data)
            axis.set_title(f"{data.title}\n", pad=2)
            look = {"xycoords": "axes fraction", "fontsize": 7.5, "color": "#666666"}
            drawing.note(axis, port, (0.0, 1.0), (0, 4), **look)
            if len(data.series) > 1:
                drawing.legend_below(axis, 5.0, 7.5)
    return out.getvalue()


def draw_on(axis: Any, data: CurveData) -> None:
    (_draw_bars if data.bars else _draw_curves)(axis, data)


def _height(data: CurveData) -> float:
    """Inches: of bars as many as there are, and of a legend its rows."""
    series = min(len(data.series), drawing.MOST_DRAWN + 1)
    legend = -(-series // 2) * _LINE if series > 1 else 0.0
    bars = len(data.bars) * (max(1, len(data.series)) * _LINE + 0.06) + 1.1
    return (max(2.2, bars) if data.bars else 3.3) + legend


def _draw_curves(axis: Any, data: CurveData) -> None:
    styles = ((colour, dash) for dash in cycle(_DASHES) for colour in drawing.COLOURS)
    totals = [float(series.label.startswith("Total")) for series in data.series]
    shown = [data.series[place] for place in drawing.strongest(totals)]
    for series, (colour, dash) in zip(shown, styles, strict=False):
        total = series.label.startswith("Total")
        y = _drawn(series.y, data.log_y)
        axis.plot(
            series.x,
            y,
            color="black" if total else colour,
            ls=(0, (3, 3)) if total else dash,  # in its gaps a curve below is seen
            lw=1.8 if total else 1.2,
            marker="o" if len(y) == 1 else None,
            label=series.label or data.y_label,
        )
    if len(shown) < len(data.series):
        axis.plot([], [], " ", label=f"and {len(data.series) - len(shown)} more, not drawn")
    axis.set_xlabel(data.x_label)
    axis.set_ylabel(data.y_label)
    along = np.concatenate([series.x for series in data.series] or [np.zeros(0)])
    if data.log_x:
        axis.set_xscale("log")
    elif len(along) and along.max() > along.min():  # gaps at the ends are shown, too
        room = 0.01 * (along.max() - along.min())
        axis.set_xlim(along.min() - room, along.max() + room)
    if data.log_y:
        axis.set_yscale("log")


def _draw_bars(axis: Any, data: CurveData) -> None:
    count = max(1, len(data.series))
    thick = 0.8 / count
    places = np.arange(len(data.bars))
    for place, (series, colour) in enumerate(
        zip(data.series, cycle(drawing.COLOURS), strict=False)
    ):
        at = places + (place - (count - 1) / 2) * thick
        y = np.asarray(series.y, np.float64)
        drawn = _drawn(y, data.log_y)
        axis.barh(at, drawn, thick * 0.92, color=colour, label=series.label)
        for height, end, value in zip(at, drawn, y, strict=True):
            _write_value(axis, height, end, value, data.log_y)
    if data.log_y:
        axis.set_xscale("log")
    names = (wrap(name, 24, max_lines=2, placeholder=" …") for name in data.bars)
    axis.set_yticks(places, ["\n".join(lines) for lines in names])
    axis.set_ylim(len(places) - 0.5, -0.5)
    axis.set_axisbelow(True)
    axis.grid(visible=False, axis="y")
    axis.axvline(0, color="#555555", lw=0.8)
    axis.margins(x=0.18)
    axis.set_xlabel(data.y_label)


def _write_value(axis: Any, height: float, end: float, value: float, log: bool) -> None:
    """The value behind its bar; where there is no bar, where it would begin."""
    if np.isfinite(value):
        text = drawing.number(value)
    else:
        text = "–" if np.isnan(value) else "∞" if value > 0 else "−∞"
    begins: Any = ((0.0, height), ("axes fraction", "data")) if log else ((0.0, height), "data")
    place, counted = ((end, height), "data") if np.isfinite(end) else begins
    below = bool(value < 0) and bool(np.isfinite(end))
    look = {"ha": "right" if below else "left", "va": "center", "fontsize": 7.5}
    drawing.note(axis, text, place, (-3 if below else 3, 0), xycoords=counted, **look)


def _drawn(y: Any, log: bool) -> Any:
    """Values with a gap where there is nothing to draw."""
    y = np.asarray(y, np.float64)
    return np.where(np.isfinite(y) & ((y > 0) | (not log)), y, np.nan)


# MTF and PTF figures, drawn like figs. 5.26 and 5.27 of Tantalo 1996.


_NEAR = 0.02  # curves so close are distinguished by their dashes
Part = Literal["mtf", "ptf"]
_DASHES = ("-", "--", "-.", (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))


def stages_png(responses: Responses, chain: Chain, part: Part) -> bytes:
    """MTF or PTF of the stages in `drawn_stages` and of the products: a. across, b. along."""
    stages = drawn_stages(responses, part)
    with drawing.figure(10.0, 4.7) as (drawn, out):
        axes = drawn.subplots(1, 2, sharey=True)
        named: dict[str, Any] = {}
        for axis, along in zip(axes, ("x", "y"), strict=True):
            panel(axis, responses, chain, stages, part, along)
            handles, labels = axis.get_legend_handles_labels()
            named = dict(zip(labels, handles, strict=True)) | named
        order = [_label(stage) for stage in (*stages, *responses.products)]
        named = {label: named[label] for label in order if label in named}
        texts = named.values(), named.keys()
        drawn.legend(*texts, loc="outside lower center", ncols=3, fontsize=8.5)
    return out.getvalue()


def line_png(responses: Responses, angle_deg: float) -> bytes:
    with drawing.figure(6.6, 4.7) as (drawn, out):
        axis = drawn.subplots()
        panel(axis, responses, None, drawn_stages(responses, "mtf"), "mtf", "x")
        axis.set_title(f"MTFs at {angle_deg:g}° from horizontal")
        axis.set_xlabel("frequency in this direction (cyc/mrad)")
        drawn.legend(loc="outside lower center", ncols=2, fontsize=8.5)
    return out.getvalue()


def drawn_stages(responses: Responses, part: Part) -> list[StageResponse]:
    """Stages that do something; of very many those that do most."""
    stages = [s for s in responses.stages if (s.has_phase if part == "ptf" else s.has_blur)]
    neutral = 1.0 if part == "mtf" else 0.0
    strengths = [
        max(float(np.abs(_values(s, part, along) - neutral).max(initial=0.0)) for along in "xy")
        for s in stages
    ]
    return [stages[place] for place in drawing.strongest(strengths)]


def product_png(responses: Responses, chain: Chain) -> bytes:
    whole = responses.products[-1]
    with drawing.figure(6.6, 4.3) as (drawn, out):
        axis = drawn.subplots()
        apart = whole.x.mtf - np.interp(responses.xi, responses.eta, whole.y.mtf)
        alike = float(np.max(np.abs(apart))) < _NEAR
        for frequency, response, colour, dash, name in (
            (responses.xi, whole.x, drawing.COLOURS[0], "-", "Horizontal MTF"),
            (responses.eta, whole.y, drawing.COLOURS[1], "--" if alike else "-", "Vertical MTF"),
        ):
            axis.plot(frequency, response.mtf, dash, color=colour, lw=2.0, label=name)
        _frame(axis, "frequency (cyc/mrad)", "MTF")
        _limits(axis, [whole.x.mtf, whole.y.mtf])
        _nyquist(axis, chain, "x")
        drawn.legend(loc="outside lower center", ncols=2, fontsize=8.5)
    return out.getvalue()


def _label(stage: StageResponse) -> str:
    return stage.title if stage.is_product else f"{stage.title} ({stage.name})"


def panel(
    axis: Any,
    responses: Responses,
    chain: Chain | None,
    stages: Sequence[StageResponse],
    part: Part,
    along: str,
) -> None:
    frequency = responses.xi if along == "x" else responses.eta
    styles = zip(cycle(drawing.COLOURS), cycle(_DASHES), strict=False)
    curves = []
    for stage, (colour, dash) in zip(stages, styles, strict=False):
        if not (stage.has_phase if part == "ptf" else stage.has_blur):
            continue
        curves.append(_values(stage, part, along))
        axis.plot(frequency, curves[-1], color=colour, ls=dash, lw=1.3, label=_label(stage))
    for product, dash in zip(responses.products, ("-", "--"), strict=False):
        values = _values(product, part, along)
        # On top of a curve it coincides with, in dashes that show it; else below all.
        hides = any(np.allclose(values, other, rtol=0, atol=1e-3) for other in curves)
        style: Any = {"ls": (0, (3, 3)), "zorder": 3} if hides else {"ls": dash, "zorder": 1.6}
        axis.plot(frequency, values, "k", lw=2.4, label=_label(product), **style)
        curves.append(values)
    direction = "a. Horizontal" if along == "x" else "b. Vertical"
    symbol = "ξ" if along == "x" else "η"
    axis.set_title(f"{direction} {part.upper()}s", pad=15)
    height = {"mtf": "MTF", "ptf": "PTF (rad)"}[part]
    _frame(axis, f"{symbol} (cyc/mrad)", height if along == "x" else "")
    if part == "mtf":
        _limits(axis, curves)
    _nyquist(axis, chain, along)


def _values(stage: StageResponse, part: Part, along: str) -> Any:
    response: StageCurve = stage.x if along == "x" else stage.y
    return response.mtf if part == "mtf" else response.ptf_rad


def _frame(axis: Any, x_label: str, y_label: str) -> None:
    axis.set_xlabel(x_label)
    axis.set_ylabel(y_label)
    axis.axhline(0, color="#555555", lw=0.8)
    axis.margins(x=0)


def _limits(axis: Any, curves: Sequence[Any]) -> None:
    from matplotlib.ticker import MultipleLocator

    low = min((float(curve.min()) for curve in curves if len(curve)), default=0.0)
    high = max((float(curve.max()) for curve in curves if len(curve)), default=1.0)
    axis.set_ylim(min(low * 1.15, -0.02), max(high, 1.0) * 1.06)
    axis.yaxis.set_major_locator(MultipleLocator(0.25))


def _nyquist(axis: Any, chain: Chain | None, along: str) -> None:
    """Vertical lines at the Nyquist frequencies of the samples and, where coarser, the pixels."""
    grid = None if chain is None else chain.grid
    if chain is None or grid is None:
        return
    nyquist = grid.nyquist_x if along == "x" else grid.nyquist_y
    pixels = chain.pixel_nyquist[0 if along == "x" else 1]
    marks = [(nyquist, "Nyquist")]
    if pixels is not None and pixels < 0.999 * nyquist:
        marks = [(nyquist, "samples' Nyquist"), (pixels, "pixels' Nyquist")]
    for index, (place, name) in enumerate(marks):
        axis.axvline(place, color="#999999", ls=":", lw=1.2)
        look = {"xycoords": ("data", "axes fraction"), "fontsize": 7, "color": "#666666"}
        look |= {"ha": "left" if index else "right", "va": "bottom"}
        drawing.note(axis, f"{name} {place:.4g}", (place, 1.0), (0, 2.5), **look)
    axis.set_xlim(0, marks[0][0] * 1.02)
