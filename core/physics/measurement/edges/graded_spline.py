"""Cubic splines whose intervals widen away from the middle, level beyond their ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Index = NDArray[np.intp]
Complex = NDArray[np.complex128]

_QUADRATURE = 6  # points an interval: exact to 1e-9 for two radians
_FINE = 2.5  # samples from the middle to where intervals begin to widen


@dataclass(frozen=True)
class GradedSpline:
    """Basis of cubic splines on intervals between breaks; level outside with no corner.

    Notes
    -----
    Source: de Boor, A Practical Guide to Splines, 2001, ch. IX and X. The first two and the last
    two B-splines are joined, which makes the slope zero at both ends.
    """

    breaks: Vector  # ascending, at least four

    @property
    def size(self) -> int:
        """Number of basis functions."""
        return len(self.breaks)

    @property
    def _knots(self) -> Vector:
        return np.concatenate([[self.breaks[0]] * 3, self.breaks, [self.breaks[-1]] * 3])

    def _interval(self, distance: Vector) -> Index:
        found = np.searchsorted(self.breaks, distance, side="right") - 1
        return np.clip(found, 0, len(self.breaks) - 2)

    def _nonzero(self, distance: Vector, interval: Index, degree: int) -> Matrix:
        """Values of the degree + 1 B-splines that are not zero, shape (degree + 1, distances)."""
        knots, first = self._knots, interval + 3
        values = np.zeros((degree + 1, len(distance)))
        values[0] = 1.0
        for order in range(1, degree + 1):
            carried = np.zeros(len(distance))
            for k in range(order):
                right, left = knots[first + k + 1], knots[first + k + 1 - order]
                share = values[k] / (right - left)
                values[k] = carried + (right - distance) * share
                carried = (distance - left) * share
            values[order] = carried
        return values

    def at(self, distance: Vector) -> tuple[Matrix, Index]:
        """Values of the four basis functions at distances, and which; shapes (4, distances)."""
        clipped = np.clip(distance, self.breaks[0], self.breaks[-1])
        interval = self._interval(clipped)
        which = interval + np.arange(4)[:, np.newaxis]
        return self._nonzero(clipped, interval, 3), np.clip(which - 1, 0, self.size - 1)

    def slopes(self, distance: Vector, coefficients: Vector) -> Vector:
        """Derivative of a spline at distances."""
        steps = self._steps(coefficients)
        inside = (distance > self.breaks[0]) & (distance < self.breaks[-1])
        clipped = np.clip(distance, self.breaks[0], self.breaks[-1])
        interval = self._interval(clipped)
        values = self._nonzero(clipped, interval, 2)
        slope = sum(values[k] * steps[interval + k] for k in range(3))
        return np.asarray(np.where(inside, slope, 0.0), np.float64)

    def _steps(self, coefficients: Matrix) -> Matrix:
        """Coefficients of the derivative, of second degree, from those of the joined basis."""
        full = np.concatenate([coefficients[:1], coefficients, coefficients[-1:]])
        knots = self._knots
        width = knots[4 : 4 + len(full) - 1] - knots[1 : len(full)]
        scale = (3.0 / width).reshape((-1,) + (1,) * (coefficients.ndim - 1))
        return np.asarray(np.diff(full, axis=0) * scale, np.float64)

    def transform(self, frequency: Vector) -> Complex:
        """∫ B′(d) exp(−2πi·f·d) dd of each basis function, shape (frequencies, size)."""
        nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE)
        half = np.diff(self.breaks) / 2.0
        middle = self.breaks[:-1] + half
        distance = (middle[:, np.newaxis] + half[:, np.newaxis] * nodes).ravel()
        weight = (half[:, np.newaxis] * weights).ravel()
        interval = np.repeat(np.arange(len(half)), _QUADRATURE)
        values = self._nonzero(distance, interval, 2) * weight
        dense = np.zeros((len(distance), self.size + 1))
        for k in range(3):
            dense[np.arange(len(distance)), interval + k] = values[k]
        slopes = dense @ self._steps(np.eye(self.size))
        waves = np.exp(-2j * np.pi * np.outer(frequency, distance))
        return np.asarray(waves @ slopes, np.complex128)


def graded_spline(*, half_width: float, spacing: float) -> GradedSpline:
    """Splines from −`half_width` to `half_width` with intervals of `spacing` at the middle.

    Parameters
    ----------
    half_width : float
        Samples from the middle to where the spline becomes level.
    spacing : float
        Of the breaks within four samples of the middle; farther out it grows as the distance.

    Notes
    -----
    What lies far from an edge changes slowly there: its blur's tails. Fine intervals would bring
    noise of high frequencies from there and nothing else.
    """
    place, places = 0.0, [0.0]
    while place < half_width:
        place += spacing * max(1.0, place / _FINE)
        places.append(place)
    outer = np.array(places) * (half_width / places[-1])
    return GradedSpline(np.concatenate([-outer[:0:-1], outer]))
