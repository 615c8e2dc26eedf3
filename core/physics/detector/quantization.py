"""Analogue-to-digital conversion: the nearest of 2^b levels, and the error it leaves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Literal, TypeVar, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.machine import ForEach, in_turn
from core.physics.checks import finite, positive

# Samples worked on at once. A picture of 512² is done sooner in one block than by two threads:
# 0.45 ms against 0.7, most of it waiting for each other.
_BLOCK_SAMPLES = 1 << 18


def quantize(
    array: NDArray[Any],
    *,
    bits: int,
    low: float,
    high: float,
    for_each: ForEach = in_turn,
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
    """Matching pieces of two arrays of one shape, as views."""
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
    width = positive("step", step)
    if not 0.0 <= noise_variance < math.inf:
        raise ParameterError("noise_variance", noise_variance, "0 or above and finite")
    whole = width * width / 12.0
    a = 4.0 * math.pi**2 * (noise_variance / width / width)
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
    for name, percent in (("gain_percent", gain_percent), ("bias_percent", bias_percent)):
        if not 0.0 <= percent < float("inf"):
            raise ParameterError(name, percent, "must be 0 or above and finite", unit="%")
    gain, bias = gain_percent / 100.0, bias_percent / 100.0
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
