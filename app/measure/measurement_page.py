"""A measurement as files: one page that needs no other, JSON, and a table of MTF."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.measure import measurement_text as told
from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement
from app.report import html_page as html
from app.report.drawing.picture_drawing import COLOURS, figure, number
from app.run.saving import robust_limits
from app.run.terminal import json_text, values_of
from core.atomic import write_text
from core.errors import DataError, UsageError, listed, printable
from core.physics.measurement.edge_mtf import LARGEST_ANGLE_DEG, MtfCurve
from core.records import asdict
from nodes.files.curve_tables import LARGEST_MTF
from nodes.files.file_format import CSV, HTML, JSON, suffixes
from nodes.files.table_cells import csv_columns

_MOST_REFUSED = 60
_PLACE = ("edge", "column", "row", "normal (°)", "length")


def measurement_page(measured: PictureMeasurement) -> str:
    names = [Path(file.name).name for file in measured.files]
    title = f"Measured: {names[0]}" + (f" and {len(names) - 1} more" if len(names) > 1 else "")
    notes, heads = told.remarks(measured), ("figure", "value", "unit", "meaning")
    blocks = [
        html.paragraph(_lead(measured), "lead"),
        html.grid(heads, told.figure_rows(measured), (1,), kind="readouts"),
        html.items(f"{line[:1].upper()}{line[1:]}." for line in notes) if notes else "",
        _edges(measured),
        _mtf(measured),
        _noise(measured),
        _edge_tables(measured),
    ]
    return html.page(title, blocks)


def _lead(measured: PictureMeasurement) -> str:
    count = measured.picture_count
    what = "One picture" if count == 1 else f"{count} pictures"
    unit = f", in {measured.unit}" if measured.unit else ""
    interval = ""
    if measured.interval_x_mrad is not None and measured.interval_y_mrad is not None:
        interval = (
            f"; sampling interval {number(_short(measured.interval_x_mrad))} × "
            f"{number(_short(measured.interval_y_mrad))} mrad"
        )
    return f"{what} of {measured.columns} × {measured.rows} samples{unit}{interval}."


def _short(value: float) -> float:
    return float(f"{value:.4g}")


def _edges(measured: PictureMeasurement) -> str:
    blocks = html.heading(2, "Edges")
    if not measured.edges:
        return blocks + html.paragraph("No straight edge was found.")
    for picture in range(len(measured.previews)):
        name = measured.picture_name(picture)
        caption = (
            f"{name}. The tables below refer to edges by number. Grey levels span the 0.1 % to "
            "99.9 % quantiles."
        )
        drawn = edges_png(measured, picture)
        blocks += html.drawn(drawn, caption, f"edges of {name}")
    more = measured.picture_count - len(measured.previews)
    if more > 0:
        blocks += html.paragraph(f"Pictures not drawn: {more}.")
    return blocks


def _mtf(measured: PictureMeasurement) -> str:
    blocks = html.heading(2, "MTF")
    if measured.x is None and measured.y is None:
        across = html.paragraph(f"No horizontal MTF: {measured.reason_x}.")
        return blocks + across + html.paragraph(f"No vertical MTF: {measured.reason_y}.")
    caption = (
        "MTF of everything from the scene to the stored samples, pooled over the edges used "
        "(weights: 1/error²). Grey curves: single edges whose normals lie within 30° of the axis. "
        "Beyond the Nyquist frequency, 0.5 cycles/sample, the picture is aliased, but slanted "
        "edges still give the MTF."
    )
    blocks += html.drawn(mtf_png(measured), caption, "pooled MTF")
    return blocks


def _noise(measured: PictureMeasurement) -> str:
    if measured.frames is None:
        return ""
    heads = ("component", "σ", "unit", "meaning")
    return (
        html.heading(2, "Temporal noise")
        + html.grid(heads, told.frame_rows(measured), numbers=(1,))
        + html.paragraph(
            "The fixed pattern of these frames includes the scene. To measure "
            "fixed-pattern noise, give frames of a uniform field to imagechain photon-transfer."
        )
    )


def _edge_tables(measured: PictureMeasurement) -> str:
    numbered = list(enumerate(measured.edges, 1))
    used = [(number, edge) for number, edge in numbered if edge.used]
    refused = [(number, edge) for number, edge in numbered if not edge.used]
    blocks = ""
    several = measured.picture_count > 1
    if used:
        rows = [(*_place(edge, n, several), *_figures(edge)) for n, edge in used]
        blocks += (
            html.heading(2, "Edges used")
            + html.grid((*_PLACE, "step", "step/noise", "MTF50"), rows, numbers=range(1, 8))
            + html.paragraph(
                "MTF50 in cycles/sample along the edge's normal. Edges with a normal within "
                f"{LARGEST_ANGLE_DEG:g}° of 0° or 180° give the horizontal MTF; a normal within "
                f"{LARGEST_ANGLE_DEG:g}° of ±90° gives the vertical MTF. The value after ± is the "
                "standard error that the horizontal or vertical MTF50 would have with this edge "
                "alone. Edges in other directions show how the blur changes with direction."
            )
        )
    if refused:
        kinds = told.counted(edge.why_not for _, edge in refused)
        shown = refused[:_MOST_REFUSED]
        whys = [(*_place(edge, n, several), edge.why_not) for n, edge in shown]
        blocks += (
            html.heading(2, "Edges not used")
            + html.grid(("edges", "why not"), [(str(n), kind) for kind, n in kinds], numbers=(0,))
            + html.paragraph("For advice, run imagechain handbook edge_pictures.")
            + html.grid((*_PLACE, "why not"), whys, numbers=range(1, 5))
        )
        if len(refused) > len(shown):
            blocks += html.paragraph(f"And {len(refused) - len(shown)} more.")
    return blocks


def _place(edge: MeasuredEdge, place: int, several: bool) -> tuple[str, ...]:
    found = edge.found
    name = f"{place} (picture {edge.picture})" if several else str(place)
    angle = f"{found.angle_deg:.1f}".replace("-", "−")
    return name, f"{found.x:.1f}", f"{found.y:.1f}", angle, f"{found.length:.0f}"


def _figures(edge: MeasuredEdge) -> tuple[str, str, str]:
    step, noise, curve = edge.found.contrast, edge.found.noise_sigma, edge.curve
    half = told.with_error(None if curve is None else curve.mtf50, edge.mtf50_sigma)
    return number(_short(step)), f"{step / noise:.3g}" if noise > 0.0 else "–", half


# Figures of a measurement: edges drawn on the pictures, and the MTF with its error.

_MOST_NUMBERED = 60
_MOST_CURVES = 40
_UNSURE = 0.25  # standard error from which on a single edge's MTF is not drawn


def edges_png(measured: PictureMeasurement, picture: int) -> bytes:
    """One picture with its edges: used ones in full lines with their numbers, others dashed."""
    preview, (rows, columns) = measured.previews[picture], measured.preview_shape
    width = 10.0 if columns >= 0.9 * rows else 6.5
    with figure(width, min(width * rows / columns, 12.0) + 0.5) as (drawn, out):
        axis = drawn.subplots()
        low, high = robust_limits(preview)
        axis.imshow(
            preview, cmap="gray", vmin=low, vmax=high if high > low else low + 1.0,
            extent=(-0.5, columns - 0.5, rows - 0.5, -0.5), interpolation="nearest",
        )  # fmt: skip
        axis.grid(visible=False)
        axis.set_xlabel("column")
        axis.set_ylabel("row")
        every = enumerate(measured.edges, 1)
        own = [(number, edge) for number, edge in every if edge.picture == picture]
        for number, edge in sorted(own, key=lambda one: one[1].used):
            _draw_edge(axis, edge, number if len(own) <= _MOST_NUMBERED or edge.used else None)
        axis.set_xlim(-0.5, columns - 0.5)
        axis.set_ylim(rows - 0.5, -0.5)
        _legend(drawn, own)
    return out.getvalue()


def _draw_edge(axis: Any, edge: MeasuredEdge, number: int | None) -> None:
    from matplotlib.patheffects import withStroke

    xs, ys = zip(*edge.found.ends, strict=True)
    dark = [withStroke(linewidth=3.0 if edge.used else 2.0, foreground="#000000a0")]
    look: Any = (
        {"color": told.USED, "lw": 1.8, "ls": "-", "zorder": 3}
        if edge.used
        else {"color": told.REFUSED, "lw": 1.0, "ls": (0, (3, 2)), "zorder": 2}
    )
    axis.plot(xs, ys, path_effects=dark, **look)
    if number is not None:
        axis.annotate(
            str(number), (edge.found.x, edge.found.y), xytext=(3, 3), textcoords="offset points",
            fontsize=8 if edge.used else 6.5, color=look["color"], clip_on=True,
            path_effects=[withStroke(linewidth=2.0, foreground="#000000c0")], zorder=4,
        )  # fmt: skip


def _legend(drawn: Any, edges: Sequence[tuple[int, MeasuredEdge]]) -> None:
    from matplotlib.lines import Line2D

    used = sum(edge.used for _, edge in edges)
    lines = [
        Line2D([], [], color=told.USED, lw=2.0, label=f"used ({used})"),
        Line2D(
            [], [], color="#2b8cc4", lw=1.4, ls=(0, (3, 2)), label=f"not used ({len(edges) - used})"
        ),
    ]
    drawn.legend(handles=lines, loc="outside lower center", ncols=2, fontsize=8.5)


def mtf_png(measured: PictureMeasurement) -> bytes:
    with figure(10.0, 4.4) as (drawn, out):
        axes = drawn.subplots(1, 2, sharey=True)
        for axis, direction in zip(axes, ("x", "y"), strict=True):
            curve = measured.x if direction == "x" else measured.y
            words = "a. Horizontal (x)" if direction == "x" else "b. Vertical (y)"
            axis.set_title(words, pad=4 if measured.interval_x_mrad else 12)
            axis.set_xlabel("frequency (cycles/sample)")
            axis.axhline(0.0, color="#555555", lw=0.8)
            axis.axvline(told.NYQUIST, color="#999999", ls=":", lw=1.2)
            axis.annotate(
                "Nyquist", (told.NYQUIST, 0.98), xycoords=("data", "axes fraction"), xytext=(3, 0),
                textcoords="offset points", va="top", fontsize=7, color="#666666",
            )  # fmt: skip
            _mtf_panel(axis, measured, direction, curve)
            axis.set_xlim(0.0, 1.0)
            axis.set_ylim(-0.03, 1.25)
            _second_scale(axis, measured.interval_mrad(direction))
        axes[0].set_ylabel("MTF")
    return out.getvalue()


def _mtf_panel(
    axis: Any, measured: PictureMeasurement, direction: str, curve: MtfCurve | None
) -> None:
    if curve is None:
        axis.text(0.5, 0.5, "not measured", transform=axis.transAxes, ha="center", color="#666666")
        return
    colour = COLOURS[0] if direction == "x" else COLOURS[1]
    used = (edge for edge in measured.edges if edge.used and edge.curve is not None)
    own = [edge for edge in used if edge.direction == direction]
    for place, edge in enumerate(own[:_MOST_CURVES]):
        assert edge.curve is not None
        sure = edge.curve.sigma < _UNSURE
        axis.plot(
            (edge.curve.frequency * edge.stretch)[sure], edge.curve.mtf[sure],
            color="#777777", lw=0.6, alpha=0.6,
            label="single edges" if place == 0 else None,
        )  # fmt: skip
    axis.fill_between(
        curve.frequency, curve.mtf - 2.0 * curve.sigma, curve.mtf + 2.0 * curve.sigma,
        color=colour, alpha=0.25, lw=0, label="± 2 standard errors",
    )  # fmt: skip
    axis.plot(curve.frequency, curve.mtf, color=colour, lw=1.8, label="pooled")
    if curve.mtf50 is not None:
        axis.plot([curve.mtf50], [0.5], "o", ms=5, color=colour, mec="white", mew=0.8)
    axis.legend(loc="upper right", fontsize=8)


def _second_scale(axis: Any, interval_mrad: float | None) -> None:
    if interval_mrad is None:
        return
    there = lambda frequency: np.asarray(frequency) / interval_mrad  # noqa: E731
    back = lambda frequency: np.asarray(frequency) * interval_mrad  # noqa: E731
    scale = axis.secondary_xaxis("top", functions=(there, back))
    scale.set_xlabel("cycles/mrad", fontsize=7.5, color="#444444")
    scale.tick_params(labelsize=7.5, colors="#444444")


# Files of a measurement: JSON, a table of MTF that the module MTF File reads, or a page.

Json = dict[str, Any]
WRITTEN = (JSON, CSV, HTML)
_NOISE = (
    "sigma", "sigma_error", "gain_e_per_dn", "gain_error", "read_noise_dn", "read_noise_error",
    "offset_dn", "mean_level", "row_sigma", "column_sigma", "step",
)  # fmt: skip
_FOUND = ("x", "y", "angle_deg", "length", "reach", "low", "high")


def measurement_facts(measured: PictureMeasurement) -> Json:
    """The measurement for JSON; what could not be measured is absent, and a reason stands there."""
    content: Json = {
        "format": "imagechain-measurement",
        "version": 1,
        "pictures": [
            {"file": file.name, "frames": file.frames, **_given(taken=file.taken or None)}
            for file in measured.files
        ],
        "rows": measured.rows,
        "columns": measured.columns,
        **_given(
            unit=measured.unit or None,
            interval_x_mrad=measured.interval_x_mrad,
            interval_y_mrad=measured.interval_y_mrad,
            pitch_um=measured.pitch_um,
        ),
        "mtf": {
            "x": _curve(measured.x, measured.reason_x, measured.interval_x_mrad, measured.pitch_um),
            "y": _curve(measured.y, measured.reason_y, measured.interval_y_mrad, measured.pitch_um),
        },
        "noise": _noise_json(measured),
        "edges": [_edge(edge, measured.picture_count > 1) for edge in measured.edges],
    }
    if measured.picture_count > 1:
        content["frames"] = _frames(measured)
    warnings = [*told.file_warnings(measured.files), *measured.warnings]
    if warnings:
        content["warnings"] = warnings
    return content


def measurement_csv(measured: PictureMeasurement) -> str:
    """The pooled MTF as a table that the module MTF File reads: frequency, horizontal, vertical."""
    curves = {"mtf_x": measured.x, "mtf_y": measured.y}
    known = {name: curve for name, curve in curves.items() if curve is not None}
    if not known:
        raise DataError(
            f"there is no MTF to write (horizontal: {measured.reason_x}; vertical: "
            f"{measured.reason_y}). To see why each edge was not used, write a page (.html)"
        )
    last = min(float(curve.frequency[-1]) for curve in known.values())
    frequency = next(iter(known.values())).frequency
    frequency = frequency[frequency <= last]
    columns = [("frequency (cyc/pixel)", frequency.tolist())]
    for name, curve in known.items():
        mtf = np.clip(np.interp(frequency, curve.frequency, curve.mtf), 0.0, LARGEST_MTF)
        columns.append((name, mtf.tolist()))
    return csv_columns(columns)


def _given(**values: Any) -> Json:
    """Those that are known and finite."""
    return {
        name: value
        for name, value in values.items()
        if value is not None and not (isinstance(value, float) and not math.isfinite(value))
    }


def _curve(
    curve: MtfCurve | None, reason: str, interval_mrad: float | None, pitch_um: float | None
) -> Json:
    if curve is None:
        return {"reason": reason}
    content: Json = {"frequency_cyc_per_sample": curve.frequency}
    if interval_mrad is not None:
        content["frequency_cyc_per_mrad"] = curve.frequency / interval_mrad
    if pitch_um is not None:
        content["frequency_cyc_per_mm"] = curve.frequency / (1e-3 * pitch_um)
    return {
        **content,
        "mtf": curve.mtf,
        "sigma": curve.sigma,
        **_given(mtf50=curve.mtf50, mtf50_sigma=curve.mtf50_sigma),
        "edges": curve.edges,
        "scatter": curve.scatter,
    }


def _noise_json(measured: PictureMeasurement) -> Json:
    noise = measured.noise
    if noise is None:
        return {"reason": measured.noise_reason}
    return _given(
        **values_of(noise, *_NOISE),
        levels=[asdict(level) for level in noise.levels],
        remarks=noise.remarks or None,
        reason=noise.reason or None,
    )


def _edge(edge: MeasuredEdge, of_several: bool) -> Json:
    curve = edge.curve
    figures: Mapping[str, float | None] = (
        {} if curve is None else {"mtf50": curve.mtf50, "sigma": edge.mtf50_sigma}
    )
    return {
        **({"picture": edge.picture} if of_several else {}),
        **values_of(edge.found, *_FOUND),
        **_given(**figures),
        "used": edge.used,
        "why_not": edge.why_not,
    }


def _frames(measured: PictureMeasurement) -> Json:
    frames = measured.frames
    if frames is None:
        return {"reason": measured.frames_reason}
    return {
        "frames": frames.frames,
        **_given(**values_of(measured.noise, "sigma", "sigma_error")),
        **{f"sigma_{name}": frames.variances.sigma(name) for name in told.TEMPORAL},
        **{f"variance_{name}_error": frames.errors.variance(name) for name in told.TEMPORAL},
    }


def measurement_text(measured: PictureMeasurement, path: Path) -> str:
    """What a file of that suffix holds: .json everything, .csv the pooled MTF, .html a page."""
    if JSON.matches(path):
        text = json_text(measurement_facts(measured))
    elif CSV.matches(path):
        text = measurement_csv(measured)
    elif HTML.matches(path):
        text = measurement_page(measured)
    else:
        ends = listed(suffixes(*WRITTEN), "or")
        raise UsageError(f"{path}: the file's name must end in {ends}")
    # Names of files may hold what cannot be written.
    return "\n".join(printable(line) for line in text.split("\n"))


def write_measurement(measured: PictureMeasurement, path: Path) -> None:
    write_text(path, measurement_text(measured, path))
