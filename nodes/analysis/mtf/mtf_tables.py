"""A measured MTF, and what was expected, as curves and figures."""

from __future__ import annotations

from typing import Literal

import numpy as np

from core.chain.results import CurveData, CurveMark, Series, TableData, TableRow
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from nodes.analysis.mtf.expected_mtf import Expected
from nodes.analysis.mtf.mtf_measuring import Measured

Axis = Literal["cyc_per_mrad", "cyc_per_pixel"]
NYQUIST = 0.5  # cycles per pixel
UNITS: dict[Axis, str] = {"cyc_per_mrad": "cyc/mrad", "cyc_per_pixel": "cyc/pixel"}


@ends_lineage
def curve_of(work: Work, measured: Measured, *expected: Expected, axis: Axis) -> CurveData:
    """MTF, the bounds of one standard error, and what is expected where that is known."""
    axis, factor = _axis(measured, axis)
    x = measured.frequency * factor
    series = [Series("measured", x, measured.mtf)]
    if measured.error.any():
        series.append(Series("+ standard error", x, measured.mtf + measured.error))
        series.append(Series("− standard error", x, np.maximum(measured.mtf - measured.error, 0.0)))
    series += [Series("expected", curve.frequency * factor, curve.mtf) for curve in expected]
    return CurveData(
        f"MTF {measured.direction}",
        f"frequency ({UNITS[axis]})",
        "MTF",
        tuple(series),
        marks=(CurveMark("Nyquist", NYQUIST * factor),),
    )


@ends_lineage
def spread_of(work: Work, measured: Measured, *, unit: str) -> CurveData:
    """Edge spread and line spread, per pixel, against the distance along the normal."""
    y_label = f"value ({unit})" if unit else "value"
    series = (
        Series("edge spread", measured.away, measured.spread),
        Series("line spread", measured.away, measured.line_spread),
    )
    return CurveData(f"Spread {measured.direction}", "distance (pixels)", y_label, series)


@ends_lineage
def table_of(
    work: Work, measured: Measured, *expected: Expected, axis: Axis, unit: str
) -> TableData:
    """Figures with their standard errors, and what is expected where that is known."""
    axis, factor = _axis(measured, axis)

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * factor

    rows = [TableRow("direction", measured.direction, "", "across what the MTF is measured")]
    rows.append(
        TableRow("edge_angle_deg", measured.angle_deg, "deg", "direction of the edge's normal")
    )
    for name, figure, meaning in (
        ("mtf50", measured.mtf50, "frequency at which the MTF falls to 0.5"),
        ("mtf10", measured.mtf10, "frequency at which the MTF falls to 0.1"),
    ):
        rows.append(TableRow(name, scaled(figure.value), UNITS[axis], meaning))
        rows.append(TableRow(f"{name}_error", scaled(figure.error), UNITS[axis], "standard error"))
    rows += [
        TableRow("nyquist", NYQUIST * factor, UNITS[axis], "half a cycle per pixel"),
        TableRow("at_nyquist", measured.nyquist.value, "", "MTF at Nyquist"),
        TableRow("at_nyquist_error", measured.nyquist.error, "", "standard error"),
        TableRow("contrast", measured.contrast, unit, "step of the edge, or height of the line"),
        TableRow("noise", measured.noise, unit, "standard deviation of a sample"),
    ]
    rows += _expected_rows(expected[0] if expected else None, factor, UNITS[axis])
    return TableData(tuple(rows))


def _axis(measured: Measured, axis: Axis) -> tuple[Axis, float]:
    """Axis and cycles on it in a cycle per pixel: without an interval per pixel."""
    if axis == "cyc_per_mrad" and measured.per_mrad is not None:
        return axis, measured.per_mrad
    return "cyc_per_pixel", 1.0


@ends_lineage
def figure_of(work: Work, measured: Measured, *, name: str) -> float | None:
    """One figure, frequencies in cycles per pixel or per mrad by the name."""
    if name == "edge_angle_deg":
        return measured.angle_deg
    if name.startswith("at_nyquist"):
        return measured.nyquist.error if name.endswith("error") else measured.nyquist.value
    figure = measured.mtf50 if name.startswith("mtf50") else measured.mtf10
    value = figure.error if name.endswith("error") else figure.value
    if name.endswith("per_pixel"):
        return value
    return None if value is None or measured.per_mrad is None else value * measured.per_mrad


def _expected_rows(expected: Expected | None, factor: float, unit: str) -> list[TableRow]:
    """Figures, without values where nothing is expected."""

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * factor

    half = at_nyquist = largest = at = scene = None
    if expected is not None:
        half, at_nyquist = scaled(expected.mtf50), expected.at_nyquist
        largest, at = expected.largest_difference, scaled(expected.largest_difference_at)
        scene = expected.scene
    return [
        TableRow("expected_mtf50", half, unit, "where the chain's own MTF falls to 0.5"),
        TableRow("expected_at_nyquist", at_nyquist, "", "the chain's own MTF at Nyquist"),
        TableRow("largest_difference", largest, "", "measured from expected, up to Nyquist"),
        TableRow("largest_difference_at", at, unit, "frequency of the largest difference"),
        TableRow("scene_blur", scene, "", "the scene's own, which counts as expected if known"),
    ]


@ends_lineage
def expected_figure(
    _work: Work, measured: Measured, expected: Expected, *, name: str
) -> float | None:
    """One figure for a read-out; frequencies in cycles/mrad."""
    if name == "expected_at_nyquist":
        return expected.at_nyquist
    if name == "largest_difference":
        return expected.largest_difference
    known = expected.mtf50 is not None and measured.per_mrad is not None
    return expected.mtf50 * measured.per_mrad if known else None  # type: ignore[operator]
