"""Least squares fit of an edge's spread and course to the samples about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_samples import EdgeSamples
from core.physics.measurement.edges.graded_spline import GradedSpline, graded_spline

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

FINEST = 0.25  # samples between the spline's breaks
_LEVEL_FROM = 0.8  # of the reach, beyond which the spread is taken as level
_TURNS = 4


@dataclass(frozen=True)
class SpreadFit:
    """Spread of an edge as a spline, with what is needed for its errors.

    Parameters
    ----------
    spline, coefficients
        The spread.
    inverse : ndarray
        Of the normal equations' matrix.
    residual : ndarray
        Of each sample.
    turn, bend : float
        By how many samples both ends of the edge were moved: in opposite directions, and alike.
    turn_error, bend_error : float
        Their standard errors.
    gap : float
        Largest distance near the edge between neighbouring samples.
    """

    spline: GradedSpline
    coefficients: Vector
    inverse: Matrix
    residual: Vector
    turn: float
    bend: float
    turn_error: float
    bend_error: float
    gap: float

    @property
    def levels(self) -> tuple[float, float]:
        """Levels on both sides."""
        return float(self.coefficients[0]), float(self.coefficients[-1])


def largest_gap(*, distance: Vector, within: float = 3.0) -> float:
    """Largest distance between neighbours among the samples' distances near an edge."""
    near = np.sort(distance[np.abs(distance) <= within])
    near = np.concatenate([[-within], near, [within]])
    return float(np.max(np.diff(near)))


def solve_spread(
    *, spline: GradedSpline, distance: Vector, value: Vector
) -> tuple[Vector, Matrix, Vector]:
    """Coefficients of the spline through samples, inverse normal matrix, residuals.

    Notes
    -----
    A thousand-millionth of the matrix's trace on third differences only settles what no sample
    determines.
    """
    values, which = spline.at(distance)
    size = spline.size
    matrix = np.zeros(size * size)
    for a in range(4):
        for b in range(4):
            place = which[a] * size + which[b]
            matrix += np.bincount(place, values[a] * values[b], size * size)
    right = np.zeros(size)
    for a in range(4):
        right += np.bincount(which[a], values[a] * value, size)
    smooth = np.diff(np.eye(size), 3, axis=0)
    normal = matrix.reshape(size, size) + 1e-9 * len(value) / size * (smooth.T @ smooth)
    inverse = np.asarray(np.linalg.inv(normal), np.float64)
    coefficients = inverse @ right
    fitted = sum(values[a] * coefficients[which[a]] for a in range(4))
    return coefficients, inverse, np.asarray(value - fitted, np.float64)


def fit_spread(
    *, samples: EdgeSamples, reach: float, half_length: float, turns: int = _TURNS
) -> SpreadFit:
    """Fit the spread of an edge, and by how much its course is to be turned and bent.

    Parameters
    ----------
    samples : EdgeSamples
        Samples about the edge.
    reach : float
        Of the samples across the edge.
    half_length : float
        Of the edge.
    turns : int
        Times the course is adjusted; 0 leaves it as it is.

    Returns
    -------
    SpreadFit
        Spread about the adjusted course.

    Notes
    -----
    Gauss–Newton by turns: a spline through the samples by their distance, then the turn and bend
    that make the residuals along its slope least. The distance cannot be told from the spread.
    """
    away = samples.along / half_length
    centre = samples.value.mean()
    value = samples.value - centre
    turn = bend = 0.0
    for step in range(turns + 1):
        distance = samples.distance - turn * away - bend * away**2
        gap = largest_gap(distance=distance)
        spline = graded_spline(half_width=_LEVEL_FROM * reach, spacing=max(FINEST, gap))
        coefficients, inverse, residual = solve_spread(
            spline=spline, distance=distance, value=value
        )
        slope = spline.slopes(distance, coefficients)
        design = np.stack([slope * away, slope * (away**2 - np.mean(away**2))])
        normal = design @ design.T
        inverse_course = np.linalg.pinv(normal)
        if step < turns:
            moved = -inverse_course @ (design @ residual)
            turn, bend = turn + float(moved[0]), bend + float(moved[1])
    scatter = (design * residual) @ (design * residual).T
    error = np.sqrt(np.maximum(np.diag(inverse_course @ scatter @ inverse_course), 0.0))
    return SpreadFit(
        spline=spline,
        coefficients=coefficients + centre,
        inverse=inverse,
        residual=residual,
        turn=turn,
        bend=bend,
        turn_error=float(error[0]),
        bend_error=float(error[1]),
        gap=gap,
    )
