"""The spread of an edge or line, sampled four times as finely as the picture it is taken from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.edges.edge_line import EdgeLine
from core.physics.numerics import sinc

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

BINS_PER_SAMPLE = 4
_CENTRINGS = 3
_LEAST_REACH = 5.0  # samples on each side of the edge


@dataclass(frozen=True)
class EdgeSpread:
    """Means of bins a quarter sample wide, across an edge."""

    # mean level of each bin, from one side of the edge to the other; the middle is on it
    values: Vector
    scatter: Vector  # standard deviation of the samples within each bin
    # variance of the distances within a bin, mean over the edge, samples². Were they spread evenly,
    # it would be (1/4)²/12.
    variance: float

    @property
    def away(self) -> Vector:
        """Distance of the bins from the edge along a row, samples."""
        half = len(self.values) // 2
        return np.arange(-half, half + 1) / BINS_PER_SAMPLE

    @property
    def sides(self) -> tuple[slice, slice]:
        """The outer quarter of the bins on each side, away from the edge."""
        outer = max(2, len(self.values) // 8)
        return slice(0, outer), slice(len(self.values) - outer, None)

    @property
    def levels(self) -> tuple[float, float]:
        """Mean level on the left and on the right."""
        left, right = self.sides
        return float(np.mean(self.values[left])), float(np.mean(self.values[right]))

    @property
    def noise(self) -> float:
        """Standard deviation of the samples away from the edge."""
        left, right = self.sides
        return float(
            np.sqrt(np.mean(np.concatenate([self.scatter[left], self.scatter[right]]) ** 2))
        )


def reach(*, line: EdgeLine, columns: int) -> int:
    """Bins on each side of a line that every row of a picture fills.

    Raises
    ------
    DataError
        If fewer than five samples lie beside the line.
    """
    middle = line.columns()
    samples = float(min(middle.min(), columns - 1 - middle.max()))
    if samples < _LEAST_REACH:
        raise DataError(
            f"the region is too small: {max(samples, 0.0):.2g} samples lie beside the edge in "
            f"every row, of at least {_LEAST_REACH:g}. Widen it, or use fewer rows"
        )
    return math.floor(samples * BINS_PER_SAMPLE - 0.5)


def edge_spread(
    *, picture: Matrix, line: EdgeLine, bins: int, rows: NDArray[np.bool_] | None = None
) -> EdgeSpread:
    """Average the samples of a picture in bins by their distance from a line.

    Parameters
    ----------
    bins : int
        Bins on each side, a quarter sample wide along a row.
    rows : ndarray of bool, optional
        Rows to take, shape (rows,); all, if not given.

    Returns
    -------
    EdgeSpread
        2·`bins` + 1 bins.

    Raises
    ------
    DataError
        If a bin has no sample: rows repeat one another's distances.

    Notes
    -----
    Source: ISO 12233:2023, edge-based spatial frequency response. The samples of a bin do not lie
    evenly in it: what their mean distance is off its middle is made good with slope and curvature.
    """
    taken = slice(None) if rows is None else rows
    away = np.arange(picture.shape[1]) - line.columns()[taken, np.newaxis]
    place = np.rint(away * BINS_PER_SAMPLE).astype(np.intp) + bins
    inside = (place >= 0) & (place <= 2 * bins)
    place, away, values = place[inside], away[inside], picture[taken][inside]
    count = np.bincount(place, minlength=2 * bins + 1)
    if not count.all():
        raise DataError(
            f"at {abs(line.angle_deg):.3g}° the rows repeat each other's samples, and the edge "
            "cannot be supersampled: turn it to 2° to 10°, or take more rows"
        )
    mean = np.bincount(place, values, 2 * bins + 1) / count
    scatter = np.sqrt(np.bincount(place, (values - mean[place]) ** 2, 2 * bins + 1) / count)
    middle = np.arange(-bins, bins + 1) / BINS_PER_SAMPLE
    off = np.bincount(place, away, 2 * bins + 1) / count - middle
    slope, _ = _derivatives(mean)
    weight = slope**2
    total = float(np.sum(weight))
    if not total > 0.0:
        raise DataError("no edge found: the region is uniform across it")
    off = off - float(np.sum(weight * off)) / total  # all alike they only move the edge
    values = mean
    for _ in range(_CENTRINGS):
        slope, curvature = _derivatives(values)
        values = mean - off * slope - off**2 / 2.0 * curvature
    apart = (away - (place - bins) / BINS_PER_SAMPLE) ** 2
    about = np.bincount(place, away, 2 * bins + 1) / count - middle
    variance = np.bincount(place, apart, 2 * bins + 1) / count - about**2
    return EdgeSpread(values, scatter, float(np.sum(weight * variance)) / total)


def _derivatives(values: Vector) -> tuple[Vector, Vector]:
    """First and second derivative per sample, to fourth order; level beyond the ends."""
    wide = np.pad(values, 2, mode="edge")
    slope = (wide[:-4] - 8 * wide[1:-3] + 8 * wide[3:-1] - wide[4:]) / 12.0
    bend = (-wide[:-4] + 16 * wide[1:-3] - 30 * values + 16 * wide[3:-1] - wide[4:]) / 12.0
    return slope * BINS_PER_SAMPLE, bend * BINS_PER_SAMPLE**2


def bin_response(*, frequency: Vector, variance: float) -> Vector:
    """Response of averaging in bins to waves across the edge.

    Returns
    -------
    ndarray
        sinc(f/4) for distances spread evenly. Rows whose distances repeat (an edge at 7.125° has
        two in each bin) differ: to fourth order in f, by a Gaussian of the difference in variance.
    """
    excess = variance - 1.0 / (12.0 * BINS_PER_SAMPLE**2)
    gauss = np.exp(-2.0 * np.pi**2 * excess * frequency**2)
    return np.asarray(sinc(frequency / BINS_PER_SAMPLE) * gauss, np.float64)


# Signs that the picture of an edge was cut off at a limit, where its MTF would be a wrong one.
#
# Not every clipped edge shows: one with little or no noise that is cut off at both ends and left
# narrower than a pixel looks like the unblurred edge of a smaller pixel.

End = Literal["corner", "soft", "other"]

_REMEDY = "Expose less, or widen the range"
_NOISE_MATTERS = 1e-3  # share of the contrast
_NOISE_SHOWS = 3e-3  # share of the contrast; without any, the line's own error gives up to 1.2e-3
_SAME = 1e-9  # share of the range by which equal samples may differ
_STEPS = 4.0  # of a quantized picture, below which the shape of an end is not known
_SOFT = 3e-4  # mean deficit over the end, below which it is soft; cut off there, it matters not
_END = 0.25  # samples over which the shape of an end is looked at
_LEAST_AT_END = 5  # distances in it that samples have
_APART = 1 / 64  # samples between distances that count as two
_CORNER = 0.15  # slope at an end, of that a quarter sample before it
PIXEL_RAMP = 1.6  # samples: an edge with no blur but the pixel's own is no wider
_ALL_AT_LIMIT = 0.9  # share of a side's samples
_LEAST_SAMPLES = 10  # that give the noise on a half of the ramp
_SPACING = 0.125  # samples between those that are compared for it
FADED = 0.52  # noise of photons in the dark half of the ramp, of that on the bright side
SURE = 2.5  # times the doubt of that ratio
_ERRORS = 3.0  # standard errors of the line that count as possible
_TURNS, _SEARCHES = 81, 3  # of the line, the range of one search being a step of the one before


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
            at_limit = int(np.count_nonzero(samples == limit))
            others, counts = np.unique(samples[samples != limit], return_counts=True)
            usual = int(counts.max()) if len(counts) else 0
            if at_limit > 0.1 * len(samples) and len(others) >= 4 and at_limit > 3 * usual:
                raise DataError(
                    f"the picture is clipped: {at_limit / len(samples):.0%} of the samples beside "
                    f"the edge have the same extreme value. {_REMEDY}"
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
        end_of(away if outward else -away, deficit, spread.away[-1])
        for deficit, outward in ((1.0 - values, rising), (values, not rising))
    ]
    wide = float(np.ptp(between)) > PIXEL_RAMP
    if "corner" in ends and (wide or "soft" in ends):
        raise DataError(
            "the picture is clipped: the edge runs into its extreme value in a sharp corner. "
            + _REMEDY
        )


def end_of(outer: Vector, deficit: Vector, reach: float) -> End:
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
    if mean < _STEPS * quantum_of(deficit[short & (deficit < 0.25)]):
        return "other"  # the last steps of a quantized picture
    if mean < _SOFT:
        return "soft"
    # Beyond its outermost sample the deficit goes on to where the parabola is zero.
    start, slope, bend = np.polynomial.polynomial.polyfit(inwards, lacking, 2)
    at_zero = np.sqrt(max(0.0, slope**2 - 4.0 * start * bend))
    sharp = at_zero > _CORNER * (slope + 2.0 * bend * _END) > 0.0
    return "corner" if sharp else "other"


def quantum_of(levels: Vector) -> float:
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
    least = max(2.0 * quantum_of(picture[ramp]), _NOISE_SHOWS * abs(right - left))
    steepest = float(np.max(np.abs(np.diff(spread.values)))) * BINS_PER_SAMPLE
    askew = _ERRORS * line.scatter * float(np.sqrt(2.0 / line.rows)) * steepest
    risen = picture * np.sign(right - left)
    limits = float(picture.min()), float(picture.max())
    for k, (side, half) in enumerate(((-away, share < 0.45), (away, share > 0.55))):
        samples = picture[(side > 0.75 * spread.away[-1]) & (side <= spread.away[-1])]
        at_dark, at_bright = (float(np.mean(samples == limit)) for limit in limits)
        if max(at_dark, at_bright) < _ALL_AT_LIMIT:
            continue
        noise, count = noise_of_ramp(away[ramp & half], picture[ramp & half], curvature)
        if noise < least:
            continue
        if at_dark > at_bright:
            beyond = float(np.sqrt(np.mean(spread.scatter[spread.sides[1 - k]] ** 2)))
            if noise < FADED * beyond * np.exp(SURE / np.sqrt(count)):
                continue
        if noise < askew and _disorder(away[ramp], risen[ramp], line, ramp) < least:
            continue
        raise DataError(
            f"the picture is clipped: {max(at_dark, at_bright):.0%} of the samples beside the "
            f"edge have the same extreme value, though the edge itself has noise. {_REMEDY}"
        )


def _disorder(away: Vector, values: Vector, line: EdgeLine, ramp: NDArray[np.bool_]) -> float:
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


def noise_of_ramp(away: Vector, values: Vector, curvature: float) -> tuple[float, int]:
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
