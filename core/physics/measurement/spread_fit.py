"""Least squares fit of an edge's spread and course to the samples about it."""

import numpy as np

from core.arrays import Complex, Index, Matrix, Vector
from core.physics.measurement.found_edge import EdgeSamples
from core.records import dataclass

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
    """Splines from −`half_width` to `half_width` with intervals of `spacing` samples at the middle.

    Farther out they grow as the distance: what lies there, a blur's tails, changes slowly. Fine
    intervals would bring noise of high frequencies from there and nothing else.
    """
    place, places = 0.0, [0.0]
    while place < half_width:
        place += spacing * max(1.0, place / _FINE)
        places.append(place)
    outer = np.array(places) * (half_width / places[-1])
    return GradedSpline(np.concatenate([-outer[:0:-1], outer]))


# Functions of which the spread of an edge is made: a spline, a tail, and ramps on both sides.

TAIL_WIDTH = 2.0  # samples
TAIL, LOW_RAMP, HIGH_RAMP, TURN, BEND = range(5)  # places of the others, after the spline's
OTHERS = 5


@dataclass(frozen=True)
class SpreadBasis:
    """The functions at the samples of an edge.

    Notes
    -----
    Beyond an edge's reach the spread of diffraction still falls as 1/distance, for its line
    spread as 1/distance². The tail is the integral of a Lorentzian, which does the same.
    """

    spline: GradedSpline  # the spline's functions
    # its four functions that are not zero at each sample, and which they are
    values: Matrix
    which: Index
    others: Matrix  # tail, ramps, and what a turn and a bend of the edge change, shape (5, samples)

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
    """The functions at samples, `distance` from the edge and `away` along it, from −1 to 1.

    `slope` is the line spread there, as far as it is known: it is what a turn and a bend change.
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
    """Transform of each function's derivative, shape (frequencies, functions).

    Of ramps, turn and bend it is zero.
    """
    others = np.zeros((len(frequency), OTHERS))
    others[:, TAIL] = np.exp(-2.0 * np.pi * TAIL_WIDTH * np.abs(frequency))
    return np.concatenate([spline.transform(frequency), others], axis=1)


FINEST = 0.25  # samples between the spline's breaks
_COARSE = 1.0  # so much, it cannot follow what a wrong turn does to neighbouring rows
_LEVEL_FROM = 0.8  # of the reach, beyond which the spline is level
_FIRST_SLOPE = 1.5  # samples, width of the step assumed to begin with

TAIL_ASSUMED = (0.08, 0.1)  # share of the step in the tail, and its doubt, before looking
_RAMP = 0.002  # of the step, by which a side may change a sample
_COURSE = 0.3  # samples, doubt of the ends to begin with
_SETTLED_COURSE = 0.05  # after the coarse fit, beside its own error


@dataclass(frozen=True)
class SpreadFit:
    """Spread of an edge as a sum of functions, with what is needed for its errors."""

    basis: SpreadBasis
    coefficients: Vector  # of the functions
    inverse: Matrix  # of the normal equations' matrix
    prior: Matrix  # what the doubt of each assumption adds to their right side, one a row
    residual: Vector  # of each sample
    # by how many samples both ends of the edge were moved towards the brighter side: in opposite
    # directions, and alike
    turn: float
    bend: float
    turn_error: float
    gap: float  # largest distance near the edge between neighbouring samples

    @property
    def levels(self) -> tuple[float, float]:
        """Levels on both sides."""
        size = self.basis.spline.size
        tail = float(self.coefficients[size + TAIL])
        low, high = float(self.coefficients[0]), float(self.coefficients[size - 1])
        return low - tail / 2.0, high + tail / 2.0

    def at(self, distance: Vector) -> Vector:
        """The spread at distances, without ramps."""
        spline, nothing = self.basis.spline, np.zeros(len(distance))
        basis = spread_basis(spline=spline, distance=distance, away=nothing, slope=nothing)
        level = self.coefficients.copy()
        level[spline.size + TAIL + 1 :] = 0.0
        return basis.spread(level)


def largest_gap(*, distance: Vector, within: float = 3.0) -> float:
    """Largest distance between neighbours among the samples' distances near an edge."""
    near = np.sort(distance[np.abs(distance) <= within])
    near = np.concatenate([[-within], near, [within]])
    return float(np.max(np.diff(near)))


def fit_spread(
    *,
    samples: EdgeSamples,
    reach: float,
    half_length: float,
    coarse_turns: int = 1,
    fine_turns: int = 1,
) -> SpreadFit:
    """Fit the spread of an edge, and by how much its course is to be turned and bent.

    Gauss–Newton: the functions of the spread and what a turn and a bend would change are fitted
    together, so many times with a coarse spline and with the fine one. First the coarse one, since
    a fine one follows each row by itself where the edge crosses few columns, whatever its turn. The
    distance is not fitted: it cannot be told from the spread.
    """
    away = samples.along / half_length
    centre = float(samples.value.mean())
    value = samples.value - centre
    outer = np.abs(samples.distance) > reach / 2.0
    bright = samples.distance > 0.0
    step = float(value[outer & bright].mean() - value[outer & ~bright].mean())
    noise = float(value[outer & bright].std() + value[outer & ~bright].std()) / 2.0
    course, doubt, assumed = np.zeros(2), np.full(2, _COURSE), np.zeros(2)
    error = doubt
    distance = samples.distance
    slope = step * np.exp(-0.5 * (distance / _FIRST_SLOPE) ** 2) / (_FIRST_SLOPE * 2.5066)
    for turn in range(coarse_turns + fine_turns + 1):
        if turn == coarse_turns:
            assumed = course.copy()
            doubt = np.hypot(_SETTLED_COURSE, error)
        distance = samples.distance - course[0] * away - course[1] * away**2
        gap = largest_gap(distance=distance)
        finest = _COARSE if turn < coarse_turns else FINEST
        spline = graded_spline(half_width=_LEVEL_FROM * reach, spacing=max(finest, gap))
        basis = spread_basis(spline=spline, distance=distance, away=away, slope=slope)
        coefficients, inverse, prior = _solved(basis, value, step, noise, assumed - course, doubt)
        residual = value - basis.spread(coefficients)
        noise = float(np.sqrt(np.mean(residual**2)))
        places = spline.size + np.array([TURN, BEND])
        error = noise * np.sqrt(np.diag(inverse)[places])
        slope = line_spread(spline=spline, coefficients=coefficients, distance=distance)
        if turn < coarse_turns + fine_turns:
            course = course + coefficients[places]
    coefficients[: spline.size] += centre
    return SpreadFit(
        basis=basis,
        coefficients=coefficients,
        inverse=inverse,
        prior=prior,
        residual=residual,
        turn=float(course[0]),
        bend=float(course[1]),
        turn_error=float(error[0]),
        gap=gap,
    )


def _solved(
    basis: SpreadBasis, value: Vector, step: float, noise: float, course: Vector, doubt: Vector
) -> tuple[Vector, Matrix, Matrix]:
    """Coefficients, inverse normal matrix, and the doubts of what is assumed.

    What is assumed of tail, ramps and course is a measurement like others, in the noise's units.
    A thousand-millionth on third differences only settles what no sample determines.
    """
    size = basis.spline.size
    normal, right = basis.normal_matrix(), basis.onto(value)
    smooth = np.diff(np.eye(size), 3, axis=0)
    normal[:size, :size] += 1e-9 * len(value) / size * (smooth.T @ smooth)
    doubts = np.array([TAIL_ASSUMED[1] * step, _RAMP * step, _RAMP * step, *doubt])
    assumed = np.array([TAIL_ASSUMED[0] * step, 0.0, 0.0, *course])
    weights = max(noise, 1e-6 * abs(step)) ** 2 / doubts**2
    places = np.arange(size, size + OTHERS)
    normal[places, places] += weights
    right[places] += weights * assumed
    inverse = np.asarray(np.linalg.inv(normal), np.float64)
    prior = np.zeros((OTHERS, basis.size))
    prior[np.arange(OTHERS), places] = weights * doubts
    return inverse @ right, inverse, prior
