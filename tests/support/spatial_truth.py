"""Blur by spreading samples in space, on frames really extended: no frequency anywhere."""

import mpmath
import numpy as np

MODES = {"reflect": "symmetric", "periodic": "wrap"}


def spread(picture, weights, before, axis, edges):
    """Sum of samples `before` … back along an axis, weighted; beyond the frame as `edges` say."""
    after = len(weights) - 1 - before
    pad = [(0, 0), (0, 0)]
    # What is `before` in the weights comes from later samples.
    pad[axis] = (after, before)
    frame = np.pad(np.asarray(picture, float), pad, mode=MODES[edges])
    size = picture.shape[axis]
    total = np.zeros(picture.shape)
    for place, weight in enumerate(weights):
        start = len(weights) - 1 - place
        total += weight * np.take(frame, range(start, start + size), axis=axis)
    return total


def blurred(picture, sigma, edges):
    """Gaussian of `sigma` samples, 2.6 or more: what aliases is below 1e-14."""
    reach = int(9 * sigma)
    places = np.arange(-reach, reach + 1)
    weights = np.exp(-((places / sigma) ** 2) / 2) / (sigma * np.sqrt(2 * np.pi))
    for axis in (0, 1):
        picture = spread(picture, weights, reach, axis, edges)
    return picture


def left_behind(picture, transfers, efficiency, edges):
    """Charge that lags n samples after N transfers: C(N + n − 1, n)·ε^N·(1 − ε)^n."""
    with mpmath.workdps(30):
        kept = mpmath.mpf(repr(efficiency))
        weight, weights = kept**transfers, []
        while len(weights) <= transfers * (1 - efficiency) / efficiency or weight > 1e-19:
            weights.append(float(weight))
            n = len(weights)
            weight *= (transfers + n - 1) * (1 - kept) / n
    return spread(picture, weights, 0, 1, edges)
