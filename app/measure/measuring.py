"""The measurement of pictures of one camera, from files or from arrays, to its results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.measure.edge_measuring import edges_of, pooled
from app.measure.noise_measuring import pooled_noise, with_frames
from app.measure.picture_loading import (
    PictureFile,
    common_limits,
    is_repeated,
    open_picture,
    same_size,
)
from app.measure.picture_measurement import (
    BY_HAND,
    WITH_LOSS,
    FlatCurve,
    MeasuredEdge,
    MeasuredFile,
    PictureMeasurement,
    Preview,
)
from core.errors import DataError, ParameterError
from core.physics.measurement.edges.picture_suspicions import missing_samples, why_interpolated
from core.physics.measurement.levels.flat_field import FlatField, FlatFrames
from core.physics.measurement.levels.photon_transfer import photon_transfer
from core.physics.measurement.noise.frames_noise import FramesNoise, SceneFrames
from core.physics.measurement.noise.picture_noise import PictureNoise, noise_of_picture
from core.physics.sampling.detector_sampling import interval_mrad
from nodes.files.frames.frame_reading import open_frames

Matrix = NDArray[np.float64]
Report = Callable[[str], None]
_INTERPOLATED = (
    "the MTF is that of the picture, with what filling it in has changed; its noise is not measured"
)
_LEAST = 16  # rows and columns, below which nothing is measured
_MOST_COLOURS = 4
MOST_PREVIEWS = 4
_PREVIEW_SAMPLES = 1400  # of a side
_LARGEST = 1e60
_WIDEST_UM = 10_000.0  # of a pixel


@dataclass(frozen=True)
class MeasurePlan:
    """What is measured.

    Parameters
    ----------
    pictures : tuple of Path
        Pictures, or files of frames, of one camera.
    band : int or None
        Band of files that have several.
    fov_x_deg : float or None
        Field of view across, in place of the header's.
    pitch_um : float or None
        From one pixel to the next.
    flats : tuple of Path
        Files of frames of flat fields, each of another level.
    dark : Path or None
        Frames without light.
    offset_dn : float or None
        The number of no electrons.
    """

    pictures: tuple[Path, ...]
    band: int | None = None
    fov_x_deg: float | None = None
    flats: tuple[Path, ...] = ()
    dark: Path | None = None
    offset_dn: float | None = None
    pitch_um: float | None = None


@dataclass(frozen=True)
class Source:
    """Pictures of one size, and where they come from."""

    files: tuple[MeasuredFile, ...]
    pictures: Iterable[Matrix]
    rows: int
    columns: int
    unit: str = ""
    interval_x_mrad: float | None = None
    interval_y_mrad: float | None = None
    clip_levels: tuple[float, float] | None = None
    offset_dn: float | None = None


def measure_files(
    plan: MeasurePlan,
    *,
    check: Callable[[], None] = lambda: None,
    report: Report = lambda _text: None,
) -> PictureMeasurement:
    """Carry out a plan.

    Parameters
    ----------
    plan : MeasurePlan
        The files, and what is known of them.
    check : callable
        Called between steps; may raise to stop.
    report : callable
        Gets the name of what is measured next.

    Raises
    ------
    ImagechainError
        A file cannot be read, or they do not go together.
    """
    files = [open_picture(path, band=plan.band) for path in plan.pictures]
    same_size(files)
    first = files[0]
    x, y = first.interval_x_mrad, first.interval_y_mrad
    if plan.fov_x_deg is not None:
        x = interval_mrad(fov_deg=plan.fov_x_deg, samples=first.columns, name="--fov-x-deg")
        y = x if y is None else y
    pitch = checked_pitch(plan.pitch_um, "--pitch-um")
    source = Source(
        tuple(measured_file(file) for file in files),
        (picture for file in files for picture in file.pictures()),
        first.rows, first.columns, first.unit, x, y, common_limits(files),
        _offset(plan, (first.rows, first.columns), check),
    )  # fmt: skip
    measured = measure_pictures(source, check=check, report=report)
    measured = replace(measured, pitch_um=pitch)
    if not plan.flats:
        return measured
    flats, reason = _flat_curve(plan, check, report)
    return replace(measured, flats=flats, flats_reason=reason)


def checked_pitch(pitch_um: float | None, name: str) -> float | None:
    """A pitch that pixels can have.

    Raises
    ------
    ParameterError
        It is not above 0, or above 10 mm.
    """
    if pitch_um is not None and not 0.0 < pitch_um <= _WIDEST_UM:
        raise ParameterError(name, pitch_um, f"above 0 to {_WIDEST_UM:g}", unit="µm")
    return pitch_um


def measure_pictures(
    source: Source,
    *,
    check: Callable[[], None] = lambda: None,
    report: Report = lambda _text: None,
) -> PictureMeasurement:
    """Measure edges and noise of each picture in turn, and what they give together."""
    refuse_small(source.files[0].name, source.rows, source.columns)
    offset = source.offset_dn or 0.0
    count = sum(file.frames for file in source.files)
    lossy = any(file.is_lossy for file in source.files)
    taken = SceneFrames(source.rows, source.columns) if count > 1 else None
    edges: list[MeasuredEdge] = []
    previews: list[Preview] = []
    noises: list[PictureNoise] = []
    no_noise: list[str] = []
    warnings: list[str] = []
    seen: set[bytes] = set()
    repeated: list[int] = []
    for number, picture in enumerate(source.pictures):
        name = _name(source.files, number)
        report(name)
        check()
        _refuse_extreme(picture, name)
        if source.offset_dn is not None:
            _refuse_dark(picture, name, source.offset_dn)
        if number < MOST_PREVIEWS:
            previews.append(_preview(picture, number))
        if taken is not None:
            taken.add(picture)
            if is_repeated(picture, seen):
                repeated.append(number)
                continue
        own = edges_of(picture=picture, number=number, clip_levels=source.clip_levels, check=check)
        if _place(source.files, number)[0].is_lossy:
            edges += [replace(edge, why_not=edge.why_not or WITH_LOSS) for edge in own]
            continue
        edges += own
        interpolated = why_interpolated(picture=picture) if any(e.used for e in own) else ""
        if interpolated:
            warnings.append(f"{name}: {interpolated}: {_INTERPOLATED}")
            no_noise.append(interpolated)
            continue
        try:
            missing = missing_samples(picture=picture)
            noises.append(
                noise_of_picture(picture=picture, avoid=missing, offset=offset, check=check)
            )
        except DataError as error:  # numbers too large or too small for it
            no_noise.append(error.message)
    noise, noise_reason = pooled_noise(noises, offset_dn=offset)
    if not noises:
        noise_reason = no_noise[0] if no_noise else WITH_LOSS
    frames, frames_reason = (None, WITH_LOSS) if lossy else _frames(taken, offset)
    if frames is not None:
        noise, noise_reason = with_frames(noise, noise_reason, frames, offset)
    x, reason_x = pooled(edges, "x")
    y, reason_y = pooled(edges, "y")
    return PictureMeasurement(
        source.files, source.rows, source.columns, source.unit, source.interval_x_mrad,
        source.interval_y_mrad, tuple(edges), x, y, reason_x, reason_y, noise, noise_reason,
        frames, frames_reason, previews=tuple(previews), repeated=tuple(repeated),
        warnings=tuple(warnings),
    )  # fmt: skip


def refuse_small(name: str, rows: int, columns: int) -> None:
    """Refuse a picture in which nothing can be measured.

    Raises
    ------
    DataError
        With what is needed.
    """
    if min(rows, columns) >= _LEAST:
        return
    colours = (
        "; of an array (rows, columns, colours) give one colour, (rows, columns)"
        if columns <= _MOST_COLOURS < rows
        else ""
    )
    raise DataError(
        f"{name}: {columns} × {rows} samples are too few to be measured; at least "
        f"{_LEAST} × {_LEAST} are needed{colours}"
    )


def _refuse_dark(picture: Matrix, name: str, offset: float) -> None:
    """Refuse a level without light that a picture is not above."""
    mean = float(picture.mean())
    if not offset < mean:
        raise DataError(
            f"{name}: its mean level, {mean:.6g}, is not above the level without light, "
            f"{offset:.6g}: give frames without light as --dark, or the number as --offset-dn"
        )


def _refuse_extreme(picture: Matrix, name: str) -> None:
    """Refuse numbers of which squares of squares cannot be had in double precision."""
    low, high = float(picture.min()), float(picture.max())
    most = max(abs(low), abs(high))
    if most > _LARGEST or 0.0 < high - low < 1.0 / _LARGEST:
        raise DataError(
            f"{name}: samples from {low:.4g} to {high:.4g} cannot be measured; allowed: up to "
            f"{_LARGEST:g}, that differ by {1.0 / _LARGEST:g} or more: scale them"
        )


def _preview(picture: Matrix, number: int) -> Preview:
    rows, columns = picture.shape
    factor = max(1, -(-max(rows, columns) // _PREVIEW_SAMPLES))
    whole = picture[: rows // factor * factor, : columns // factor * factor]
    squares = whole.reshape(rows // factor, factor, columns // factor, factor)
    return Preview(number, squares.mean(axis=(1, 3)).astype(np.float32), factor)


def without_edge(
    measured: PictureMeasurement, place: int, why: str = BY_HAND
) -> PictureMeasurement:
    """The same without one of its edges, counted from 0; the MTF is pooled anew."""
    return _with_reason(measured, place, why)


def with_edge(measured: PictureMeasurement, place: int) -> PictureMeasurement:
    """The same with an edge that was removed by hand."""
    if measured.edges[place].why_not != BY_HAND:
        return measured
    return _with_reason(measured, place, "")


def _with_reason(measured: PictureMeasurement, place: int, why: str) -> PictureMeasurement:
    edges = list(measured.edges)
    edges[place] = replace(edges[place], why_not=why)
    x, reason_x = pooled(edges, "x")
    y, reason_y = pooled(edges, "y")
    return measured.with_edges(tuple(edges), x, y, (reason_x, reason_y))


def measured_file(file: PictureFile) -> MeasuredFile:
    """The same for a measurement."""
    return MeasuredFile(str(file.path), file.frames, file.taken, file.gamma, file.is_lossy)


def _name(files: Sequence[MeasuredFile], number: int) -> str:
    file, frame = _place(files, number)
    name = Path(file.name).name
    return name if file.frames == 1 else f"{name}, frame {frame}"


def _place(files: Sequence[MeasuredFile], number: int) -> tuple[MeasuredFile, int]:
    """The file of a picture, and its number there."""
    for file in files:
        if number < file.frames:
            return file, number
        number -= file.frames
    raise IndexError(number)


def _frames(taken: SceneFrames | None, offset_dn: float) -> tuple[FramesNoise | None, str]:
    """Noise from frame to frame, if the scene stood still."""
    if taken is None:
        return None, "a single picture"
    measured = taken.measured(offset=offset_dn)
    if measured.sigma is None:
        return None, measured.sigma_reason
    return measured, ""


def _flat_curve(
    plan: MeasurePlan, check: Callable[[], None], report: Report
) -> tuple[FlatCurve | None, str]:
    fields = []
    for path in plan.flats:
        report(path.name)
        fields.append(_field(path, check))
    dark = None if plan.dark is None else _field(plan.dark, check)
    try:
        curve = photon_transfer(levels=fields, dark=dark, offset_dn=plan.offset_dn)
    except DataError as error:
        return None, error.message
    return FlatCurve(tuple(zip(plan.flats, fields, strict=True)), curve), ""


def _offset(plan: MeasurePlan, size: tuple[int, int], check: Callable[[], None]) -> float | None:
    """The level without light: of the dark frames, or as given."""
    if plan.dark is None:
        return plan.offset_dn
    dark = open_frames(plan.dark)
    if (dark.rows, dark.columns) != size:
        raise DataError(
            f"{plan.dark} has {dark.columns} × {dark.rows} samples, and {plan.pictures[0]} "
            f"{size[1]} × {size[0]}: give frames of one camera"
        )
    means = []
    for frame in dark.each():
        check()
        means.append(float(np.mean(frame, dtype=np.float64)))
    return sum(means) / len(means)


def _field(path: Path, check: Callable[[], None]) -> FlatField:
    file = open_frames(path)
    if file.frames < 2:
        raise DataError(f"{path}: holds a single frame; a flat field needs 2 or more")
    taken = FlatFrames(file.rows, file.columns)
    for frame in file.each():
        check()
        taken.add(frame)
    return taken.measured()
