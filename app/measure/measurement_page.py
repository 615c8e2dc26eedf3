"""A measurement as one page that needs no other file."""

from __future__ import annotations

from pathlib import Path

from app.measure.measurement_drawing import edges_png, levels_png, mtf_png
from app.measure.measurement_text import (
    figure_rows,
    flat_rows,
    frame_rows,
    remarks,
    with_error,
)
from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement
from app.measure.refused_edges import counted
from app.report.blocks import Block, Drawn, Grid, Heading, Items, Text
from app.report.drawing.printed_numbers import number
from app.report.html_page import html_page
from core.physics.measurement.edges.edge_pooling import LARGEST_ANGLE_DEG

_MOST_REFUSED = 60
_LEAST_LEVELS = 3
_PLACE = ("edge", "column", "row", "normal (°)", "length")


def measurement_page(measured: PictureMeasurement) -> str:
    """The page as HTML."""
    names = [Path(file.name).name for file in measured.files]
    title = f"Measured: {names[0]}" + (f" and {len(names) - 1} more" if len(names) > 1 else "")
    notes = remarks(measured)
    blocks: list[Block] = [
        Heading(1, title),
        Text(_lead(measured), "lead"),
        Grid(
            ("figure", "value", "unit", "meaning"),
            [tuple(row) for row in figure_rows(measured)],
            numbers=(1,),
            kind="readouts",
        ),
        *([Items(tuple(f"{line[:1].upper()}{line[1:]}." for line in notes))] if notes else []),
        *_edges(measured),
        *_mtf(measured),
        *_levels(measured),
        *_noise(measured),
        *_flats(measured),
        *_edge_tables(measured),
    ]
    return html_page(title, blocks)


def _lead(measured: PictureMeasurement) -> str:
    count = measured.picture_count
    what = "One picture" if count == 1 else f"{count} pictures"
    unit = f", in {measured.unit}" if measured.unit else ""
    interval = ""
    if measured.interval_x_mrad is not None and measured.interval_y_mrad is not None:
        interval = (
            f"; samples {number(_short(measured.interval_x_mrad))} × "
            f"{number(_short(measured.interval_y_mrad))} mrad apart"
        )
    return f"{what} of {measured.columns} × {measured.rows} samples{unit}{interval}."


def _short(value: float) -> float:
    return float(f"{value:.4g}")


def _edges(measured: PictureMeasurement) -> list[Block]:
    blocks: list[Block] = [Heading(2, "Edges")]
    if not measured.edges:
        return [*blocks, Text("No straight edge was seen.")]
    for preview in measured.previews:
        name = measured.picture_name(preview.picture)
        caption = (
            f"{name}. Numbers are those of the tables below. Grey levels between the 0.1 % and "
            "99.9 % quantiles."
        )
        drawn = edges_png(measured, preview)
        blocks.append(Drawn(drawn, caption, f"edges of {name}"))
    more = measured.picture_count - len(measured.previews)
    if more > 0:
        blocks.append(Text(f"{more} more pictures are not drawn."))
    return blocks


def _mtf(measured: PictureMeasurement) -> list[Block]:
    blocks: list[Block] = [Heading(2, "MTF")]
    if measured.x is None and measured.y is None:
        return [
            *blocks,
            Text(f"Not measured across: {measured.reason_x}."),
            Text(f"Not measured along: {measured.reason_y}."),
        ]
    caption = (
        "MTF of everything from the scene to the stored samples, pooled over the edges in use, "
        "weighted by their errors; grey: edges whose normals lie within 30° of the axis. Beyond "
        "the Nyquist frequency, 0.5 cycles/sample, the picture itself holds this contrast as alias "
        "only; slanted edges show it all the same."
    )
    blocks.append(Drawn(mtf_png(measured), caption, "pooled MTF"))
    return blocks


def _levels(measured: PictureMeasurement) -> list[Block]:
    noise = measured.noise
    blocks: list[Block] = [Heading(2, "Noise over the level")]
    if noise is None:
        return [*blocks, Text(f"Noise was not measured: {measured.noise_reason}.")]
    if len(noise.levels) < _LEAST_LEVELS:
        return []
    caption = (
        "Variance of a sample against the level; of shot noise it rises by one "
        "electron for each electron."
    )
    drawn = levels_png(noise, measured.unit)
    return [*blocks, Drawn(drawn, caption, "variance against level")]


def _noise(measured: PictureMeasurement) -> list[Block]:
    if measured.frames is None:
        return []
    heads = ("component", "σ", "unit", "meaning")
    return [
        Heading(2, "Noise from frame to frame"),
        Grid(heads, frame_rows(measured), numbers=(1,)),
        Text(
            "What stays from frame to frame is the scene's as well: fixed patterns need frames of "
            "a uniform field, as --flats."
        ),
    ]


def _flats(measured: PictureMeasurement) -> list[Block]:
    flats = measured.flats
    if flats is None:
        return []
    curve = flats.curve
    levels = [
        (path.name, number(_short(field.mean_dn)), number(_short(field.temporal_dn2)),
         "saturated" if saturated else "" if used else "not in the line")
        for (path, field), used, saturated in zip(
            flats.files, curve.used, curve.saturated, strict=True
        )
    ]  # fmt: skip
    return [
        Heading(2, "Photon transfer of the flat fields"),
        Grid(("figure", "value", "unit", "meaning"), flat_rows(measured), numbers=(1,)),
        Grid(("file", "mean (DN)", "temporal σ² (DN²)", ""), levels, numbers=(1, 2)),
    ]


def _edge_tables(measured: PictureMeasurement) -> list[Block]:
    numbered = list(enumerate(measured.edges, 1))
    used = [(number, edge) for number, edge in numbered if edge.used]
    refused = [(number, edge) for number, edge in numbered if not edge.used]
    blocks: list[Block] = []
    several = measured.picture_count > 1
    if used:
        rows = [(*_place(edge, n, several), *_strength(edge), _half(edge)) for n, edge in used]
        blocks += [
            Heading(2, "Edges used"),
            Grid((*_PLACE, "step", "step/noise", "MTF50"), rows, numbers=range(1, 8)),
            Text(
                "MTF50 in cycles/sample along the edge's normal. Normals within "
                f"{LARGEST_ANGLE_DEG:g}° of 0° or 180° are counted as across, of ±90° as along: "
                "the standard error is that of this direction, if the edge alone showed it. Edges "
                "of other directions say how the blur turns with direction."
            ),
        ]
    if refused:
        kinds = counted(edge.why_not for _, edge in refused)
        most = sorted(kinds.items(), key=lambda item: -item[1])
        shown = refused[:_MOST_REFUSED]
        whys = [(*_place(edge, n, several), edge.why_not) for n, edge in shown]
        blocks += [
            Heading(2, "Edges not used"),
            Grid(
                ("edges", "why not", "what helps"),
                [(str(count), kind.words, kind.helps) for kind, count in most],
                numbers=(0,),
            ),
            Grid((*_PLACE, "why not"), whys, numbers=range(1, 5)),
        ]
        if len(refused) > len(shown):
            blocks.append(Text(f"And {len(refused) - len(shown)} more."))
    return blocks


def _place(edge: MeasuredEdge, place: int, several: bool) -> tuple[str, ...]:
    found = edge.found
    name = f"{place} (picture {edge.picture})" if several else str(place)
    angle = f"{found.angle_deg:.1f}".replace("-", "−")
    return name, f"{found.x:.1f}", f"{found.y:.1f}", angle, f"{found.length:.0f}"


def _strength(edge: MeasuredEdge) -> tuple[str, str]:
    step = edge.found.high - edge.found.low
    share = step / edge.found.noise_sigma if edge.found.noise_sigma > 0.0 else None
    return number(_short(step)), "–" if share is None else f"{share:.3g}"


def _half(edge: MeasuredEdge) -> str:
    curve = edge.curve
    return "–" if curve is None else with_error(curve.mtf50, edge.mtf50_sigma)
