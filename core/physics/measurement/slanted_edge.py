"""MTF from the spread of a slanted edge or line (ISO 12233:2023), with its standard error."""

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Complex, Index, Matrix, Vector
from core.errors import DataError, percent
from core.physics.measurement.found_edge import why_clipped
from core.physics.numerics import sinc
from core.records import dataclass

Target = Literal["edge", "line"]
Window = Literal["tukey", "hamming", "none"]

# Where an edge or a line runs through a picture: its place in each row, and the straight line.

_LEAST_COLUMNS = 16
_LEAST_ROWS = 12
_LARGEST_ANGLE_DEG = 40.0
_MARGIN = 4.0  # samples between the edge and the region's sides, for a window to look through
_PASSES = 12
_SETTLED = 1e-9


@dataclass(frozen=True)
class EdgeLine:
    """The straight line x = start + slope·row, in samples."""

    slope: float  # columns per row
    columns: Vector  # where the line is in each row, shape (rows,)
    places: Vector  # where each row has the edge

    @property
    def angle_deg(self) -> float:
        """Angle to the columns, positive where the line runs to the right as rows go down."""
        return math.degrees(math.atan(self.slope))

    @property
    def scatter(self) -> float:
        """Root mean square distance of the rows' places from the line, samples."""
        return float(np.sqrt(np.mean((self.places - self.columns) ** 2)))


def _edge_line(*, picture: Matrix, target: Target = "edge") -> EdgeLine:
    """Find the one straight edge, or bright or dark line, that runs down a picture.

    As in ISO 12233: the place in a row is the centroid of the windowed derivative, and a straight
    line is laid through the places by least squares. The window follows the line until it moves
    no more, so that it draws no centroid towards itself.
    """
    signal = _signal(picture, target)
    columns = signal.shape[1]
    places = _first_places(picture, signal, target)
    line = _median_line(places)
    _refuse_direction(line.slope)
    for _ in range(_PASSES):
        moved = _follow(signal, line, columns)
        change = np.max(np.abs(moved.columns - line.columns))
        line = moved
        if change < _SETTLED:
            break
    _refuse_line(line, columns)
    return line


def _signal(picture: Matrix, target: Target) -> Matrix:
    """What is bright on the edge and zero off it, mostly positive."""
    rows, columns = picture.shape
    if columns < _LEAST_COLUMNS or rows < _LEAST_ROWS:
        raise DataError(
            f"the region is too small to find an edge in: {columns} samples across the edge and "
            f"{rows} along it; needed: at least {_LEAST_COLUMNS} and {_LEAST_ROWS}"
        )
    if not np.ptp(picture) > 0.0:
        raise DataError(f"no {target} found: the region is uniform")
    signal = np.zeros_like(picture)
    if target == "edge":
        signal[:, 1:-1] = (picture[:, 2:] - picture[:, :-2]) / 2.0
    else:
        outer = max(2, columns // 8)
        background = np.concatenate([picture[:, :outer], picture[:, -outer:]], axis=1)
        signal[...] = picture - np.median(background)
    return signal if np.sum(signal) >= 0.0 else -signal


def _first_places(picture: Matrix, signal: Matrix, target: Target) -> Vector:
    """Column of the strongest change in each row, over so many samples that noise is small."""
    reach = max(2, picture.shape[1] // 8) if target == "edge" else 2
    total = np.cumsum(np.pad(signal, ((0, 0), (1, 0))), axis=1)
    if target == "edge":  # mean of `reach` samples right of a place less that of those left
        total = np.cumsum(np.pad(total[:, 1:], ((0, 0), (1, 0))), axis=1)
        within = total[:, 2 * reach :] - 2 * total[:, reach:-reach] + total[:, : -2 * reach]
        return np.asarray(np.argmax(within, axis=1) + reach - 0.5, np.float64)
    within = total[:, 2 * reach + 1 :] - total[:, : -2 * reach - 1]
    return np.asarray(np.argmax(within, axis=1) + reach, np.float64)


def _median_line(places: Vector) -> EdgeLine:
    """A line that rows with a wrong place do not move."""
    rows = np.arange(len(places))
    half = len(places) // 2
    slope = float(np.median((places[-half:] - places[:half]) / (len(places) - half)))
    start = float(np.median(places - slope * rows))
    return EdgeLine(slope, np.asarray(start + slope * rows, np.float64), places)


def _follow(signal: Matrix, line: EdgeLine, columns: int) -> EdgeLine:
    """The line through the centroids of what a window on `line` shows."""
    middle = line.columns
    margin = float(min(middle.min(), columns - 1 - middle.max()))
    if margin < _MARGIN:
        raise DataError(
            f"the edge leaves the region or comes within {_MARGIN:g} samples of the region's side. "
            "Choose a region in which the edge runs through the middle from end to end"
        )
    half = min(margin, max(_MARGIN, 2.5 * _width(signal, middle)))
    away = np.arange(columns) - middle[:, np.newaxis]
    window = np.where(np.abs(away) < half, np.cos(np.pi / 2.0 * away / half) ** 2, 0.0)
    weight = np.sum(window * signal, axis=1)
    usual = float(np.median(weight))
    if not np.min(weight) > 0.2 * usual:
        raise DataError(
            "no edge found that runs through every row of the region. Choose a region with one "
            "edge and little else"
        )
    places = middle + np.sum(window * signal * away, axis=1) / weight
    return _line_through(places, np.arange(len(places)))


def _width(signal: Matrix, middle: Vector) -> float:
    """Area over height of the signal across the edge, samples."""
    rows, columns = signal.shape
    near = np.rint(np.arange(columns) - middle[:, np.newaxis]).astype(np.intp) + columns
    mean = np.bincount(near.ravel(), signal.ravel(), 2 * columns)
    count = np.bincount(near.ravel(), minlength=2 * columns)
    mean = mean / np.maximum(count, rows / 2)
    height = float(mean.max())
    return float(max(0.0, mean.sum()) / height) if height > 0.0 else 0.0


def _line_through(places: Vector, rows: Index) -> EdgeLine:
    """By least squares, through the places of these rows."""
    centre = rows - rows.mean()
    slope = float(np.sum(centre * places[rows]) / np.sum(centre**2))
    start = float(places[rows].mean() - slope * rows.mean())
    columns = np.asarray(start + slope * np.arange(len(places)), np.float64)
    return EdgeLine(slope, columns, places)


def _refuse_direction(slope: float) -> None:
    angle = math.degrees(math.atan(abs(slope)))
    if angle > _LARGEST_ANGLE_DEG:
        raise DataError(
            f"the edge is tilted by about {angle:.0f}°, where horizontal and vertical edges cannot "
            f"be distinguished. Tilt the edge by 2° to 10° (up to "
            f"{_LARGEST_ANGLE_DEG:g}° is accepted)"
        )


def _refuse_line(line: EdgeLine, columns: int) -> None:
    _refuse_direction(line.slope)
    if line.scatter > max(1.0, columns / 64.0):
        raise DataError(
            f"no straight edge found: edge positions in the rows scatter by {line.scatter:.2g} "
            "samples about a line. Choose a region with one straight edge, or with less noise"
        )
    rows = len(line.places)
    crossed = abs(line.slope) * (rows - 1)
    if crossed < 1.0:
        raise DataError(
            f"the edge is not slanted: over {rows} rows, it crosses {crossed:.2g} samples; "
            "needed: at least 1. Turn the edge by 2° to 10°, use more rows, or set method = "
            "row_average"
        )


# The spread of an edge or line, sampled four times as finely as the picture it is taken from.

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


def _reach(*, line: EdgeLine, columns: int) -> int:
    """Bins on each side of a line that every row of a picture fills."""
    middle = line.columns
    samples = float(min(middle.min(), columns - 1 - middle.max()))
    if samples < _LEAST_REACH:
        raise DataError(
            f"the region is too small: it has {max(samples, 0.0):.2g} samples beside the edge "
            f"in every row; needed: at least {_LEAST_REACH:g}. Widen the region, or use fewer rows"
        )
    return math.floor(samples * BINS_PER_SAMPLE - 0.5)


def _edge_spread(
    *, picture: Matrix, line: EdgeLine, bins: int, rows: NDArray[np.bool_] | None = None
) -> EdgeSpread:
    """Average the samples of some rows in 2·`bins` + 1 bins by their distance from a line.

    Bins are a quarter of a sample wide along a row. The samples of a bin do not lie evenly in it:
    what their mean distance is off its middle is made good with slope and curvature.
    """
    taken = slice(None) if rows is None else rows
    away = np.arange(picture.shape[1]) - line.columns[taken, np.newaxis]
    place = np.rint(away * BINS_PER_SAMPLE).astype(np.intp) + bins
    inside = (place >= 0) & (place <= 2 * bins)
    place, away, values = place[inside], away[inside], picture[taken][inside]
    count = np.bincount(place, minlength=2 * bins + 1)
    if not count.all():
        raise DataError(
            f"at {abs(line.angle_deg):.3g}° every row samples the edge at the same distances, "
            "so the edge cannot be supersampled. Rotate the edge by 2° to 10°, or use more rows"
        )
    mean = np.bincount(place, values, 2 * bins + 1) / count
    scatter = np.sqrt(np.bincount(place, (values - mean[place]) ** 2, 2 * bins + 1) / count)
    middle = np.arange(-bins, bins + 1) / BINS_PER_SAMPLE
    off = np.bincount(place, away, 2 * bins + 1) / count - middle
    slope, _ = _derivatives(mean)
    weight = slope**2
    total = float(np.sum(weight))
    if not total > 0.0:
        raise DataError("no edge found: the region is uniform across the expected edge")
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


def _bin_response(*, frequency: Vector, variance: float) -> Vector:
    """Response of averaging in bins to waves across the edge.

    It is sinc(f/4) for distances spread evenly. Rows whose distances repeat (an edge at 7.125° has
    two in each bin) differ: to fourth order in f, by a Gaussian of the difference in variance.
    """
    excess = variance - 1.0 / (12.0 * BINS_PER_SAMPLE**2)
    gauss = np.exp(-2.0 * np.pi**2 * excess * frequency**2)
    return np.asarray(sinc(frequency / BINS_PER_SAMPLE) * gauss, np.float64)


# The MTF.

_GROUPS = 24  # of rows, each left out once for the standard error


@dataclass(frozen=True)
class SlantedEdge:
    """MTF measured from a slanted edge."""

    frequency: Vector  # cycles per sample along the edge's normal
    # modulus, 1 at zero, and its standard error
    mtf: Vector
    error: Vector
    replicas: Matrix  # modulus without each group of rows, shape (groups, frequencies)
    # the edge, and its supersampled spread
    line: EdgeLine
    spread: EdgeSpread


def slanted_edge(
    *,
    picture: Matrix,
    frequency: Vector,
    target: Target = "edge",
    window: Window = "tukey",
    check: Callable[[], None] = lambda: None,
) -> SlantedEdge:
    """Measure the MTF across an edge, or line, that runs slanted down a picture.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite, of a size near 1: squares are taken.
    frequency : ndarray
        Cycles per sample along the edge's normal, from zero to 1.
    target : {'edge', 'line'}
        Of a line the width is part of what is measured.
    window : {'tukey', 'hamming', 'none'}
        Weight of the line spread: flat over the middle half, or Hamming's.

    Returns
    -------
    SlantedEdge
        MTF, and its standard error by leaving out every 24th row (jackknife).

    Raises
    ------
    DataError
        If there is no edge that can be measured; the message states why.

    Notes
    -----
    Source: ISO 12233:2023. The responses of the bins (`_bin_response`) and of the central
    difference, sinc(f/2), are divided out. Frequency is that along the normal: along a row
    the edge is stretched by 1/cos of its angle.
    """
    line = _edge_line(picture=picture, target=target)
    bins = _reach(line=line, columns=picture.shape[1])
    spread = _edge_spread(picture=picture, line=line, bins=bins)
    _check_spread(picture=picture, line=line, spread=spread, target=target)
    # Leaving out rows turns the line too little to be worth a cosine of its own.
    along_row = frequency * math.cos(math.atan(line.slope))
    many = len(spread_to_line(spread=spread, target=target))
    middles = (np.arange(many) - (many - 1) / 2) / BINS_PER_SAMPLE
    waves = np.exp(-2j * np.pi * np.outer(along_row, middles))
    whole = _transform(spread, along_row, waves, target, window)
    rows = len(picture)
    group = np.arange(rows) % min(_GROUPS, rows // 2)
    replicas = np.empty((int(group.max()) + 1, len(frequency)), np.complex128)
    for left_out in range(len(replicas)):
        check()
        chosen_rows = group != left_out
        other = _line_through(line.places, np.flatnonzero(chosen_rows))
        part = _edge_spread(picture=picture, line=other, bins=bins, rows=chosen_rows)
        replicas[left_out] = _transform(part, along_row, waves, target, window)
    error = modulus_error(whole=whole, replicas=replicas)
    return SlantedEdge(frequency, np.abs(whole), error, np.abs(replicas), line, spread)


def _transform(
    spread: EdgeSpread, along_row: Vector, waves: Complex, target: Target, window: Window
) -> Complex:
    """Transform of a supersampled spread, 1 at zero, without the responses of its making."""
    line_spread = spread_to_line(spread=spread, target=target)
    place = np.linspace(-1.0, 1.0, len(line_spread))
    weighted = line_spread * _window_weight(place=place, window=window)
    transform = waves @ weighted / float(np.sum(weighted))
    response = _bin_response(frequency=along_row, variance=spread.variance)
    if target == "edge":
        response = response * sinc(2.0 * along_row / BINS_PER_SAMPLE)
    return np.asarray(transform / response, np.complex128)


def spread_to_line(*, spread: EdgeSpread, target: Target) -> Vector:
    """Line spread: the edge's central differences, or the line less what is beside it."""
    values = spread.values
    if target == "edge":
        return np.asarray((values[2:] - values[:-2]) / 2.0, np.float64)
    left, right = spread.levels
    return np.asarray(values - np.linspace(left, right, len(values)), np.float64)


def _window_weight(*, place: Vector, window: Window) -> Vector:
    """Weight at places from −1 to 1, the ends of the line spread."""
    if window == "none":
        return np.ones_like(place)
    if window == "hamming":
        return np.asarray(0.54 + 0.46 * np.cos(np.pi * place), np.float64)
    outside = np.clip(2.0 * np.abs(place) - 1.0, 0.0, 1.0)
    return np.asarray(np.cos(np.pi / 2.0 * outside) ** 2, np.float64)


def modulus_error(*, whole: Complex, replicas: Complex) -> Vector:
    """Standard error of a modulus, from replicas each made without one of equal groups of rows.

    Notes
    -----
    Jackknife (Efron 1982). Noise square to the transform lengthens it: |H + i·n| is longer than
    |H| by n²/(2|H|), at most n, which is no scatter but an error all the same, and is added, for
    an |H| that is three errors less than what was measured.
    """
    modulus = np.abs(whole)
    aligned = replicas * np.where(modulus > 0.0, np.conj(whole) / np.maximum(modulus, 1e-300), 1.0)
    along = jackknife_error(replicas=aligned.real)
    across = jackknife_error(replicas=aligned.imag)
    least = np.maximum(modulus - 3.0 * along, 0.0)
    longer = across * np.minimum(1.0, across / np.maximum(2.0 * least, 1e-300))
    return np.asarray(np.hypot(along, longer), np.float64)


def jackknife_error(*, replicas: Matrix) -> Vector:
    """Standard error from values each made without one of equal groups, shape (groups, …)."""
    groups = len(replicas)
    away = replicas - np.mean(replicas, axis=0)
    return np.asarray(np.sqrt((groups - 1) / groups * np.sum(away**2, axis=0)), np.float64)


def falls_to(*, frequency: Vector, mtf: Vector, level: float) -> float | None:
    """Lowest frequency at which the MTF falls to a level, linear between points; None if none."""
    below = np.flatnonzero(mtf <= level)
    if len(below) == 0 or below[0] == 0:
        return None
    k = int(below[0])
    share = (mtf[k - 1] - level) / (mtf[k - 1] - mtf[k])
    return float(frequency[k - 1] + share * (frequency[k] - frequency[k - 1]))


# Reasons not to trust the spread of an edge, given instead of a wrong MTF.

_UNSETTLED = 0.02  # share of the contrast by which a side's level may still change
_CUT_BY_WINDOW = 0.02  # share of the step outside the window's level half


def _check_spread(*, picture: Matrix, line: EdgeLine, spread: EdgeSpread, target: Target) -> None:
    """Refuse an edge that is not one, does not settle in the region, or is clipped."""
    values = spread.values
    left, right = spread.levels
    background = np.linspace(left, right, len(values))
    height = abs(right - left) if target == "edge" else float(np.abs(values - background).max())
    count = picture.shape[0] / (BINS_PER_SAMPLE + abs(line.slope))
    error = spread.noise / np.sqrt(max(1.0, count))  # of one bin
    if height < 0.5 * float(np.ptp(values)) or height < 5.0 * error:
        raise DataError(
            f"no single {target} found: the candidate's height is {height:.3g} of the "
            f"region's range and {height / max(spread.noise, 1e-300):.2g} times the noise. "
            f"Choose a region with one {target} and little else"
        )
    for side in spread.sides:
        near, far = np.array_split(values[side], 2)
        change = abs(float(np.mean(near)) - float(np.mean(far)))
        doubt = 4.0 * error * np.sqrt(2.0 / len(near))
        if change > _UNSETTLED * height + doubt:
            raise DataError(
                f"the region is too small: the level still changes by {percent(change / height)} "
                f"of the contrast at {spread.away[-1]:.3g} samples from the {target}. Widen the "
                "region"
            )
    if target == "edge":
        _refuse_narrow(spread, height, error)
        away = (np.arange(picture.shape[1]) - line.columns[:, np.newaxis]).ravel()
        inside = np.abs(away) <= spread.away[-1]
        off = 1.5 * line.scatter * math.sqrt(2.0 / len(picture))  # samples, of its ends
        reason = why_clipped(
            value=picture.ravel()[inside],
            distance=away[inside] if right > left else -away[inside],
            extremes=(float(picture.min()), float(picture.max())),
            askew=off * BINS_PER_SAMPLE * float(np.abs(np.diff(values)).max()),
        )
        if reason:
            raise DataError(f"the edge is {reason}. Expose less, or store a wider range of values")


def _refuse_narrow(spread: EdgeSpread, height: float, error: float) -> None:
    """The window tapers over the outer half of the spread: little of the step may be there."""
    quarter = len(spread.values) // 4
    near = max(1, quarter // 8)
    left, right = (
        float(np.mean(spread.values[k - near : k + near + 1])) for k in (quarter, -1 - quarter)
    )
    outside = abs(left - spread.levels[0]) + abs(right - spread.levels[1])
    if outside > _CUT_BY_WINDOW * height + 6.0 * error / np.sqrt(near):
        raise DataError(
            f"the region is too small: {percent(outside / height)} of the edge's step lies more "
            f"than {spread.away[-1] / 2:.3g} samples from the edge. Widen the region"
        )
