"""Chebyshev fits of smooth functions, for arrays too large for the direct formula."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_FIT_SIZES = (24, 48, 96)
_FIT_TOLERANCE = 4e-16


def chebyshev_fit(function: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Coefficients of a smooth function on [-1, 1], as many as double precision can use.

    Parameters
    ----------
    function
        Takes and returns an array of shape (n,).

    Returns
    -------
    Array of coefficients of the Chebyshev polynomials T0, T1, …

    Source: Trefethen 2013, Approximation Theory and Approximation Practice, chapters 3 and 8.
    """
    for size in _FIT_SIZES:
        angles = np.pi * (np.arange(size) + 0.5) / size
        values = function(np.cos(angles))
        waves = np.cos(np.outer(np.arange(size), angles))
        coefficients: FloatArray = 2.0 / size * (waves @ values)
        coefficients[0] /= 2.0
        floor = _FIT_TOLERANCE * max(np.max(np.abs(coefficients)), np.finfo(float).tiny)
        used = np.flatnonzero(np.abs(coefficients) > floor)
        length = int(used[-1]) + 1 if used.size else 1
        if length <= size - 4:
            break
    return coefficients[:length]


def chebyshev_sum(coefficients: FloatArray, places: FloatArray) -> FloatArray:
    """Sum of Chebyshev polynomials at `places` in [-1, 1], by Clenshaw's recurrence.

    Source: Clenshaw 1955, Mathematics of Computation 9, 118.
    """
    doubled = places + places
    later, latest = np.zeros_like(places), np.zeros_like(places)
    scratch = np.empty_like(places)
    for coefficient in coefficients[:0:-1]:
        np.multiply(doubled, latest, out=scratch)
        scratch -= later
        scratch += coefficient
        later, latest, scratch = latest, scratch, later
    np.multiply(places, latest, out=scratch)
    scratch -= later
    scratch += coefficients[0]
    return scratch
