"""Motion of the line of sight during an exposure: smear, scan, vibration, random motion."""

import math
import sys
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Vector
from core.errors import ParameterError
from core.kernels import special
from core.physics.numerics import finite, gauss_legendre, non_negative, positive, sinc
from core.records import dataclass


def blur_mrad(*, velocity_m_per_s: float, time_s: float, range_m: float) -> float:
    """Angle the scene moves through during one exposure: 1000·v·t/range.

    The velocity is that of the platform less that of the image, of either sign, and gives the sign.

    Source: Tantalo 1996, eqs. 4.24-4.35. Erratum: the widths 134, 160 and 201 there are
    cycles/rad, not cycles/mrad: the blur is 1000 times what they give.
    """
    velocity = finite("velocity_m_per_s", velocity_m_per_s, unit="m/s")
    path_m = velocity * non_negative("time_s", time_s, unit="s")
    blur = 1000.0 * path_m / positive("range_m", range_m, unit="m")
    if not math.isfinite(blur):
        raise ParameterError("motion blur", blur, "a finite angle", unit="mrad")
    return blur


def scan_blur_mrad(*, scan_velocity_mrad_per_s: float, dwell_time_s: float) -> float:
    """Angle a scan moves through in one dwell time (Tantalo 1996, section 4.4.1 and eq. 4.26)."""
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    blur = velocity * non_negative("dwell_time_s", dwell_time_s, unit="s")
    return finite("scan blur", blur, unit="mrad")


def motion_mtf(*, frequency: ArrayLike, blur_mrad: float) -> NDArray[np.float64]:
    """MTF of a uniform smear along one axis, signed.

    Parameters
    ----------
    frequency : array_like
        Frequencies along this axis in cycles/mrad, any shape, finite.
    blur_mrad : float
        Length of the smear in mrad, of either sign.

    Returns
    -------
    ndarray of float64
        sinc(blur·frequency); exactly 1 everywhere for no blur.

    Source: Tantalo 1996, eqs. 4.26 and 4.31; in x and y the published form is the product.
    """
    width = finite("blur_mrad", blur_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        return sinc(width * np.asarray(frequency, dtype=np.float64))


def line_motion_mtf(
    *, xi: ArrayLike, eta: ArrayLike, blur_x_mrad: float, blur_y_mrad: float
) -> NDArray[np.float64]:
    """MTF of a smear along a straight line in any direction, signed.

    Parameters
    ----------
    xi, eta : array_like
        Frequencies in x and y in cycles/mrad, finite, of shapes that broadcast.
    blur_x_mrad, blur_y_mrad : float
        Components of the smear in mrad, of either sign.

    Returns
    -------
    ndarray of float64
        sinc(bx·xi + by·eta), of the common shape; it does not separate.

    Source: Fourier transform of a line of uniform weight. Erratum: Tantalo 1996, eq. 4.31, has the
    product of two sincs, which is a blur over a whole rectangle.
    """
    width_x = finite("blur_x_mrad", blur_x_mrad, unit="mrad")
    width_y = finite("blur_y_mrad", blur_y_mrad, unit="mrad")
    largest = 1e300  # two such opposite terms still add up to a number
    with np.errstate(over="ignore"):
        along_x = np.clip(width_x * np.asarray(xi, dtype=np.float64), -largest, largest)
        along_y = np.clip(width_y * np.asarray(eta, dtype=np.float64), -largest, largest)
    return sinc(along_x + along_y)


# Mixed sampling of a line scanner: equal angles along the scan, equal ground steps in flight.
#
# Over flat ground the scan lines are as far apart on the ground at every view angle, but the
# farther the ground, the smaller the angle between them. Each column of the frame, seen at one view
# angle, so has a sampling interval of its own in flight, and one transfer function acts on it at
# frequencies of its own.
#
# Source: Tantalo 1996, section 2 and figure 2.3a, which treats the whole frame at one scale and
# leaves the comparison to later work.


def view_angles_rad(*, columns: int, interval_mrad: float, look_angle_rad: float = 0.0) -> Vector:
    """Angle from nadir of each sample of a scan line, whose middle is at the look angle.

    Refused where the scan reaches the horizon.
    """
    step = positive("interval_mrad", interval_mrad, unit="mrad") / 1000.0
    if (columns - 1) * step >= math.pi:
        raise ParameterError(
            "interval_mrad", interval_mrad, f"below {1000 * math.pi / (columns - 1):g}", unit="mrad"
        )
    aside = 0.5 * (columns - 1) * step
    if not abs(look_angle_rad) + aside < 0.5 * math.pi:
        raise ParameterError(
            "look_angle_rad", look_angle_rad, f"within ±{0.5 * math.pi - aside:g}", unit="rad"
        )
    return np.asarray(look_angle_rad + (np.arange(columns) - 0.5 * (columns - 1)) * step)


def line_intervals_mrad(
    *, line_spacing_m: float, altitude_m: float, view_angle_rad: ArrayLike
) -> Vector:
    """Angle between neighbouring scan lines as seen from the sensor, over flat ground.

    1000·spacing/range of the view angles' shape; the range is altitude/cos(view angle).
    """
    spacing = positive("line_spacing_m", line_spacing_m, unit="m")
    altitude = positive("altitude_m", altitude_m, unit="m")
    angle = np.asarray(view_angle_rad, np.float64)
    farthest = float(np.max(np.abs(angle), initial=0.0))
    if not farthest < 0.5 * math.pi:
        raise ParameterError("view_angle_rad", farthest, "within ±π/2", unit="rad")
    return np.asarray(1000.0 * spacing / altitude * np.cos(angle))


def scale_nodes_mrad(*, intervals_mrad: ArrayLike, count: int) -> Vector:
    """Intervals for which whole frames are filtered, so that `scale_weights` can blend them.

    `count` Chebyshev nodes between the smallest and largest of the scales 1/interval.
    """
    scales = 1.0 / np.asarray(intervals_mrad, np.float64)
    middle, reach = 0.5 * (scales.max() + scales.min()), 0.5 * (scales.max() - scales.min())
    nodes = middle + reach * np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return np.asarray(1.0 / nodes)


def scale_weights(*, nodes_mrad: ArrayLike, intervals_mrad: ArrayLike) -> Vector:
    """Weights of whole frames, each filtered at one node's interval, in each column.

    Lagrange's polynomials in the scale 1/interval, shape (nodes, columns); each column adds to 1.

    Source: Trefethen 2013, Approximation Theory and Approximation Practice, chapters 5 and 8: for
    a transfer function smooth in frequency the error falls geometrically with the nodes.
    """
    nodes, scales = (1.0 / np.asarray(one, np.float64) for one in (nodes_mrad, intervals_mrad))
    weights = np.ones((nodes.size, scales.size))
    for index, node in enumerate(nodes):
        for other in np.delete(nodes, index):
            weights[index] *= (scales - other) / (node - other)
    return weights


# Sinusoidal vibration of the line of sight during one exposure.

# Up to this much phase swept along the remainder one Gauss rule is exact to rounding; beyond,
# the paths of steepest descent are.
_SWEPT_RAD = 32.0
_GAUSS_NODES = 64
_BLOCK = 256
# The J0 of a larger argument is below rounding, and its phase is unknown in float64.
_LARGEST_ARGUMENT = 1e32


def vibration_mtf(
    *,
    frequency: ArrayLike,
    amplitude_mrad: float,
    vibration_frequency_Hz: float | None = None,
    integration_time_s: float | None = None,
) -> NDArray[np.float64]:
    """MTF of a sinusoidal vibration along one axis.

    Parameters
    ----------
    frequency : array_like
        Frequencies along this axis in cycles/mrad, any shape, finite.
    amplitude_mrad : float
        Amplitude A of the motion A·sin(2πft) in mrad, zero or above.
    vibration_frequency_Hz, integration_time_s : float, optional
        Frequency f and exposure t, zero or above. Empty or 0: many periods in one exposure.

    Returns
    -------
    ndarray of float64
        For whole (or many) periods the signed J0(2πA·frequency). With a part of a period left
        over, the modulus of `vibration_otf`, whose phase is then neither 0 nor π.

    Source: N. S. Kopeika, A System Engineering Approach to Imaging (SPIE, 1998). With a remainder,
    a lobe in which J0 is negative comes out positive; `vibration_otf` keeps its phase.
    """
    otf = vibration_otf(
        frequency=frequency,
        amplitude_mrad=amplitude_mrad,
        vibration_frequency_Hz=vibration_frequency_Hz,
        integration_time_s=integration_time_s,
    )
    periods = _periods(vibration_frequency_Hz, integration_time_s)
    # The modulus may exceed 1 by a rounding error of the quadrature.
    modulus = otf.real if periods is None else np.minimum(np.abs(otf), 1.0)
    return np.asarray(modulus, dtype=np.float64)


def vibration_otf(
    *,
    frequency: ArrayLike,
    amplitude_mrad: float,
    vibration_frequency_Hz: float | None = None,
    integration_time_s: float | None = None,
) -> NDArray[np.complex128]:
    """Transfer function of a sinusoidal vibration that starts at phase 0 with the exposure.

    The mean of exp(−2πi·A·frequency·sin(2πf·t')) over the exposure; real for whole periods.
    Source: time average of a displaced image. n whole periods give J0, the remainder its own
    integral, each weighted by its time.
    """
    amplitude = non_negative("amplitude_mrad", amplitude_mrad, unit="mrad")
    periods = _periods(vibration_frequency_Hz, integration_time_s)
    with np.errstate(over="ignore"):
        argument = 2.0 * math.pi * (amplitude * np.asarray(frequency, dtype=np.float64))
    argument = np.clip(argument, -_LARGEST_ARGUMENT, _LARGEST_ARGUMENT)
    whole = np.asarray(special("j0")(argument), dtype=np.complex128)
    if periods is None:
        return whole
    count = math.floor(periods)
    share = (periods - count) / periods
    size = np.abs(argument)
    part = _partial_mean(size.ravel(), 2.0 * math.pi * (periods - count)).reshape(size.shape)
    part = np.where(argument < 0.0, part.conj(), part)
    otf = (1.0 - share) * whole + share * part if count else part
    return np.asarray(np.where(argument == 0.0, 1.0, otf), dtype=np.complex128)


def _periods(
    vibration_frequency_Hz: float | None, integration_time_s: float | None
) -> float | None:
    """Periods in one exposure, or None when they are whole (to rounding) or many."""
    rate = non_negative("vibration_frequency_Hz", vibration_frequency_Hz or 0.0, unit="Hz")
    time = non_negative("integration_time_s", integration_time_s or 0.0, unit="s")
    periods = rate * time
    if not math.isfinite(periods):
        raise ParameterError("vibration periods in one exposure", periods, "a finite number")
    rounding = 4.0 * sys.float_info.epsilon * periods
    nearest = round(periods)
    if periods == 0.0 or (nearest >= 1 and abs(periods - nearest) <= rounding):
        return None
    return periods


def _partial_mean(size: NDArray[np.float64], end: float) -> NDArray[np.complex128]:
    """Mean of exp(−i·size·sin θ) over θ from 0 to `end`, less than a whole turn."""
    swept = size * _swept(end)
    gentle = swept <= _SWEPT_RAD
    mean = np.empty(size.shape, dtype=np.complex128)
    mean[gentle] = _gauss_mean(size[gentle], end)
    steep = np.flatnonzero(~gentle)
    for start in range(0, steep.size, _BLOCK):
        block = steep[start : start + _BLOCK]
        mean[block] = _descent_integral(size[block], end) / end
    return mean


def _swept(end: float) -> float:
    """Total variation of the sine from 0 to `end`."""
    if end <= 0.5 * math.pi:
        return math.sin(end)
    return 2.0 - math.sin(end) if end <= 1.5 * math.pi else 4.0 + math.sin(end)


def _gauss_mean(size: NDArray[np.float64], end: float) -> NDArray[np.complex128]:
    nodes, weights = gauss_legendre(_GAUSS_NODES)
    sines = np.sin(0.5 * end * (1.0 + nodes))
    phase = np.multiply.outer(size, sines)
    half = 0.5 * weights
    return np.asarray(np.cos(phase) @ half - 1j * (np.sin(phase) @ half), dtype=np.complex128)


def _descent_integral(size: NDArray[np.float64], end: float) -> NDArray[np.complex128]:
    """Integral of exp(−i·size·sin θ) from 0 to `end`, for many oscillations.

    On each monotone stretch of the sine the contour is turned down from both ends, where the
    integrand decays without oscillating: the cost does not grow with `size`.
    """
    total = _descent(size, 0.0, 1.0)
    forward = 1.0
    if end > 0.5 * math.pi:
        total -= 2.0 * _descent(size, 1.0, 0.0)
        forward = -1.0
    if end > 1.5 * math.pi:
        total += 2.0 * _descent(size, -1.0, 0.0)
        forward = 1.0
    return total - forward * _descent(size, math.sin(end), abs(math.cos(end)))


def _descent(size: NDArray[np.float64], sine: float, cosine: float) -> NDArray[np.complex128]:
    """Integral of exp(−i·size·w)/√(1 − w²) dw from w = `sine` straight down to −i∞.

    With w = sine − i·q/size the integrand is e^{−q} times an algebraic function, whose branch
    points lie on the imaginary axis of q: the trapezoidal rule in ln q converges exponentially,
    alike for every distance of `sine` from ±1.
    """
    step = 0.25
    q = np.exp(np.arange(-76.0, 3.75, step))
    depth = np.divide.outer(1.0 / size, 1.0 / q)
    root = np.sqrt(cosine**2 + depth * (depth + 2j * sine))
    integral = np.sum(np.exp(-q) * depth / root, axis=-1) * step
    return np.asarray(-1j * np.exp(-1j * size * sine) * integral, dtype=np.complex128)


# Random motion of the line of sight by its spectrum: what blurs an exposure, what moves frames.
#
# Of an exposure of length T the centroid is the mean of the motion, whose spectrum is S·sinc²(fT).
# What is left, motion about the centroid, blurs. At time t from the exposure's middle its variance
# is v(t) = ∫ S(f)·[1 + sinc²(fT) − 2·sinc(fT)·cos(2πft)] df, and the expected transfer function, of
# a normal motion, is the mean over the exposure of exp(−2π²·v(t)·ξ²): exact, where exp(−2π²·v̄·ξ²),
# the Gaussian of jitter, only begins alike.
#
# Sources: Papoulis 1991, Probability, Random Variables, and Stochastic Processes, chapter 10;
# Kopeika 1998, A System Engineering Approach to Imaging, chapter 14.

_REACH = 1e6  # corners below and above which the law's spectrum ends: a share of 6e-7 each
WAVES = 4096
"""Waves of a motion: 100 to an octave of the law, over 40 octaves."""
_PANEL_NODES = 8
_TIMES = 24  # of half an exposure
_FAST = 64.0  # periods in an exposure beyond which its centroid is nothing


@dataclass(frozen=True)
class MotionSpectrum:
    """One-sided power density of an angle, by a law or by points.

    The law is S = rms²·(2/π)/(corner·(1 + (f/corner)²)), a first-order Gauss–Markov motion. Points
    (Hz, mrad²/Hz) take its place: a power of the frequency between two of them, nothing beyond.
    """

    rms_mrad: float = 0.0
    corner_Hz: float = 1.0
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        non_negative("rms", self.rms_mrad, unit="mrad")
        positive("corner_Hz", self.corner_Hz, unit="Hz")
        for place, value in self.points:
            positive("frequency of the power spectral density", place, unit="Hz")
            positive("power spectral density", value, unit="mrad²/Hz")

    @property
    def still(self) -> bool:
        """Whether there is no motion."""
        return not self.points and self.rms_mrad == 0.0

    @property
    def ends_Hz(self) -> tuple[float, float]:  # noqa: N802
        """First and last frequency."""
        if self.points:
            return self.points[0][0], self.points[-1][0]
        return self.corner_Hz / _REACH, self.corner_Hz * _REACH

    def density(self, frequency: ArrayLike) -> Vector:
        """Power density at frequencies between the ends, mrad²/Hz."""
        place = np.asarray(frequency, np.float64)
        if not self.points:
            ratio = place / self.corner_Hz
            return np.asarray(self.rms_mrad**2 * 2.0 / np.pi / self.corner_Hz / (1.0 + ratio**2))
        known = np.log(np.array(self.points))
        return np.asarray(np.exp(np.interp(np.log(place), known[:, 0], known[:, 1])))

    def bounds(self, exposure_s: float) -> Vector:
        """Ends of panels in which density, and the kernel of an exposure, are smooth."""
        low, high = self.ends_Hz
        octaves = math.log2(high / low)
        edges = low * 2.0 ** np.linspace(0.0, octaves, max(2, math.ceil(4 * octaves) + 1))
        parts = [edges, np.array([place for place, _ in self.points])]
        if exposure_s > 0.0:
            turning = np.arange(0.25, _FAST + 0.25, 0.25) / exposure_s
            parts.append(turning[(turning > low) & (turning < high)])
        return np.unique(np.concatenate(parts))


@lru_cache(maxsize=64)
def _quadrature(spectrum: MotionSpectrum, exposure_s: float) -> tuple[Vector, Vector]:
    """Frequencies, and the variance that belongs to each."""
    bounds = spectrum.bounds(exposure_s)
    nodes, weights = gauss_legendre(_PANEL_NODES)
    half = 0.5 * np.diff(bounds)[:, np.newaxis]
    places = (bounds[:-1, np.newaxis] + half * (1.0 + nodes)).ravel()
    return places, (half * weights).ravel() * spectrum.density(places)


@lru_cache(maxsize=256)
def within_exposure(
    *, spectrum: MotionSpectrum, exposure_s: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Variance about the centroid through an exposure, at Gauss–Legendre points of it, and weights.

    The variances are in mrad², the weights add to 1.
    """
    exposure = non_negative("integration_time_s", exposure_s, unit="s")
    nodes, weights = gauss_legendre(_TIMES)
    places, power = _quadrature(spectrum, exposure)
    turns = places * exposure
    fast = turns > _FAST  # the centroid knows nothing of it
    variances = np.full(_TIMES, power[fast].sum())
    places, power, turns = places[~fast], power[~fast], turns[~fast]
    mean = np.sinc(turns)
    times = 0.25 * exposure * (1.0 + nodes)  # of its second half: the first mirrors it
    for index, time in enumerate(times):
        # (1 − sinc)² + 2·sinc·(1 − cos): no digits are lost where both are next to 1.
        sine = np.sin(np.pi * places * time)
        kernel = (1.0 - mean) ** 2 + 4.0 * mean * sine**2
        variances[index] += float(np.sum(power * kernel))
    return tuple(map(float, np.maximum(variances, 0.0))), tuple(map(float, 0.5 * weights))


def between_exposures_mrad(*, spectrum: MotionSpectrum, exposure_s: float) -> float:
    """Standard deviation of the centroid of an exposure: the root of ∫ S·sinc²(fT) df."""
    exposure = non_negative("integration_time_s", exposure_s, unit="s")
    places, power = _quadrature(spectrum, exposure)
    return math.sqrt(float(np.sum(power * np.sinc(places * exposure) ** 2)))


def exposure_mtf(
    *, frequency: ArrayLike, variances: tuple[float, ...], weights: tuple[float, ...]
) -> Vector:
    """MTF of motion about the centroid of an exposure: mean of exp(−2π²·v·frequency²).

    Variances and weights are those of `within_exposure`.
    """
    place = np.asarray(frequency, np.float64)
    square = -2.0 * np.pi**2 * place**2
    total = np.zeros_like(place)
    for variance, weight in zip(variances, weights, strict=True):
        total += weight * np.exp(square * variance)
    return np.asarray(total / math.fsum(weights))


def motion_waves(
    *, spectrum: MotionSpectrum, exposure_s: float, uniform: Any
) -> Callable[[float], float]:
    """Draw a motion, as its centroids over exposures, by uniform deviates of shape (3, n).

    What it gives is the centroid in mrad of the exposure about a time in s.

    Best n is `WAVES`. A wave in each of n parts of the spectrum of equal ratio has a frequency
    within its part, an amplitude of Rayleigh's distribution and a phase. Over all draws the
    spectrum of the centroids is S·sinc²(fT).
    """
    place, level, phase = np.asarray(uniform, np.float64)
    exposure = non_negative("integration_time_s", exposure_s, unit="s")
    low, high = spectrum.ends_Hz
    span = math.log(high / low)
    if span <= 0.0:
        raise ParameterError("spectrum", high, "two different frequencies", unit="Hz")
    frequency = low * np.exp(span * (np.arange(len(place)) + place) / len(place))
    # A draw that is uniform in the logarithm stands for S·f·span/n of the variance.
    variance = spectrum.density(frequency) * frequency * span / len(place)
    amplitude = np.sqrt(-2.0 * np.log1p(-level) * variance) * np.sinc(frequency * exposure)

    def centroid_mrad(time_s: float) -> float:
        turns = frequency * finite("time_s", time_s, unit="s") + phase
        turns -= np.floor(turns)
        return float(np.sum(amplitude * np.cos(2.0 * np.pi * turns)))

    return centroid_mrad
