"""The section on the MTF measured in the final picture, beside what was to be expected."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from app.report.blocks import Block, Drawn, Grid, Heading, Text
from app.report.drawing.picture_drawing import COLOURS, figure, named
from app.report.drawing.printed_numbers import short

Fact = dict[str, Any]
_METHODS = {"slanted_edge": "slanted edge", "row_average": "row average"}
_LOOKS = {"slanted_edge": (COLOURS[0], "o", "k", "-"), "row_average": (COLOURS[1], "^", "k", ":")}
_MARKS = 32  # of measured points along a curve
_NO_ERROR = 5e-7


def judged(facts: Fact) -> list[Block]:
    """The section, with the reason where nothing could be measured."""
    edges, drawn_as = facts["judged"], facts["drawn_as"]
    blocks: list[Block] = [Heading(2, "Checked by measurement")]
    if edges["reason"]:
        return [*blocks, Text(f"Not measured: {edges['reason']}.")]
    good = [measurement for measurement in edges["measurements"] if measurement["reason"] is None]
    if good:
        blocks.append(Text(_introduction(edges)))
        published = drawn_as.get("judged")
        drawn = judged_png(edges, mirrored=published is not None)
        blocks.append(Drawn(drawn, _caption(published), "measured and expected MTF"))
        blocks.append(_table(good))
    for measurement in edges["measurements"]:
        if measurement["reason"] is not None:
            what = f"{measurement['direction']}, {_METHODS[measurement['method']]}"
            blocks.append(Text(f"Not measured ({what}): {measurement['reason']}."))
    return blocks


def _introduction(edges: Fact) -> str:
    text = (
        f"An edge from the lowest to the highest value of {edges['source']} replaces it and "
        f"passes through the whole chain; the MTF is measured in {edges['picture']}"
    )
    if edges["silenced"]:
        text += f", without the noise of {', '.join(edges['silenced'])}"
    return text + "."


def _caption(published: str | None) -> str:
    text = (
        "MTF measured (marks, with their standard errors) and expected (lines). For the "
        "slanted edge, the expected MTF is the product of the stages and the blur of the "
        "samples themselves: their area in the scene, combined pixels, and interpolation "
        "along the edge. Aliasing, from samples that are too far apart, scatters the marks about "
        "it. The row average sees a vertical edge at a single position relative to the pixels, so "
        "frequencies beyond the pixels' Nyquist frequency are aliased. It also takes differences "
        "between neighbours, which reduce the MTF to 0.64 at Nyquist. Its expected MTF is "
        "computed along one row and includes this aliasing."
    )
    if published:
        text += (
            " The row average is the method of the thesis. Its curves for pictures of real "
            "cameras are printed without numbers, so they are not drawn here."
        )
    return named(text, published)


def judged_png(edges: Fact, *, mirrored: bool) -> bytes:
    """Horizontal and vertical MTF beside each other, in cycles per sample of the picture."""
    with figure(10.0, 4.6) as (drawn, out):
        axes = drawn.subplots(1, 2, sharey=True)
        lines: dict[str, Any] = {}
        for axis, direction in zip(axes, ("horizontal", "vertical"), strict=True):
            _panel(axis, edges, direction, mirrored)
            axis.set_title(f"{direction.capitalize()} MTF")
            interval = edges["interval_mrad"][direction]
            axis.set_xlabel(f"frequency (cycles/sample of {short(interval)} mrad)")
            handles, labels = axis.get_legend_handles_labels()
            lines |= dict(zip(labels, handles, strict=True))
        axes[0].set_ylabel("MTF")
        drawn.legend(lines.values(), lines.keys(), loc="outside lower center", ncols=3, fontsize=8)
    return out.getvalue()


def _panel(axis: Any, edges: Fact, direction: str, mirrored: bool) -> None:
    stages = edges["stages"][direction]
    inside = stages["frequency_cyc_per_sample"] <= 0.5 + 1e-9
    x, y = _sides(mirrored, stages["frequency_cyc_per_sample"][inside], stages["mtf"][inside])
    axis.plot(x, y, color="#999999", lw=1.2, ls="--", label="stages alone")
    highest = 1.0
    for measurement in edges["measurements"]:
        if measurement["direction"] != direction or measurement["reason"] is not None:
            continue
        colour, mark, line, dash = _LOOKS[measurement["method"]]
        name = _METHODS[measurement["method"]]
        frequency = measurement["frequency_cyc_per_sample"]
        x, y = _sides(mirrored, frequency, measurement["expected"])
        axis.plot(x, y, color=line, ls=dash, lw=1.4, label=f"expected for the {name}")
        few = slice(None, None, max(1, len(frequency) // _MARKS))
        x, y, error = _sides(
            mirrored, frequency[few], measurement["mtf"][few], measurement["mtf_error"][few]
        )
        axis.errorbar(
            x, y, error, fmt=mark, ms=3.6, color=colour, mfc="none", mew=1.0, elinewidth=0.8,
            label=f"measured, {name}",
        )  # fmt: skip
        highest = max(highest, float(y.max()))
    axis.axhline(0, color="#555555", lw=0.8)
    axis.set_ylim(-0.03, highest * 1.06)
    axis.set_xlim(*(-0.52, 0.52) if mirrored else (0.0, 0.51))


def _sides(mirrored: bool, frequency: Any, *curves: Any) -> list[Any]:
    if not mirrored:
        return [frequency, *curves]
    sides = [np.concatenate([-frequency[:0:-1], frequency])]
    return sides + [np.concatenate([curve[:0:-1], curve]) for curve in curves]


def _table(measurements: Iterable[Fact]) -> Grid:
    rows = [
        (
            measurement["direction"],
            _METHODS[measurement["method"]],
            _with_error(measurement["mtf50_cyc_per_mrad"], measurement["mtf50_error_cyc_per_mrad"]),
            short(measurement["expected_mtf50_cyc_per_mrad"]),
            _with_error(measurement["at_nyquist"], measurement["at_nyquist_error"]),
            short(measurement["expected_at_nyquist"]),
            short(measurement["largest_difference"], 2),
            short(measurement["largest_difference_at_cyc_per_mrad"], 3),
        )
        for measurement in measurements
    ]
    heads = (
        "direction", "edge", "MTF50 (cyc/mrad)", "expected", "MTF at Nyquist", "expected",
        "largest difference", "at (cyc/mrad)",
    )  # fmt: skip
    return Grid(heads, rows, numbers=range(2, 8))


def _with_error(value: float | None, error: float | None) -> str:
    """A figure with its standard error, where that is more than rounding."""
    text = short(value)
    known = value is not None and error is not None and error > _NO_ERROR
    return f"{text} ± {short(error, 2)}" if known else text
