"""``imagechain measure``: edges, MTF and noise of pictures."""

from __future__ import annotations

import json
import threading
from functools import partial

from app.command.results import Progress, check_stop, show, written
from app.measure.measurement_files import measurement_json, measurement_text
from app.measure.measurement_text import figure_rows, flat_rows, frame_rows, refused_lines, remarks
from app.measure.measuring import MeasurePlan, measure_files
from app.measure.picture_measurement import PictureMeasurement
from app.options.command_options import Options
from app.run.readout_tables import columns
from core.names import in_line


def carry_out(options: Options, stop: threading.Event) -> None:
    plan = MeasurePlan(
        options.pictures, options.band, options.fov_x_deg, options.flats, options.dark,
        options.offset_dn, options.pitch_um,
    )  # fmt: skip
    inputs = [*plan.pictures, *plan.flats, *([plan.dark] if plan.dark is not None else [])]

    def made() -> PictureMeasurement:
        with Progress(len(inputs)) as progress:
            return measure_files(plan, check=partial(check_stop, stop), report=progress)

    outputs = [*filter(None, (options.json_file, options.csv, options.report))]
    measured = written(outputs, inputs, stop, made, measurement_text)
    rows = [*figure_rows(measured), *frame_rows(measured), *flat_rows(measured)]
    lines = map(in_line, (*remarks(measured), *refused_lines(measured)))
    show(options, lambda: json.loads(measurement_json(measured)), columns(rows, right=(1,)), *lines)
