"""Measuring the MTF in a region of a picture."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Region, ends_lineage, holds_region
from core.evaluation.work import Work
from core.physics.measurement.row_average import row_average
from core.physics.measurement.slanted_edge import (
    Target,
    Window,
    falls_to,
    jackknife_error,
    slanted_edge,
    spread_to_line,
)
from core.physics.numerics import sinc
from core.transfer.factors import Array, Grid, factor_at
from nodes.analysis.lineage import Stage, transfer_of

Vector = NDArray[np.float64]
Direction = Literal["automatic", "horizontal", "vertical"]
_BLOCK = 4


@dataclass(frozen=True)
class Figure:
    value: float | None
    error: float | None = None


@dataclass(frozen=True)
class Measured:
    """An MTF measured in a picture, whatever the method; frequencies in cycles per pixel."""

    frequency: Vector
    mtf: Vector
    error: Vector
    per_mrad: float | None
    direction: str
    angle_deg: float
    mtf50: Figure
    mtf10: Figure
    nyquist: Figure
    contrast: float
    noise: float
    away: Vector
    spread: Vector
    line_spread: Vector


def _size(*, where: Region, **_: Any) -> tuple[int, int]:
    return where.shape


@holds_region(_size)
@ends_lineage
def measured_slanted(
    work: Work,
    image: Array,
    *,
    where: Region,
    intervals: tuple[float, float] | None,
    direction: Direction,
    target: Target,
    window: Window,
    samples: int,
) -> Measured:
    region, scale = _region(image, where)
    across = direction if direction != "automatic" else _direction(region)
    if across == "vertical":
        region = region.T
    frequency = np.linspace(0.0, 1.0, samples)
    # The figures are those of fine steps, however few points the curve has.
    fine = np.linspace(0.0, 1.0, 257)
    edge = slanted_edge(
        picture=np.ascontiguousarray(region),
        frequency=np.concatenate([frequency, fine]),
        target=target,
        window=window,
        check=work.check,
    )
    levels = edge.spread.levels
    lines = spread_to_line(spread=edge.spread, target=target)
    height = levels[1] - levels[0] if target == "edge" else float(lines[np.argmax(np.abs(lines))])
    away = edge.spread.away * math.cos(math.radians(edge.line.angle_deg))
    inner = slice(1, -1) if target == "edge" else slice(None)
    return Measured(
        frequency,
        edge.mtf[:samples],
        edge.error[:samples],
        _per_mrad(intervals, across, edge.line.slope),
        across,
        -edge.line.angle_deg if across == "horizontal" else 90.0 + edge.line.angle_deg,
        _crossing(fine, edge.mtf[samples:], edge.replicas[:, samples:], 0.5),
        _crossing(fine, edge.mtf[samples:], edge.replicas[:, samples:], 0.1),
        Figure(float(edge.mtf[samples + 128]), float(edge.error[samples + 128])),
        abs(height) * scale,
        edge.spread.noise * scale,
        away[inner],
        edge.spread.values[inner] * scale,
        lines * scale,
    )


@holds_region(_size)
@ends_lineage
def measured_rows(
    work: Work,
    image: Array,
    *,
    where: Region,
    intervals: tuple[float, float] | None,
    direction: Direction,
    target: Target,
    clip_left: int | None,
    clip_right: int | None,
) -> Measured:
    """MTF across an upright edge or line from the mean of rows, from 0 to Nyquist."""
    region, scale = _region(image, where)
    across = direction if direction != "automatic" else _direction(region)
    if across == "vertical":
        region = region.T
    work.check()
    average = row_average(picture=region, target=target, clip_left=clip_left, clip_right=clip_right)
    spread = np.diff(average.clipped) if target == "edge" else average.clipped
    from_sample = np.arange(len(spread), dtype=np.float64) + (0.5 if target == "edge" else 0.0)
    nyquist = len(average.frequency) - 1
    at_nyquist = Figure(
        float(np.interp(0.5, average.frequency, average.mtf)), float(average.error[nyquist])
    )
    return Measured(
        average.frequency,
        average.mtf,
        average.error,
        _per_mrad(intervals, across, 0.0),
        across,
        0.0 if across == "horizontal" else 90.0,
        Figure(falls_to(frequency=average.frequency, mtf=average.mtf, level=0.5)),
        Figure(falls_to(frequency=average.frequency, mtf=average.mtf, level=0.1)),
        at_nyquist,
        average.contrast * scale,
        average.noise * scale,
        from_sample,
        np.interp(from_sample, np.arange(len(average.clipped)), average.clipped) * scale,
        spread * scale,
    )


def _region(image: Array, where: Region) -> tuple[NDArray[np.float64], float]:
    """The region in double precision from 0 to 1, and the range it had."""
    region = np.asarray(image[where.slices], np.float64)
    if not np.isfinite(region).all():
        raise DataError("the region contains samples that are not finite; move the region")
    lowest, highest = float(region.min()), float(region.max())
    if not highest - lowest > 1e-12 * max(abs(lowest), abs(highest)):
        raise DataError("no edge found: the region is uniform; move the region to an edge")
    return (region - lowest) / (highest - lowest), highest - lowest


def _direction(region: NDArray[np.float64]) -> str:
    """Across what the picture changes most; means of blocks, which noise changes little."""
    rows, columns = (size // _BLOCK for size in region.shape)
    if min(rows, columns) >= 2:
        whole = region[: rows * _BLOCK, : columns * _BLOCK]
        region = whole.reshape(rows, _BLOCK, columns, _BLOCK).mean(axis=(1, 3))
    across, along = (float(np.sum(np.diff(region, axis=axis) ** 2)) for axis in (1, 0))
    return "horizontal" if across >= along else "vertical"


def _per_mrad(intervals: tuple[float, float] | None, across: str, slope: float) -> float | None:
    """Cycles per mrad in a cycle per pixel, along the normal; pixels may be oblong."""
    if intervals is None:
        return None
    over, down = intervals if across == "horizontal" else intervals[::-1]
    in_pixels = math.cos(math.atan(slope))
    in_angle = math.cos(math.atan(slope * over / down))
    return in_pixels / in_angle / over


def _crossing(frequency: Vector, mtf: Vector, replicas: Array, level: float) -> Figure:
    value = falls_to(frequency=frequency, mtf=mtf, level=level)
    crossings = [falls_to(frequency=frequency, mtf=one, level=level) for one in replicas]
    known = [one for one in crossings if one is not None]
    if value is None or len(known) < len(crossings):
        return Figure(value)
    return Figure(value, float(jackknife_error(replicas=np.array(known))))


# What a measured MTF is expected to be: the chain's own, along the same direction.

_FINE = 513
_AREA, _UNKNOWN = "area of the scene's samples", "not known"


@dataclass(frozen=True)
class Expected:
    """An expected MTF; frequencies in cycles per pixel, up to Nyquist or where less is known.

    Figures are None where they lie beyond.
    """

    frequency: Vector
    mtf: Vector
    mtf50: float | None
    at_nyquist: float | None
    largest_difference: float
    largest_difference_at: float
    scene: str


def chain_behind(image: Image) -> dict[str, Any] | None:
    """What `expected` needs of a picture; None where not all of its way from the source is known.

    A test scene's samples are means over their area, which blurs too. The scene in a file may be
    blurred by anything: its own MTF is unknown, and of a picture straight from a file no MTF is
    expected.
    """
    try:
        transfer = transfer_of(image)
    except DataError:
        return None
    is_scene = transfer.area_means
    if not is_scene and (transfer.source.inputs or not transfer.stages):
        return None
    return {
        "stages": transfer.part("mtf"),
        "grid": transfer.grid,
        "source_grid": transfer.source_grid,
        "is_scene": is_scene,
    }


@ends_lineage
def expected(
    work: Work,
    measured: Measured,
    *,
    stages: tuple[Stage, ...],
    grid: Grid,
    source_grid: Grid,
    is_scene: bool,
    differences: bool,
) -> Expected:
    """The modulus of all stages along the normal that was measured.

    With `differences` as the mean of rows shows it: the derivative of samples one pixel apart
    takes sin(πf)/(πf) of a frequency f. What is folded back from beyond Nyquist does not count.
    """
    normal = math.radians(measured.angle_deg)
    # A cycle per pixel along the normal, in cycles/mrad across and along.
    xi_per_pixel = math.cos(normal) / grid.interval_x_mrad
    eta_per_pixel = math.sin(normal) / grid.interval_y_mrad

    def mtf(frequency: Vector) -> Vector:
        xi, eta = frequency * xi_per_pixel, frequency * eta_per_pixel
        total = np.ones(len(frequency))
        for stage in stages:
            work.check()
            for factor in stage.factors:
                total = total * factor_at(work, factor, xi, eta)
        if is_scene:
            total = total * sinc(xi * source_grid.interval_x_mrad)
            total = total * sinc(eta * source_grid.interval_y_mrad)
        return np.abs(total * sinc(frequency)) if differences else np.abs(total)

    end = _end(source_grid, abs(xi_per_pixel), abs(eta_per_pixel))
    frequency = measured.frequency[measured.frequency <= end]
    here = mtf(frequency)
    fine = np.linspace(0.0, end, _FINE)
    apart = np.abs(measured.mtf[: len(frequency)] - here)
    largest = int(np.argmax(apart))
    return Expected(
        frequency,
        here,
        falls_to(frequency=fine, mtf=mtf(fine), level=0.5),
        float(mtf(np.array([0.5]))[0]) if end == 0.5 else None,
        float(apart[largest]),
        float(frequency[largest]),
        _AREA if is_scene else _UNKNOWN,
    )


def _end(source: Grid, xi_per_pixel: float, eta_per_pixel: float) -> float:
    """Nyquist, or where the source's samples end if these are coarser."""
    ends = [
        nyquist / per_pixel
        for nyquist, per_pixel in (
            (source.nyquist_x, xi_per_pixel),
            (source.nyquist_y, eta_per_pixel),
        )
        if per_pixel > 0.0
    ]
    least = min(ends)
    return 0.5 if least >= 0.5 * (1.0 - 1e-9) else least
