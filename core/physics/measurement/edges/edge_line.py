"""Where an edge or a line runs through a picture: its place in each row, and the straight line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.edges.picture_checks import FoundEdge

Target = Literal["edge", "line"]
Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

LEAST_COLUMNS = 16
LEAST_ROWS = 12
_LARGEST_ANGLE_DEG = 40.0
_MARGIN = 4.0  # samples between the edge and the region's sides, for a window to look through
_PASSES = 12
_SETTLED = 1e-9


@dataclass(frozen=True)
class EdgeLine:
    """The straight line x = start + slope·row, in samples."""

    # column in row 0, and columns per row
    start: float
    slope: float
    places: Vector  # where each row has the edge, shape (rows,)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.places)

    @property
    def angle_deg(self) -> float:
        """Angle to the columns, positive where the line runs to the right as rows go down."""
        return math.degrees(math.atan(self.slope))

    def columns(self) -> Vector:
        """Column of the line in each row."""
        return np.asarray(self.start + self.slope * np.arange(self.rows), np.float64)

    @property
    def scatter(self) -> float:
        """Root mean square distance of the rows' places from the line, samples."""
        return float(np.sqrt(np.mean((self.places - self.columns()) ** 2)))

    def without(self, left_out: NDArray[np.bool_]) -> EdgeLine:
        """The line through the places of the other rows."""
        rows = np.flatnonzero(~left_out)
        slope, start = _line_through(rows.astype(np.float64), self.places[rows])
        return EdgeLine(start, slope, self.places)


def edge_line(*, picture: Matrix, target: Target = "edge") -> EdgeLine:
    """Find the one straight edge, or bright or dark line, that runs down a picture.

    Parameters
    ----------
    target : {'edge', 'line'}
        Whether levels differ on the two sides, or only on the line itself.

    Raises
    ------
    DataError
        If the picture is too small or uniform, has no such edge, or the edge is not straight,
        leaves the picture, or is not slanted enough or too much to be supersampled.

    Notes
    -----
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
        change = np.max(np.abs(moved.columns() - line.columns()))
        line = moved
        if change < _SETTLED:
            break
    _refuse_line(line, columns)
    return line


def _signal(picture: Matrix, target: Target) -> Matrix:
    """What is bright on the edge and zero off it, mostly positive."""
    rows, columns = picture.shape
    if columns < LEAST_COLUMNS or rows < LEAST_ROWS:
        raise DataError(
            f"the region is too small to find an edge in: {columns} samples across the edge and "
            f"{rows} along it; needed: at least {LEAST_COLUMNS} and {LEAST_ROWS}"
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
    return EdgeLine(float(np.median(places - slope * rows)), slope, places)


def _follow(signal: Matrix, line: EdgeLine, columns: int) -> EdgeLine:
    """The line through the centroids of what a window on `line` shows."""
    middle = line.columns()
    margin = float(min(middle.min(), columns - 1 - middle.max()))
    if margin < _MARGIN:
        raise DataError(
            f"the edge leaves the region, or comes within {_MARGIN:g} samples of its side: "
            "choose a region with the edge in the middle, from end to end"
        )
    half = min(margin, max(_MARGIN, 2.5 * _width(signal, middle)))
    away = np.arange(columns) - middle[:, np.newaxis]
    window = np.where(np.abs(away) < half, np.cos(np.pi / 2.0 * away / half) ** 2, 0.0)
    weight = np.sum(window * signal, axis=1)
    usual = float(np.median(weight))
    if not np.min(weight) > 0.2 * usual:
        raise DataError(
            "no edge found that runs through every row of the region: choose a region with one "
            "edge and little else"
        )
    places = middle + np.sum(window * signal * away, axis=1) / weight
    slope, start = _line_through(np.arange(len(places), dtype=np.float64), places)
    return EdgeLine(start, slope, places)


def _width(signal: Matrix, middle: Vector) -> float:
    """Area over height of the signal across the edge, samples."""
    rows, columns = signal.shape
    near = np.rint(np.arange(columns) - middle[:, np.newaxis]).astype(np.intp) + columns
    mean = np.bincount(near.ravel(), signal.ravel(), 2 * columns)
    count = np.bincount(near.ravel(), minlength=2 * columns)
    mean = mean / np.maximum(count, rows / 2)
    height = float(mean.max())
    return float(max(0.0, mean.sum()) / height) if height > 0.0 else 0.0


def _line_through(rows: Vector, places: Vector) -> tuple[float, float]:
    centre = rows - rows.mean()
    slope = float(np.sum(centre * places) / np.sum(centre**2))
    return slope, float(places.mean() - slope * rows.mean())


def _refuse_direction(slope: float) -> None:
    angle = math.degrees(math.atan(abs(slope)))
    if angle > _LARGEST_ANGLE_DEG:
        raise DataError(
            f"the edge is tilted by about {angle:.0f}°, where horizontal and vertical edges cannot "
            f"be distinguished: tilt it by 2° to 10° (up to {_LARGEST_ANGLE_DEG:g}° is accepted)"
        )


def _refuse_line(line: EdgeLine, columns: int) -> None:
    _refuse_direction(line.slope)
    if line.scatter > max(1.0, columns / 64.0):
        raise DataError(
            f"no straight edge found: its positions in the rows scatter by {line.scatter:.2g} "
            "samples about a line. Choose a region with one straight edge, or with less noise"
        )
    crossed = abs(line.slope) * (line.rows - 1)
    if crossed < 1.0:
        raise DataError(
            f"the edge is not slanted: over {line.rows} rows it crosses {crossed:.2g} samples; "
            "it must cross at least 1. Turn it by 2° to 10°, use more rows, or set method = "
            "row_average"
        )


# The samples of a picture that belong to an edge, by their distance from it.


@dataclass(frozen=True)
class EdgeSamples:
    """Samples about an edge, in the order of the picture's rows."""

    # of each sample's middle from the edge along its normal, positive on the brighter side
    distance: Vector
    along: Vector  # place along the edge, 0 at its middle
    value: Vector


def edge_samples(*, picture: NDArray[np.floating], edge: FoundEdge) -> EdgeSamples:
    """Take the samples within an edge's reach and length."""
    return rectangle_samples(
        picture=picture,
        middle=(edge.x, edge.y),
        angle_deg=edge.angle_deg,
        half_length=edge.length / 2.0,
        reach=edge.reach,
        bend=edge.bend,
    )


def rectangle_samples(
    *,
    picture: NDArray[np.floating],
    middle: tuple[float, float],
    angle_deg: float,
    half_length: float,
    reach: float,
    bend: float = 0.0,
) -> EdgeSamples:
    """Take the samples of a turned rectangle, whose long axis may be a parabola.

    Parameters
    ----------
    middle : tuple of float
        x and y of the rectangle's middle.
    angle_deg : float
        Of the normal.
    half_length, reach : float
        Half the sides along and across, samples.
    bend : float
        Distance of the axis's ends from the tangent at its middle, along the normal.
    """
    across_x, across_y = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    wide = reach + abs(bend)
    half_x = abs(across_x) * wide + abs(across_y) * half_length
    half_y = abs(across_y) * wide + abs(across_x) * half_length
    rows, columns = picture.shape
    top, left = max(0, math.ceil(middle[1] - half_y)), max(0, math.ceil(middle[0] - half_x))
    bottom = min(rows, math.floor(middle[1] + half_y) + 1)
    right = min(columns, math.floor(middle[0] + half_x) + 1)
    x = np.arange(left, max(left, right)) - middle[0]
    y = (np.arange(top, max(top, bottom)) - middle[1])[:, np.newaxis]
    along = across_x * y - across_y * x
    distance = across_x * x + across_y * y - bend * (along / half_length) ** 2
    inside = (np.abs(distance) <= reach) & (np.abs(along) <= half_length)
    value = picture[top : max(top, bottom), left : max(left, right)][inside]
    return EdgeSamples(distance[inside], along[inside], value.astype(np.float64))
