"""Writing what a port carries in the format of the file's suffix."""

import dataclasses
import gc
import math
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.run.option_values import Save
from core import atomic, errors, machine
from core.arrays import Array
from core.chain import engine, random_fields
from core.chain.wires import Context, Curve, CurveData, Image, Table, TableData
from core.evaluation.recipes import Region, number_bits
from core.evaluation.work import Policy, Work
from nodes.files import arrays, formats, table_cells, zarr_array
from nodes.files import frames as frame_files
from nodes.files.file_format import CSV, ENVI_FRAMES, ZARR, Format, suffixes
from nodes.input_output import write_image

_TABLES = (CSV,)
_CURVES = (CSV, *(file_format for file_format in formats.WRITTEN if file_format.stores_floats))


def check_suffix(port: str, value: Any, path: Path) -> None:
    allowed: tuple[Format, ...] = (
        (*formats.SAVED, ENVI_FRAMES, ZARR) if isinstance(value, Image) else formats.SAVED
    )
    if isinstance(value, Table | Context):
        allowed = _TABLES
    elif isinstance(value, Curve):
        allowed = _CURVES
    if not any(file_format.matches(path) for file_format in allowed):
        what = f"{'an' if value.port_type[0] in 'aeiou' else 'a'} {value.port_type}"
        words = ", ".join(suffixes(*allowed))
        raise errors.UsageError(f"--save {port}={path}: {what} must be written as {words}")
    if ZARR.matches(path):
        zarr_array.check_zarr(path)


def region_of(save: Save, value: Any) -> Region | None:
    if isinstance(value, Image):
        return save.region(value.rows, value.columns)
    if save.bounds:
        raise errors.UsageError(f"{save.shown}: a region needs an image, not a {value.port_type}")
    return None


def save_value(
    value: Any, path: Path, work: Work, *, port: str, region: Region | None = None
) -> None:
    """Write the computed value: arrays as they are, curves as columns, tables as rows.

    Of an image only the region is computed; its bands go into an ENVI file, their sum into others.
    A pupil with a wavefront is written as its amplitude.
    """
    if isinstance(value, Image) and is_cube(value, path):
        cube_of(value, work.policy, region).write(path, work, name=port)
        return
    made = engine.realize(value, work, region)
    if isinstance(made, TableData):
        rows = [(row.name, row.value, row.unit, row.meaning) for row in made.rows]
        atomic.write_text(path, table_cells.csv_figures(rows))
    elif isinstance(made, Context):
        atomic.write_text(path, table_cells.csv_figures(_context_rows(made)))
    elif isinstance(made, CurveData):
        _save_curve(path, made, work)
    else:
        array = real_array(made, work)
        formats.check_finite(array, port)
        metadata = metadata_of(value, array.shape) if isinstance(value, Image) else {}
        save_array(path, array, metadata)


def is_cube(value: Any, path: Path) -> bool:
    return isinstance(value, Image) and value.bands is not None and ENVI_FRAMES.matches(path)


def cube_of(image: Image, policy: Policy, region: Region | None = None) -> write_image.Cube:
    shape = region.shape if region else image.shape
    return write_image.Cube(image, policy.dtype, metadata_of(image, shape), region)


def real_array(made: Array, work: Work) -> Array:
    """The array as it is written, in the run's precision: complex samples by their modulus."""
    real = np.abs(made) if np.iscomplexobj(made) else np.asarray(made)
    with np.errstate(over="ignore"):  # found by the check for samples that are not finite
        return real.astype(work.policy.dtype, copy=False)


def save_array(path: Path, array: Array, metadata: dict[str, Any]) -> None:
    """Write a real array; integers run from its least to its greatest sample."""
    kind = formats.written_format(path)
    if ZARR.matches(path):
        zarr_array.write_store(path, array, metadata)
    elif ENVI_FRAMES.matches(path):
        rows, columns = array.shape
        dtype = array.dtype.newbyteorder("<")
        series = frame_files.FrameSeries(1, rows, columns, dtype, metadata)
        frame_files.write_envi(path, series, [array])
    elif CSV.matches(path):
        arrays.write_matrix(path, array)
    elif kind is None:
        words = ", ".join(suffixes(*formats.SAVED, ENVI_FRAMES, ZARR))
        raise errors.UsageError(f"{path}: a picture must be written as {words}")
    elif kind.stores_floats:
        whole = formats.integer_type(array, metadata.get("unit", ""), kind.dtypes)
        if whole is not None:
            formats.write_picture(path, array, dtype=whole, metadata=metadata)
            return
        double = "float" not in kind.dtypes or (
            array.dtype == np.float64 and "double" in kind.dtypes
        )
        formats.write_picture(path, array, dtype="double" if double else "float", metadata=metadata)
    else:
        levels = grey_levels(float(array.min()), float(array.max()), array)
        if kind is formats.PNG:
            atomic.write_bytes(path, encode_png(levels))
        else:
            formats.write_picture(path, levels, dtype=kind.dtypes[0], metadata=metadata)


def metadata_of(image: Image, shape: tuple[int, ...]) -> dict[str, Any]:
    """The image's header, the field of view being that of the samples written."""
    x, y = image.header.fov_x_deg, image.header.fov_y_deg
    header = {
        "unit": image.unit,
        "focal_length_mm": image.header.focal_length_mm,
        "fov_x_deg": None if x is None else x * (shape[1] / image.columns),
        "fov_y_deg": None if y is None else y * (shape[0] / image.rows),
    }
    return {name: value for name, value in header.items() if value not in (None, "")}


def _save_curve(path: Path, curve: CurveData, work: Work) -> None:
    shared = all(np.array_equal(series.x, curve.series[0].x) for series in curve.series[1:])
    if CSV.matches(path) and shared and curve.series:
        arrays.write_curves(path, curve, write_image.curve_columns(curve))
    elif CSV.matches(path):
        points = [
            (series.label, x, y)
            for series in curve.series
            for x, y in zip(series.x.tolist(), series.y.tolist(), strict=True)
        ]
        atomic.write_text(
            path, table_cells.csv_lines([("series", curve.x_label, curve.y_label), *points])
        )
    elif shared and curve.series:
        columns = np.stack(list(write_image.curve_columns(curve).values()), axis=1)
        save_array(path, real_array(columns, work), {})
    else:
        raise errors.UsageError(f"{path}: curves with different axes must be written as .csv")


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


# The picture every run writes: 8-bit grey PNG, without loading a picture library.

Grey = NDArray[np.uint8]
_BLOCK_SAMPLES = 1 << 18
_SAMPLES_READ = 1 << 22


def grey_levels(low: float, high: float, samples: NDArray[Any]) -> Grey:
    """Samples as 0 (`low` and below) to 255 (`high` and above); mid grey where these are equal."""
    if not high > low:
        return np.full(samples.shape, 128, np.uint8)
    levels = np.empty(samples.shape, np.uint8)
    # The difference of the largest numbers overflows, halves of the smallest ones vanish.
    part = 1.0 if math.isfinite(high - low) else 0.5
    # By rows, so that a large picture is never held in double precision as a whole.
    step = max(1, _BLOCK_SAMPLES // samples.shape[1])
    for start in range(0, samples.shape[0], step):
        rows = slice(start, start + step)
        clipped = np.clip(samples[rows].astype(np.float64), low, high)
        shares = (clipped * part - low * part) / (high * part - low * part)
        levels[rows] = np.rint(shares * 255.0)
    return levels


def robust_limits(samples: NDArray[Any]) -> tuple[float, float]:
    """Black and white at the 0.1 % quantiles; at the extremes if nearly all samples are alike."""
    every = max(1, round((samples.size / _SAMPLES_READ) ** 0.5))
    sampled = samples[::every, ::every]
    low, high = (float(limit) for limit in np.percentile(sampled, (0.1, 99.9)))
    if not high > low:
        low, high = float(samples.min()), float(samples.max())
    return low, high


def grey_png(samples: NDArray[Any], limits: tuple[float, float] | None = None) -> bytes:
    """Samples as a grey PNG, from black to white at the limits, by default the robust ones."""
    return encode_png(grey_levels(*(limits or robust_limits(samples)), samples))


def encode_png(levels: Grey) -> bytes:
    """Bytes of a grey PNG file (ISO/IEC 15948)."""
    rows, columns = levels.shape
    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    # Each row is stored as differences to the row above (filter 2): half the size of plain rows.
    above = np.zeros_like(levels)
    above[1:] = levels[:-1]
    lines = np.empty((rows, columns + 1), np.uint8)
    lines[:, 0] = 2
    np.subtract(levels, above, out=lines[:, 1:])
    content = _chunk(b"IDAT", zlib.compress(lines.tobytes(), 3))
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + content + _chunk(b"IEND", b"")


def _chunk(name: bytes, content: bytes) -> bytes:
    check = zlib.crc32(name + content)
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", check)


# Writing frames of a picture, each with temporal noise of its own, into one file.

MOST_FRAMES = 1_000_000


_COLLECTED = 256  # frames between two collections of what refers to itself: 4 MB of small ones


def check_for_frames(port: str, path: Path) -> None:
    if not frame_files.holds_frames(path):
        words = ", ".join(suffixes(*frame_files.FRAME_FORMATS))
        raise errors.UsageError(
            f"--save {port}={path}: with --frames, an image must be written as {words}"
        )


def series_of(
    image: Image, path: Path, policy: Policy, *, frames: int, region: Region | None
) -> frame_files.FrameSeries:
    shape = region.shape if region else image.shape
    stored = frame_files.stored_type(path, policy.dtype, number_bits(image.recipe))
    return frame_files.FrameSeries(frames, *shape, stored, metadata_of(image, shape))


def save_frames(
    image: Image,
    path: Path,
    work: Work,
    *,
    port: str,
    frames: int,
    region: Region | None = None,
    done: Callable[[int], None] | None = None,
) -> None:
    """Write frames one after the other; `done` gets the number of frames written."""
    check_for_frames(port, path)
    series = series_of(image, path, work.policy, frames=frames, region=region)
    recipes = (random_fields.at_frame(image.recipe, number) for number in range(frames))

    def made() -> Iterator[NDArray[Any]]:
        for number, value in enumerate(work.one_by_one(recipes, region, forgetting=True)):
            if number % _COLLECTED == _COLLECTED - 1:
                gc.collect()  # the recipes of a frame refer to one another
            work.check()
            frame = real_array(value, work)
            formats.check_finite(frame, port)
            yield frame

    if frames == 1 and formats.TIFF.matches(path):
        (frame,) = made()
        if machine.is_on_disk(frame):
            frame_files.write_tiled_tiff(path, series, frame)
            return
        frame_files.write_frames(path, series, [frame], done)
        return
    frame_files.write_frames(path, series, made(), done)
