"""MTF across an edge found in a picture, with its standard error."""

import math
from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Complex, Matrix, Vector
from core.errors import DataError
from core.physics.measurement.found_edge import EdgeSamples, FoundEdge, edge_samples
from core.physics.measurement.slanted_edge import falls_to
from core.physics.measurement.spread_fit import (
    TAIL,
    TAIL_ASSUMED,
    TAIL_WIDTH,
    SpreadFit,
    fit_spread,
    line_transform,
)
from core.records import dataclass

_GROUPS = 24  # pieces of the edge, whose differences enter the error
_ALIKE = 8  # neighbouring pieces, over which texture may hang together
_ALONE = 12.0  # samples of reach, with less of which a neighbour is near
_MODEL = 5e-4  # of the MTF, that the spline may not follow
_TEXTURE_BLOCK, _LEAST_BLOCKS = 3.0, 8  # samples; and blocks of a side
_TEXTURE_LENGTH = 4.0  # samples, over which texture hangs together
_NEAR = 0.05  # cycles per sample, over which their variances are averaged
_LARGEST_GAP = 0.75  # samples between distances, above which nothing is supersampled
_SLOPE_WIDTH = 0.03  # cycles per sample about a crossing, over which the MTF's slope is taken


@dataclass(frozen=True, eq=False)
class MtfCurve:
    """MTF across one edge, or that of one direction, pooled over edges."""

    angle_deg: float  # direction from the x axis that the frequencies are along
    frequency: Vector  # cycles per sample
    # modulus, 1 at zero, and its standard error
    mtf: Vector
    sigma: Vector
    # part of `sigma` that all edges of a picture share: what is assumed of the spread's tails
    shared_sigma: Vector
    # lowest frequency at which the MTF falls to one half, and its standard error; None where it
    # does not in `frequency`
    mtf50: float | None
    mtf50_sigma: float | None
    edges: int = 1  # how many lie within 30° of the direction
    # root of the mean square of all edges' departures over their errors, by which `sigma` is
    # widened; 1 where they agree within these, and for one edge
    scatter: float = 1.0


def measure_edge(
    *,
    picture: NDArray[np.floating],
    edge: FoundEdge,
    frequency: Vector,
    check: Callable[[], None] = lambda: None,
) -> MtfCurve:
    """Measure the MTF across an edge of any direction.

    Parameters
    ----------
    frequency : ndarray
        Cycles per sample along the edge's normal, ascending from 0.

    Raises
    ------
    DataError
        If the samples' distances from the edge repeat, so that it cannot be supersampled.

    Notes
    -----
    As in ISO 12233:2023, samples are taken by their distance from the edge. In place of means of
    bins, a central difference and a window, whose responses would have to be divided out, a
    spline is laid through the samples by least squares (`graded_breaks`), and its derivative
    transformed exactly.
    """
    check()
    frequency = np.asarray(frequency, np.float64)
    samples = edge_samples(picture=picture, edge=edge)
    fit = fit_spread(samples=samples, reach=edge.reach, half_length=edge.length / 2.0)
    if fit.gap > _LARGEST_GAP:
        raise DataError(
            f"the edge at x = {edge.x:.1f}, y = {edge.y:.1f} cannot be supersampled: at "
            f"{edge.angle_deg:.1f}°, the supersampled profile has gaps of {fit.gap:.2g} "
            f"samples; allowed: at most {_LARGEST_GAP:g}"
        )
    check()
    transform = line_transform(breaks=fit.breaks, frequency=np.append(0.0, frequency))
    mtf, sigma, shared = _modulus(samples, fit, transform, edge, frequency)
    half = _half(frequency, mtf, sigma)
    return MtfCurve(edge.angle_deg, frequency, mtf, sigma, shared, *half)


def _modulus(
    samples: EdgeSamples, fit: SpreadFit, transform: Complex, edge: FoundEdge, frequency: Vector
) -> tuple[Vector, Vector, Vector]:
    """Modulus, 1 at zero, standard error, and the part of it from what is assumed of the tail.

    Noise square to the transform H lengthens it: |H + i·n| is longer than |H| by n²/(2|H|), which
    is taken off. What cannot be is an error: n²/(2|H|), at most n, for an |H| that is three errors
    less than what was measured.
    """
    whole = transform @ fit.coefficients
    step, whole = whole[0].real, whole[1:] / whole[0]
    length = np.abs(whole)
    phase = np.where(length > 0.0, np.conj(whole) / np.maximum(length, 1e-300), 1.0)
    # What a unit of each normal equation's right side does to the aligned transform.
    effect = (transform[1:] - transform[:1] * whole[:, np.newaxis]) @ fit.inverse
    effect = effect * (phase / step)[:, np.newaxis]
    along = _variance(effect.real, samples, fit, edge, frequency)
    across = _variance(effect.imag, samples, fit, edge, frequency)
    modulus = np.sqrt(np.maximum(length**2 - across, 0.0))
    least = np.maximum(modulus - 3.0 * np.sqrt(along), 0.0)
    longer = np.minimum(across, (across / np.maximum(2.0 * least, 1e-150)) ** 2)
    blurred = modulus * 2.0 * (np.pi * frequency * fit.turn_error) ** 2 / 3.0
    textured = _texture(samples, fit, edge) * _texture_response(frequency, edge) / step**2
    beside = modulus * _lost_to_neighbours(frequency, edge.reach)
    others = longer + blurred**2 + textured + beside**2 + _MODEL**2
    shared = np.hypot(effect.real @ fit.prior[TAIL], beside)
    return modulus, np.asarray(np.sqrt(along + others), np.float64), shared


def _lost_to_neighbours(frequency: Vector, reach: float) -> Vector:
    """Share by which tails of neighbouring edges may make the MTF too large.

    The tail that an edge has beyond its reach lies within that of its neighbours: the step is too
    small by as much, and what the MTF is divided by. Long waves do not show it: a tail as wide as
    the reach is in them as in the step. All edges of a picture share it.
    """
    beyond = 1.0 - 2.0 / np.pi * math.atan(reach / TAIL_WIDTH)
    seen = 1.0 - np.exp(-2.0 * np.pi * reach * frequency)
    return np.asarray(sum(TAIL_ASSUMED) * beyond * seen, np.float64) * (reach < _ALONE)


def _variance(
    effect: Matrix, samples: EdgeSamples, fit: SpreadFit, edge: FoundEdge, frequency: Vector
) -> Vector:
    """Variance of sums of the normal equations' right sides.

    Of samples that are independent, it follows from their residuals (White, 1980). Where the
    noise or texture hangs together, pieces of the edge differ by more, and neighbours alike (Newey
    and West, 1987); their few differences are averaged over neighbouring frequencies before they
    are believed.
    """
    scores = fit.basis * fit.residual[:, np.newaxis]
    alone = np.sum((effect @ (scores.T @ scores)) * effect, axis=1)
    place = samples.along / edge.length + 0.5
    group = np.clip((place * _GROUPS).astype(np.intp), 0, _GROUPS - 1)
    apart = np.abs(np.subtract.outer(np.arange(_GROUPS), np.arange(_GROUPS)))
    together = np.maximum(0.0, 1.0 - apart / _ALIKE)
    moved = effect @ ((group == np.arange(_GROUPS)[:, np.newaxis]) @ scores).T
    pieces = np.sum((moved @ together) * moved, axis=1) * _GROUPS / (_GROUPS - _ALIKE / 2.0)
    near = np.exp(-0.5 * (np.subtract.outer(frequency, frequency) / _NEAR) ** 2)
    excess = (near @ pieces) / np.maximum(near @ alone, 1e-300)
    degrees = len(fit.residual) / max(1.0, len(fit.residual) - len(fit.coefficients))
    assumed = np.sum((effect @ fit.prior.T) ** 2, axis=1)
    return np.asarray(alone * degrees * np.maximum(1.0, excess) + assumed, np.float64)


def _texture(samples: EdgeSamples, fit: SpreadFit, edge: FoundEdge) -> float:
    """Variance of the texture of both sides: what blocks of samples differ by beyond the noise."""
    place = np.floor((samples.along + edge.length / 2.0) / _TEXTURE_BLOCK).astype(np.intp)
    across = np.floor((samples.distance + edge.reach) / _TEXTURE_BLOCK).astype(np.intp)
    block = place * (int(across.max()) + 1) + across
    total = 0.0
    for side in (samples.distance < -_TEXTURE_BLOCK, samples.distance > _TEXTURE_BLOCK):
        residual, number = fit.residual[side], block[side]
        count = np.bincount(number)
        sums = np.bincount(number, residual)[count > 0]
        count = count[count > 0]
        if len(count) < _LEAST_BLOCKS:
            continue
        noise = float(np.mean(residual**2))
        ratio = float(np.mean(sums**2 / count)) / max(noise, 1e-300)
        excess = ratio - 1.0 - 2.0 * math.sqrt(2.0 / len(count))
        total += max(0.0, excess) * noise / float(np.mean(count))
    return total


def _texture_response(frequency: Vector, edge: FoundEdge) -> Vector:
    """Variance that texture of unit variance on one side brings to the transform.

    A spread with texture t(d), its mean along the edge, adds 2πi·f·∫ t(d) exp(−2πi·f·d) dd. Texture
    that hangs together over ℓ samples has the variance ℓ/length after that mean, and the integral
    over the reach one of reach·ℓ for waves longer than ℓ.
    """
    wave = 2.0 * np.pi * frequency
    seen = _TEXTURE_LENGTH**2 / edge.length * edge.reach
    return np.asarray(wave**2 * seen / (1.0 + (wave * _TEXTURE_LENGTH / 2.0) ** 2), np.float64)


def _half(frequency: Vector, mtf: Vector, sigma: Vector) -> tuple[float | None, float | None]:
    half = falls_to(frequency=frequency, mtf=mtf, level=0.5)
    if half is None:
        return None, None
    return half, crossing_error(frequency=frequency, mtf=mtf, sigma=sigma, crossing=half)


def crossing_error(
    *, frequency: Vector, mtf: Vector, sigma: Vector, crossing: float
) -> float | None:
    """Standard error of the frequency at which an MTF falls to a level.

    Notes
    -----
    The error of the MTF over its slope. Noise turns the slope between two points, and a curve is
    more likely to cross where noise makes it steep: the slope is that of a straight line through
    all points near the crossing, weighted by their errors and by a Gaussian of their distance.
    """
    away = frequency - crossing
    weight = np.exp(-0.5 * (away / _SLOPE_WIDTH) ** 2) / np.maximum(sigma, _MODEL) ** 2
    away = away - np.sum(weight * away) / np.sum(weight)
    slope = float(np.sum(weight * away * mtf) / np.sum(weight * away**2))
    if not slope < 0.0:
        return None
    return float(np.interp(crossing, frequency, sigma) / -slope)


# MTF across and down a picture, pooled over its edges.

Axis = Literal["x", "y"]

LARGEST_ANGLE_DEG = 30.0
_ACROSS, _ASLANT = 0.3, 0.15  # of 1 − MTF, by which x and y, and both diagonals, may differ
_LAW = 0.15  # of 1 − MTF, by which an edge across the axis may depart from the law of directions
_LEAST_VARIANCE = 1e-12


def pooled_mtf(*, edges: Sequence[MtfCurve], axis: Axis) -> MtfCurve | None:
    """Pool the MTFs of a picture's edges to that along an axis; None if no edge lies near it.

    Parameters
    ----------
    edges : sequence of MtfCurve
        Measured edges of any direction, all at the same frequencies.
    axis : {'x', 'y'}
        Across the picture, or down it; the normal of at least one edge must lie within 30° of it.

    At a frequency f along a normal at an angle φ to the axis, the MTF is taken as
    M + A·sin²φ + B·sin φ·cos φ, which is what blurs, motion and pixels do to second order in f: a
    round blur has A = B = 0, and an edge off the axis is then as good as one on it. A is assumed to
    be about 0.3·(1 − M), or as large as edges of other directions show, B about 0.15·(1 − M): x and
    y differ by pixels, readout and scan, both diagonals by motion and astigmatism alone (0.11 of
    what is lost, rms, by motion of 0.3 to 1.6 samples in any direction). They follow from the edges
    where these have several directions; the law is trusted to 0.15·(1 − M)·sin²φ. What all edges
    share (what is assumed of their tails) is not made smaller by their number. Where the edges
    differ by more than their errors, a common variance is added to all (DerSimonian and Laird,
    Meta-analysis in clinical trials, 1986); A and B take fewer degrees of freedom than two from the
    edges, as far as they are assumed.
    """
    angles = np.array([math.radians(off_axis_deg(edge.angle_deg, axis)) for edge in edges])
    near = np.abs(angles) <= math.radians(LARGEST_ANGLE_DEG)
    if not near.any():
        return None
    mtf = np.array([edge.mtf for edge in edges])
    shared = np.array([edge.shared_sigma for edge in edges])
    own = np.maximum(np.array([edge.sigma for edge in edges]) ** 2 - shared**2, _LEAST_VARIANCE)
    design = np.stack([np.ones(len(angles)), np.sin(angles) ** 2, np.sin(2 * angles) / 2], axis=1)
    here = _mean(mtf[near], own[near])
    there = here if near.all() else _mean(mtf[~near], own[~near])
    lost = np.maximum(1.0 - np.minimum(here, there), 1e-6)
    doubts = np.stack([np.hypot(_ACROSS * lost, there - here), _ASLANT * lost], axis=1)
    own = own + (_LAW * lost * design[:, 1:2]) ** 2
    value, variance, part, terms = _fitted(design, mtf, own, doubts)
    chi2 = np.sum((mtf - part) ** 2 / own, axis=0)
    degrees = len(edges) - terms
    common, scatter = np.zeros(len(chi2)), 1.0
    if len(edges) > design.shape[1]:
        spare = np.sum(1.0 / own, axis=0) * degrees / len(edges)
        common = np.maximum(chi2 - degrees, 0.0) / spare
        value, variance, _, _ = _fitted(design, mtf, own + common, doubts)
        scatter = math.sqrt(float(np.mean((chi2 / degrees)[1:])))
    share = np.sum(shared / (own + common), axis=0) / np.sum(1.0 / (own + common), axis=0)
    frequency, sigma = edges[0].frequency, np.sqrt(variance + share**2)
    half = _half(frequency, value, sigma)
    angle = 0.0 if axis == "x" else 90.0
    return MtfCurve(
        angle, frequency, value, sigma, share, *half, int(near.sum()), max(1.0, scatter)
    )


def _mean(values: Matrix, variance: Matrix) -> Vector:
    weight = 1.0 / variance
    return np.asarray(np.sum(weight * values, axis=0) / np.sum(weight, axis=0), np.float64)


def off_axis_deg(angle_deg: float, axis: Axis = "x") -> float:
    """Angle between a line and an axis, from −90 to 90."""
    angle = angle_deg - (0.0 if axis == "x" else 90.0)
    return (angle + 90.0) % 180.0 - 90.0


def _fitted(
    design: Matrix, mtf: Matrix, variance: Matrix, doubts: Matrix
) -> tuple[Vector, Vector, Matrix, Vector]:
    """Value on the axis, its variance, the fit at the edges, and how many terms these determine."""
    weighted = design.T[:, :, np.newaxis] / variance  # terms, edges, frequencies
    normal = np.einsum("aef,eb->fab", weighted, design)
    alone = normal.copy()
    normal[:, [1, 2], [1, 2]] += 1.0 / doubts**2
    right = np.einsum("aef,ef->fa", weighted, mtf)
    inverse = np.linalg.inv(normal)
    terms = np.einsum("fab,fb->fa", inverse, right)
    determined = np.einsum("fab,fba->f", inverse, alone)
    return terms[:, 0], inverse[:, 0, 0], design @ terms.T, determined
