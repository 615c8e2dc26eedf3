"""Reading a detector: skew, smear, blooming, trails and lag; its amplifier and converter.

Charges have any unit that is proportional to electrons.
"""

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, Literal, TypeVar, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Array, Vector
from core.errors import ParameterError
from core.kernels import special
from core.machine import ForEach, in_turn
from core.physics.numerics import (
    all_above_zero,
    all_finite,
    all_from_zero,
    finite,
    mean_of_waves,
    non_negative,
    positive,
    within,
)

REACH = 8  # samples to either side of a place
_KAISER = 7.0  # waves of up to 0.35 cycles/sample are exact within 6e-4


def sinc_weights(*, fraction: ArrayLike) -> Vector:
    """Weights, shape (…, 2·REACH), of the samples around a place: a sinc in Kaiser's window.

    `fraction` is how far the place is behind a sample, from 0 to 1. The weights, whose sum is 1,
    begin REACH − 1 samples before that sample.

    Source: Oppenheim and Schafer 2010, Discrete-Time Signal Processing, section 7.5.
    """
    away = all_finite("fraction", fraction)[..., np.newaxis] - np.arange(1 - REACH, REACH + 1)
    window = np.i0(_KAISER * np.sqrt(np.clip(1.0 - (away / REACH) ** 2, 0.0, None)))
    weights = np.sinc(away) * window
    weights[np.abs(weights) < 1e-13] = 0.0  # at a sample, it alone
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def smear(
    *, charge: Array, passed: Vector, total: Vector, ratio: float, above: bool, below: bool
) -> Array:
    """Charge that rows collect while they pass the rows above them, or below, or both.

    `charge` is what some rows collect in the exposure, shape (rows, columns); `passed` is the sum
    of the rows above these, `total` that of all rows, shape (columns,). `ratio` is the time of one
    transfer over the exposure.

    Source: Janesick 2001, Scientific Charge-Coupled Devices, chapter 1 (frame transfer): packets
    stay under every row that they pass for the time of one transfer.
    """
    through = passed + np.cumsum(charge, axis=0, dtype=np.result_type(charge, np.float64))
    seen = above * (through - charge) + below * (total - through)
    return np.asarray(non_negative("ratio", ratio) * seen)


def smear_mtf(
    *, frequency: ArrayLike, interval_mrad: float, rows: int, ratio: float, sides: int
) -> Vector:
    """Contrast along the columns behind `smear`, relative to the mean that it raises.

    [1 + sτ(N·D² − 1)/2]/[1 + sτ(N − 1)/2], the mean over the rows, with s the sides passed, τ the
    ratio, N the rows and D the transform of a column.
    """
    half = 0.5 * sides * non_negative("ratio", ratio)
    column = mean_of_waves(np.asarray(frequency, np.float64) * interval_mrad, rows) ** 2
    return np.asarray((1.0 + half * (rows * column - 1.0)) / (1.0 + half * (rows - 1.0)))


def bloomed(*, charge: ArrayLike, full_well: float, drained: float = 0.0) -> Vector:
    """Charge of a column, shape (rows,), whose full pixels pass their excess to both neighbours.

    `drained`, from 0 to 1, is the share of the excess that the anti-blooming drain takes first.
    What reaches an end of the column leaves it. Pixels that no excess reaches keep their charge.

    Source: Levine and Peres 2009, Potential Analysis 30, 1 (divisible sandpile): whatever the order
    of the spills, u, the total that each pixel passes on, is the least concave majorant of γ less
    γ, with γ'' = 2(charge − full_well), and charge + u''/2 is left. The slopes of the majorant are
    the falling regression of the slopes of γ.
    """
    from scipy.optimize import isotonic_regression  # imported where it is used: start-up time

    well, collected = positive("full_well", full_well), all_finite("charge", charge)
    excess = np.maximum(collected - well, 0.0)
    held = collected - within("drained", drained, 0.0, 1.0) * excess
    slopes = np.concatenate([[0.0], np.cumsum(2.0 * (held - well))])
    majorant = isotonic_regression(slopes, increasing=False).x
    reached = majorant != slopes
    return np.where(reached[1:] | reached[:-1], well + 0.5 * np.diff(majorant), held)


def trail_weights(*, transfers: ArrayLike, lag: ArrayLike, efficiency: float) -> Vector:
    """Share of a packet that is read `lag` pixels late, 0 or more, after 1 or more transfers.

    C(n + k − 1, k)·εⁿ(1 − ε)^k: k failures before the n-th success, for an efficiency ε from 0.5.

    Source: Janesick 2001, Scientific Charge-Coupled Devices, chapter 5: charge left behind joins
    the next packet.
    """
    passed_on = within("efficiency", efficiency, 0.5, 1.0)
    n, k = all_finite("transfers", transfers), all_finite("lag", lag)
    ways = special("gammaln")(n + k) - special("gammaln")(n) - special("gammaln")(k + 1)
    powers = n * np.log(passed_on) + special("xlogy")(k, 1.0 - passed_on)
    return np.asarray(np.exp(ways + powers), np.float64)


@lru_cache(maxsize=64)
def trail_length(*, transfers: int, efficiency: float) -> int:
    """Pixels after which less than 1e-13 of a packet is to come."""
    weights = trail_weights(transfers=transfers, lag=np.arange(transfers), efficiency=efficiency)
    come = np.cumsum(weights)  # the whole within the rounding of logarithms
    return int(np.searchsorted(come, come[-1] * (1.0 - 1e-13)))


def trailed(
    *, charge: Array, efficiency: float, length: int, nearest: int = 0, skip: int = 0
) -> Array:
    """Packets as they are read through one amplifier, each with what earlier ones left behind.

    The pixels are along the first axis, the nearest to the amplifier first, with `nearest` pixels
    between; the charge may be complex. `length` is that of the trails (`trail_length`). The first
    `skip` pixels only trail: with `length` of them, the others are to the bit what they are in the
    whole line.
    """
    pixels = len(charge)
    made = np.zeros_like(charge[skip:], np.result_type(charge, np.float64))  # laid out as these
    for lag in range(min(length, pixels - 1) + 1):
        first = max(skip, lag)
        transfers = nearest + 1 + np.arange(first - lag, pixels - lag)
        weights = trail_weights(transfers=transfers, lag=lag, efficiency=efficiency)
        made[first - skip :] += weights[:, np.newaxis] * charge[first - lag : pixels - lag]
    return made


def persistence(*, shares: ArrayLike, time_constants_s: ArrayLike, delay_s: float) -> float:
    """Share of an earlier exposure that is left after a delay: Σ share·e^(−delay/time constant).

    Source: Smith, Zavodny, Rahmer and Bonati 2008, Proc. SPIE 7021, 70210J (traps that release
    their charge).
    """
    constants = all_above_zero("time_constants_s", time_constants_s, unit="s")
    decay = np.exp(-non_negative("delay_s", delay_s, unit="s") / constants)
    return float(np.sum(all_from_zero("shares", shares) * decay))


# Pre-amplifier of a scanning sensor: one or more equal poles in time, seen along the scan.


def lowpass_mtf(
    *, frequency: ArrayLike, scan_velocity_mrad_per_s: float, time_constant_s: float, poles: int = 1
) -> NDArray[np.float64]:
    """Modulus of the low-pass H = 1/(1 + 2πi·τ·v·frequency)^n.

    Parameters
    ----------
    frequency : array_like
        Frequencies along the scan in cycles/mrad, any shape, finite.
    scan_velocity_mrad_per_s : float
        Scan velocity v in mrad/s; positive towards +x.
    time_constant_s : float
        Time constant τ of each pole in s, zero or above.
    poles : int
        Number n of equal poles, 1 to 100.

    Returns
    -------
    ndarray of float64
        (1 + (2πτv·frequency)²)^(−n/2).

    Source: Tantalo 1996, section 4.9.2 and eq. 4.60 (one pole).
    """
    count = pole_count(poles)
    size = _phase_size(frequency, scan_velocity_mrad_per_s, time_constant_s)
    with np.errstate(over="ignore"):
        return np.asarray(np.hypot(1.0, size) ** -float(count), dtype=np.float64)


def lowpass_ptf(
    *, frequency: ArrayLike, scan_velocity_mrad_per_s: float, time_constant_s: float, poles: int = 1
) -> NDArray[np.float64]:
    """Phase of the low-pass of `lowpass_mtf`: −n·arctan(2πτv·frequency), radians.

    A lag to +x when the scan runs to +x. Source: Tantalo 1996, section 4.9.2 (one pole).
    """
    count = pole_count(poles)
    size = _phase_size(frequency, scan_velocity_mrad_per_s, time_constant_s)
    return np.asarray(-count * np.arctan(size), dtype=np.float64)


def noise_bandwidth_hz(*, time_constant_s: float) -> float:
    """Bandwidth of the detector noise, Hz: 1/(2τ) (Tantalo 1996, section 4.6)."""
    return 0.5 / positive("time_constant_s", time_constant_s, unit="s")


def dwell_time_s(*, interval_mrad: float, scan_velocity_mrad_per_s: float) -> float:
    """Time the scan stays on one sample, interval/velocity: the time constant where none is given.

    The velocity is of either sign, not zero. Source: Tantalo 1996, section 4.9.2: 30° in 512
    samples at 16 Hz have a bandwidth of 49152 Hz.
    """
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    if velocity == 0.0:
        allowed = (
            "finite and not 0, as the dwell time is the sampling interval over the scan velocity"
        )
        raise ParameterError("scan_velocity_mrad_per_s", velocity, allowed, unit="mrad/s")
    return positive("interval_mrad", interval_mrad, unit="mrad") / abs(velocity)


def mirror_scan_velocity_mrad_per_s(*, scan_mirror_rate_Hz: float) -> float:
    """Angular velocity of a mirror that turns once per line: 2π·1000·rate (Tantalo 1996, 4.9.2)."""
    rate = non_negative("scan_mirror_rate_Hz", scan_mirror_rate_Hz, unit="Hz")
    return 2.0 * math.pi * 1000.0 * rate


def pole_count(poles: int) -> int:
    """The number of equal poles of a filter, checked: a whole number from 1 to 100."""
    if within("poles", poles, 1, 100) != int(poles):
        raise ParameterError("poles", poles, "a whole number, 1 to 100")
    return int(poles)


def _phase_size(
    frequency: ArrayLike, scan_velocity_mrad_per_s: float, time_constant_s: float
) -> NDArray[np.float64]:
    """2πτv·frequency, without unit."""
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    lag = velocity * non_negative("time_constant_s", time_constant_s, unit="s")
    scale = 2.0 * math.pi * finite("time constant × scan velocity", lag, unit="mrad")
    # The largest float64 stands in for infinity, so that zero frequency stays zero.
    scale = max(-1e300, min(scale, 1e300))
    with np.errstate(over="ignore"):
        return np.asarray(scale * np.asarray(frequency, dtype=np.float64), dtype=np.float64)


# Post filters behind the amplifier: low-pass, high-pass and boost, along one axis.

KINDS = ("none", "lowpass", "highpass", "boost")


def post_filter_mtf(
    *,
    frequency: ArrayLike,
    kind: str,
    corner_cyc_per_mrad: float,
    poles: int = 1,
    max_gain: float = 2.0,
) -> NDArray[np.float64]:
    """Modulus of a post filter.

    Parameters
    ----------
    frequency : array_like
        Frequencies along the filtered axis in cycles/mrad, any shape, finite.
    kind : str
        With u = frequency/corner: `none`, H = 1. `lowpass`, H = 1/(1 + iu)^n. `highpass`,
        H = (iu/(1 + iu))^n: it takes the mean out, H(0) = 0. `boost`,
        H = 1 + (G − 1)(1 − cos(πu))/2 up to the corner and G beyond, without phase.
    corner_cyc_per_mrad : float
        Corner of each pole, or the frequency at which the boost reaches its gain; above zero.
    poles : int
        Number n of equal poles, 1 to 100; not used by `boost`.
    max_gain : float
        Gain G of `boost`, 1 to 1e6.

    Returns
    -------
    ndarray of float64
        Modulus of H, of the shape of `frequency`.

    Source: poles, linear network theory. Boost: the raised-cosine form of thermal-system models
    (Ratches et al. 1975), held at its gain beyond the boost frequency instead of falling again.
    """
    ratio = _ratio(frequency, kind, corner_cyc_per_mrad)
    count = pole_count(poles)
    gain = within("max_gain", max_gain, 1.0, 1e6)
    if kind == "none":
        return np.ones_like(ratio)
    if kind == "boost":
        rise = np.square(np.sin(0.5 * math.pi * np.minimum(np.abs(ratio), 1.0)))
        return np.asarray(1.0 + (gain - 1.0) * rise, dtype=np.float64)
    size = np.hypot(1.0, ratio)
    one_pole = 1.0 / size if kind == "lowpass" else np.abs(ratio) / size
    return np.asarray(one_pole ** float(count), dtype=np.float64)


def post_filter_ptf(
    *, frequency: ArrayLike, kind: str, corner_cyc_per_mrad: float, poles: int = 1
) -> NDArray[np.float64]:
    """Phase of a post filter in radians, odd in frequency, the scan running towards +x.

    −n·arctan(u) for `lowpass`, n·(±π/2 − arctan(u)) for `highpass`, and 0 at frequency 0; 0 for
    `none` and `boost`. Arguments as of `post_filter_mtf`. Source: linear network theory.
    """
    ratio = _ratio(frequency, kind, corner_cyc_per_mrad)
    count = pole_count(poles)
    if kind == "lowpass":
        return np.asarray(-count * np.arctan(ratio), dtype=np.float64)
    if kind == "highpass":
        lead = np.sign(ratio) * np.arctan2(1.0, np.abs(ratio))
        return np.asarray(count * lead, dtype=np.float64)
    return np.zeros_like(ratio)


def corner_in_cyc_per_mrad(*, corner_Hz: float, scan_velocity_mrad_per_s: float) -> float:
    """Corner along the scan of a filter whose corner is given in time: corner/velocity."""
    velocity = positive("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    return positive("corner_Hz", corner_Hz, unit="Hz") / velocity


def _ratio(frequency: ArrayLike, kind: str, corner_cyc_per_mrad: float) -> NDArray[np.float64]:
    if kind not in KINDS:
        raise ParameterError("post_filter", kind, "one of " + ", ".join(KINDS))
    corner = positive("corner_cyc_per_mrad", corner_cyc_per_mrad, unit="cyc/mrad")
    with np.errstate(over="ignore"):
        ratio = np.asarray(frequency, dtype=np.float64) / corner
    return np.asarray(np.clip(ratio, -1e300, 1e300), dtype=np.float64)


# Analogue-to-digital conversion: the nearest of 2^b levels, and the error it leaves.

# Samples worked on at once. A picture of 512² is done sooner in one block than by two threads:
# 0.45 ms against 0.7, most of it waiting for each other.
_BLOCK_SAMPLES = 1 << 18


def quantize(
    array: NDArray[Any], *, bits: int, low: float, high: float, for_each: ForEach = in_turn
) -> NDArray[Any]:
    """Replace each sample by the nearest of 2^b levels from `low` to `high`.

    Parameters
    ----------
    array : ndarray
        Samples, any shape, finite; float32 and float64 keep their dtype, others become float64.
    bits : int
        Bits b per sample, 1 to 64; 0 switches the quantizer off.
    low, high : float
        First and last level, both included, in the unit of the samples. Where they are equal
        there is no range, and the samples come back as they are.
    for_each : callable
        Calls a function on every block of samples, in any order: `Work.for_each`.

    Returns
    -------
    ndarray
        low + k·q, q = (high − low)/(2^b − 1), clipped to the range; ties to even k. The work is
        done in float64, so that a float32 sample is rounded once.

    Source: Tantalo 1996, section 4.7 (2^m levels for m bits).
    """
    samples = np.asarray(array)
    if samples.dtype not in (np.float32, np.float64):
        samples = samples.astype(np.float64)
    result = np.empty_like(samples, order="C")
    steps = 2.0**bits - 1.0
    first, last = _range(low, high, samples.dtype)
    if steps == 0.0 or first == last:
        np.copyto(result, samples)
        return result
    if not math.isfinite(steps / (last - first)):
        # The levels are closer together than float64 can count.
        return np.clip(samples, first, last, out=result)

    up, down = steps / (last - first), (last - first) / steps
    # By a rounding error; a sample beyond the range is clipped to the last level below.
    missed = steps * down + first != last

    def one(block: tuple[NDArray[Any], NDArray[Any]]) -> None:
        source, target = block
        level = source.astype(np.float64)
        level -= first
        level *= up
        np.rint(level, out=level)
        if missed:
            level[level == steps] = math.inf
        level *= down
        level += first
        np.clip(level, first, last, out=level)
        np.copyto(target, level, casting="same_kind")

    for_each(one, list(_blocks(samples, result)))
    return result


def quantization_rms(*, original: NDArray[Any], quantized: NDArray[Any]) -> float:
    """Root mean square of what the quantizer changed, in the unit of the samples.

    Source: Tantalo 1996, eq. 4.56. Erratum: the root there is of a sum; the mean is meant.
    """
    before, after = np.asarray(original), np.asarray(quantized)
    sums = []
    for first, second in _blocks(before, after):
        difference = np.subtract(first, second, dtype=np.float64).ravel()
        sums.append(float(np.einsum("i,i->", difference, difference)))
    return math.sqrt(math.fsum(sums) / before.size)


def _blocks(
    first: NDArray[Any], second: NDArray[Any]
) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
    if first.flags.c_contiguous and second.flags.c_contiguous:
        first, second = first.reshape(-1), second.reshape(-1)
    first, second = np.atleast_1d(first), np.atleast_1d(second)
    rows = max(1, _BLOCK_SAMPLES * first.shape[0] // max(1, first.size))
    for start in range(0, first.shape[0], rows):
        yield first[start : start + rows], second[start : start + rows]


def _range(low: float, high: float, dtype: np.dtype[Any]) -> tuple[float, float]:
    first, last = finite("range_low", low), finite("range_high", high)
    if last < first:
        raise ParameterError("range_high", high, f"at least range_low = {first:g}")
    largest = float(np.finfo(dtype).max)
    if max(-first, last) > largest or not math.isfinite(last - first):
        raise ParameterError(
            "range_low, range_high", (low, high), f"a range that {dtype} can represent"
        )
    return first, last


# How much of a quantizer's rounding error changes from frame to frame, and how much stays.


def rounding_variances(*, step: float, noise_variance: float) -> tuple[float, float]:
    """Variance of the rounding error that temporal noise stirs, and of that it leaves in place.

    Their sum is step²/12; the noise before the quantizer is normal, in the unit of the step
    squared. What is rounded is taken to lie anywhere between two levels with equal chance, as of a
    picture with many levels; a picture of one level only has one fixed error.

    The mean error of s + noise over the noise is a Fourier series in s; its mean square is
    step²/(2π²)·Σ exp(−4π²k²σ²/step²)/k². Source: Widrow and Kollár 2008, Quantization Noise,
    chapters 4 and 19 (the characteristic function method); for small σ the sum is
    π²/6 − √(πa) + a/2 with a = 4π²σ²/step², by Poisson's summation formula.
    """
    width, variance = positive("step", step), non_negative("noise_variance", noise_variance)
    whole = width * width / 12.0
    a = 4.0 * math.pi**2 * (variance / width / width)
    if a < 0.25:
        total = math.pi**2 / 6.0 - math.sqrt(math.pi * a) + 0.5 * a
    else:
        total = math.fsum(math.exp(-a * k * k) / (k * k) for k in range(1, 14))
    fixed = min(whole, width * width / (2.0 * math.pi**2) * total)
    return whole - fixed, fixed


# Errors of gain and bias in the conversion from radiance to voltage, detector by detector.

GainModel = Literal["per_pixel", "published", "literal"]
Floats = TypeVar("Floats", NDArray[np.float32], NDArray[np.float64])


def apply_gain_bias(
    radiance: Floats,
    *,
    gain_pattern: ArrayLike,
    bias_pattern: ArrayLike,
    gain_percent: float,
    bias_percent: float,
    mean_radiance: float,
    model: GainModel = "per_pixel",
) -> Floats:
    """Picture as read through detectors whose gain and bias differ.

    With g, b = percent/100, n₁ and n₂ the patterns and m the mean:

    - `per_pixel`: in·(1 + g·n₁) + b·n₂·m, each detector's gain scales what it sees;
    - `published`: in + (g·n₁ + b·n₂)·m, gain error too as a share of the mean;
    - `literal`: in·(g·m) + b·m, the equation as printed: it scales the whole picture by g·m and
      has no pattern.

    Parameters
    ----------
    radiance
        Picture, (rows, columns), W m⁻² sr⁻¹.
    gain_pattern, bias_pattern
        Standard normal deviates that broadcast against the picture: a scalar for one detector
        (line scanner), (1, columns) or (rows, 1) for a line of detectors, (rows, columns) for an
        array.
    gain_percent, bias_percent
        Spread among detectors in percent (1 means 0.01), 0 or above.

    Source: Tantalo 1996, eq. 4.59. Erratum: as printed it multiplies the picture by a number of
    the order of the gain error; the text above it describes `published`.
    """
    gain = non_negative("gain_percent", gain_percent, unit="%") / 100.0
    bias = non_negative("bias_percent", bias_percent, unit="%") / 100.0
    kind = radiance.dtype
    offset = bias * mean_radiance * _typed(bias_pattern, radiance)
    deviation = gain * _typed(gain_pattern, radiance)
    if model == "per_pixel":
        result = radiance * (1.0 + deviation).astype(kind, copy=False)
        result += offset.astype(kind, copy=False)
        return result
    if model == "published":
        return radiance + (mean_radiance * deviation + offset).astype(kind, copy=False)
    if model == "literal":
        return radiance * kind.type(gain * mean_radiance) + kind.type(bias * mean_radiance)
    raise ParameterError("gain_model", model, f"must be one of {', '.join(get_args(GainModel))}")


def _typed(pattern: ArrayLike, radiance: NDArray[Any]) -> NDArray[Any]:
    """In double while small, in its own type where every sample has its own."""
    values = np.asarray(pattern)
    return values if values.size >= radiance.size else values.astype(float)
