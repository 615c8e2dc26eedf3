"""Functions of which the spread of an edge is made: a spline, a tail, and ramps on both sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.splines.graded_spline import GradedSpline

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

TAIL_WIDTH = 2.0  # samples
TAIL, LOW_RAMP, HIGH_RAMP, TURN, BEND = range(5)  # places of the others, after the spline's
OTHERS = 5


@dataclass(frozen=True)
class SpreadBasis:
    """The functions at the samples of an edge.

    Parameters
    ----------
    spline : GradedSpline
        The spline's functions.
    values, which : ndarray
        Its four functions that are not zero at each sample, and which they are.
    others : ndarray
        Tail, ramps, and what a turn and a bend of the edge change, shape (5, samples).

    Notes
    -----
    Beyond an edge's reach the spread of diffraction still falls as 1/distance, for its line
    spread as 1/distance². The tail is the integral of a Lorentzian, which does the same.
    """

    spline: GradedSpline
    values: Matrix
    which: Index
    others: Matrix

    @property
    def size(self) -> int:
        """Number of functions."""
        return self.spline.size + OTHERS

    def normal_matrix(self, weight: Vector | None = None) -> Matrix:
        """Products of the functions, summed over the samples."""
        size = self.spline.size
        matrix = np.zeros((self.size, self.size))
        inner = np.zeros(size * size)
        weighted = self.values if weight is None else self.values * weight
        for a in range(4):
            for b in range(a, 4):
                product = weighted[a] * self.values[b] * (0.5 if a == b else 1.0)
                inner += np.bincount(self.which[a] * size + self.which[b], product, size * size)
        matrix[:size, :size] = inner.reshape(size, size)
        matrix[:size, :size] += matrix[:size, :size].T.copy()
        others = self.others if weight is None else self.others * weight
        for k, other in enumerate(others):
            matrix[:size, size + k] = self.onto(other)[:size]
        matrix[size:, :size] = matrix[:size, size:].T
        matrix[size:, size:] = others @ self.others.T
        return matrix

    def onto(self, value: Vector) -> Vector:
        """Sums over the samples of the functions times values."""
        size = self.spline.size
        sums = sum(np.bincount(self.which[a], self.values[a] * value, size) for a in range(4))
        return np.concatenate([np.asarray(sums, np.float64), self.others @ value])

    def onto_groups(self, value: Vector, group: Index, groups: int) -> Matrix:
        """As `onto`, over each group of samples; shape (groups, functions)."""
        size = self.spline.size
        sums = np.zeros(groups * size)
        for a in range(4):
            place = group * size + self.which[a]
            sums += np.bincount(place, self.values[a] * value, groups * size)
        others = [np.bincount(group, other * value, groups) for other in self.others]
        return np.concatenate([sums.reshape(groups, size), np.stack(others, axis=1)], axis=1)

    def spread(self, coefficients: Vector) -> Vector:
        """Sum of the functions at the samples."""
        size = self.spline.size
        inner = sum(self.values[a] * coefficients[self.which[a]] for a in range(4))
        return np.asarray(inner + coefficients[size:] @ self.others, np.float64)


def spread_basis(
    *, spline: GradedSpline, distance: Vector, away: Vector, slope: Vector
) -> SpreadBasis:
    """The functions at samples.

    Parameters
    ----------
    spline : GradedSpline
        The spline's functions.
    distance : ndarray
        Of the samples from the edge.
    away : ndarray
        Place along the edge, from −1 to 1.
    slope : ndarray
        Line spread at the samples, as far as it is known: it is what a turn and a bend change.
    """
    values, which = spline.at(distance)
    others = np.empty((OTHERS, len(distance)))
    others[TAIL] = np.arctan(distance / TAIL_WIDTH) / np.pi
    others[LOW_RAMP], others[HIGH_RAMP] = np.minimum(distance, 0.0), np.maximum(distance, 0.0)
    others[TURN], others[BEND] = -slope * away, -slope * away**2
    return SpreadBasis(spline, values, which, others)


def line_spread(*, spline: GradedSpline, coefficients: Vector, distance: Vector) -> Vector:
    """Derivative of a spread, without ramps, at distances."""
    tail = TAIL_WIDTH / np.pi / (distance**2 + TAIL_WIDTH**2)
    inner = spline.slopes(distance, coefficients[: spline.size])
    return np.asarray(inner + coefficients[spline.size + TAIL] * tail, np.float64)


def line_transform(*, spline: GradedSpline, frequency: Vector) -> Complex:
    """Transform of the derivative of each function; of ramps, turn and bend zero.

    Returns
    -------
    ndarray
        Shape (frequencies, functions).
    """
    others = np.zeros((len(frequency), OTHERS))
    others[:, TAIL] = np.exp(-2.0 * np.pi * TAIL_WIDTH * np.abs(frequency))
    return np.concatenate([spline.transform(frequency), others], axis=1)
