"""Transfer functions of resampling: means of pixels, and interpolation between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.checks import positive

Vector = NDArray[np.float64]


def block_mean_mtf(*, frequency: ArrayLike, interval_mrad: float, samples: int) -> Vector:
    """Mean of neighbouring samples, about the middle of the block.

    sin(πnfd)/(n·sin(πfd)) of n samples, signed, 1 at zero frequency.
    Source: Bracewell 1986, The Fourier Transform and Its Applications, the row of n impulses.
    """
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
        Signed, 1 at zero frequency. The places are symmetric about the old samples, so that this
        is all, but where `takes_the_later` of two: there `interpolation_ptf` belongs to it.

    Source: Keys 1981, IEEE Trans. ASSP 29, for the cubic weights; Park and Schowengerdt 1982,
    Applied Optics 21, for the mean over the places of samples.
    """
    response = _mean_response(frequency, interval_mrad, order, old, new)
    if takes_the_later(order=order, old=old, new=new):
        return np.asarray(np.abs(response) * _sign(response, old, new), np.float64)
    return np.asarray(response.real, np.float64)


def interpolation_ptf(
    *, frequency: ArrayLike, interval_mrad: float, order: int, old: int, new: int
) -> Vector:
    """Phase of the same mean: 0 but for nearest samples that lie half-way between two.

    Radians, between −π and π. Of every second, fourth, … sample it is πf·interval: the picture
    moves by half an old sample to −x, and loses nothing of its contrast.
    """
    response = _mean_response(frequency, interval_mrad, order, old, new)
    if takes_the_later(order=order, old=old, new=new):
        return np.asarray(np.angle(response * _sign(response, old, new)), np.float64)
    return np.zeros(response.shape)


def takes_the_later(*, order: int, old: int, new: int) -> bool:
    """Whether nearest samples include some half-way between two old ones, of which one is taken."""
    # At (2k + 1)·old/new/2 a whole number, which takes an even number of old ones a place.
    return order == 0 and (old // math.gcd(old, new)) % 2 == 0


def _sign(response: NDArray[np.complex128], old: int, new: int) -> Vector:
    """Sign of the MTF: of the real part, but for a shift of all samples alike."""
    return np.where((response.real < 0.0) & (old % new != 0), -1.0, 1.0)


def _mean_response(
    frequency: ArrayLike, interval_mrad: float, order: int, old: int, new: int
) -> NDArray[np.complex128]:
    """Mean over the places of new samples of what a wave of unit amplitude shows there."""
    step = positive("interval_mrad", interval_mrad, unit="mrad")
    cycles = 2.0 * np.pi * np.asarray(frequency, np.float64) * step
    places = new // math.gcd(old, new)
    total = np.zeros(cycles.shape, np.complex128)
    for place in range(places):
        # Where the sample lies from the old one before it, in whole numbers of 1/(2·new).
        t = ((2 * place + 1) * old - new) % (2 * new) / (2 * new)
        for offset, weight in _weights(t, order):
            total += weight * np.exp(1j * cycles * (offset - t))
    return np.asarray(total / places)


def _weights(t: float, order: int) -> tuple[tuple[int, float], ...]:
    """Old samples, counted from the one before, and what each weighs at t from it."""
    if order == 0:
        return ((0 if t < 0.5 else 1, 1.0),)
    return ((0, 1.0 - t), (1, t)) if order == 1 else cubic_weights(t)


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


# What samples made of other samples do to a wave, on average over where they lie.

Indices = NDArray[np.intp]


def resampling_response(
    *,
    frequency: Vector,
    places: Vector,
    base: Indices,
    further: Sequence[tuple[Indices, Vector]],
    share: Vector | None = None,
) -> Vector:
    """Modulus of the mean response of samples made of others, 1 at zero.

    `frequency` is in cycles per old sample, and the new samples lie at `places` counted in old
    ones. Each starts from the old sample `base`; `further` adds weight·(old sample at index − old
    sample at base). All count alike in the mean, or by their `share`. Where new samples lie evenly
    between old ones it is the transform of the interpolation's kernel, sinc² if linear; the fewer
    their places, the more it may differ.

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


# Where pixels lie among the samples of a scene, and the shift of their picture.

_WHOLE = 1e-6  # of a pixel that may lack at the frame's end: ratios come of rounded data sheets


def pixel_count(*, samples: int, ratio: float) -> int:
    """Whole pixels of `ratio` samples, which need not be whole, that fit a frame.

    At least 1; a millionth of the last pixel may lie beyond the frame. Refused where not one fits.
    """
    count = math.floor(samples / positive("ratio", ratio) + _WHOLE)
    if count < 1:
        raise DataError(f"a pixel of {ratio:g} samples does not fit a frame of {samples} samples")
    return count


def pixel_places(*, samples: int, ratio: float, offset: float = 0.0) -> Vector:
    """Middles of the pixels, counted in samples from the middle of the first sample.

    (m + 1/2 + offset)·ratio − 1/2, the offset in pixels. Without an offset, pixel m covers the same
    part of the frame as a block of samples, so that the picture does not move.
    """
    number = np.arange(pixel_count(samples=samples, ratio=ratio))
    return np.asarray((number + 0.5 + offset) * ratio - 0.5, np.float64)


def shifted_samples_ptf(*, frequency: ArrayLike, shift_mrad: float) -> Vector:
    """Phase of samples that lie `shift_mrad` further to +x than they are taken for.

    2π·frequency·shift, radians: the picture moves to −x. By the shift theorem.
    """
    return np.asarray(2.0 * np.pi * shift_mrad * np.asarray(frequency, np.float64), np.float64)
