"""What reading a detector does to its picture: skew, smear, blooming, trails and lag.

Charges have any unit that is proportional to electrons.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from core.physics.checks import (
    all_above_zero,
    all_finite,
    all_from_zero,
    non_negative,
    positive,
    within,
)

Array = NDArray[Any]
Vector = NDArray[np.float64]
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
    cycles = np.asarray(frequency, np.float64) * interval_mrad
    rest = cycles - np.round(cycles)
    column = (np.sinc(rows * rest) / np.sinc(rest)) ** 2
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
    ways = scipy.special.gammaln(n + k) - scipy.special.gammaln(n) - scipy.special.gammaln(k + 1)
    powers = n * np.log(passed_on) + scipy.special.xlogy(k, 1.0 - passed_on)
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
