"""sin(πx)/(πx), exactly zero at the integers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Beyond this every float64 is an even integer, and the sinc is zero.
_LARGEST = 2.0**60


def sinc(x: ArrayLike) -> NDArray[np.float64]:
    """Normalised sinc, signed.

    Parameters
    ----------
    x : array_like
        Arguments without unit, any shape; infinite ones give 0.

    Returns
    -------
    ndarray of float64
        sin(πx)/(πx), 1 at x = 0 and 0 at every other integer.

    Notes
    -----
    The nearest integer is taken off before the sine (an exact subtraction), so the relative
    accuracy holds next to the zeros, where sin(π·x) of the whole argument has none left.
    """
    argument = np.clip(np.asarray(x, dtype=np.float64), -_LARGEST, _LARGEST)
    turns = np.rint(argument)
    sign = 1.0 - 2.0 * np.abs(np.fmod(turns, 2.0))
    scale = np.where(argument == 0.0, 1.0, np.pi * argument)
    wave = sign * np.sin(np.pi * (argument - turns))
    return np.asarray(np.where(argument == 0.0, 1.0, wave / scale), dtype=np.float64)
