"""MTF and PTF figures, drawn like figs. 5.26 and 5.27 of Tantalo 1996."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Any, Literal

import numpy as np

from app.report.drawing.picture_drawing import COLOURS, figure, strongest
from app.run.responses import LineResponses, Response, Responses, StageResponse
from app.run.transfer_chain import Chain

_NEAR = 0.02  # curves so close are distinguished by their dashes
Part = Literal["mtf", "ptf"]
_DASHES = ("-", "--", "-.", (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))


def stages_png(responses: Responses, chain: Chain, part: Part) -> bytes:
    """MTF or PTF of the stages in `drawn_stages` and of the products: a. across, b. along."""
    stages = drawn_stages(responses, part)
    with figure(10.0, 4.7) as (drawn, out):
        axes = drawn.subplots(1, 2, sharey=True)
        named: dict[str, Any] = {}
        for axis, along in zip(axes, ("x", "y"), strict=True):
            panel(axis, responses, chain, stages, part, along)
            handles, labels = axis.get_legend_handles_labels()
            named = dict(zip(labels, handles, strict=True)) | named
        order = [_label(stage) for stage in (*stages, *responses.products)]
        named = {label: named[label] for label in order if label in named}
        drawn.legend(
            named.values(), named.keys(), loc="outside lower center", ncols=3, fontsize=8.5
        )
    return out.getvalue()


def line_png(responses: LineResponses, angle_deg: float) -> bytes:
    stages = [stage for stage in responses.stages if (stage.response.mtf != 1).any()]
    stages = [stages[n] for n in strongest([float(np.ptp(s.response.mtf)) for s in stages])]
    with figure(6.6, 4.7) as (drawn, out):
        axis = drawn.subplots()
        for stage, (colour, dash) in zip(
            stages, zip(cycle(COLOURS), cycle(_DASHES), strict=False), strict=False
        ):
            name = f"{stage.title} ({stage.name})"
            axis.plot(responses.frequency, stage.response.mtf, color=colour, ls=dash, label=name)
        for product, dash in zip(responses.products, ("-", "--"), strict=False):
            values = product.response.mtf
            axis.plot(responses.frequency, values, "k", ls=dash, lw=2.4, label=product.title)
        axis.set_title(f"MTFs at {angle_deg:g}° from horizontal")
        _frame(axis, "frequency along the line (cyc/mrad)", "MTF")
        _limits(axis, [stage.response.mtf for stage in (*stages, *responses.products)])
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
    return [stages[place] for place in strongest(strengths)]


def product_png(responses: Responses, chain: Chain) -> bytes:
    whole = responses.products[-1]
    with figure(6.6, 4.3) as (drawn, out):
        axis = drawn.subplots()
        apart = whole.x.mtf - np.interp(responses.xi, responses.eta, whole.y.mtf)
        alike = float(np.max(np.abs(apart))) < _NEAR
        for frequency, response, colour, dash, name in (
            (responses.xi, whole.x, COLOURS[0], "-", "Horizontal MTF"),
            (responses.eta, whole.y, COLOURS[1], "--" if alike else "-", "Vertical MTF"),
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
    chain: Chain,
    stages: Sequence[StageResponse],
    part: Part,
    along: str,
) -> None:
    frequency = responses.xi if along == "x" else responses.eta
    styles = zip(cycle(COLOURS), cycle(_DASHES), strict=False)
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
    _frame(
        axis,
        f"{symbol} (cyc/mrad)",
        {"mtf": "MTF", "ptf": "PTF (rad)"}[part] if along == "x" else "",
    )
    if part == "mtf":
        _limits(axis, curves)
    _nyquist(axis, chain, along)


def _values(stage: StageResponse, part: Part, along: str) -> Any:
    response: Response = stage.x if along == "x" else stage.y
    return response.mtf if part == "mtf" else response.ptf


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


def _nyquist(axis: Any, chain: Chain, along: str) -> None:
    """Vertical lines at the Nyquist frequencies of the samples and, where coarser, the pixels."""
    grid = chain.grid
    if grid is None:
        return
    nyquist = grid.nyquist_x if along == "x" else grid.nyquist_y
    pixels = chain.pixel_nyquist[0 if along == "x" else 1]
    marks = [(nyquist, "Nyquist")]
    if pixels is not None and pixels < 0.999 * nyquist:
        marks = [(nyquist, "samples' Nyquist"), (pixels, "pixels' Nyquist")]
    for index, (place, name) in enumerate(marks):
        axis.axvline(place, color="#999999", ls=":", lw=1.2)
        axis.annotate(
            f"{name} {place:.4g}",
            (place, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 2.5),
            textcoords="offset points",
            ha="left" if index else "right",
            va="bottom",
            fontsize=7,
            color="#666666",
        )
    axis.set_xlim(0, marks[0][0] * 1.02)
