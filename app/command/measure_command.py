"""``imagechain measure``: edges, MTF and noise of pictures."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

from app.measure.measurement_files import measurement_csv, measurement_json
from app.measure.measuring import MeasurePlan, measure_files
from app.measure.picture_measurement import MtfCurve, NoiseFigures, PictureMeasurement
from app.options.command_options import Options
from app.options.progress import Progress
from app.run.readout_tables import columns, number_text
from app.run.staging import Staging
from core.atomic import write_text
from core.errors import Cancelled
from core.names import in_line, printable

_MOST_REASONS = 8
Row = tuple[str, str, str, str]


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
    print(columns(_rows(measured), right=(1,)))
    for line in _remarks(measured):
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
    return outputs


def _rows(measured: PictureMeasurement) -> list[Row]:
    used = sum(edge.used for edge in measured.edges)
    rows: list[Row] = [
        ("edges used", str(used), "", f"of {len(measured.edges)} that were seen"),
        *_mtf_rows("x", "across", measured.x, measured.interval_x_mrad),
        *_mtf_rows("y", "along", measured.y, measured.interval_y_mrad),
    ]
    noise = measured.noise
    if noise is not None:
        rows += _noise_rows(noise, measured.unit)
    return rows


def _mtf_rows(name: str, words: str, curve: MtfCurve | None, interval: float | None) -> list[Row]:
    if curve is None or curve.mtf50 is None or curve.mtf50_sigma is None:
        return []
    rows = [_row(f"mtf50_{name}", curve.mtf50, curve.mtf50_sigma, "cyc/sample",
                 f"MTF of one half {words}, of {curve.edges} edges")]  # fmt: skip
    if interval is not None:
        rows.append(
            _row(f"mtf50_{name}", curve.mtf50 / interval, curve.mtf50_sigma / interval,
                 "cyc/mrad", "the same")
        )  # fmt: skip
    return rows


def _noise_rows(noise: NoiseFigures, unit: str) -> list[Row]:
    rows = [_row("sigma", noise.sigma, noise.sigma_error, unit, "noise of a sample, flat areas")]
    if noise.gain_e_per_dn is not None:
        rows.append(_row("gain", noise.gain_e_per_dn, noise.gain_error, "e-/DN",
                         "electrons of one digital number"))  # fmt: skip
    if noise.read_noise_dn is not None:
        rows.append(_row("read_noise", noise.read_noise_dn, noise.read_noise_error, unit or "DN",
                         "noise that no light makes"))  # fmt: skip
    return rows


def _row(name: str, value: float, error: float | None, unit: str, meaning: str) -> Row:
    text = number_text(float(f"{value:.4g}"))
    if error is not None:
        text += f" ± {number_text(float(f'{error:.2g}'))}"
    return name, text, unit, meaning


def _remarks(measured: PictureMeasurement) -> list[str]:
    lines = [f"measured of {file.name}: {file.taken}" for file in measured.files if file.taken]
    lines += [
        f"warning: {file.name}: numbers of 8 bits of this format usually follow the eye, not the "
        "light: the MTF is that of these numbers"
        for file in measured.files
        if file.is_encoded
    ]
    for words, curve, reason in (
        ("across", measured.x, measured.reason_x), ("along", measured.y, measured.reason_y),
    ):  # fmt: skip
        if curve is None:
            lines.append(f"no MTF {words}: {reason}")
        elif curve.mtf50 is None:
            lines.append(f"no MTF50 {words}: the MTF does not fall to one half")
    if measured.noise is None:
        lines.append(f"no noise: {measured.noise_reason}")
    elif measured.noise.reason:
        lines.append(f"no gain, no read noise: {measured.noise.reason}")
    if measured.picture_count > 1 and measured.frames is None:
        lines.append(f"no noise from frame to frame: {measured.frames_reason}")
    if measured.flats is None and measured.flats_reason:
        lines.append(f"no photon transfer curve: {measured.flats_reason}")
    refused = Counter(_kind(edge.why_not) for edge in measured.edges if not edge.used)
    lines += [f"{count} not used: {why}" for why, count in refused.most_common(_MOST_REASONS)]
    return lines


def _kind(why_not: str) -> str:
    """A reason without its figures, which differ from edge to edge."""
    return why_not.partition(":")[0]
