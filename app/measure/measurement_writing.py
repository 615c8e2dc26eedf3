"""Writing a measurement: what each kind of file holds, by its suffix."""

from __future__ import annotations

from pathlib import Path

from app.measure.measurement_files import measurement_csv, measurement_json
from app.measure.picture_measurement import PictureMeasurement
from core.atomic import write_text
from core.errors import UsageError
from core.names import printable
from nodes.files.common.file_format import CSV, HTML, JSON, suffixes

WRITTEN = (JSON, CSV, HTML)


def measurement_text(measured: PictureMeasurement, path: Path) -> str:
    """What a file of that suffix holds: .json everything, .csv the pooled MTF, .html a page.

    Raises
    ------
    UsageError
        Another suffix.
    DataError
        There is no MTF for a .csv.
    """
    if JSON.matches(path):
        text = measurement_json(measured)
    elif CSV.matches(path):
        text = measurement_csv(measured)
    elif HTML.matches(path):
        # Imported only where a page is written: matplotlib and jinja2.
        from app.measure.measurement_page import measurement_page

        text = measurement_page(measured)
    else:
        raise UsageError(f"{path}: the file's name must end in {', '.join(suffixes(*WRITTEN))}")
    # Names of files may hold what cannot be written.
    return "\n".join(printable(line) for line in text.split("\n"))


def write_measurement(measured: PictureMeasurement, path: Path) -> None:
    """Write one file, whole or not at all.

    Raises
    ------
    ImagechainError
        As of `measurement_text`, or it cannot be written.
    """
    write_text(path, measurement_text(measured, path))
