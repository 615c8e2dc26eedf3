"""Photon noise: means, deviates and quantiles of Poisson's law."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

from core.errors import DataError, ParameterError

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
    _require_photons(photons_per_unit)
    unit = radiance.dtype.type(photons_per_unit)
    return _without_undershoot(np.multiply(radiance, unit, out=out))


def radiance_of_photons(
    counts: Floats, *, photons_per_unit: float, out: Floats | None = None
) -> Floats:
    """Picture that photon counts stand for: the way back from `photon_means`."""
    _require_photons(photons_per_unit)
    return np.divide(counts, counts.dtype.type(photons_per_unit), out=out)


def _require_photons(photons_per_unit: float) -> None:
    if not 0.0 < photons_per_unit < float("inf"):
        raise ParameterError("photons_per_unit", photons_per_unit, "must be above 0 and finite")


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
            f"Poisson noise: {np.count_nonzero(means < 0.0)} of {means.size} means are below 0"
            f" (the lowest is {lowest:.6g}): photon counts cannot be negative"
        )
    return np.maximum(means, means.dtype.type(0.0), out=means)


# Poisson deviates made of standard normal ones: a deviate goes with its normal's probability.
#
# The count is the quantile of the Poisson distribution at Φ(z). So the unit deviates of a picture
# stay what they are when exposure or aperture change, and a sample's count depends on nothing but
# its own mean and deviate: a region of a picture has the bits of the whole.

Array = NDArray[Any]

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
    upper = scipy.special.ndtr(-z)  # of the probability beyond, which keeps its digits for large z
    chance = np.exp(-mean)
    beyond = -np.expm1(-mean)
    k = 0
    while waiting.size:
        # A sum of differences loses the digits of a small tail: that is taken anew.
        lost = beyond < 1e-3
        if lost.any():
            beyond = np.where(lost, scipy.special.pdtrc(k, mean), beyond)
        going_on = beyond > upper
        waiting, mean, upper = waiting[going_on], mean[going_on], upper[going_on]
        k += 1
        chance = chance[going_on] * mean / k
        beyond = beyond[going_on] - chance
        counts[waiting] = k
    return counts
