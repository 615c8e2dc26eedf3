"""Least squares fit of an edge's spread and course to the samples about it."""

import numpy as np

from core.arrays import Complex, Index, Matrix, Vector
from core.physics.measurement.found_edge import EdgeSamples
from core.physics.numerics import gauss_legendre
from core.records import dataclass

_QUADRATURE = 6  # points an interval: exact to 1e-9 for two radians
_FINE = 2.5  # samples from the middle to where intervals begin to widen

# Basis of cubic splines on intervals between breaks, at least four; level outside with no corner.
#
# Source: de Boor, A Practical Guide to Splines, 2001, ch. IX and X. The first two and the last
# two B-splines are joined, which makes the slope zero at both ends: as many functions as breaks.


def graded_breaks(*, half_width: float, spacing: float) -> Vector:
    """Breaks from −`half_width` to `half_width`, `spacing` samples apart at the middle.

    Farther out they grow as the distance: what lies there, a blur's tails, changes slowly. Fine
    intervals would bring noise of high frequencies from there and nothing else.
    """
    place, places = 0.0, [0.0]
    while place < half_width:
        place += spacing * max(1.0, place / _FINE)
        places.append(place)
    outer = np.array(places) * (half_width / places[-1])
    return np.concatenate([-outer[:0:-1], outer])


def _b_splines(breaks: Vector, distance: Vector, degree: int) -> tuple[Matrix, Index]:
    """Values of the B-splines that are not zero, (degree + 1, distances), and the first of each."""
    knots = np.pad(breaks, 3, mode="edge")
    distance = np.clip(distance, breaks[0], breaks[-1])
    interval = np.minimum(np.searchsorted(breaks, distance, side="right"), len(breaks) - 1) - 1
    first = interval + 3
    values = np.ones((degree + 1, len(distance)))
    for order in range(1, degree + 1):
        carried = np.zeros(len(distance))
        for k in range(order):
            right, left = knots[first + k + 1], knots[first + k + 1 - order]
            share = values[k] / (right - left)
            values[k] = carried + (right - distance) * share
            carried = (distance - left) * share
        values[order] = carried
    return values, interval


def _slopes(breaks: Vector) -> Matrix:
    """Derivatives of the basis in B-splines of the second degree, shape (breaks + 1, breaks)."""
    size = len(breaks)
    joined = np.eye(size)[np.clip(np.arange(size + 2) - 1, 0, size - 1)]
    width = np.pad(breaks[1:], (0, 2), mode="edge") - np.pad(breaks[:-1], (2, 0), mode="edge")
    return np.diff(joined, axis=0) * (3.0 / width)[:, np.newaxis]


# Functions of which the spread of an edge is made: a spline, a tail, and ramps on both sides.
#
# Beyond an edge's reach the spread of diffraction still falls as 1/distance, for its line spread
# as 1/distance². The tail is the integral of a Lorentzian, which does the same.

TAIL_WIDTH = 2.0  # samples
TAIL, LOW_RAMP, HIGH_RAMP, TURN, BEND = range(5)  # places of the others, after the spline's
OTHERS = 5


def spread_basis(*, breaks: Vector, distance: Vector, away: Vector, slope: Vector) -> Matrix:
    """The functions at samples, `distance` from the edge and `away` along it, from −1 to 1.

    `slope` is the line spread there, as far as it is known: it is what a turn and a bend change.
    Of shape (samples, functions), the spline's first.
    """
    values, first = _b_splines(breaks, distance, 3)
    basis = np.zeros((len(distance), len(breaks) + OTHERS))
    for k, value in enumerate(values, -1):
        basis[np.arange(len(distance)), np.clip(first + k, 0, len(breaks) - 1)] += value
    others = basis[:, -OTHERS:].T
    others[TAIL] = np.arctan(distance / TAIL_WIDTH) / np.pi
    others[LOW_RAMP], others[HIGH_RAMP] = np.minimum(distance, 0.0), np.maximum(distance, 0.0)
    others[TURN], others[BEND] = -slope * away, -slope * away**2
    return basis


def line_spread(*, breaks: Vector, coefficients: Vector, distance: Vector) -> Vector:
    """Derivative of a spread, without ramps, at distances."""
    tail = TAIL_WIDTH / np.pi / (distance**2 + TAIL_WIDTH**2)
    steps = _slopes(breaks) @ coefficients[:-OTHERS]
    values, first = _b_splines(breaks, distance, 2)
    inner = sum(value * steps[first + k] for k, value in enumerate(values))
    return np.asarray(inner + coefficients[TAIL - OTHERS] * tail, np.float64)


def line_transform(*, breaks: Vector, frequency: Vector) -> Complex:
    """∫ B′(d) exp(−2πi·f·d) dd of each function, shape (frequencies, functions).

    Of ramps, turn and bend it is zero.
    """
    nodes, weights = gauss_legendre(_QUADRATURE)
    half = np.diff(breaks)[:, np.newaxis] / 2.0
    distance = (breaks[:-1, np.newaxis] + half * (1.0 + nodes)).ravel()
    values, first = _b_splines(breaks, distance, 2)
    steps = _slopes(breaks)
    slopes = sum(value[:, np.newaxis] * steps[first + k] for k, value in enumerate(values))
    others = np.zeros((len(frequency), OTHERS))
    others[:, TAIL] = np.exp(-2.0 * np.pi * TAIL_WIDTH * np.abs(frequency))
    waves = np.exp(-2j * np.pi * np.outer(frequency, distance)) * (half * weights).ravel()
    return np.concatenate([waves @ slopes, others], axis=1)


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

    breaks: Vector  # of the spline
    basis: Matrix  # the functions at the samples
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
        tail = float(self.coefficients[TAIL - OTHERS])
        low, high = float(self.coefficients[0]), float(self.coefficients[-OTHERS - 1])
        return low - tail / 2.0, high + tail / 2.0

    def at(self, distance: Vector) -> Vector:
        """The spread at distances, without ramps."""
        nothing = np.zeros(len(distance))
        basis = spread_basis(breaks=self.breaks, distance=distance, away=nothing, slope=nothing)
        level = self.coefficients.copy()
        level[TAIL - OTHERS + 1 :] = 0.0
        return np.asarray(basis @ level, np.float64)


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
        breaks = graded_breaks(half_width=_LEVEL_FROM * reach, spacing=max(finest, gap))
        basis = spread_basis(breaks=breaks, distance=distance, away=away, slope=slope)
        coefficients, inverse, prior = _solved(basis, value, step, noise, assumed - course, doubt)
        residual = value - basis @ coefficients
        noise = float(np.sqrt(np.mean(residual**2)))
        places = [TURN - OTHERS, BEND - OTHERS]
        error = noise * np.sqrt(np.diag(inverse)[places])
        slope = line_spread(breaks=breaks, coefficients=coefficients, distance=distance)
        if turn < coarse_turns + fine_turns:
            course = course + coefficients[places]
    coefficients[:-OTHERS] += centre
    return SpreadFit(
        breaks=breaks,
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
    basis: Matrix, value: Vector, step: float, noise: float, course: Vector, doubt: Vector
) -> tuple[Vector, Matrix, Matrix]:
    """Coefficients, inverse normal matrix, and the doubts of what is assumed.

    What is assumed of tail, ramps and course is a measurement like others, in the noise's units.
    A thousand-millionth on third differences only settles what no sample determines.
    """
    size = basis.shape[1] - OTHERS
    normal, right = basis.T @ basis, value @ basis
    smooth = np.diff(np.eye(size), 3, axis=0)
    normal[:size, :size] += 1e-9 * len(value) / size * (smooth.T @ smooth)
    doubts = np.array([TAIL_ASSUMED[1] * step, _RAMP * step, _RAMP * step, *doubt])
    assumed = np.array([TAIL_ASSUMED[0] * step, 0.0, 0.0, *course])
    weights = max(noise, 1e-6 * abs(step)) ** 2 / doubts**2
    places = np.arange(size, size + OTHERS)
    normal[places, places] += weights
    right[places] += weights * assumed
    inverse = np.asarray(np.linalg.inv(normal), np.float64)
    prior = np.zeros((OTHERS, size + OTHERS))
    prior[np.arange(OTHERS), places] = weights * doubts
    return inverse @ right, inverse, prior
