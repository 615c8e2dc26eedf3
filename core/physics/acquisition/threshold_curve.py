"""A contrast threshold between its samples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.physics.numerics.array_checks import Values

Threshold = Callable[[Values], Values]


def interpolated(*, frequency: Values, ctf: Values) -> Threshold:
    """The function through samples of a contrast threshold.

    Parameters
    ----------
    frequency
        Rising, zero or above, shape (n,), n at least 2.
    ctf
        Threshold at them, above zero or infinite, shape (n,); at frequency zero also zero.

    Returns
    -------
    callable
        Threshold at an array of frequencies within those of the samples; infinite between a
        finite and an infinite sample.

    Notes
    -----
    The logarithm is interpolated by Hermite's cubics, whose slopes are those of parabolas through
    three samples: the error is of the third order in the step. A threshold that is zero at
    frequency zero rises as the frequency (MRTD), one that is infinite falls as its inverse (eye):
    that power is taken out before and put back after.
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
