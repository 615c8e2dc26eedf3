"""1/f noise of independent samples, of any frame by its number alone.

A spectrum of 1/f from a lowest to a highest frequency is parted into strata of equal ratio, which
hold equal variances. A sample has one wave in each, of a frequency drawn from the stratum's part of
the spectrum (log-uniform), an amplitude of Rayleigh's distribution and a uniform phase. Over all
samples the spectrum is then 1/f without a ripple, whatever the number of strata, the noise is
stationary, and its distribution in any frame exactly normal.

Source: Shinozuka and Deodatis 1991, Simulation of stochastic processes by spectral representation,
with the frequencies drawn at random within their strata.
"""

import math
from math import ceil, log, log2, sqrt
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Array
from core.errors import DataError, ParameterError
from core.kernels import special
from core.physics.numerics import finite, gauss_legendre, non_negative, positive, within
from core.records import dataclass


@dataclass(frozen=True)
class FlickerBand:
    """Ends of the spectrum of a 1/f noise."""

    low_Hz: float
    high_Hz: float

    @property
    def strata(self) -> int:
        """Number of parts of an octave or less."""
        return max(1, ceil(log2(self.high_Hz / self.low_Hz)))


def flicker_band(*, frame_rate_Hz: float, longest_period_s: float) -> FlickerBand:
    """From 1/longest period, which must exceed two frames, to the frames' Nyquist frequency."""
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    longest = positive("longest_period_s", longest_period_s, unit="s")
    if not longest * rate > 2.0:
        allowed = f"above two frame periods, {2.0 / rate:g} s"
        raise ParameterError("longest_period_s", longest, allowed, unit="s")
    return FlickerBand(1.0 / longest, 0.5 * rate)


def flicker_sigma(*, white_sigma: float, corner_Hz: float, band: FlickerBand) -> float:
    """Standard deviation of the 1/f noise that equals a white one's density at the corner.

    white_sigma·√(corner/high·ln(high/low)), the root of the integral of the density: that of the
    white noise of a frame is white_sigma²/high_Hz up to high_Hz.
    """
    corner = non_negative("corner_Hz", corner_Hz, unit="Hz")
    share = corner / band.high_Hz * log(band.high_Hz / band.low_Hz)
    return non_negative("white_sigma", white_sigma) * sqrt(share)


def filtered_flicker(*, kept: float, band: FlickerBand) -> float:
    """Standard deviation of 1/f noise behind a recursive filter over frames, over that before.

    `kept` is the share a of the last result that stays: y = a·y₋₁ + (1 − a)·x. 0 to below 1.

    Source: the integral of |H|²/f over that of 1/f, |H(f)|² = (1 − a)²/(1 − 2a·cos(2πf/r) + a²)
    (Oppenheim and Schafer 2010, Discrete-Time Signal Processing, chapter 5).
    """
    share = within("kept", kept, 0.0, 1.0)
    places, weights = gauss_legendre(32)
    octaves = np.linspace(log(band.low_Hz / band.high_Hz), 0.0, band.strata + 1)
    middles, half = (octaves[1:] + octaves[:-1]) / 2.0, (octaves[1] - octaves[0]) / 2.0
    angle = math.pi * np.exp(middles[:, np.newaxis] + half * places)
    power = (1.0 - share) ** 2 / (1.0 - 2.0 * share * np.cos(angle) + share**2)
    return float(np.sqrt(np.mean(power @ (weights / 2.0))))


def flicker_waves(
    *, band: FlickerBand, stratum: int, place: Array, level: Array
) -> tuple[Array, Array]:
    """Frequencies in Hz of one stratum's waves, and amplitudes, Rayleigh-distributed.

    Uniform deviates in [0, 1) of the samples, in double, tell where in its stratum the frequency
    is, and the amplitude; `place` may be the same for all strata. Stratum 0 is the slowest. With a
    uniform phase each stratum is standard normal; all strata have the variance of their number.
    """
    ratio = (band.high_Hz / band.low_Hz) ** (1.0 / band.strata)
    return np.asarray(band.low_Hz * ratio ** (stratum + place)), np.sqrt(-2.0 * np.log1p(-level))


def wave_at(*, time_s: float, frequency_hz: Array, amplitude: Array, phase: Array) -> Array:
    """Values of waves of frequencies in Hz at a time; their phase is in turns."""
    turns = frequency_hz * finite("time_s", time_s, unit="s")
    turns += phase
    turns -= np.floor(turns)  # before the cosine, whose argument so keeps its digits
    return np.asarray(amplitude * np.cos(2.0 * np.pi * turns))


# Periodic noise: a sinusoid, plain or modulated in amplitude.


def periodic_pattern(
    *,
    x_mrad: ArrayLike,
    y_mrad: ArrayLike,
    amplitude: float,
    xi: float,
    eta: float,
    phase_rad: float = 0.0,
    modulation: float = 0.0,
    modulation_xi: float = 0.0,
    modulation_eta: float = 0.0,
    modulation_phase_rad: float = 0.0,
) -> NDArray[np.float64]:
    """Sinusoidal pattern A·(1 + m·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ).

    Positions broadcast: a row of columns and a column of rows make a frame at the cost of vectors.
    The depth m of the modulation is 0 to 1; frequencies are in cycles/mrad.

    Source: Tantalo 1996, chapter 3 ("simple sinusoidal noise models and modified periodic noise").
    """
    x = np.asarray(x_mrad, dtype=np.float64)
    y = np.asarray(y_mrad, dtype=np.float64)
    size = finite("amplitude", amplitude)
    depth = within("modulation", modulation, 0.0, 1.0)
    frequencies = (finite("xi", xi, unit="cyc/mrad"), finite("eta", eta, unit="cyc/mrad"))
    pattern = size * _wave(x, y, *frequencies, finite("phase_rad", phase_rad, unit="rad"))
    if depth > 0.0:
        envelope = _wave(
            x,
            y,
            finite("modulation_xi", modulation_xi, unit="cyc/mrad"),
            finite("modulation_eta", modulation_eta, unit="cyc/mrad"),
            finite("modulation_phase_rad", modulation_phase_rad, unit="rad"),
        )
        pattern = pattern * (1.0 + depth * envelope)
    return np.asarray(pattern, dtype=np.float64)


def _wave(
    x: NDArray[np.float64], y: NDArray[np.float64], xi: float, eta: float, phase: float
) -> NDArray[np.float64]:
    """sin(2π(ξx + ηy) + φ) by the addition theorem: sines of the axes, not of the frame."""
    across = 2.0 * math.pi * xi * x + phase
    along = 2.0 * math.pi * eta * y
    wave = np.sin(across) * np.cos(along)
    return np.asarray(wave + np.cos(across) * np.sin(along), dtype=np.float64)


# Photon noise: means, deviates and quantiles of Poisson's law.

Floats = TypeVar("Floats", NDArray[np.float32], NDArray[np.float64])

_ROUNDING = 1e-5  # of the largest value: what a Fourier blur in single precision can undershoot


def published_means(local_mean: Floats, *, percent: float, out: Floats | None = None) -> Floats:
    """Mean of the Poisson deviate that is added to each sample: a percentage of the local mean.

    The local mean is Gaussian-weighted, (rows, columns), and 0 or above; a percentage of 1 means
    0.01. The deviate is added to the picture as it is, which ties the strength of the noise to the
    unit.

    Source: Tantalo 1996, section 4.3 (Poisson noise module).
    """
    if not 0.0 <= percent < float("inf"):
        raise ParameterError("percent", percent, "must be 0 or above and finite", unit="%")
    share = local_mean.dtype.type(percent / 100.0)
    return _without_undershoot(np.multiply(local_mean, share, out=out))


def photon_means(radiance: Floats, *, photons_per_unit: float, out: Floats | None = None) -> Floats:
    """Mean photon count of each sample: radiance times photons per sample for 1 W m⁻² sr⁻¹.

    Of the picture's shape and type. Radiance below 0 beyond rounding is refused (`DataError`).
    """
    positive("photons_per_unit", photons_per_unit)
    unit = radiance.dtype.type(photons_per_unit)
    return _without_undershoot(np.multiply(radiance, unit, out=out))


def radiance_of_photons(
    counts: Floats, *, photons_per_unit: float, out: Floats | None = None
) -> Floats:
    """Picture that photon counts stand for: the way back from `photon_means`."""
    positive("photons_per_unit", photons_per_unit)
    return np.divide(counts, counts.dtype.type(photons_per_unit), out=out)


def _without_undershoot(means: Floats) -> Floats:
    if not means.size:
        return means
    lowest = float(means.min())
    if lowest >= 0.0:
        return means
    highest = float(means.max())
    if not (np.isfinite(lowest) and np.isfinite(highest)):
        raise DataError("Poisson noise: the picture has samples that are not finite")
    if lowest < -_ROUNDING * max(highest, 0.0):
        raise DataError(
            "Poisson noise: photon counts cannot be negative. Means below 0: "
            f"{np.count_nonzero(means < 0.0)} of {means.size}; the lowest is {lowest:.6g}"
        )
    return np.maximum(means, means.dtype.type(0.0), out=means)


# Poisson deviates made of standard normal ones: a deviate goes with its normal's probability.
#
# The count is the quantile of the Poisson distribution at Φ(z). So the unit deviates of a picture
# stay what they are when exposure or aperture change, and a sample's count depends on nothing but
# its own mean and deviate: a region of a picture has the bits of the whole.


LARGE_MEAN = 64.0
"""From here on the expansion to 1/√mean: total variation distance 3e-5 and less."""

SMALL_MEAN = 16.0
"""Below it the distribution function is summed; from here to `LARGE_MEAN` the expansion goes to
1/mean: total variation distance 5e-5 and less."""


def poisson_of_normal(mean: Array, deviates: Array, *, out: Array | None = None) -> Array:
    """Poisson counts, one for each mean and standard normal deviate of the same shape and type.

    float32 or float64; a mean that is not above 0 gives no count. `out` is contiguous, and neither
    of the two. Counts are whole as far as the type counts that far.

    The quantile is floor(m + √m·z + (z² + 2)/6 − (z/36 + z³/72)/√m + …); the distance to the true
    distribution is tabulated by `imagechain bench`. Source: Giles 2016, Algorithm 955:
    approximation of the inverse Poisson cumulative distribution function, ACM Transactions on
    Mathematical Software 42, 7; after Temme 1979.
    """
    if mean.size == 0 or mean.min() >= LARGE_MEAN:
        return _of_large(mean, deviates, out)
    few = np.flatnonzero(mean.reshape(-1) < LARGE_MEAN)
    small = _of_small(mean.reshape(-1)[few], deviates.reshape(-1)[few])
    counts = _of_large(np.maximum(mean, mean.dtype.type(LARGE_MEAN)), deviates, out)
    counts.reshape(-1)[few] = small
    return counts


def _of_large(mean: Array, deviates: Array, out: Array | None) -> Array:
    number = mean.dtype.type
    root = np.sqrt(mean)
    # m + z·(√m − (z² + 2)/(72·√m)) + (z² + 2)/6
    square = deviates * deviates
    square += number(2.0)
    counts = np.divide(square, root, out=out)
    counts *= number(-1.0 / 72.0)
    counts += root
    counts *= deviates
    square *= number(1.0 / 6.0)
    counts += square
    counts += mean
    return np.asarray(np.floor(counts, out=counts))


def _of_small(mean: Array, deviates: Array) -> Array:
    means, z = mean.astype(np.float64), deviates.astype(np.float64)
    counts = np.zeros(len(means))
    middle = means >= SMALL_MEAN
    if middle.any():
        m, w = means[middle], z[middle]
        square, root = w * w, np.sqrt(m)
        counts[middle] = np.floor(
            m
            + root * w
            + (square + 2.0) / 6.0
            - w * (square + 2.0) / (72.0 * root)
            + (square * (square / 270.0 + 7.0 / 810.0) - 8.0 / 405.0) / m
        )
        np.maximum(counts, 0.0, out=counts)
    tiny = np.flatnonzero(~middle & (means > 0.0))
    counts[tiny] = _summed(means[tiny], z[tiny])
    return counts


def _summed(mean: Array, z: Array) -> Array:
    """The smallest k with P(N ≤ k) ≥ Φ(z); by the upper tail where that is the smaller one."""
    counts = np.zeros(len(mean))
    waiting = np.arange(len(mean))
    upper = special("ndtr")(-z)  # of the probability beyond, which keeps its digits for large z
    chance = np.exp(-mean)
    beyond = -np.expm1(-mean)
    k = 0
    while waiting.size:
        # A sum of differences loses the digits of a small tail: that is taken anew.
        lost = beyond < 1e-3
        if lost.any():
            beyond = np.where(lost, special("pdtrc")(k, mean), beyond)
        going_on = beyond > upper
        waiting, mean, upper = waiting[going_on], mean[going_on], upper[going_on]
        k += 1
        chance = chance[going_on] * mean / k
        beyond = beyond[going_on] - chance
        counts[waiting] = k
    return counts
