"""Transfer functions of resampling: means of pixels, and interpolation between them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.scalar_checks import positive

Vector = NDArray[np.float64]


def block_mean_mtf(*, frequency: ArrayLike, interval_mrad: float, samples: int) -> Vector:
    """Mean of neighbouring samples, about the middle of the block.

    Parameters
    ----------
    frequency : array_like
        Cycles/mrad.
    interval_mrad : float
        From one sample to the next, above zero.
    samples : int
        Samples of a block, 1 or more.

    Returns
    -------
    ndarray
        sin(πnfd)/(n·sin(πfd)), signed, 1 at zero frequency.

    Raises
    ------
    ParameterError
        For an interval or number out of range.

    Notes
    -----
    Source: Bracewell 1986, The Fourier Transform and Its Applications, the row of n impulses.
    """
    if samples < 1:
        raise ParameterError("samples", samples, "1 or more")
    step = positive("interval_mrad", interval_mrad, unit="mrad")
    # The period of the function is that of the samples: nearest to zero no sine loses digits.
    cycles = np.asarray(frequency, np.float64) * step
    rest = cycles - np.round(cycles)
    sign = np.where((np.round(cycles) * (samples - 1)) % 2 == 0, 1.0, -1.0)
    return np.asarray(sign * np.sinc(samples * rest) / np.sinc(rest))


def interpolation_mtf(
    *, frequency: ArrayLike, interval_mrad: float, order: int, old: int, new: int
) -> Vector:
    """Interpolation of `old` samples to `new` ones over the same field, the mean over these.

    Parameters
    ----------
    frequency : array_like
        Cycles/mrad.
    interval_mrad : float
        From one old sample to the next, above zero.
    order : 0, 1 or 3
        Nearest sample, linear, or cubic convolution with a = −1/2.
    old, new : int
        Numbers of samples, 1 or more. The new ones lie at new/gcd(old, new) different places
        between the old ones; of very many, this is the transform of the interpolating kernel.

    Returns
    -------
    ndarray
        Real, as the places are symmetric about the old samples; 1 at zero frequency.

    Raises
    ------
    ParameterError
        For a value out of range or another order.

    Notes
    -----
    Source: Keys 1981, IEEE Trans. ASSP 29, for the cubic weights; Park and Schowengerdt 1982,
    Applied Optics 21, for the mean over the places of samples.
    """
    if order not in (0, 1, 3):
        raise ParameterError("order", order, "0, 1 or 3")
    for name, number in (("old", old), ("new", new)):
        if number < 1:
            raise ParameterError(name, number, "1 or more")
    step = positive("interval_mrad", interval_mrad, unit="mrad")
    cycles = 2.0 * np.pi * np.asarray(frequency, np.float64) * step
    places = new // math.gcd(old, new)
    total = np.zeros(cycles.shape)
    for place in range(places):
        # Where the sample lies from the old one before it, in whole numbers of 1/(2·new).
        t = ((2 * place + 1) * old - new) % (2 * new) / (2 * new)
        for offset, weight in _weights(t, order):
            total += weight * np.cos(cycles * (offset - t))
    return total / places


def _weights(t: float, order: int) -> tuple[tuple[int, float], ...]:
    """Old samples, counted from the one before, and what each weighs at t from it."""
    if order == 0:
        return ((0 if t < 0.5 else 1, 1.0),)
    if order == 1:
        return (0, 1.0 - t), (1, t)
    return (
        (-1, t * (-0.5 + t * (1.0 - 0.5 * t))),
        (0, 1.0 + t * t * (-2.5 + 1.5 * t)),
        (1, t * (0.5 + t * (2.0 - 1.5 * t))),
        (2, t * t * (-0.5 + 0.5 * t)),
    )
