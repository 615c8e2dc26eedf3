"""Whether the samples of an edge were cut off at a limit of the picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_line import EdgeSamples, edge_samples
from core.physics.measurement.edges.edge_spread import (
    FADED,
    PIXEL_RAMP,
    SURE,
    end_of,
    noise_of_ramp,
    quantum_of,
)
from core.physics.measurement.edges.picture_checks import FoundEdge
from core.physics.measurement.edges.ridges import Piece

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_SHARE = 0.02  # of an edge's samples, at a limit that is known
_PILED = 0.1  # of a side's, at one that is not
_TIMES = 3  # as often as any other value
_OTHERS = 4  # values beside it, or a side is quantized too coarsely to know
_NOISE_MATTERS = 1e-3  # of the contrast: with less, a level side is no sign of a limit
_NOISE_SHOWS = 3e-3  # of the contrast, between sides that have none
_QUIET = 0.1  # of the other side's noise
_ALL_AT_LIMIT = 0.9  # share of a side's samples
_LEAST_STEP = 0.3  # samples between two levels
_DISTINCT = 0.5  # values for each sample, of a side with noise
_NOISE_BESIDE = 3e-4  # of the contrast: less may be a tail's
_LEAST_CUT, _LEAST_CUT_SHARE = 2, 0.3  # edges that show a limit to others which reach it
_DISORDER = 8e-3  # of the contrast, between sides that have none
_LEAST_FREE = 12  # samples of a side, that show its noise
# From a tenth to the end, of the way from a half to a tenth: blurs have more, and a smear of five
# pixels and more, without noise, at least half.
_CORNER, _SHARP_CORNER = 0.85, 0.45
_BESIDE = 3.0  # samples from the edge, where its sides begin


def why_clipped(
    *, samples: EdgeSamples, clip_levels: tuple[float, float] | None, extremes: tuple[float, float]
) -> str:
    """Why an edge is taken as clipped; empty if it is not.

    Notes
    -----
    Where the limits are not known, noise that was cut off shows as many samples of a side at the
    picture's extreme value, far more than at any other, or as a side at that value with no noise
    while the other side has some. A picture with no noise at all shows nothing.
    """
    value = samples.value
    if clip_levels is not None:
        share = float(np.mean((value <= clip_levels[0]) | (value >= clip_levels[1])))
        return f"clipped: {share:.0%} of its samples are at a limit" if share > _SHARE else ""
    contrast = float(np.ptp(value))
    dark, bright = value[samples.distance < -_BESIDE], value[samples.distance > _BESIDE]
    if len(dark) and len(bright) and dark.max() == extremes[0] and bright.min() == extremes[1]:
        noise, quantum = _noise_between(samples)
        if noise > max(_NOISE_SHOWS * contrast, quantum):
            return (
                f"clipped: both sides have the picture's extreme values with no noise, and the "
                f"step between them has {noise / contrast:.2g} of the contrast"
            )
    half = 0.5 * float(np.abs(samples.distance).max())
    for side, other, limit in ((dark, bright, extremes[0]), (bright, dark, extremes[1])):
        if len(side) == 0 or len(other) == 0:
            continue
        # Near the edge a side without noise has the end of the step, which varies too.
        far = samples.distance > half if other is bright else samples.distance < -half
        if not far.any() or float(value[far].std()) < _NOISE_MATTERS * contrast:
            continue
        at_limit = int(np.count_nonzero(side == limit))
        values, counts = np.unique(side[side != limit], return_counts=True)
        piled = len(values) >= _OTHERS and at_limit > _TIMES * int(counts.max())
        quiet = side is bright and float(side.std()) < _QUIET * float(other.std())
        if at_limit > _PILED * len(side) and (piled or quiet):
            return (
                f"clipped: {at_limit / len(side):.0%} of the samples on one side have the "
                f"picture's extreme value {limit:.6g}"
            )
    return ""


def why_cut_off(
    *, samples: EdgeSamples, distance: Vector, reach: float, extremes: tuple[float, float]
) -> str:
    """Why an edge beside which the samples are at the picture's limits was cut off there.

    Notes
    -----
    As in `refuse_quiet_side` and `refuse_corner`: noise on the step ends beside it, though not as
    that of photons fades towards the dark, or the step runs into the limit in a corner.
    """
    low, high = extremes
    if not high > low:
        return ""
    share = (samples.value - low) / (high - low)
    dark = _is_at_limit(samples.value[distance < -_BESIDE], low)
    bright = _is_at_limit(samples.value[distance > _BESIDE], high)
    between = (share > 0.01) & (share < 0.99) & (np.abs(distance) < _BESIDE)
    if not (dark or bright) or not between.any():
        return ""
    levels = samples.value[between]
    least = max(2.0 * quantum_of(levels), _NOISE_SHOWS * (high - low))
    for at_limit, outward, limit in ((dark, -1.0, low), (bright, 1.0, high)):
        half = between & (np.abs(share - (0.28 if outward < 0.0 else 0.72)) < 0.18)
        noise, count = noise_of_ramp(distance[half], samples.value[half], 0.0)
        if not at_limit or noise < least:
            continue
        beyond = float(np.std(samples.value[distance > _BESIDE]))
        if outward > 0.0 or noise > FADED * beyond * np.exp(SURE / np.sqrt(count)):
            return (
                f"clipped: beside it the samples have the picture's extreme value {limit:.6g} "
                f"with no noise, on the step {noise / (high - low):.2g} of the contrast"
            )
    ends = [
        end_of(-distance, share, reach) if dark else "other",
        end_of(distance, 1.0 - share, reach) if bright else "other",
    ]
    wide = float(np.ptp(distance[between])) > PIXEL_RAMP
    if "corner" in ends and (wide or "soft" in ends):
        return "clipped: it runs into the picture's extreme value in a sharp corner"
    return ""


def why_piled_up(*, value: Vector, distance: Vector, extremes: tuple[float, float]) -> str:
    """Why an edge with a side of one extreme value was cut off there, where the other has noise.

    Notes
    -----
    Noise never gives one value again and again. Only that of photons leaves a dark side without
    any, if nothing lies below it; the edge then goes over into that side as softly as its blur
    does, and not in a corner.
    """
    low, high = extremes
    contrast = high - low
    dark, bright = distance < -_BESIDE, distance > _BESIDE
    if not (contrast > 0.0 and dark.any() and bright.any()):
        return ""
    near = np.abs(distance) < _BESIDE
    if np.mean(~np.isin(value[near], extremes)) * 2.0 * _BESIDE < _LEAST_STEP:
        return "clipped: nearly all of its samples have two values, and little is left of its blur"
    between = (value > low + 0.01 * contrast) & (value < high - 0.01 * contrast)
    inner = distance[between & near]
    wide = len(inner) > 0 and float(np.ptp(inner)) > PIXEL_RAMP
    if _is_at_limit(value[dark], low) and _is_at_limit(value[bright], high):
        noise = _disorder(distance[between], value[between]) / contrast
        if noise > _DISORDER:
            return (
                f"clipped: both sides have the picture's extreme values with no noise, and the "
                f"step between them has {noise:.2g} of the contrast"
            )
    for side, other, limit, outward in ((dark, bright, low, -1.0), (bright, dark, high, 1.0)):
        share = float(np.mean(value[side] == limit))
        if share < _PILED:
            continue
        what = (
            f"{share:.0%} of the samples on one side have the picture's extreme value {limit:.6g}"
        )
        if share < _ALL_AT_LIMIT:
            if _has_noise(distance[side], value[side], extremes):
                return f"clipped: {what}, and others there have noise"
            continue
        noisy = _has_noise(distance[other], value[other], extremes)
        if noisy and outward > 0.0:
            return f"clipped: {what}, and the other side has noise"
        limits = _CORNER if noisy else _SHARP_CORNER
        if (noisy or wide) and _is_corner(value, outward * distance, limit, limits):
            return f"clipped: {what}, and the edge runs into it in a sharp corner"
    return ""


def without_those_at(
    *, edges: Sequence[FoundEdge], picture: NDArray[np.floating], extremes: tuple[float, float]
) -> list[FoundEdge]:
    """Refuse edges that reach an extreme value at which others were found to be cut off.

    Notes
    -----
    A limit is the picture's, not an edge's; noise shows it on one edge better than on another.
    """
    made = list(edges)
    if sum(_is_cut(edge) for edge in made) < _LEAST_CUT:
        return made
    for limit in extremes:
        reaching = [
            (place, share)
            for place, edge in enumerate(made)
            if edge.used or _is_cut(edge)
            if (share := _share_at(picture, edge, limit)) > _SHARE
        ]
        cut = sum(_is_cut(made[place]) for place, _ in reaching)
        if cut < max(_LEAST_CUT, _LEAST_CUT_SHARE * len(reaching)):
            continue
        for place, share in reaching:
            if made[place].used:
                reason = (
                    f"clipped: {share:.0%} of its samples have the picture's extreme value "
                    f"{limit:.6g}, at which {cut} others are cut off"
                )
                made[place] = replace(made[place], used=False, why_not=reason)
    return made


def _is_cut(edge: FoundEdge) -> bool:
    return edge.why_not.startswith("clipped")


def _share_at(picture: NDArray[np.floating], edge: FoundEdge, limit: float) -> float:
    value = edge_samples(picture=picture, edge=edge).value
    return float(np.mean(value == limit)) if len(value) else 0.0


def _disorder(distance: Vector, value: Vector) -> float:
    """What samples depart from the nearest rising function of their distance, rms."""
    if len(value) < _LEAST_FREE:
        return 0.0
    rising = value[np.argsort(distance, kind="stable")]
    return float(np.std(rising - nearest_rising(values=rising)))


def _has_noise(distance: Vector, value: Vector, extremes: tuple[float, float]) -> bool:
    """Whether samples of a side have noise, those at the picture's limits left out."""
    free = ~np.isin(value, extremes)
    value = value[free][np.argsort(distance[free], kind="stable")]
    if len(value) < _LEAST_FREE or len(np.unique(value)) < _DISTINCT * len(value):
        return False
    second = value[2:] - 2.0 * value[1:-1] + value[:-2]
    noise = float(np.median(np.abs(second))) / (0.6745 * math.sqrt(6.0))
    return noise > _NOISE_BESIDE * (extremes[1] - extremes[0])


def _is_corner(value: Vector, outward: Vector, limit: float, least: float) -> bool:
    """Whether a step reaches its limit sooner after a tenth of its height than blurs let it."""
    order = np.argsort(outward, kind="stable")
    place, at_limit = outward[order], value[order] == limit
    # Where to part the samples so that most beyond are at the limit, and most before are not.
    before = np.concatenate([[0], np.cumsum(~at_limit)])
    beyond = np.concatenate([np.cumsum(at_limit[::-1])[::-1], [0]])
    end = float(place[min(int(np.argmax(before + beyond)), len(place) - 1)])
    step = float(np.median(value[outward < -_BESIDE])) - limit
    if step == 0.0:
        return False
    share = -nearest_rising(values=(limit - value[order]) / step)
    half, tenth = (float(place[int(np.argmax(share <= level))]) for level in (0.5, 0.1))
    return end - tenth < least * (tenth - half)


def _is_at_limit(side: Vector, limit: float) -> bool:
    return len(side) > 0 and float(np.mean(side == limit)) > _ALL_AT_LIMIT


def _noise_between(samples: EdgeSamples) -> tuple[float, float]:
    """Noise of the samples within the step, from neighbours by distance, and a quantum."""
    value = samples.value[np.argsort(samples.distance)]
    inner = value[(value > value.min()) & (value < value.max())]
    if len(inner) < _OTHERS:
        return 0.0, 0.0
    second = inner[2:] - 2.0 * inner[1:-1] + inner[:-2]
    quantum = float(np.diff(np.unique(value)).min())
    return float(np.median(np.abs(second)) / (0.6745 * np.sqrt(6.0))), quantum


# The nearest values that never fall, to some that may.


def nearest_rising(*, values: Vector) -> Vector:
    """Values that never fall, with the least sum of squares of what they are off.

    Notes
    -----
    Neighbours that fall are given their mean, and so on with what lies before (pool adjacent
    violators; Ayer, Brunk, Ewing, Reid and Silverman, 1955).
    """
    means: list[float] = []
    counts: list[int] = []
    for value in values:
        mean, count = float(value), 1
        while means and means[-1] > mean:
            before, many = means.pop(), counts.pop()
            mean = (mean * count + before * many) / (count + many)
            count += many
        means.append(mean)
        counts.append(count)
    return np.repeat(np.array(means, np.float64), counts)


# How much of a picture belongs to an edge alone: its length and reach, and what limits them.

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
    """What belongs to an edge."""

    # of the edge, along it from the piece's middle
    start: float
    end: float
    reach: float  # samples on both sides
    # levels
    low: float
    high: float
    noise_sigma: float  # of a sample on the level sides
    why_not: str = ""  # why there is no such part; empty if there is


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
        return replace(nothing, why_not=_contrast_reason(contrast, noise_sigma, length))
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
        why_not = reasons[min(reasons)] if reasons else "too near to the frame"
        return replace(nothing, why_not=why_not)
    return best[1]


def _beside(off: Matrix, wide: int, reach: int) -> float:
    """Largest departure of a cell beside the edge, within its reach."""
    near = np.abs(np.arange(-wide, wide + 1))
    return float(off[:, (near > _STEEP) & (near <= reach)].max())


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
