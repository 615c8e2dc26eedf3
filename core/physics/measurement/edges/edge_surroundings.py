"""How much of a picture belongs to an edge alone: its length and reach, and what limits them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_samples import EdgeSamples
from core.physics.measurement.edges.ridges.straight_pieces import Piece

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

LARGEST_REACH = 20
BEYOND = 2  # samples beyond the reach that are looked at, for a neighbour's blur
LEAST_REACH = 5
LEAST_LENGTH = 11.0
LEAST_CONTRAST = 5.0  # of the noise, for the longest edges
_CONTRAST_OF_16 = 10.0  # the same for one of 16 samples
_REACHES = (20, 16, 13, 10, 8, 6, 5)
_ENOUGH_REACH = 16.0  # beyond which more reach is worth no length
_CELL = 3.0  # samples along the edge
_LEVEL = 0.04  # of the contrast, by which a level side may differ across it
_ALIKE = 0.06  # of the contrast, by which pieces of the edge may differ
_NEIGHBOUR = 0.2  # of the contrast, that the level just beyond the reach may differ by
_OVERSHOOT = 0.35  # of the contrast, beyond the levels
_SURE = 4.0  # standard errors
_STEEP = 2  # samples beside an edge where its level changes fast


@dataclass(frozen=True)
class Surroundings:
    """What belongs to an edge.

    Parameters
    ----------
    start, end : float
        Of the edge, along it from the piece's middle.
    reach : float
        Samples on both sides.
    low, high : float
        Levels.
    noise_sigma : float
        Of a sample on the level sides.
    why_not : str
        Why there is no such part; empty if there is.
    """

    start: float
    end: float
    reach: float
    low: float
    high: float
    noise_sigma: float
    why_not: str = ""


def cells_along(length: float) -> int:
    """Number of cells along an edge."""
    return max(3, round(length / _CELL))


def frame_reach(*, piece: Piece, shape: tuple[int, ...], clear: Matrix | None = None) -> Vector:
    """Samples on both sides of each cell along a piece to the frame's border, or to missing ones.

    `clear` is how far each sample of the frame is from missing ones.
    """
    across_x, across_y = (
        math.cos(math.radians(piece.angle_deg)),
        math.sin(math.radians(piece.angle_deg)),
    )
    place = np.linspace(-0.5, 0.5, cells_along(piece.length) + 1)
    off = piece.bend * 4.0 * place**2
    x = piece.x - place * piece.length * across_y + off * across_x
    y = piece.y + place * piece.length * across_x + off * across_y
    reach = np.full(len(place), np.inf)
    for at, across, last in ((x, across_x, shape[1] - 1), (y, across_y, shape[0] - 1)):
        if abs(across) > 1e-3:
            reach = np.minimum(reach, np.minimum(at, last - at) / abs(across))
    if clear is not None:
        row, column = (
            np.clip(np.rint(at), 0, last - 1).astype(np.intp)
            for at, last in zip((y, x), shape, strict=True)
        )
        reach = np.minimum(reach, clear[row, column] - 1.5)
    return np.asarray(np.maximum(np.minimum(reach[1:], reach[:-1]), 0.0), np.float64)


def surroundings(
    *, samples: EdgeSamples, length: float, reach: float, room: Vector, noise_sigma: float
) -> Surroundings:
    """Choose the length and reach over which a piece is one step between level sides.

    Parameters
    ----------
    samples : EdgeSamples
        Samples about the piece.
    length, reach : float
        Of the rectangle they fill.
    room : ndarray
        Samples beside each cell of the edge to the frame's border.
    noise_sigma : float
        Of a sample of the picture, at least.

    Notes
    -----
    The samples' means in cells of one sample by four are compared with the medians along the
    edge. Of the runs of cells that agree within 6 % of the contrast (and four standard errors of
    the noise) to a reach, the one of the largest length times reach is chosen; its sides must be
    level within 4 %.
    """
    wide = int(min(reach, LARGEST_REACH + BEYOND))
    cells = cells_along(length)
    column = np.rint(samples.distance).astype(np.intp) + wide
    row = np.clip(((samples.along / length + 0.5) * cells).astype(np.intp), 0, cells - 1)
    inside = (column >= 0) & (column <= 2 * wide)
    column, row, value = column[inside], row[inside], samples.value[inside]
    distance = samples.distance[inside]
    size = 2 * wide + 1
    profile = _medians(row * size + column, value, cells, size)
    near, far = 3, min(6, wide)
    low = float(np.median(profile[wide - far : wide - near + 1]))
    high = float(np.median(profile[wide + near : wide + far + 1]))
    contrast = high - low
    nothing = Surroundings(-length / 2, length / 2, float(wide), low, high, noise_sigma)
    if not contrast > least_contrast(length) * noise_sigma:
        return _refused(nothing, _contrast_reason(contrast, noise_sigma, length))
    residual = value - np.interp(distance, np.arange(-wide, wide + 1), profile)
    count = np.bincount(row * size + column, minlength=cells * size).reshape(cells, size)
    total = np.bincount(row * size + column, residual, cells * size).reshape(cells, size)
    off = np.abs(total) / np.maximum(count, 1)
    doubt = _SURE * noise_sigma / np.sqrt(np.maximum(count, 1))
    good = off <= _ALIKE * contrast + doubt
    good[:, wide - _STEEP : wide + _STEEP + 1] = True  # there a mean depends on the phase
    best, reasons = None, {}
    for reach_now in sorted({r for r in _REACHES if r <= wide}, reverse=True):
        within = good[:, wide - reach_now : wide + reach_now + 1]
        in_frame = room >= reach_now - 0.5
        first, last = _longest_run(np.asarray(within.all(axis=1)) & in_frame)
        piece_length = (last - first) * length / cells
        if piece_length < LEAST_LENGTH:
            reasons[reach_now] = (
                "too near to the frame's side"
                if not in_frame.any()
                else (
                    f"its sides or its contrast differ along it by "
                    f"{_beside(off, wide, reach_now) / contrast:.0%} of the contrast"
                )
            )
            continue
        chosen = (row >= first) & (row < last)
        sides = _sides(
            distance[chosen], value[chosen], reach_now, noise_sigma, profile, wide, piece_length
        )
        if isinstance(sides, str):
            reasons[reach_now] = sides
            continue
        score = piece_length * min(reach_now, _ENOUGH_REACH)
        if best is None or score > best[0]:
            start, end = (k * length / cells - length / 2 for k in (first, last))
            best = (score, Surroundings(start, end, float(reach_now), *sides))
    if best is None:
        return _refused(nothing, reasons[min(reasons)] if reasons else "too near to the frame")
    return best[1]


def _beside(off: Matrix, wide: int, reach: int) -> float:
    """Largest departure of a cell beside the edge, within its reach."""
    near = np.abs(np.arange(-wide, wide + 1))
    return float(off[:, (near > _STEEP) & (near <= reach)].max())


def _refused(about: Surroundings, reason: str) -> Surroundings:
    return Surroundings(
        about.start, about.end, about.reach, about.low, about.high, about.noise_sigma, reason
    )


def least_contrast(length: float) -> float:
    """Contrast over the noise that an edge of a length needs."""
    return max(LEAST_CONTRAST, _CONTRAST_OF_16 * math.sqrt(16.0 / length))


def _contrast_reason(contrast: float, noise_sigma: float, length: float) -> str:
    if not contrast > 0.0:
        return "too little contrast: farther from it, its bright side is no brighter than the other"
    times = contrast / max(noise_sigma, 1e-300)
    return (
        f"too little contrast: {times:.2g} times the noise, of at least "
        f"{least_contrast(length):.2g} for its length"
    )


def _medians(place: NDArray[np.intp], value: Vector, cells: int, size: int) -> Vector:
    """Median over the cells along the edge of the mean at each distance."""
    count = np.bincount(place, minlength=cells * size).reshape(cells, size)
    total = np.bincount(place, value, cells * size).reshape(cells, size)
    means = np.where(count > 0, total / np.maximum(count, 1), np.inf)
    means.sort(axis=0)
    known = np.sum(count > 0, axis=0)
    columns = np.arange(size)
    lower = means[np.maximum(known - 1, 0) // 2, columns]
    upper = means[np.minimum(known // 2, np.maximum(known - 1, 0)), columns]
    return np.asarray(np.where(known > 0, (lower + upper) / 2.0, np.median(value)), np.float64)


def _longest_run(agree: NDArray[np.bool_]) -> tuple[int, int]:
    """First, and one beyond the last, of the longest run of true values."""
    steps = np.flatnonzero(np.diff(np.concatenate([[False], agree, [False]]).astype(np.int8)))
    if len(steps) == 0:
        return 0, 0
    starts, ends = steps[::2], steps[1::2]
    k = int(np.argmax(ends - starts))
    return int(starts[k]), int(ends[k])


def _sides(
    distance: Vector,
    value: Vector,
    reach: int,
    noise_sigma: float,
    profile: Vector,
    wide: int,
    length: float,
) -> tuple[float, float, float] | str:
    """Levels and noise of the outer halves of both sides, or why they are not level."""
    levels, variances, steps = [], [], []
    for side in (-1.0, 1.0):
        away = side * distance
        inner = value[(away > 0.5 * reach) & (away <= 0.75 * reach)]
        outer = value[(away > 0.75 * reach) & (away <= reach)]
        if len(inner) < 8 or len(outer) < 8:
            return "too few samples beside it"
        error = math.sqrt(inner.var() / len(inner) + outer.var() / len(outer))
        levels.append(float(np.mean(np.concatenate([inner, outer]))))
        variances.append(float((inner.var() + outer.var()) / 2.0))
        steps.append((abs(float(outer.mean() - inner.mean())), error))
    contrast = levels[1] - levels[0]
    noise = math.sqrt(sum(variances) / 2.0)
    if not contrast > least_contrast(length) * max(noise, noise_sigma):
        return _contrast_reason(contrast, max(noise, noise_sigma), length)
    for change, error in steps:
        if change > _LEVEL * contrast + 3.0 * error:
            return (
                f"{reach} samples from it a side is not level: it changes by "
                f"{change / contrast:.0%} of the contrast"
            )
    seen = min(reach + BEYOND, wide)
    place = np.arange(-seen, seen + 1)
    part = (profile[wide - seen : wide + seen + 1] - levels[0]) / contrast
    doubt = _SURE * noise / contrast / math.sqrt(max(1.0, len(value) / (2.0 * reach + 1.0)))
    off = np.abs(part - (place > 0))
    beyond = off[(np.abs(place) > reach / 2.0) & (np.abs(place) <= reach)]
    inside = np.maximum(part - 1.0, -part)[np.abs(place) <= reach / 2.0]
    neighbour = off[np.abs(place) > reach]
    if neighbour.max(initial=0.0) > _NEIGHBOUR + doubt:
        return f"another edge about {reach + BEYOND} samples away"
    if beyond.max() > _ALIKE + doubt or inside.max() > _OVERSHOOT + doubt:
        farthest = int(np.abs(place[off > _ALIKE + doubt]).max())
        return f"another edge about {farthest} samples away"
    return levels[0], levels[1], noise
