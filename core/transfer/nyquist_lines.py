"""What acts at the Nyquist row and column of an even frame: the Hermitian part of H.

There +Nyquist and −Nyquist are one frequency of the samples, whose spectrum must stay that of a
real picture: the mean of H at both acts (Oppenheim and Schafer 1989, Discrete-Time Signal
Processing, on the symmetries of the transform of a real sequence).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
OnPlane = Callable[[Array, Array], Array]
Lines = tuple[slice | int, slice | int]


def nyquist_lines(function: OnPlane, xi: Array, eta: Array) -> Iterator[tuple[Lines, Array]]:
    """Means over both signs of Nyquist's frequencies, on the lines where there are two.

    Parameters
    ----------
    function : callable
        Of xi (columns,) and eta (rows,), gives values of shape (rows, columns).
    xi, eta : ndarray
        Frequencies of a plain FFT, in its order.

    Yields
    ------
    place : index of a row, or a column, of the plane
    mean : ndarray
        Mean of the values there, shape (columns,) or (rows,).
    """
    across, along = _turned(xi), _turned(eta)
    for axis, signs in ((0, along), (1, across)):
        if signs is None:
            continue
        place = len(signs) // 2
        on_line = slice(place, place + 1)
        whole: Lines = (place, slice(None)) if axis == 0 else (slice(None), place)
        total: Array | None = None
        for x in (xi, xi if across is None else across):
            for y in (eta, eta if along is None else along):
                value = function(x, y[on_line]) if axis == 0 else function(x[on_line], y)
                total = value if total is None else total + value
        assert total is not None
        yield whole, 0.25 * total.ravel()


def _turned(frequency: Array) -> Array | None:
    """The same frequencies with Nyquist's of the other sign; None of an odd size."""
    size = len(frequency)
    if size % 2:
        return None
    turned = np.array(frequency, np.float64)
    turned[size // 2] *= -1.0
    return turned
