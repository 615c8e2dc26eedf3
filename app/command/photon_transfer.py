"""``imagechain photon-transfer``: what a camera's flat fields give of its gain, noise and well."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.command.results import Progress, check_stop, show, written
from app.measure.measurement_text import transfer_rows
from app.options.command_options import Options
from app.run.readout_tables import columns, json_text, number_text
from core.names import in_line
from core.physics.measurement.levels.flat_field import FlatField, FlatFrames
from core.physics.measurement.levels.photon_transfer import PhotonTransfer, photon_transfer
from nodes.files.common.file_format import JSON
from nodes.files.common.table_cells import csv_lines
from nodes.files.frame_reading import FrameFile, check_one_camera, open_frames

_MOSTLY = 0.5  # of the fixed pattern, from which on that is the field's more than the pixels'


@dataclass(frozen=True)
class Measured:
    files: tuple[tuple[Path, FlatField], ...]
    curve: PhotonTransfer


def carry_out(options: Options, stop: threading.Event) -> None:
    flats = [open_frames(path) for path in options.flats]
    dark = None if options.dark is None else open_frames(options.dark)
    check_one_camera([*flats, *([dark] if dark is not None else [])], of_one="a flat field")

    def made() -> Measured:
        with Progress(len(flats) + 1) as progress:
            fields = [_field(file, progress, stop) for file in flats]
            dark_field = None if dark is None else _field(dark, progress, stop)
        curve = photon_transfer(levels=fields, dark=dark_field, offset_dn=options.offset_dn)
        return Measured(tuple(zip(options.flats, fields, strict=True)), curve)

    inputs = [*options.flats, *filter(None, [options.dark])]
    measured = written(options.outputs, inputs, stop, made, _text)
    figures = [
        (name, number_text(value), unit, meaning)
        for name, value, unit, meaning in transfer_rows(measured.curve)
    ]
    show(
        options,
        lambda: _facts(measured),
        columns(figures, right=(1,)) + "\n",
        columns([_LEVEL_HEAD, *_levels(measured)], right=(1, 2, 3, 4)),
        *map(in_line, (*_remarks(measured.curve, options), *_textures(measured))),
    )


def _field(file: FrameFile, progress: Progress, stop: threading.Event) -> FlatField:
    progress(file.path.name)
    taken = FlatFrames(file.rows, file.columns)
    for frame in file.each():
        check_stop(stop)
        taken.add(frame)
    return taken.measured()


_LEVEL_HEAD = ("file", "frames", "mean (DN)", "temporal σ² (DN²)", "fixed σ² (DN²)", "")


def _levels(made: Measured) -> list[tuple[str, ...]]:
    states = zip(made.curve.used, made.curve.saturated, strict=True)
    return [
        (
            path.name,
            str(field.frames),
            number_text(field.mean_dn),
            number_text(field.temporal_dn2),
            number_text(field.fixed_dn2),
            "saturated" if saturated else "" if used else "not used for the line",
        )
        for (path, field), (used, saturated) in zip(made.files, states, strict=True)
    ]


def _remarks(curve: PhotonTransfer, options: Options) -> list[str]:
    lines = []
    if curve.dark_cut_off:
        lines.append(
            f"{options.dark}: the noise reaches 0, where the converter clips it, so these dark "
            "frames are not used; raise the camera's offset, or give --offset-dn"
        )
    elif curve.offset_dn is None:
        lines.append("read noise and full well need --dark FILE, or --offset-dn DN")
    if curve.offset_dn is not None and curve.full_well_e is None:
        lines.append(
            "no level is saturated: the full well is above the brightest level; "
            "add a brighter level"
        )
    return lines


def _textures(made: Measured) -> list[str]:
    """Fields of which more is structure than pixels that differ; saturated ones say nothing."""
    return [
        f"warning: {path.name}: {100.0 * field.structure_share:.0f} % of the differences "
        "between pixels is structure of 8 pixels or more, as in a scene or uneven light: PRNU "
        "and DSNU include it; give frames of a uniform field"
        for (path, field), saturated in zip(made.files, made.curve.saturated, strict=True)
        if field.structure_share > _MOSTLY and not saturated
    ]


def _text(made: Measured, path: Path) -> str:
    return json_text(_facts(made)) if JSON.matches(path) else _csv(made)


def _facts(made: Measured) -> dict[str, Any]:
    return {
        "format": "imagechain-photon-transfer",
        "version": 1,
        "figures": {name: value for name, value, _, _ in transfer_rows(made.curve)},
        "dark_cut_off": made.curve.dark_cut_off,
        "levels": [
            {
                "file": str(path),
                "frames": field.frames,
                "mean_dn": field.mean_dn,
                "temporal_dn2": field.temporal_dn2,
                "fixed_dn2": field.fixed_dn2,
                "pixels": field.pixels,
                "bad_pixels": field.bad,
                "structure_share": field.structure_share,
                "used": used,
                "saturated": saturated,
            }
            for (path, field), used, saturated in zip(
                made.files, made.curve.used, made.curve.saturated, strict=True
            )
        ],
    }


def _csv(made: Measured) -> str:
    rows = [("name", "value", "unit", "meaning")]
    for name, value, unit, meaning in transfer_rows(made.curve):
        rows.append((name, "" if value is None else repr(value), unit, meaning))
    for path, field in made.files:
        rows.append((f"{path.name}: mean_dn", repr(field.mean_dn), "DN", "mean of a level"))
        meaning = "temporal variance of a level"
        rows.append((f"{path.name}: temporal_dn2", repr(field.temporal_dn2), "DN²", meaning))
    return csv_lines(rows)
