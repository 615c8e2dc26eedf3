"""``imagechain measure``: edges, MTF and noise of pictures."""

from __future__ import annotations

import json
import threading
from functools import partial

from app.measure.measurement_files import measurement_json
from app.measure.measurement_text import figure_rows, flat_rows, frame_rows, refused_lines, remarks
from app.measure.measurement_writing import measurement_text
from app.measure.measuring import MeasurePlan, measure_files
from app.options.command_options import Options
from app.options.progress import Progress
from app.options.terminal_streams import show
from app.run.readout_tables import columns
from app.run.staging import Staging
from core.atomic import write_text
from core.errors import Cancelled
from core.names import in_line


def carry_out(options: Options, stop: threading.Event) -> None:
    """Measure the pictures; prints the figures when all is written."""
    plan = MeasurePlan(
        options.pictures, options.band, options.fov_x_deg, options.flats, options.dark,
        options.offset_dn, options.pitch_um,
    )  # fmt: skip
    inputs = [*plan.pictures, *plan.flats, *([plan.dark] if plan.dark is not None else [])]

    def check() -> None:
        if stop.is_set():
            raise Cancelled("stopped on request")

    outputs = [*filter(None, (options.json_file, options.csv, options.report))]
    with Staging(None, inputs) as staging:
        for path in outputs:
            staging.claim(path)
        with Progress(len(inputs)) as progress:
            measured = measure_files(plan, check=check, report=progress)
        for path in outputs:
            check()
            staging.write(path, partial(write_text, content=measurement_text(measured, path)))
        staging.commit()
    rows = [*figure_rows(measured), *frame_rows(measured), *flat_rows(measured)]
    lines = map(in_line, (*remarks(measured), *refused_lines(measured)))
    show(options, lambda: json.loads(measurement_json(measured)), columns(rows, right=(1,)), *lines)
