"""``imagechain measure``: edges, MTF and noise of pictures."""

from __future__ import annotations

import threading
from functools import partial

from app.measure.measurement_text import figure_rows, flat_rows, frame_rows, refused_lines, remarks
from app.measure.measurement_writing import measurement_text
from app.measure.measuring import MeasurePlan, measure_files
from app.options.command_options import Options
from app.options.progress import Progress
from app.run.readout_tables import columns
from app.run.staging import Staging
from core.atomic import write_text
from core.errors import Cancelled
from core.names import in_line


def measure(options: Options, cancel: threading.Event | None = None) -> None:
    """Carry out the command; prints the figures when all is written.

    Parameters
    ----------
    options : Options
        What the command line gives.
    cancel : threading.Event, optional
        Set to stop between steps.

    Raises
    ------
    ImagechainError
        The first fault; nothing has been written then.
    """
    plan = MeasurePlan(
        options.pictures, options.band, options.fov_x_deg, options.flats, options.dark,
        options.offset_dn, options.pitch_um,
    )  # fmt: skip
    inputs = [*plan.pictures, *plan.flats, *([plan.dark] if plan.dark is not None else [])]

    def check() -> None:
        if cancel is not None and cancel.is_set():
            raise Cancelled("stopped on request")

    outputs = [*filter(None, (options.measured_json, options.measured_csv)), *options.reports]
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
    print(columns(rows, right=(1,)))
    for line in (*remarks(measured), *refused_lines(measured)):
        print(in_line(line))
