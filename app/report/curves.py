"""MTF and PTF figures, drawn like figs. 5.26 and 5.27 of Tantalo 1996."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np

from app.chain import Chain
from app.report.drawing import COLOURS, figure
from app.responses import Response, Responses, StageResponse

_DASHES = ("-", "--", "-.", (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))


def stages_png(found: Responses, chain: Chain) -> bytes:
    """Every stage and the products, across and along: MTF, and PTF where there is one.

    Stages that do nothing are left out.
    """
    drawn_stages = [s for s in found.stages if s.acts]
    phases = any(stage.has_phase for stage in drawn_stages)
    rows = 2 if phases else 1
    with figure(10.0, 3.9 * rows + 0.8) as (drawn, out):
        axes = drawn.subplots(rows, 2, squeeze=False, sharey="row")
        for row, part in enumerate(("mtf", "ptf")[:rows]):
            for column, along in enumerate(("x", "y")):
                panel(axes[row][column], found, chain, drawn_stages, part, along)
        named: dict[str, Any] = {}
        for axis in axes.ravel():
            handles, labels = axis.get_legend_handles_labels()
            named = dict(zip(labels, handles, strict=True)) | named
        order = [_label(s) for s in (*drawn_stages, *found.products)]
        named = {label: named[label] for label in order if label in named}
        drawn.legend(
            named.values(), named.keys(), loc="outside lower center", ncols=3, fontsize=8.5
        )
    return out.getvalue()


def product_png(found: Responses, chain: Chain) -> bytes:
    """The product across and along in one figure."""
    with figure(6.6, 4.3) as (drawn, out):
        axis = drawn.subplots()
        for product, width in zip(found.products, (1.8, 1.2), strict=False):
            for frequency, response, colour, name in (
                (found.xi, product.x, "#1f77b4", "across (x)"),
                (found.eta, product.y, "#d95f02", "along (y)"),
            ):
                first = product is found.products[0]
                total = found.products[0].x if response is product.x else found.products[0].y
                if not first and np.array_equal(response.mtf, total.mtf):
                    continue  # the electronics does nothing along this axis
                dash = "-" if first else "-."
                if response is product.y and np.array_equal(product.x.mtf, product.y.mtf):
                    dash = "--" if first else ":"
                axis.plot(
                    frequency,
                    response.mtf,
                    dash,
                    color=colour,
                    lw=width,
                    label=f"{product.title}, {name}",
                )
        _frame(axis, "frequency (cyc/mrad)", "MTF")
        _limits(axis, [r.mtf for p in found.products for r in (p.x, p.y)])
        _nyquist(axis, chain, "x")
        drawn.legend(loc="outside lower center", ncols=2, fontsize=8.5)
    return out.getvalue()


def _label(stage: StageResponse) -> str:
    return stage.title if stage.is_product else f"{stage.title} ({stage.name})"


def panel(
    axis: Any,
    found: Responses,
    chain: Chain,
    stages: Sequence[StageResponse],
    part: str,
    along: str,
) -> None:
    """Draw the MTF or PTF of the stages and products along one axis."""
    frequency = found.xi if along == "x" else found.eta
    styles = zip(cycle(COLOURS), cycle(_DASHES), strict=False)
    curves = []
    for stage, (colour, dash) in zip(stages, styles, strict=False):
        if not (stage.has_phase if part == "ptf" else stage.has_blur):
            continue
        curves.append(_values(stage, part, along))
        axis.plot(frequency, curves[-1], color=colour, ls=dash, lw=1.3, label=_label(stage))
    for product, dash in zip(found.products, ("-", "--"), strict=False):
        values = _values(product, part, along)
        # On top of a curve it coincides with, in dashes that let it through; else below all.
        hides = any(np.allclose(values, other, rtol=0, atol=1e-3) for other in curves)
        style: Any = {"ls": (0, (3, 3)), "zorder": 3} if hides else {"ls": dash, "zorder": 1.6}
        axis.plot(frequency, values, "k", lw=2.0, label=_label(product), **style)
        curves.append(values)
    direction = "Across" if along == "x" else "Along"
    symbol = "ξ" if along == "x" else "η"
    axis.set_title(f"{direction}: {part.upper()}", pad=15)
    _frame(
        axis,
        f"{symbol} (cyc/mrad)",
        {"mtf": "MTF", "ptf": "PTF (rad)"}[part] if along == "x" else "",
    )
    if part == "mtf":
        _limits(axis, curves)
    _nyquist(axis, chain, along)


def _values(stage: StageResponse, part: str, along: str) -> Any:
    response: Response = stage.x if along == "x" else stage.y
    return response.mtf if part == "mtf" else response.ptf


def _frame(axis: Any, x_label: str, y_label: str) -> None:
    axis.set_xlabel(x_label)
    axis.set_ylabel(y_label)
    axis.axhline(0, color="#555555", lw=0.8)
    axis.margins(x=0)


def _limits(axis: Any, curves: Sequence[Any]) -> None:
    low = min((float(curve.min()) for curve in curves if len(curve)), default=0.0)
    high = max((float(curve.max()) for curve in curves if len(curve)), default=1.0)
    axis.set_ylim(min(low * 1.15, -0.02), max(high, 1.0) * 1.06)


def _nyquist(axis: Any, chain: Chain, along: str) -> None:
    """Vertical lines at the Nyquist frequencies before and after pixels are combined."""
    grid, combined = chain.grid, chain.combined
    if grid is None:
        return
    marks = [(grid.nyquist_x if along == "x" else grid.nyquist_y, "Nyquist")]
    if combined is not None:
        after = combined.nyquist_x if along == "x" else combined.nyquist_y
        if after < 0.999 * marks[0][0]:
            marks.append((after, "pixels combined"))
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
