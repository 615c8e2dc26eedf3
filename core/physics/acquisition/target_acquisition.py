"""Probability that an observer acquires a target, and the range at which it falls to a value.

Lengths on the target are in m, ranges in m, frequencies in cycles per mrad of the scene; a target
of 1 m at 1000 m is 1 mrad wide. TTP values are in `core.physics.acquisition.ttp`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from core.errors import ParameterError
from core.physics.checks import (
    Values,
    all_above_zero,
    all_finite,
    all_from_zero,
    broadcast,
    rising,
)


def johnson_probability(*, cycles: ArrayLike, n50: ArrayLike) -> Any:
    """Probability of a task, such as recognition, from the cycles resolved across the target.

    Parameters
    ----------
    cycles
        Resolvable cycles N across the target's critical dimension, zero or above.
    n50
        Cycles at which half of the trials succeed, above zero. In one dimension (Johnson 1958):
        detection 1, recognition 4, identification 6.4; in two, with the root of the target's
        area and the 2-D MRTD (Ratches, Vollmerhausen and Driggers 2001): 0.75, 3, 6.

    Returns
    -------
    float or ndarray
        P = r^E/(1 + r^E) with r = N/N50, E = 2.7 + 0.7·r; of the broadcast shape.

    Source: Johnson 1958, Analysis of image forming systems (cycles); Ratches, Vollmerhausen and
    Driggers 2001, IEEE Sensors J. 1, 31 (two dimensions); Howe 1993, The Infrared and
    Electro-Optical Systems Handbook 4, chapter 2 (target transfer probability function with this
    E). The numbers of their equations could not be checked.
    """
    return _logistic(
        all_from_zero("cycles", cycles, infinite=True), all_above_zero("n50", n50), 2.7, 0.7
    )


def ttp_probability(*, value: ArrayLike, v50: ArrayLike) -> Any:
    """Probability of a task from the TTP value V of the target (`core.physics.acquisition.ttp`).

    P = r^E/(1 + r^E) with r = V/V50, E = 1.51 + 0.24·r, of the broadcast shape; `v50` is the value
    at which half of the trials succeed, above zero.

    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806. The number of the
    equation could not be checked.
    """
    return _logistic(
        all_from_zero("value", value, infinite=True), all_above_zero("v50", v50), 1.51, 0.24
    )


def _logistic(amount: Values, half: Values, constant: float, slope: float) -> Any:
    """r^E/(1 + r^E) as the logistic function of E·ln r: exact at r = 0, 1 and infinity."""
    amount, half = broadcast(amount=amount, half=half)
    with np.errstate(over="ignore", divide="ignore", under="ignore"):
        ratio = amount / half
        return scipy.special.expit((constant + slope * ratio) * np.log(ratio))[()]


def apparent_difference(
    *, delta_K: ArrayLike, extinction_per_km: ArrayLike, range_m: ArrayLike
) -> Any:
    """Temperature difference of target and background that is left after a path through air.

    ΔT·exp(−β·R), K, of the broadcast shape and the sign of `delta_K`.
    Source: Bouguer 1729, Beer 1852 (one coefficient for the band); Ratches 1976.
    """
    difference, extinction, distance = broadcast(
        delta_K=all_finite("delta_K", delta_K, unit="K"),
        extinction_per_km=all_from_zero("extinction_per_km", extinction_per_km, unit="1/km"),
        range_m=all_from_zero("range_m", range_m, unit="m"),
    )
    with np.errstate(under="ignore", over="ignore"):
        return (difference * np.exp(-extinction * (distance / 1000.0)))[()]


def resolvable_frequency(*, frequency: ArrayLike, mrtd_K: ArrayLike, apparent_K: ArrayLike) -> Any:
    """Highest frequency at which an apparent temperature difference reaches the MRTD.

    Parameters
    ----------
    frequency
        Frequencies of the curve in cycles/mrad, rising, shape (n,).
    mrtd_K
        Minimum resolvable temperature difference at them in K, zero or above, shape (n,). The
        curve begins with the first finite one and ends before the next infinite one.
    apparent_K
        Difference that reaches the sensor in K, of either sign, any shape.

    Returns
    -------
    float or ndarray
        Cycles/mrad, of the shape of `apparent_K`; 0 where it is below all of the curve, the
        curve's last frequency where it is above it up to its end.

    Source: Ratches 1976. Between samples the MRTD is a power of the frequency, as it is towards
    zero; from frequency zero, or an MRTD of zero, it is linear. End the curve at the first zero
    of the MTF: the lobes beyond, of false resolution, would count.
    """
    places, curve = _resolved_part(frequency, mrtd_K)
    apparent = np.abs(all_finite("apparent_K", apparent_K, unit="K"))
    if len(curve) == 0:
        return np.zeros_like(apparent)[()]
    # Of the last sample that is reached, the next is not: the curve is crossed between the two.
    least_beyond = np.minimum.accumulate(curve[::-1])[::-1]
    last = np.searchsorted(least_beyond, apparent, side="right") - 1
    lower = np.clip(last, 0, len(curve) - 1)
    upper = np.minimum(lower + 1, len(curve) - 1)
    start, end = curve[lower], curve[upper]
    from_place, to_place = places[lower], places[upper]
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = (np.log(apparent) - np.log(start)) / (np.log(end) - np.log(start))
        power = from_place * np.exp(rise * (np.log(to_place) - np.log(from_place)))
        linear = from_place + (to_place - from_place) * (apparent - start) / (end - start)
    crossing = np.where((from_place > 0.0) & (start > 0.0), power, linear)
    crossing = np.where(upper > lower, np.clip(crossing, from_place, to_place), from_place)
    return np.where(last < 0, 0.0, crossing)[()]


def _resolved_part(frequency: ArrayLike, mrtd_K: ArrayLike) -> tuple[Values, Values]:
    """Frequencies and MRTD, checked, from the first finite sample to the next infinite one."""
    places = rising("frequency", frequency, unit="cyc/mrad")
    curve = all_from_zero("mrtd_K", mrtd_K, unit="K", infinite=True)
    if curve.shape != places.shape:
        allowed = f"an array of the same shape as frequency, {places.shape}"
        raise ParameterError("mrtd_K", f"an array of shape {curve.shape}", allowed, unit="K")
    finite = np.isfinite(curve)
    first = int(np.argmax(finite)) if finite.any() else len(curve)
    end = first + int(np.argmin(finite[first:])) if not finite[first:].all() else len(curve)
    return places[first:end], curve[first:end]


def resolvable_cycles(
    *,
    frequency: ArrayLike,
    mrtd_K: ArrayLike,
    delta_K: ArrayLike,
    target_size_m: ArrayLike,
    range_m: ArrayLike,
    extinction_per_km: ArrayLike = 0.0,
) -> Any:
    """Cycles that a sensor resolves across a target.

    Parameters
    ----------
    frequency, mrtd_K
        The MRTD's curve, as in `resolvable_frequency`.
    delta_K, range_m, extinction_per_km
        As in `apparent_difference`; they broadcast.
    target_size_m
        Critical dimension of the target; the root of the area for criteria in two dimensions.

    Returns
    -------
    float or ndarray
        Highest frequency at which ΔT·exp(−β·R) reaches the MRTD, times the target's angle.

    Source: Ratches 1976, static performance model: acquisition with Johnson's cycles.
    """
    size = all_above_zero("target_size_m", target_size_m, unit="m")
    distance = all_above_zero("range_m", range_m, unit="m")
    apparent = apparent_difference(
        delta_K=delta_K, extinction_per_km=extinction_per_km, range_m=distance
    )
    resolved = resolvable_frequency(frequency=frequency, mrtd_K=mrtd_K, apparent_K=apparent)
    size, distance, resolved = broadcast(
        target_size_m=size, range_m=distance, delta_K=np.asarray(resolved)
    )
    return target_cycles(resolved, size, distance)[()]


def target_cycles(per_mrad: Values, size_m: Values, range_m: Values) -> Values:
    """Cycles per mrad times the target's angle in mrad; infinite beyond the largest number."""
    with np.errstate(over="ignore", under="ignore"):
        angle = np.minimum(1000.0 * (size_m / range_m), np.finfo(np.float64).max)
        return np.asarray(per_mrad * angle, np.float64)
