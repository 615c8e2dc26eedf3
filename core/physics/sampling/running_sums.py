"""Integrals of sampled values between any two places, by their running sums.

What lies between samples is taken as `area`: each holds all over its extent, as block means have
it, and nothing overshoots; `bilinear`: straight from centre to centre; `cubic`: parabolas that
join, and keep each sample's mean. The last two have a straight ramp exactly.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Array = NDArray[Any]
Between = Literal["area", "bilinear", "cubic"]
PAD = 2  # samples beyond those between two places that `between` looks at


def running_sums(samples: Array, axis: int) -> Vector:
    """Sums of all samples before each border: one more along the axis than samples."""
    shape = list(samples.shape)
    shape[axis] += 1
    sums = np.zeros(shape)
    after = (slice(None),) * axis + (slice(1, None),)
    np.cumsum(samples, axis=axis, out=sums[after])
    return sums


def between(sums: Vector, places: Vector, kind: Between, axis: int) -> Vector:
    """Integral from the first border up to places along one axis of (rows, columns).

    The running sums are along that axis. Places count in samples from the first border, `PAD`
    within the first and last; of length 1 along the other axis where they are the same there.
    """
    base, weights = taps(places, kind, sums.shape[axis] - 1)
    return weighted(sums, base, weights, axis)


def weighted(
    sums: Vector, base: NDArray[np.intp], weights: Iterable[tuple[int, Vector]], axis: int
) -> Vector:
    """Weighted sum of values near a base along an axis, as `taps` gives them."""
    total: Vector | None = None
    for index, weight in weights:
        term = picked(sums, base + index, axis)
        term *= weight
        total = term if total is None else np.add(total, term, out=total)
    assert total is not None
    return total


def picked(values: Vector, index: NDArray[np.intp], axis: int) -> Vector:
    """Values at an index along an axis: one for all rows, or columns, or one for each."""
    if index.shape[1 - axis] == 1:
        return np.asarray(np.take(values, index.ravel(), axis=axis))
    columns = values.shape[1]
    if axis == 1:
        flat = index + np.arange(len(index))[:, np.newaxis] * columns
    else:
        flat = index * columns + np.arange(columns)
    return np.asarray(np.take(values, flat))


def taps(
    places: Vector, kind: Between, samples: int
) -> tuple[NDArray[np.intp], list[tuple[int, Vector]]]:
    """The running sums, counted from a base, whose weighted sum is the integral up to a place.

    `bilinear`: the mean over a sample's width of the sums joined straight. `cubic`: Catmull and
    Rom's curve through the sums.
    """
    if kind == "bilinear":
        base = np.rint(places).astype(np.intp)
        t = places - base
        return base, [
            (-1, 0.5 * (0.5 - t) ** 2),
            (0, 0.75 - t * t),
            (1, 0.5 * (0.5 + t) ** 2),
        ]
    base = np.minimum(places.astype(np.intp), samples - 1)
    t = places - base
    if kind == "area":
        return base, [(0, 1.0 - t), (1, t)]
    return base, list(cubic_weights(t))


def cubic_weights(t: Any) -> tuple[tuple[int, Any], ...]:
    """Samples, counted from the one before a place, and their weights at t from it.

    Source: Catmull and Rom 1974; Keys 1981, IEEE Trans. ASSP 29, with a = −1/2.
    """
    return (
        (-1, t * (-0.5 + t * (1.0 - 0.5 * t))),
        (0, 1.0 + t * t * (-2.5 + 1.5 * t)),
        (1, t * (0.5 + t * (2.0 - 1.5 * t))),
        (2, t * t * (-0.5 + 0.5 * t)),
    )
