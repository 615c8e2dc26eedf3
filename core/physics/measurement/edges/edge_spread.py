"""The spread of an edge or line, sampled four times as finely as the picture it is taken from."""

from __future__ import annotations

import math
from dataclasses import dataclass

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
            f"the region is too small: it has {max(samples, 0.0):.2g} samples beside the edge "
            f"in every row and needs at least {_LEAST_REACH:g}. Widen it, or use fewer rows"
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
            f"at {abs(line.angle_deg):.3g}° every row samples the edge at the same distances, "
            "so it cannot be supersampled: turn it to 2° to 10°, or use more rows"
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
