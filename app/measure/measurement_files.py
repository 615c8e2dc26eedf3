"""Files of a measurement: JSON, a table of MTF that the module MTF File reads, or a page."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from app.measure.measurement_text import TEMPORAL, file_warnings
from app.measure.picture_measurement import MeasuredEdge, NoiseFigures, PictureMeasurement
from core.atomic import write_text
from core.errors import DataError, UsageError, printable
from core.physics.measurement.edge_mtf import MtfCurve
from core.physics.measurement.picture_noise import FramesNoise
from nodes.files.common.file_format import CSV, HTML, JSON, suffixes
from nodes.files.common.table_cells import csv_lines
from nodes.files.mtf_table import LARGEST_MTF

Json = dict[str, Any]
WRITTEN = (JSON, CSV, HTML)
_PLACE = ("x", "y", "angle_deg", "length", "reach", "low", "high")


def measurement_json(measured: PictureMeasurement) -> str:
    """The measurement as JSON; what could not be measured is absent, and a reason stands there."""
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
        "noise": _noise(measured.noise, measured.noise_reason),
        "edges": [_edge(edge, measured.picture_count > 1) for edge in measured.edges],
    }
    if measured.picture_count > 1:
        content["frames"] = _frames(measured.frames, measured.frames_reason)
    warnings = [*file_warnings(measured.files), *measured.warnings]
    if warnings:
        content["warnings"] = warnings
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def measurement_csv(measured: PictureMeasurement) -> str:
    """The pooled MTF as a table that the module MTF File reads: frequency, horizontal, vertical."""
    curves = {"mtf_x": measured.x, "mtf_y": measured.y}
    known = {name: curve for name, curve in curves.items() if curve is not None}
    if not known:
        raise DataError(
            f"there is no MTF to write (horizontal: {measured.reason_x}; vertical: "
            f"{measured.reason_y}): write a page (.html) to see why each edge was rejected"
        )
    last = min(float(curve.frequency[-1]) for curve in known.values())
    frequency = next(iter(known.values())).frequency
    frequency = frequency[frequency <= last]
    rows: list[tuple[str, ...]] = [("frequency (cyc/pixel)", *known)]
    columns = [
        np.clip(np.interp(frequency, curve.frequency, curve.mtf), 0.0, LARGEST_MTF)
        for curve in known.values()
    ]
    for place, row in zip(frequency, zip(*columns, strict=True), strict=True):
        rows.append((repr(float(place)), *(repr(float(value)) for value in row)))
    return csv_lines(rows)


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
    content: Json = {"frequency_cyc_per_sample": _numbers(curve.frequency)}
    if interval_mrad is not None:
        content["frequency_cyc_per_mrad"] = _numbers(curve.frequency / interval_mrad)
    if pitch_um is not None:
        content["frequency_cyc_per_mm"] = _numbers(curve.frequency / (1e-3 * pitch_um))
    return {
        **content,
        "mtf": _numbers(curve.mtf),
        "sigma": _numbers(curve.sigma),
        **_given(mtf50=curve.mtf50, mtf50_sigma=curve.mtf50_sigma),
        "edges": curve.edges,
        "scatter": curve.scatter,
    }


def _numbers(values: np.ndarray[Any, Any]) -> list[float]:
    return [float(value) for value in values]


def _noise(noise: NoiseFigures | None, reason: str) -> Json:
    if noise is None:
        return {"reason": reason}
    rest = {"reason": noise.reason or None, "remarks": list(noise.remarks) or None}
    return _given(**asdict(noise) | rest)


def _edge(edge: MeasuredEdge, of_several: bool) -> Json:
    curve = edge.curve
    figures: Mapping[str, float | None] = (
        {} if curve is None else {"mtf50": curve.mtf50, "sigma": edge.mtf50_sigma}
    )
    return {
        **({"picture": edge.picture} if of_several else {}),
        **{name: getattr(edge.found, name) for name in _PLACE},
        **_given(**figures),
        "used": edge.used,
        "why_not": edge.why_not,
    }


def _frames(frames: FramesNoise | None, reason: str) -> Json:
    if frames is None:
        return {"reason": reason}
    components = frames.components
    return {
        "frames": components.frames,
        **_given(sigma=frames.sigma, sigma_error=frames.sigma_error),
        **{f"sigma_{name}": components.variances.sigma(name) for name in TEMPORAL},
        **{f"variance_{name}_error": components.errors.variance(name) for name in TEMPORAL},
    }


def measurement_text(measured: PictureMeasurement, path: Path) -> str:
    """What a file of that suffix holds: .json everything, .csv the pooled MTF, .html a page."""
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
    write_text(path, measurement_text(measured, path))
