"""What samples made of other samples do to a wave, on average over where they lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]


def resampling_response(
    *,
    frequency: Vector,
    places: Vector,
    base: Indices,
    further: Sequence[tuple[Indices, Vector]],
    share: Vector | None = None,
) -> Vector:
    """Modulus of the mean response of samples made of others.

    Parameters
    ----------
    frequency : ndarray
        Cycles per old sample.
    places : ndarray, shape (new,)
        Where the new samples lie, in old samples.
    base : ndarray of int, shape (new,)
        Old sample that each new one starts from.
    further : sequence of (index, weight)
        What is added: weight·(old sample at index − old sample at base).
    share : ndarray, shape (new,), optional
        How much each new sample counts in the mean; all alike if not given.

    Returns
    -------
    ndarray
        1 at zero. Where new samples lie evenly between old ones it is the transform of the
        interpolation's kernel, sinc² if linear; the fewer their places, the more it may differ.

    Notes
    -----
    The mean is what an edge shows that crosses samples at all their places: what differs from
    place to place averages out. Source: Park & Schowengerdt 1982, Image sampling, reconstruction,
    and the effect of sample-scene phasing, Applied Optics 21, 3142.
    """
    share = np.ones(len(base)) if share is None else share
    own = share.copy()
    total = np.zeros(len(frequency), np.complex128)
    for index, weight in further:
        own -= share * weight
        total += _waves(frequency, index - places) @ (share * weight)
    total += _waves(frequency, base - places) @ own
    return np.asarray(np.abs(total) / np.sum(share), np.float64)


def _waves(frequency: Vector, away: Vector) -> NDArray[np.complex128]:
    return np.asarray(np.exp(2j * np.pi * np.outer(frequency, away)), np.complex128)


def folded(frequency: Vector) -> Vector:
    """Cycles per sample between −1/2 and 1/2 at which samples show the same wave."""
    return np.asarray(frequency - np.rint(frequency), np.float64)
