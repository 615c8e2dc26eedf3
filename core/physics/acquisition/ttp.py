"""The targeting task performance (TTP) value of a target seen through a sensor.

Unlike Johnson's cycles, which depend only on the highest frequency resolved, it sums at all
frequencies how far the target's contrast is above the contrast threshold of sensor and eye.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.acquisition.target_acquisition import target_cycles
from core.physics.checks import Values, all_above_zero, all_from_zero, broadcast, rising
from core.physics.numerics import gauss_legendre

Threshold = Callable[[Values], Values]
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


class TtpThreshold:
    """A contrast threshold with its sums: TTP values V of targets of many contrasts.

    Parameters
    ----------
    frequency
        Frequencies in cycles/mrad, rising, shape (n,). The first and last bound the sum.
    ctf
        Contrast threshold function of sensor and eye at them, zero or above, shape (n,): zero at
        the first only, infinite where nothing is seen.

    Notes
    -----
    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806 (the equation's number could
    not be checked); the bounds of the sum are where C = CTF. With thresholds across and along, V is
    the root of the product of both. Samples are joined as in `interpolated`. The sum is
    Gauss-Legendre's between neighbouring frequencies, and the places where C = CTF, of which there
    may be one between two.
    """

    def __init__(self, frequency: ArrayLike, ctf: ArrayLike) -> None:
        self._places = places = rising("frequency", frequency, unit="cyc/mrad")
        curve = all_from_zero("ctf", ctf, infinite=True)
        if curve.shape != places.shape:
            allowed = f"an array of the same shape as frequency, {places.shape}"
            raise ParameterError("ctf", f"an array of shape {curve.shape}", allowed)
        zeros = np.flatnonzero((curve == 0.0) & (places > 0.0))
        if len(zeros):
            raise ParameterError(f"ctf[{zeros[0]}]", 0.0, "above 0 at every frequency above 0")
        self._ctf = interpolated(frequency=places, ctf=curve)
        self._levels = self._ctf(places)
        self._whole = _panels(self._ctf, places[:-1], places[1:])

    def value(self, contrast: ArrayLike, target_area_m2: ArrayLike, range_m: ArrayLike) -> Any:
        """V = √A/R·∫√(C/CTF) df over all frequencies at which C is above CTF.

        Of contrasts C at the sensor, in the unit of the threshold (an apparent temperature
        difference, where that is an MRTD), areas A in m² and ranges R in m, which broadcast.
        """
        level, area, distance = broadcast(
            contrast=all_from_zero("contrast", contrast),
            target_area_m2=all_above_zero("target_area_m2", target_area_m2, unit="m²"),
            range_m=all_above_zero("range_m", range_m, unit="m"),
        )
        return target_cycles(self._summed(level), np.sqrt(area), distance)[()]

    def _summed(self, contrast: Values) -> Values:
        """∫√(C/CTF) df where C > CTF, of the shape of `contrast`."""
        places, levels = self._places, contrast.ravel()
        seen = self._levels < levels[:, np.newaxis]
        inside = (seen[:, :-1] & seen[:, 1:]) @ self._whole
        which, crossed = np.nonzero(seen[:, :-1] != seen[:, 1:])
        low, high, seen_low = places[crossed], places[crossed + 1], seen[which, crossed]
        meet = _crossings(self._ctf, levels[which], low, high, seen_low)
        parts = _panels(self._ctf, np.where(seen_low, low, meet), np.where(seen_low, meet, high))
        inside += np.bincount(which, parts, len(levels))
        return np.asarray((np.sqrt(levels) * inside).reshape(contrast.shape), np.float64)


def _panels(ctf: Threshold, low: Values, high: Values) -> Values:
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
    ctf: Threshold, level: Values, low: Values, high: Values, seen_low: NDArray[np.bool_]
) -> Values:
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


def interpolated(*, frequency: Values, ctf: Values) -> Threshold:
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

    def threshold(at: Values) -> Values:
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


def _towards_zero(frequency: Values, level: Values) -> float:
    """The parabola, line or constant through up to three samples, at frequency zero."""
    known = np.isfinite(level)
    count = len(level) if known.all() else int(np.argmin(known))
    total = 0.0 if count else np.nan
    for k in range(count):
        others = np.delete(frequency[:count], k)
        total += float(level[k] * np.prod(others / (others - frequency[k])))
    return total


def _slopes(step: Values, secant: Values) -> Values:
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
