"""``imagechain measure``: edges, MTF and noise of pictures."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

from app.measure.measurement_files import measurement_csv, measurement_json
from app.measure.measurement_text import figure_rows, frame_rows, refused_lines, remarks
from app.measure.measuring import MeasurePlan, measure_files
from app.measure.picture_measurement import PictureMeasurement
from app.options.command_options import Options
from app.options.progress import Progress
from app.run.readout_tables import columns
from app.run.staging import Staging
from core.atomic import write_text
from core.errors import Cancelled
from core.names import in_line, printable


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
        options.offset_dn,
    )  # fmt: skip
    inputs = [*plan.pictures, *plan.flats, *([plan.dark] if plan.dark is not None else [])]

    def check() -> None:
        if cancel is not None and cancel.is_set():
            raise Cancelled("stopped on request")

    outputs = _outputs(options)
    with Staging(None, inputs) as staging:
        for path in outputs:
            staging.claim(path)
        with Progress(len(inputs)) as progress:
            measured = measure_files(plan, check=check, report=progress)
        for path, content in outputs.items():
            check()
            staging.write(path, partial(write_text, content=printable_page(content(measured))))
        staging.commit()
    print(columns([*figure_rows(measured), *frame_rows(measured)], right=(1,)))
    for line in (*remarks(measured), *refused_lines(measured)):
        print(in_line(line))


def printable_page(text: str) -> str:
    """The text, of which names of files may hold what cannot be written."""
    return "\n".join(printable(line) for line in text.split("\n"))


def _outputs(options: Options) -> dict[Path, Callable[[PictureMeasurement], str]]:
    outputs: dict[Path, Callable[[PictureMeasurement], str]] = {}
    if options.measured_json is not None:
        outputs[options.measured_json] = measurement_json
    if options.measured_csv is not None:
        outputs[options.measured_csv] = measurement_csv
    if options.reports:
        # Imported only where a page is written: matplotlib and jinja2.
        from app.measure.measurement_page import measurement_page

        outputs[options.reports[0]] = measurement_page
    return outputs
