"""The measurement of pictures of one camera, from files or from arrays, to its results."""

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.measure import picture_measurement as results
from app.measure.measurement_text import exceeds_one, in_words
from core.arrays import Matrix, block_means
from core.errors import DataError, ParameterError, several
from core.physics.measurement import edge_mtf, edge_search, found_edge, picture_noise
from core.physics.measurement.sample_noise import LineNoise, SampleNoise
from core.physics.sampling.detector_sampling import interval_mrad
from core.records import replace
from nodes.files.frames import open_frames

Report = Callable[[str], None]
_INTERPOLATED = "The MTF includes the interpolation, and the noise is not measured"
_LEAST = 16  # rows and columns, below which nothing is measured
_MOST_COLOURS = 4
MOST_PREVIEWS = 4
_LARGEST = 1e60
_WIDEST_UM = 10_000.0  # of a pixel
_OVERSHOOT = 0.05  # of the MTF above one, that one edge alone does not prove


def measure_files(
    pictures: Sequence[Path],
    band: int | None = None,
    fov_x_deg: float | None = None,
    dark: Path | None = None,
    offset_dn: float | None = None,
    pitch_um: float | None = None,
    *,
    check: Callable[[], None] = lambda: None,
    report: Report = lambda _text: None,
) -> results.PictureMeasurement:
    """Measure pictures, or files of frames, of one camera; `dark` frames replace `offset_dn`."""
    files = [results.open_picture(path, band=band) for path in pictures]
    results.same_size(files)
    if dark is not None:
        offset_dn = _dark_level(dark, files[0], check)
    names = "--fov-x-deg", "--pitch-um"
    return measure_pictures(
        files, fov_x_deg, offset_dn, pitch_um, names=names, check=check, report=report
    )


def measure_pictures(
    files: Sequence[results.PictureFile],
    fov_x_deg: float | None = None,
    offset_dn: float | None = None,
    pitch_um: float | None = None,
    *,
    names: tuple[str, str] = ("fov_x_deg", "pitch_um"),
    check: Callable[[], None] = lambda: None,
    report: Report = lambda _text: None,
) -> results.PictureMeasurement:
    """Measure pictures of one size; `names` are those of field of view and pitch in messages."""
    first = files[0]
    intervals = _intervals(first, fov_x_deg, names[0])
    if pitch_um is not None and not 0.0 < pitch_um <= _WIDEST_UM:
        raise ParameterError(names[1], pitch_um, f"above 0 and at most {_WIDEST_UM:g}", unit="µm")
    refuse_small(first.name, first.rows, first.columns)
    offset = offset_dn or 0.0
    clip_levels = results.common_limits(files)
    lossy = any(file.is_lossy for file in files)
    several_frames = sum(file.frames for file in files) > 1 and not lossy
    taken = picture_noise.SceneFrames(first.rows, first.columns) if several_frames else None
    edges: list[results.MeasuredEdge] = []
    previews: list[NDArray[np.float32]] = []
    noises: list[SampleNoise | str] = []  # or why a picture has none
    warnings: list[str] = []
    for number, picture in enumerate(picture for file in files for picture in file.pictures()):
        file, frame = results.file_of(files, number)
        name = Path(file.name).name + ("" if file.frames == 1 else f", frame {frame}")
        report(name)
        check()
        _refuse_unfit(picture, name, offset_dn)
        if number < MOST_PREVIEWS:
            previews.append(
                block_means(picture, results.preview_factor(*picture.shape)).astype(np.float32)
            )
        if taken is not None:
            taken.add(picture)
        own = edges_of(picture=picture, number=number, clip_levels=clip_levels, check=check)
        if file.is_lossy:
            edges += [replace(edge, why_not=edge.why_not or results.WITH_LOSS) for edge in own]
            continue
        edges += own
        interpolated = (
            found_edge.why_interpolated(picture=picture) if any(e.used for e in own) else ""
        )
        if interpolated:
            warnings.append(f"{name}: {interpolated}. {_INTERPOLATED}")
            noises.append(interpolated)
            continue
        try:
            missing = found_edge.missing_samples(picture=picture)
            noise_of = picture_noise.noise_of_picture
            noises.append(noise_of(picture=picture, avoid=missing, offset=offset, check=check))
        except DataError as error:  # numbers too large or too small for it
            noises.append(error.message)
    noise, noise_reason = pooled_noise(noises)
    frames, frames_reason = None, results.WITH_LOSS if lossy else "a single picture"
    if taken is not None:
        of_frames, components = taken.measured(offset=offset)
        frames_reason = of_frames.sigma_reason
        if of_frames.sigma is not None:  # the scene stood still
            noise, noise_reason, frames = of_frames, "", components
    x, reason_x = pooled(edges, "x")
    y, reason_y = pooled(edges, "y")
    described = tuple(replace(file, samples=None) for file in files)  # which holds no arrays
    return results.PictureMeasurement(
        described, first.rows, first.columns, first.unit, *intervals, tuple(edges),
        x, y, reason_x, reason_y, noise, noise_reason, frames, frames_reason, tuple(previews),
        pitch_um, tuple(warnings),
    )  # fmt: skip


def _intervals(
    first: results.PictureFile, fov_x_deg: float | None, name: str
) -> tuple[float | None, float | None]:
    x, y = first.interval_x_mrad, first.interval_y_mrad
    if fov_x_deg is not None:
        x = interval_mrad(fov_deg=fov_x_deg, samples=first.columns, name=name)
        y = x if y is None else y
    return x, y


def refuse_small(name: str, rows: int, columns: int) -> None:
    if min(rows, columns) >= _LEAST:
        return
    colours = (
        ". If the array is (rows, columns, colours), pass one colour as (rows, columns)"
        if columns <= _MOST_COLOURS < rows
        else ""
    )
    raise DataError(
        f"{name}: {columns} × {rows} samples are too few to be measured; at least "
        f"{_LEAST} × {_LEAST} are needed{colours}"
    )


def _refuse_unfit(picture: Matrix, name: str, offset: float | None) -> None:
    """Refuse numbers of which squares of squares cannot be had in double precision."""
    low, high = float(picture.min()), float(picture.max())
    most = max(abs(low), abs(high))
    if most > _LARGEST or 0.0 < high - low < 1.0 / _LARGEST:
        raise DataError(
            f"{name}: samples from {low:.4g} to {high:.4g} cannot be measured. Scale the samples: "
            f"no sample may exceed ±{_LARGEST:g}, and their range must be at least "
            f"{1.0 / _LARGEST:g}"
        )
    mean = float(picture.mean())
    if offset is not None and not offset < mean:
        raise DataError(
            f"{name}: the mean level, {mean:.6g}, is not above the dark level, {offset:.6g}. "
            "Check the dark frames (--dark) or the dark level (--offset-dn)"
        )


def without_edge(
    measured: results.PictureMeasurement, place: int, *, again: bool = False
) -> results.PictureMeasurement:
    """The same without one of its edges, counted from 0, or with it again; pooled anew."""
    edges = list(measured.edges)
    if again and edges[place].why_not != results.BY_HAND:
        return measured
    edges[place] = replace(edges[place], why_not="" if again else results.BY_HAND)
    x, reason_x = pooled(edges, "x")
    y, reason_y = pooled(edges, "y")
    return replace(measured, edges=tuple(edges), x=x, y=y, reason_x=reason_x, reason_y=reason_y)


def _dark_level(path: Path, first: results.PictureFile, check: Callable[[], None]) -> float:
    dark = open_frames(path)
    if (dark.rows, dark.columns) != (first.rows, first.columns):
        raise DataError(
            f"{path} has {dark.columns} × {dark.rows} samples, but {first.name} has "
            f"{first.columns} × {first.rows}. Give frames from one camera"
        )
    means = []
    for frame in dark.each():
        check()
        means.append(float(np.mean(frame, dtype=np.float64)))
    return sum(means) / len(means)


# Noise in the flat areas of pictures of one camera, taken together.

_SEVERAL = 2
_Figure = tuple[float | None, float | None]


def pooled_noise(seen: Sequence[SampleNoise | str]) -> tuple[SampleNoise | None, str]:
    """The noise of the pictures that show it, or the reason why none does."""
    measured = [one for one in seen if isinstance(one, SampleNoise)]
    if not measured:
        return None, next((one for one in seen if isinstance(one, str)), results.WITH_LOSS)
    known = [(one, one.sigma, one.sigma_error) for one in measured]
    good = [(one, s, e) for one, s, e in known if s is not None and e is not None]
    if not good:
        return None, "; ".join(_once(one.sigma_reason for one in measured))
    noises = [one for one, _, _ in good]
    sigma = math.sqrt(math.fsum(s**2 for _, s, _ in good) / len(good))
    error = math.sqrt(math.fsum((s * e) ** 2 for _, s, e in good)) / (sigma * len(good))
    gain, gain_error = _weighted((one.gain_e_per_dn, one.gain_error) for one in noises)
    read, read_error = _weighted((one.read_noise_dn, one.read_noise_error) for one in noises)
    steps = [one.step for one in noises if one.step is not None]
    return SampleNoise(
        mean_level=math.fsum(one.mean_level for one in noises) / len(noises),
        offset_dn=noises[0].offset_dn,
        step=min(steps) if steps else None,
        sigma=sigma,
        sigma_error=error,
        gain_e_per_dn=gain,
        gain_error=gain_error,
        gain_reason=_first(_once(one.gain_reason for one in noises)),
        read_noise_dn=read,
        read_noise_error=read_error,
        read_noise_reason=_first(_once(one.read_noise_reason for one in noises)),
        levels=tuple(level for one in noises for level in one.levels),
        rows=_lines(one.rows for one in noises),
        columns=_lines(one.columns for one in noises),
        remarks=tuple(_once(line for one in noises for line in one.remarks)),
    ), ""


def _first(reasons: Sequence[str]) -> str:
    """The first reason, and that other pictures have others of their own."""
    if len(reasons) < _SEVERAL:
        return "".join(reasons)
    return f"{reasons[0]} (and similar reasons in other pictures)"


def _once(texts: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(text for text in texts if text))


def _weighted(figures: Iterable[_Figure]) -> _Figure:
    """Mean by inverse variances; nothing where no picture has the figure."""
    known = [(value, error) for value, error in figures if value is not None and error]
    if not known:
        return None, None
    weights = [1.0 / error**2 for _, error in known]
    total = math.fsum(weights)
    mean = math.fsum(w * value for w, (value, _) in zip(weights, known, strict=True)) / total
    return mean, total**-0.5


def _lines(lines: Iterable[LineNoise | None]) -> LineNoise | None:
    known = [line for line in lines if line is not None]
    if not known:
        return None
    variance = math.fsum(line.variance for line in known) / len(known)
    error = math.sqrt(math.fsum(line.variance_error**2 for line in known)) / len(known)
    return LineNoise(variance, error)


# Edges of pictures: searched for, measured one by one, and pooled by direction.


def edges_of(
    *,
    picture: Matrix,
    number: int,
    clip_levels: tuple[float, float] | None = None,
    check: Callable[[], None] = lambda: None,
) -> tuple[results.MeasuredEdge, ...]:
    seen = edge_search.find_edges(
        picture=picture, clip_levels=clip_levels, interpolated_too=True, check=check
    )
    return tuple(_measured(picture, number, edge, check) for edge in seen)


def _measured(
    picture: Matrix, number: int, edge: found_edge.FoundEdge, check: Callable[[], None]
) -> results.MeasuredEdge:
    if not edge.used:
        return results.MeasuredEdge(number, edge, None, edge.why_not)
    try:
        frequency = np.array(results.FREQUENCIES)
        curve = edge_mtf.measure_edge(picture=picture, edge=edge, frequency=frequency, check=check)
    except DataError as error:
        return results.MeasuredEdge(number, edge, None, error.message)
    return results.MeasuredEdge(number, edge, curve, "")


def pooled(
    edges: Sequence[results.MeasuredEdge], direction: Literal["x", "y"]
) -> tuple[edge_mtf.MtfCurve | None, str]:
    """The MTF of all used edges whose normals lie near an axis, or the reason why there is none."""
    curves = [edge.curve for edge in edges if edge.used and edge.curve is not None]
    together = edge_mtf.pooled_mtf(edges=curves, axis=direction)
    if together is None:
        return None, _no_edge([edge for edge in edges if edge.direction == direction], direction)
    if together.edges == 1 and exceeds_one(together, _OVERSHOOT):
        return None, (
            "the only edge that would give this MTF overshoots (its MTF reaches "
            f"{together.mtf.max():.2f}), and no other edge confirms the overshoot"
        )
    return together, ""


def _no_edge(near: Sequence[results.MeasuredEdge], direction: str) -> str:
    words = "horizontal" if direction == "x" else "vertical"
    if not near:
        most = edge_mtf.LARGEST_ANGLE_DEG
        return f"no straight edge with a normal within {most:g}° of the {words} was found"
    if removed := sum(edge.why_not == results.BY_HAND for edge in near):
        return f"you removed {several(removed, 'edge')} that would give this MTF"
    if len(near) == 1:
        return f"the only edge that would give this MTF cannot be used: {near[0].why_not}"
    reasons = in_words(edge.why_not for edge in near)
    return f"none of the {len(near)} edges that would give this MTF can be used: {reasons}"
