"""Signs that samples of an edge were cut off at a limit, where its MTF would be a wrong one.

Not every clipped edge shows: one with little or no noise that is cut off at both ends and left
narrower than a pixel looks like the unblurred edge of a smaller pixel. `why_…` judge edges found in
a picture, `refuse_…` one that fills a region.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.edges.edge_line import EdgeLine, EdgeSamples, edge_samples
from core.physics.measurement.edges.edge_spread import BINS_PER_SAMPLE, EdgeSpread
from core.physics.measurement.edges.picture_checks import FoundEdge

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
End = Literal["corner", "soft", "other"]

_REMEDY = "Expose less, or store a wider range of values"
_SHARE = 0.02  # of an edge's samples, at a limit that is known
_PILED = 0.1  # of a side's, at one that is not
_TIMES = 3  # as often as any other value
_OTHERS = 4  # values beside it, or a side is quantized too coarsely to know
_NOISE_MATTERS = 1e-3  # of the contrast: with less, a level side is no sign of a limit
_NOISE_SHOWS = 3e-3  # of the contrast; a line without any has an error of its own, up to 1.2e-3
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
_SAME = 1e-9  # share of the range by which equal samples may differ
_STEPS = 4.0  # of a quantized picture, below which the shape of an end is not known
_SOFT = 3e-4  # mean deficit over the end, below which it is soft; cut off there, it matters not
_END = 0.25  # samples over which the shape of an end is looked at
_LEAST_AT_END = 5  # distances in it that samples have
_APART = 1 / 64  # samples between distances that count as two
_END_SLOPE = 0.15  # at an end, of that a quarter sample before it
_PIXEL_RAMP = 1.6  # samples: an edge with no blur but the pixel's own is no wider
_LEAST_SAMPLES = 10  # that give the noise on a half of the ramp
_SPACING = 0.125  # samples between those that are compared for it
_FADED = 0.52  # noise of photons in the dark half of the ramp, of that on the bright side
_SURE = 2.5  # times the doubt of that ratio
_ERRORS = 3.0  # standard errors of the line that count as possible
_TURNS, _SEARCHES = 81, 3  # of the line, the range of one search being a step of the one before


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
                "clipped: both sides are constant, at the picture's smallest and largest values, "
                f"but the step between them has noise of {noise / contrast:.2g} of the contrast"
            )
    half = 0.5 * float(np.abs(samples.distance).max())
    for side, other, limit in ((dark, bright, extremes[0]), (bright, dark, extremes[1])):
        if len(side) == 0 or len(other) == 0:
            continue
        # Near the edge a side without noise has the end of the step, which varies too.
        far = samples.distance > half if other is bright else samples.distance < -half
        if not far.any() or float(value[far].std()) < _NOISE_MATTERS * contrast:
            continue
        share, piled = _piled_up(side, limit)
        quiet = side is bright and float(side.std()) < _QUIET * float(other.std())
        if share > _PILED and (piled or quiet):
            return (
                f"clipped: {share:.0%} of the samples on one side are at the limit of the "
                f"picture's values, {limit:.6g}"
            )
    return ""


def _piled_up(side: Vector, limit: float) -> tuple[float, bool]:
    """Share of a side's samples at a limit, and whether these are far more than at other values."""
    at_limit = int(np.count_nonzero(side == limit))
    others, counts = np.unique(side[side != limit], return_counts=True)
    piled = len(others) >= _OTHERS and at_limit > _TIMES * int(counts.max())
    return at_limit / max(len(side), 1), piled


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
    least = max(2.0 * _quantum_of(levels), _NOISE_SHOWS * (high - low))
    for at_limit, outward, limit in ((dark, -1.0, low), (bright, 1.0, high)):
        half = between & (np.abs(share - (0.28 if outward < 0.0 else 0.72)) < 0.18)
        noise, count = _noise_of_ramp(distance[half], samples.value[half], 0.0)
        if not at_limit or noise < least:
            continue
        beyond = float(np.std(samples.value[distance > _BESIDE]))
        if outward > 0.0 or noise > _FADED * beyond * np.exp(_SURE / np.sqrt(count)):
            return (
                f"clipped: beside it the samples are constant at {limit:.6g}, the limit of the "
                f"picture's values, but the step has noise of {noise / (high - low):.2g} of the "
                "contrast"
            )
    ends = [
        _end_of(-distance, share, reach) if dark else "other",
        _end_of(distance, 1.0 - share, reach) if bright else "other",
    ]
    wide = float(np.ptp(distance[between])) > _PIXEL_RAMP
    if "corner" in ends and (wide or "soft" in ends):
        return "clipped: it meets the limit of the picture's values at a sharp corner"
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
        return (
            "clipped: nearly all of its samples have one of two values, so little of its blur "
            "is left"
        )
    between = (value > low + 0.01 * contrast) & (value < high - 0.01 * contrast)
    inner = distance[between & near]
    wide = len(inner) > 0 and float(np.ptp(inner)) > _PIXEL_RAMP
    if _is_at_limit(value[dark], low) and _is_at_limit(value[bright], high):
        noise = _disorder(distance[between], value[between]) / contrast
        if noise > _DISORDER:
            return (
                "clipped: both sides are constant, at the picture's smallest and largest values, "
                f"but the step between them has noise of {noise:.2g} of the contrast"
            )
    for side, other, limit, outward in ((dark, bright, low, -1.0), (bright, dark, high, 1.0)):
        share = float(np.mean(value[side] == limit))
        if share < _PILED:
            continue
        what = (
            f"{share:.0%} of the samples on one side are at the limit of the picture's values, "
            f"{limit:.6g}"
        )
        if share < _ALL_AT_LIMIT:
            if _has_noise(distance[side], value[side], extremes):
                return f"clipped: {what}, while the other samples there have noise"
            continue
        noisy = _has_noise(distance[other], value[other], extremes)
        if noisy and outward > 0.0:
            return f"clipped: {what}, while the other side has noise"
        limits = _CORNER if noisy else _SHARP_CORNER
        if (noisy or wide) and _is_corner(value, outward * distance, limit, limits):
            return f"clipped: {what}, and the edge meets it at a sharp corner"
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
                    f"clipped: {share:.0%} of its samples are at the limit of the picture's "
                    f"values, {limit:.6g}, where {cut} other edges are clipped"
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
    return float(np.std(rising - _nearest_rising(rising)))


def _has_noise(distance: Vector, value: Vector, extremes: tuple[float, float]) -> bool:
    """Whether samples of a side have noise, those at the picture's limits left out."""
    free = ~np.isin(value, extremes)
    value = value[free][np.argsort(distance[free], kind="stable")]
    if len(value) < _LEAST_FREE or len(np.unique(value)) < _DISTINCT * len(value):
        return False
    return _noise_of_neighbours(value) > _NOISE_BESIDE * (extremes[1] - extremes[0])


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
    share = -_nearest_rising((limit - value[order]) / step)
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
    return _noise_of_neighbours(inner), float(np.diff(np.unique(value)).min())


def _noise_of_neighbours(value: Vector) -> float:
    """Noise of values along a curve, by what each is off the mean of the ones beside it."""
    second = value[2:] - 2.0 * value[1:-1] + value[:-2]
    return float(np.median(np.abs(second))) / (0.6745 * math.sqrt(6.0))


def _nearest_rising(values: Vector) -> Vector:
    """Values that never fall, with the least sum of squares of what they are off."""
    from scipy.optimize import isotonic_regression  # imported where it is used: start-up time

    return np.asarray(isotonic_regression(values).x, np.float64)


def refuse_piled_up(*, picture: Matrix, line: EdgeLine, spread: EdgeSpread, height: float) -> None:
    """Noise cut off at a limit leaves many samples at exactly that value."""
    away = _away(picture, line)
    end = spread.away[-1]
    for side, scatter in zip((-away, away), spread.sides, strict=True):
        noise = float(np.mean(spread.scatter[scatter]))
        if noise < _NOISE_MATTERS * height:
            continue
        samples = picture[(side > 0.75 * end) & (side <= end)]
        for limit in (float(picture.min()), float(picture.max())):
            share, piled = _piled_up(samples, limit)
            if share > _PILED and piled:
                raise DataError(
                    f"the picture is clipped: {share:.0%} of the samples beside the edge have the "
                    f"same extreme value. {_REMEDY}"
                )


def refuse_corner(*, picture: Matrix, line: EdgeLine, spread: EdgeSpread) -> None:
    """An edge without noise that runs into its extreme value in a corner was cut off there.

    Blurs end softly: even a box's ends are rounded by the pixel, so that the deficit grows at
    least as the square of the distance from where it begins. Only an edge with no blur but the
    pixel's own has corners, and it has no soft end.
    """
    away = _away(picture, line)
    inside = np.abs(away) <= spread.away[-1]
    lowest, highest = float(picture.min()), float(picture.max())
    away, values = away[inside], (picture[inside] - lowest) / (highest - lowest)
    between = away[(values > 0.01) & (values < 0.99)]
    if len(between) == 0:
        return
    rising = spread.levels[1] > spread.levels[0]
    ends = [
        _end_of(away if outward else -away, deficit, spread.away[-1])
        for deficit, outward in ((1.0 - values, rising), (values, not rising))
    ]
    wide = float(np.ptp(between)) > _PIXEL_RAMP
    if "corner" in ends and (wide or "soft" in ends):
        raise DataError(
            "the picture is clipped: the edge meets the limit of its values at a sharp corner. "
            + _REMEDY
        )


def _end_of(outer: Vector, deficit: Vector, reach: float) -> End:
    """Whether what is lacking to the extreme value ends with a slope, by a parabola."""
    short = deficit > _SAME
    end = float(np.max(outer[short]))
    if end > reach - 1.0:
        return "other"  # nothing beyond it is level
    last = short & (outer > end - _END)
    inwards, lacking = end - outer[last], deficit[last]
    if len(np.unique(np.rint(inwards / _APART))) < _LEAST_AT_END:
        return "other"  # few rows, or ones that repeat each other's distances
    mean = float(np.mean(lacking))
    if mean < _STEPS * _quantum_of(deficit[short & (deficit < 0.25)]):
        return "other"  # the last steps of a quantized picture
    if mean < _SOFT:
        return "soft"
    # Beyond its outermost sample the deficit goes on to where the parabola is zero.
    start, slope, bend = np.polynomial.polynomial.polyfit(inwards, lacking, 2)
    at_zero = np.sqrt(max(0.0, slope**2 - 4.0 * start * bend))
    sharp = at_zero > _END_SLOPE * (slope + 2.0 * bend * _END) > 0.0
    return "corner" if sharp else "other"


def _quantum_of(levels: Vector) -> float:
    """Step between the levels of a quantized picture; that of rounding, of any other."""
    gaps = np.diff(np.unique(levels))
    gaps = gaps[gaps > _SAME]
    return float(gaps.min()) if len(gaps) else _SAME


def refuse_quiet_side(*, picture: Matrix, line: EdgeLine, spread: EdgeSpread) -> None:
    """An edge with noise beside which the samples are all at a limit, without any, was cut off.

    Noise that fades towards the dark (photons, with no background) is none that was cut off. Nor is
    what a small turn of the edge's line puts in order: the places found in the rows of an edge
    narrower than a pixel, as one decimated without a blur, scatter by up to half a sample, and a
    line a little askew mixes up the samples of a steep edge as noise would.
    """
    away = _away(picture, line)
    left, right = spread.levels
    share = (np.interp(away, spread.away, spread.values) - left) / (right - left)
    inside = np.abs(away) <= spread.away[-1]
    ramp = inside & (share > 0.1) & (share < 0.9)
    curvature = float(np.max(np.abs(np.diff(spread.values, 2)))) * BINS_PER_SAMPLE**2
    least = max(2.0 * _quantum_of(picture[ramp]), _NOISE_SHOWS * abs(right - left))
    steepest = float(np.max(np.abs(np.diff(spread.values)))) * BINS_PER_SAMPLE
    askew = _ERRORS * line.scatter * float(np.sqrt(2.0 / line.rows)) * steepest
    risen = picture * np.sign(right - left)
    limits = float(picture.min()), float(picture.max())
    for k, (side, half) in enumerate(((-away, share < 0.45), (away, share > 0.55))):
        samples = picture[(side > 0.75 * spread.away[-1]) & (side <= spread.away[-1])]
        at_dark, at_bright = (float(np.mean(samples == limit)) for limit in limits)
        if max(at_dark, at_bright) < _ALL_AT_LIMIT:
            continue
        noise, count = _noise_of_ramp(away[ramp & half], picture[ramp & half], curvature)
        if noise < least:
            continue
        if at_dark > at_bright:
            beyond = float(np.sqrt(np.mean(spread.scatter[spread.sides[1 - k]] ** 2)))
            if noise < _FADED * beyond * np.exp(_SURE / np.sqrt(count)):
                continue
        if noise < askew and _least_fall(away[ramp], risen[ramp], line, ramp) < least:
            continue
        raise DataError(
            f"the picture is clipped: {max(at_dark, at_bright):.0%} of the samples beside the "
            f"edge have the same extreme value, though the edge itself has noise. {_REMEDY}"
        )


def _least_fall(away: Vector, values: Vector, line: EdgeLine, ramp: NDArray[np.bool_]) -> float:
    """How far values are from rising along an edge, rms, for the best line there can be.

    The least distance of a rising function from all values is half of what they fall by; that is
    zero for an edge of any form without noise. Lines are those within three standard errors of the
    fitted one's slope.
    """
    row = np.nonzero(ramp)[0] - (line.rows - 1) / 2.0
    width = _ERRORS * line.scatter * np.sqrt(12.0 / line.rows**3)
    middle, least = 0.0, np.inf
    for _ in range(_SEARCHES):
        turns = middle + width * np.linspace(-1.0, 1.0, _TURNS)
        falls = [_fall(values[np.argsort(away - turn * row, kind="stable")]) for turn in turns]
        best = int(np.argmin(falls))
        middle, least = float(turns[best]), min(least, falls[best])
        width *= 2.0 / (_TURNS - 1)
    return least


def _fall(values: Vector) -> float:
    above = np.maximum.accumulate(values)
    below = np.minimum.accumulate(values[::-1])[::-1]
    return float(np.sqrt(np.mean((above - below) ** 2))) / 2.0


def _noise_of_ramp(away: Vector, values: Vector, curvature: float) -> tuple[float, int]:
    """Noise of samples about the straight line between their two neighbours, and their number.

    Zero where they are too few, or the edge's bend between neighbours may look like noise.
    """
    order = np.argsort(away, kind="stable")
    away, values = away[order], values[order]
    gap = away[2:] - away[:-2]
    close = gap < _SPACING
    count = int(np.count_nonzero(close))
    if count < _LEAST_SAMPLES:
        return 0.0, count
    share = np.divide(away[1:-1] - away[:-2], gap, out=np.full_like(gap, 0.5), where=gap > 0.0)
    off = values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:]
    parts = off[close] / np.sqrt(1.0 + share**2 + (1.0 - share) ** 2)[close]
    noise = float(np.sqrt(np.mean(parts**2)))
    bend = curvature * float(np.sqrt(np.mean((share * (1.0 - share) * gap**2)[close] ** 2))) / 2.0
    return (noise if noise > 3.0 * bend else 0.0), count


def _away(picture: Matrix, line: EdgeLine) -> Matrix:
    """Distance of each sample from the edge along its row."""
    return np.asarray(np.arange(picture.shape[1]) - line.columns()[:, np.newaxis], np.float64)
