"""Writing what a port carries in the format of the file's suffix."""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.run.png import encode_png, grey_levels
from core.atomic import write_bytes, write_text
from core.chain.realize import realize
from core.chain.results import CurveData, TableData
from core.chain.wires import Context, Curve, Image, Table
from core.errors import UsageError
from core.evaluation.region import Region
from core.evaluation.work import Work
from nodes.files.arrays import write_curves, write_matrix, write_npy
from nodes.files.curve_text import columns_text, is_plain
from nodes.files.picture_writing import write_picture
from nodes.files.read import check_finite

Array = NDArray[Any]
_TABLES = (".csv",)
_CURVES = (".csv", ".npy", ".exr", ".tif", ".tiff")


def check_suffix(port: str, value: Any, path: Path) -> None:
    """Refuse a file format that cannot hold what the port carries.

    Raises
    ------
    UsageError
        Saying which can.
    """
    allowed: tuple[str, ...] | None = None
    if isinstance(value, Table | Context):
        allowed = _TABLES
    elif isinstance(value, Curve):
        allowed = _CURVES
    if allowed is not None and path.suffix.lower() not in allowed:
        raise UsageError(
            f"--save {port}={path}: a {value.port_type} is written as {' '.join(allowed)}"
        )


def save_value(
    value: Any, path: Path, work: Work, *, port: str, region: Region | None = None
) -> None:
    """Write the computed value: arrays as they are, curves as columns, tables as rows.

    Of an image, only the region is computed and written.

    A ``.png`` runs from black at the least to white at the greatest sample, in 8 bits. A pupil
    with a wavefront is written as its amplitude.

    Raises
    ------
    ImagechainError
        From computing, or from the writer.
    """
    made = realize(value, work, region)
    suffix = path.suffix.lower()
    if isinstance(made, TableData):
        _save_rows(path, [(row.name, row.value, row.unit, row.meaning) for row in made.rows])
    elif isinstance(made, Context):
        _save_rows(path, _context_rows(made))
    elif isinstance(made, CurveData):
        _save_curve(path, made, suffix, work)
    else:
        array = real_array(made, work)
        check_finite(array, port)
        metadata = metadata_of(value, array.shape) if isinstance(value, Image) else {}
        save_array(path, array, suffix, metadata)


def real_array(made: Array, work: Work) -> Array:
    """The array as it is written, in the run's precision: complex samples by their modulus."""
    real = np.abs(made) if np.iscomplexobj(made) else np.asarray(made)
    with np.errstate(over="ignore"):  # found by the check for samples that are not finite
        return real.astype(work.policy.dtype, copy=False)


def save_array(path: Path, array: Array, suffix: str, metadata: dict[str, Any]) -> None:
    """Write a real array in the format of a suffix, ``.png`` from its least to greatest sample.

    Raises
    ------
    ImagechainError
        From the writer.
    """
    if suffix == ".npy":
        write_npy(path, array)
    elif suffix == ".csv":
        write_matrix(path, array)
    elif suffix == ".png":
        levels = grey_levels(float(array.min()), float(array.max()), array)
        write_bytes(path, encode_png(levels))
    else:
        double = array.dtype == np.float64 and suffix != ".exr"  # EXR knows no doubles
        write_picture(path, array, dtype="double" if double else "float", metadata=metadata)


def metadata_of(image: Image, shape: tuple[int, ...]) -> dict[str, Any]:
    """What the image's header says, the field of view being that of the samples written."""
    x, y = image.header.fov_x_deg, image.header.fov_y_deg
    header = {
        "unit": image.unit,
        "focal_length_mm": image.header.focal_length_mm,
        "fov_x_deg": None if x is None else x * (shape[1] / image.columns),
        "fov_y_deg": None if y is None else y * (shape[0] / image.rows),
    }
    return {name: value for name, value in header.items() if value not in (None, "")}


def _save_curve(path: Path, curve: CurveData, suffix: str, work: Work) -> None:
    shared = all(np.array_equal(series.x, curve.series[0].x) for series in curve.series[1:])
    if suffix == ".csv" and shared and curve.series:
        named = _columns(curve)
        if is_plain(curve):
            write_curves(path, named)
        else:
            write_text(path, columns_text(curve, named))
    elif suffix == ".csv":
        points = [
            (series.label, repr(float(x)), repr(float(y)))
            for series in curve.series
            for x, y in zip(series.x, series.y, strict=True)
        ]
        write_text(path, _lines([("series", curve.x_label, curve.y_label), *points]))
    elif shared and curve.series:
        columns = [curve.series[0].x, *(series.y for series in curve.series)]
        save_array(path, real_array(np.stack(columns, axis=1), work), suffix, {})
    else:
        raise UsageError(f"{path}: curves with different axes are written as .csv")


def _columns(curve: CurveData) -> dict[str, Array]:
    columns: dict[str, Array] = {}
    for name, values in [
        (curve.x_label, curve.series[0].x),
        *((series.label, series.y) for series in curve.series),
    ]:
        clean = " ".join(name.replace(",", ";").replace('"', "'").split()) or "curve"
        label, number = clean, 1
        while label in columns:
            number += 1
            label = f"{clean} ({number})"
        columns[label] = values
    return columns


def _context_rows(context: Context) -> list[tuple[Any, ...]]:
    rows: list[tuple[Any, ...]] = []
    for field in dataclasses.fields(context):
        value = getattr(context, field.name)
        if dataclasses.is_dataclass(value):
            rows += [(part.name, getattr(value, part.name)) for part in dataclasses.fields(value)]
        elif isinstance(value, tuple):
            rows += list(zip(("cut_on_um", "cut_off_um"), value, strict=True))
        else:
            rows.append((field.name, value))
    return [(name, value, "", "") for name, value in rows]


def _save_rows(path: Path, rows: Iterable[tuple[Any, ...]]) -> None:
    cells = [
        [repr(cell) if isinstance(cell, float) else "" if cell is None else cell for cell in row]
        for row in rows
    ]
    write_text(path, _lines([("name", "value", "unit", "meaning"), *cells]))


def _lines(rows: Iterable[Iterable[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
