"""What the observer's eye averages and sees, and the probability that it acquires a target.

Lengths on the target are in m, ranges in m, frequencies in cycles per mrad of the scene; a target
of 1 m at 1000 m is 1 mrad wide.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats, Vector
from core.errors import ParameterError
from core.kernels import special
from core.physics.numerics import (
    all_above_zero,
    all_finite,
    all_from_zero,
    along,
    broadcast,
    gauss_legendre,
    positive,
    rising,
)

# Averaging of noise by the observer's eye: over the parts of a target, and over time.
#
# Each function gives the share of a noise's variance that is left, at most 1: the spatial
# integrators E_h and E_v and the temporal integrator E_t of the thermal imaging models.

_LONGEST = 1e300


def spatial_share(*, length_mrad: ArrayLike, noise_bandwidth_cyc_per_mrad: float) -> Vector:
    """Share of white noise's variance that is left after averaging along a length.

    Parameters
    ----------
    length_mrad
        Length L over which the eye averages, mrad, zero or above, any shape.
    noise_bandwidth_cyc_per_mrad
        Bandwidth B up to which the noise is white, cycles/mrad, above zero: half the samples per
        mrad where the samples' noises are independent, bandwidth over scan velocity along an
        analogue scan.

    Returns
    -------
    ndarray of float64
        (1/B)·∫₀ᴮ sinc²(L·ξ) dξ, sinc(x) = sin(πx)/(πx): 1 for a short length, 1/(2·B·L), the
        inverse of the number of samples, for a long one. By the sine integral, Si(2πBL)/(πL) −
        sin²(πBL)/(π²BL²).

    Source: Ratches et al. 1975, ECOM-7043, the noise bandwidth Q(f) after the eye's filter of a
    bar's width; Scott and D'Agostino 1992, Proc. SPIE 1689, 194, the integrators E_h and E_v. Both
    have the filters behind the noise under the integral as well: `coloured_share`. The equations'
    numbers could not be checked.
    """
    bandwidth = positive(
        "noise_bandwidth_cyc_per_mrad", noise_bandwidth_cyc_per_mrad, unit="cyc/mrad"
    )
    length = all_from_zero("length_mrad", length_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        turns = np.minimum(bandwidth * length, _LONGEST)
    # Below this sinc² is 1 to rounding, and the closed form is 0/0 or next to it.
    long = turns > 1e-4
    safe = np.where(long, turns, 1.0)
    sine = np.sin(math.pi * np.fmod(safe, 1.0))
    integral = special("sici")(2.0 * math.pi * safe)[0] / math.pi - sine**2 / (math.pi**2 * safe)
    series = 1.0 - (math.pi * np.where(long, 0.0, turns)) ** 2 / 9.0
    return np.asarray(np.where(long, integral / safe, series), np.float64)


def coloured_share(
    *,
    length_x_mrad: ArrayLike,
    length_y_mrad: ArrayLike,
    noise_bandwidth_x_cyc_per_mrad: float,
    noise_bandwidth_y_cyc_per_mrad: float,
    spectrum: ArrayLike,
) -> Vector:
    """Share of a filtered noise's variance that is left after averaging over rectangles.

    Parameters
    ----------
    length_x_mrad, length_y_mrad
        Sides of the rectangles, mrad, zero or above, both of shape (n,).
    noise_bandwidth_x_cyc_per_mrad, noise_bandwidth_y_cyc_per_mrad
        Frequencies up to which the spectrum goes, cycles/mrad, above zero.
    spectrum
        Power of the noise in equal cells from 0 to the bandwidths, shape (along y, across x), in
        any unit, zero or above, not zero everywhere.

    Returns
    -------
    ndarray of float64, shape (n,)
        ∬ S(ξ, η)·sinc²(X·ξ)·sinc²(Y·η) dξ dη over ∬ S(ξ, η) dξ dη; of a spectrum of one cell, which
        is white, the product of both `spatial_share`. In a cell sinc² is integrated exactly.

    Source: Ratches et al. 1975, ECOM-7043, Q(f); Scott and D'Agostino 1992, Proc. SPIE 1689, 194,
    E_h and E_v: both have the noise's filters H_N² = S under the integral.
    """
    power = all_from_zero("spectrum", spectrum)
    if power.ndim != 2 or not power.sum() > 0.0:
        raise ParameterError(
            "spectrum.shape", power.shape, "two-dimensional, with a total power above 0"
        )
    along_y = _share_of_cells(length_y_mrad, noise_bandwidth_y_cyc_per_mrad, power.shape[0])
    along_x = _share_of_cells(length_x_mrad, noise_bandwidth_x_cyc_per_mrad, power.shape[1])
    if along_x.shape[0] != along_y.shape[0]:
        shapes = f"{along_x.shape[:1]}, {along_y.shape[:1]}"
        raise ParameterError("length_x_mrad, length_y_mrad", shapes, "equal in shape")
    left = np.einsum("ni,ij,nj->n", along_y, power / power.mean(), along_x, optimize=True)
    return np.asarray(left, np.float64)


def _share_of_cells(length_mrad: ArrayLike, bandwidth: float, cells: int) -> Vector:
    """∫ sinc²(L·ξ) dξ over each of the cells, over the bandwidth; shape (lengths, cells)."""
    length = np.atleast_1d(all_from_zero("length_mrad", length_mrad, unit="mrad"))
    part = np.arange(1, cells + 1) / cells
    with np.errstate(over="ignore"):
        lengths = np.minimum(length[:, np.newaxis] * part, _LONGEST)
    up_to = part * spatial_share(length_mrad=lengths, noise_bandwidth_cyc_per_mrad=bandwidth)
    # It never falls with the bandwidth; where it has levelled off rounding might lower it.
    return np.asarray(np.maximum(np.diff(up_to, axis=1, prepend=0.0), 0.0), np.float64)


def frames_integrated(*, frame_rate_Hz: float, eye_integration_s: float) -> float:
    """Frames over which the eye averages, F_R·t_E, or 1 where fewer frames come.

    The integration time t_E is 0.2 s in Ratches' model, 0.1 s and less for bright displays. The
    temporal integrator of FLIR92, E_t = α_t/(F_R·τ_E), is the inverse, with α_t = 1: independent
    frames. Source: Ratches et al. 1975, ECOM-7043; Scott and D'Agostino 1992.
    """
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    time = positive("eye_integration_s", eye_integration_s, unit="s")
    return max(1.0, rate * time)


def frame_count(frames: float) -> float:
    """A number of frames averaged, checked: finite, 1 or above."""
    number = positive("frames", frames)
    if number < 1.0:
        raise ParameterError("frames", frames, "1 or above")
    return number


# Contrast threshold of the naked eye, and of the eye behind a sensor and its display.

CYC_PER_DEG = 1000.0 * math.pi / 180.0  # in one cycle per mrad
NOISE_SENSITIVITY = 169.6  # √Hz, how much noise of the display raises the threshold


def eye_contrast_threshold(
    *, frequency_cyc_per_deg: ArrayLike, luminance_cd_m2: ArrayLike, display_deg: ArrayLike
) -> Any:
    """Smallest contrast (modulation) of a sine that the eye sees on a display.

    Parameters
    ----------
    frequency_cyc_per_deg
        Frequency u at the eye, cycles per degree, zero or above.
    luminance_cd_m2
        Mean luminance L of the display, above zero.
    display_deg
        Root of the display's area w, degrees at the eye, above zero.

    Returns
    -------
    float or ndarray
        1/[a·u·e^(−b·u)·√(1 + 0.06·e^(b·u))], a = 540·(1 + 0.7/L)^−0.2/(1 + 12/(w·(1 + u/3)²)),
        b = 0.3·(1 + 100/L)^0.15; infinite at u = 0, of the broadcast shape.

    Source: Barten 1990, J. Opt. Soc. Am. A 7, 2024 (fit to measured thresholds), the form used by
    Vollmerhausen and Jacobs 2004, report AMSEL-NV-TR-230. Written down from the literature that
    quotes it; the numbers of the equations could not be checked.
    """
    frequency, luminance, display = broadcast(
        frequency_cyc_per_deg=all_from_zero(
            "frequency_cyc_per_deg", frequency_cyc_per_deg, unit="cyc/deg"
        ),
        luminance_cd_m2=all_above_zero("luminance_cd_m2", luminance_cd_m2, unit="cd/m²"),
        display_deg=all_above_zero("display_deg", display_deg, unit="°"),
    )
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        size = 1.0 + 12.0 / (display * (1.0 + frequency / 3.0) ** 2)
        height = 540.0 * (1.0 + 0.7 / luminance) ** -0.2 / size
        decay = 0.3 * (1.0 + 100.0 / luminance) ** 0.15 * frequency
        # e^(−bu)·√(1 + 0.06·e^(bu)), written so that nothing overflows.
        shape = np.exp(-decay / 2.0) * np.sqrt(np.exp(-decay) + 0.06)
        return (1.0 / (height * frequency * shape))[()]


def system_contrast_threshold(
    *,
    frequency: ArrayLike,
    mtf: ArrayLike,
    luminance_cd_m2: ArrayLike,
    display_deg: ArrayLike,
    magnification: ArrayLike,
    relative_noise: ArrayLike = 0.0,
) -> Any:
    """Smallest contrast of a sine in the scene that the eye sees through a sensor.

    Parameters
    ----------
    frequency
        Frequency in the scene, cycles/mrad, zero or above.
    mtf
        MTF of sensor and display; its sign has no effect, a zero makes the threshold infinite.
    luminance_cd_m2, display_deg
        The display, as in `eye_contrast_threshold`.
    magnification
        Angle on the display over angle in the scene, above zero.
    relative_noise
        Noise σ over the mean luminance L, as the eye filters it at each frequency, 1/√Hz (s^½),
        zero or above.

    Returns
    -------
    float or ndarray
        CTF_eye/MTF·√(1 + α²·σ²/L²), α = 169.6 √Hz, of the broadcast shape.

    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806; Vollmerhausen and Jacobs
    2004, report AMSEL-NV-TR-230, where α is fitted to observers. The numbers of the equations
    could not be checked.
    """
    places, response, noise, magnified = broadcast(
        frequency=all_from_zero("frequency", frequency, unit="cyc/mrad"),
        mtf=np.abs(all_finite("mtf", mtf)),
        relative_noise=all_from_zero("relative_noise", relative_noise, unit="1/√Hz"),
        magnification=all_above_zero("magnification", magnification),
    )
    eye = eye_contrast_threshold(
        frequency_cyc_per_deg=places * (CYC_PER_DEG / magnified),
        luminance_cd_m2=luminance_cd_m2,
        display_deg=display_deg,
    )
    with np.errstate(over="ignore", divide="ignore"):
        return np.asarray(eye / response * np.hypot(1.0, NOISE_SENSITIVITY * noise))[()]


# Acquisition by the cycles resolved across a target.


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
    """Probability of a task from the TTP value V of the target.

    P = r^E/(1 + r^E) with r = V/V50, E = 1.51 + 0.24·r, of the broadcast shape; `v50` is the value
    at which half of the trials succeed, above zero.

    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806. The number of the
    equation could not be checked.
    """
    return _logistic(
        all_from_zero("value", value, infinite=True), all_above_zero("v50", v50), 1.51, 0.24
    )


def _logistic(amount: Floats, half: Floats, constant: float, slope: float) -> Any:
    """r^E/(1 + r^E) as the logistic function of E·ln r: exact at r = 0, 1 and infinity."""
    amount, half = broadcast(amount=amount, half=half)
    with np.errstate(over="ignore", divide="ignore", under="ignore"):
        ratio = amount / half
        return special("expit")((constant + slope * ratio) * np.log(ratio))[()]


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


def _resolved_part(frequency: ArrayLike, mrtd_K: ArrayLike) -> tuple[Floats, Floats]:
    """Frequencies and MRTD, checked, from the first finite sample to the next infinite one."""
    places = rising("frequency", frequency, unit="cyc/mrad")
    curve = along(places, "mrtd_K", all_from_zero("mrtd_K", mrtd_K, unit="K", infinite=True))
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


def target_cycles(per_mrad: Floats, size_m: Floats, range_m: Floats) -> Floats:
    """Cycles per mrad times the target's angle in mrad; infinite beyond the largest number."""
    with np.errstate(over="ignore", under="ignore"):
        angle = np.minimum(1000.0 * (size_m / range_m), np.finfo(np.float64).max)
        return np.asarray(per_mrad * angle, np.float64)


# The targeting task performance (TTP) value of a target seen through a sensor.
#
# Unlike Johnson's cycles, which depend only on the highest frequency resolved, it sums at all
# frequencies how far the target's contrast is above the contrast threshold of sensor and eye.

Threshold = Callable[[Floats], Floats]
_NODES = 12  # of a panel
_PARTS, _ROUNDS = 16, 15  # of a panel in which contrast and threshold cross: 2^−60 of it


def thermal_contrast(*, difference_K: ArrayLike, scene_contrast_K: ArrayLike) -> Any:
    """Contrast on the display of a temperature difference; of an MRTD, the contrast threshold.

    ΔT/(2·S), of the broadcast shape: the scene contrast temperature S is the difference that the
    display shows as its mean luminance. The difference may be infinite.

    Source: Vollmerhausen and Jacobs 2004, report AMSEL-NV-TR-230 (the equation's number could not
    be checked). With the threshold of an MRTD the TTP value is the same for every S.
    """
    difference, scene = broadcast(
        difference_K=all_from_zero("difference_K", difference_K, unit="K", infinite=True),
        scene_contrast_K=all_above_zero("scene_contrast_K", scene_contrast_K, unit="K"),
    )
    with np.errstate(over="ignore", under="ignore"):
        return (difference / scene / 2.0)[()]


def ttp_values(*, frequency: ArrayLike, ctf: ArrayLike) -> Callable[..., Any]:
    """TTP values V of targets of many contrasts, by the sums of a contrast threshold.

    Parameters
    ----------
    frequency
        Frequencies in cycles/mrad, rising, shape (n,). The first and last bound the sum.
    ctf
        Contrast threshold function of sensor and eye at them, zero or above, shape (n,): zero at
        the first only, infinite where nothing is seen.

    Returns
    -------
    callable
        V = √A/R·∫√(C/CTF) df over all frequencies at which C is above CTF, of contrasts C at the
        sensor, in the unit of the threshold (an apparent temperature difference, where that is an
        MRTD), areas A in m² and ranges R in m, which broadcast.

    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806 (the equation's number could
    not be checked); the bounds of the sum are where C = CTF. With thresholds across and along, V is
    the root of the product of both. Samples are joined as in `interpolated`. The sum is
    Gauss-Legendre's between neighbouring frequencies, and the places where C = CTF, of which there
    may be one between two.
    """
    places = rising("frequency", frequency, unit="cyc/mrad")
    curve = along(places, "ctf", all_from_zero("ctf", ctf, infinite=True))
    zeros = np.flatnonzero((curve == 0.0) & (places > 0.0))
    if len(zeros):
        raise ParameterError(f"ctf[{zeros[0]}]", 0.0, "above 0 at every frequency above 0")
    threshold = interpolated(frequency=places, ctf=curve)
    limits, whole = threshold(places), _panels(threshold, places[:-1], places[1:])

    def value(contrast: ArrayLike, target_area_m2: ArrayLike, range_m: ArrayLike) -> Any:
        level, area, distance = broadcast(
            contrast=all_from_zero("contrast", contrast),
            target_area_m2=all_above_zero("target_area_m2", target_area_m2, unit="m²"),
            range_m=all_above_zero("range_m", range_m, unit="m"),
        )
        levels = level.ravel()
        seen = limits < levels[:, np.newaxis]
        inside = (seen[:, :-1] & seen[:, 1:]) @ whole
        which, crossed = np.nonzero(seen[:, :-1] != seen[:, 1:])
        low, high, seen_low = places[crossed], places[crossed + 1], seen[which, crossed]
        meet = _crossings(threshold, levels[which], low, high, seen_low)
        parts = _panels(threshold, np.where(seen_low, low, meet), np.where(seen_low, meet, high))
        inside += np.bincount(which, parts, len(levels))
        total = np.asarray((np.sqrt(levels) * inside).reshape(level.shape), np.float64)
        return target_cycles(total, np.sqrt(area), distance)[()]

    return value


def _panels(ctf: Threshold, low: Floats, high: Floats) -> Floats:
    """∫CTF^(−1/2) df in each panel."""
    nodes, weights = gauss_legendre(_NODES)
    # The share of the panel squared: a threshold that rises from zero costs no accuracy.
    share = (1.0 + nodes) / 2.0
    width = high - low
    points = low[:, np.newaxis] + width[:, np.newaxis] * share**2
    values = ctf(points)
    root = 1.0 / np.sqrt(np.where(values == 0.0, np.inf, values))
    return np.asarray(width * (root @ (weights * share)), np.float64)


def _crossings(
    ctf: Threshold, level: Floats, low: Floats, high: Floats, seen_low: NDArray[np.bool_]
) -> Floats:
    """Where C = CTF in panels that are seen at one end only."""
    if not len(level):
        return low
    parts = np.arange(1, _PARTS) / _PARTS
    for _ in range(_ROUNDS):
        inside = low[:, np.newaxis] + (high - low)[:, np.newaxis] * parts
        seen = ctf(inside) < level[:, np.newaxis]
        as_low = np.column_stack([seen == seen_low[:, np.newaxis], np.zeros(len(low), bool)])
        last = np.argmin(as_low, axis=1)[:, np.newaxis]
        bounds = np.column_stack([low, inside, high])
        low = np.take_along_axis(bounds, last, axis=1)[:, 0]
        high = np.take_along_axis(bounds, last + 1, axis=1)[:, 0]
    return (low + high) / 2.0


# A contrast threshold between its samples.


def interpolated(*, frequency: Floats, ctf: Floats) -> Threshold:
    """The function through samples of a contrast threshold, of the third order in their step.

    The threshold is above zero or infinite, at frequency zero also zero; between a finite and an
    infinite sample it is infinite. The logarithm is interpolated by Hermite's cubics, whose slopes
    are those of parabolas through three samples. A threshold that is zero at frequency zero rises
    as the frequency (MRTD), one that is infinite falls as its inverse (eye): that power is taken
    out before and put back after.
    """
    power = 0.0
    if frequency[0] == 0.0 and ctf[0] in (0.0, np.inf) and np.isfinite(ctf[1]):
        power = 1.0 if ctf[0] == 0.0 else -1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.log(ctf) - (power * np.log(frequency) if power else 0.0)
    level[~np.isfinite(level)] = np.nan
    if power:
        level[0] = _towards_zero(frequency[1:4], level[1:4])
    step = np.diff(frequency)
    secant = np.diff(level) / step
    slope = _slopes(step, secant)

    def threshold(at: Floats) -> Floats:
        k = np.clip(np.searchsorted(frequency, at, side="right") - 1, 0, len(step) - 1)
        share = (at - frequency[k]) / step[k]
        rest = 1.0 - share
        from_start = slope[k] - secant[k]
        from_end = slope[k + 1] - secant[k]
        line = level[k] + share * (level[k + 1] - level[k])
        bend = share * rest * step[k] * (from_start * rest - from_end * share)
        with np.errstate(divide="ignore", over="ignore", under="ignore"):
            value = np.exp(line + bend) * (at**power if power else 1.0)
        return np.asarray(np.where(np.isnan(value), np.inf, value), np.float64)

    return threshold


def _towards_zero(frequency: Floats, level: Floats) -> float:
    """The parabola, line or constant through up to three samples, at frequency zero."""
    known = np.isfinite(level)
    count = len(level) if known.all() else int(np.argmin(known))
    total = 0.0 if count else np.nan
    for k in range(count):
        others = np.delete(frequency[:count], k)
        total += float(level[k] * np.prod(others / (others - frequency[k])))
    return total


def _slopes(step: Floats, secant: Floats) -> Floats:
    """Slope at each sample: of the parabola through it and two neighbours, or of the one secant."""
    known = np.isfinite(secant)
    left = np.concatenate([[np.nan], secant])
    right = np.concatenate([secant, [np.nan]])
    before = np.concatenate([[1.0], step])
    after = np.concatenate([step, [1.0]])
    middle = (after * left + before * right) / (before + after)
    slope = np.where(np.isfinite(left), left, right)
    slope = np.where(np.isfinite(middle), middle, slope)
    for here, next_to, end in _ends(known):
        share = step[here] / (step[here] + step[next_to])
        slope[end] = secant[here] + share * (secant[here] - secant[next_to])
    return np.asarray(slope, np.float64)


def _ends(known: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> list[tuple[int, int, int]]:
    """Last secant at each end of a run of two or more known ones, its neighbour, and the sample."""
    padded = np.concatenate([[False], known, [False]])
    first = np.flatnonzero(padded[1:-1] & ~padded[:-2])
    last = np.flatnonzero(padded[1:-1] & ~padded[2:])
    secants = []
    for low, high in zip(first.tolist(), last.tolist(), strict=True):
        if high > low:
            secants += [(low, low + 1, low), (high, high - 1, high + 1)]
    return secants
