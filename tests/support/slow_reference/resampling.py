"""Combining, interpolating and low-passing samples, sample by sample."""

from fractions import Fraction
from functools import lru_cache

import numpy as np

from slow_reference.filtering import filtered
from slow_reference.numbers import PI, like, turns

REACH = 3  # samples to either side that a cubic may touch, and one


def combined(samples, across, along, mode):
    """Mean or sum of whole blocks; what is left over at the far ends is dropped."""
    rows, columns = samples.shape[0] // along, samples.shape[1] // across
    whole = samples[: rows * along, : columns * across]
    total = whole.reshape(rows, along, columns, across).sum(axis=(1, 3))
    return total / (along * across) if mode == "mean" else total


def interpolated(samples, width, height, order, edges=None):
    up = weights(samples.dtype.type, samples.shape[0], height, order, edges)
    across = weights(samples.dtype.type, samples.shape[1], width, order, edges)
    return up @ samples @ across.T


@lru_cache(maxsize=256)
def weights(kind, old, new, order, edges):
    """What each new sample takes of each old one, beyond the ends of what stands there.

    That is the frame mirrored, or repeated, or without edges its last sample.
    """
    if old == new:
        return np.eye(old, dtype=kind)
    matrix = np.zeros((new, old), kind)
    for row in range(new):
        # Centres lie half a sample from the frame's ends.
        place = Fraction(2 * row + 1, 2) * Fraction(old, new) - Fraction(1, 2)
        for index in range(int(place) - REACH, int(place) + REACH + 1):
            share = kernel(place - index, order)
            matrix[row, beyond(index, old, edges)] += kind(share.numerator) / share.denominator
    return matrix


def beyond(index, size, edges):
    if edges is None:
        return min(max(index, 0), size - 1)
    if edges == "periodic":
        return index % size
    while not 0 <= index < size:
        index = -1 - index if index < 0 else 2 * size - 1 - index
    return index


def kernel(distance, order):
    """Nearest (of two as near the later), linear, or Keys 1981 with a = −1/2."""
    s = abs(distance)
    if order == 0:
        half = Fraction(1, 2)
        return Fraction(s < half or distance == -half)
    if order == 1:
        return max(Fraction(0), 1 - s)
    if s <= 1:
        return Fraction(3, 2) * s**3 - Fraction(5, 2) * s**2 + 1
    return -(s**3) / 2 + 5 * s**2 / 2 - 4 * s + 2 if s < 2 else Fraction(0)


def anti_aliased(samples, kernel_name, factor):
    """The mirrored frame behind a low-pass of `factor` samples in x and in y."""
    one = like(samples, 1)

    def axis(f):
        return LOW_PASSES[kernel_name](f, factor)

    return filtered(samples, lambda xi, eta: axis(xi) * axis(eta), (one, one), "reflect")


def box(f, factor):
    """Transform of the mean of `factor` samples about the middle, written as their sum."""
    shifts = np.arange(factor) - like(f, factor - 1) / 2
    return np.cos(2 * like(f, PI) * np.multiply.outer(f, shifts)).mean(axis=-1)


def gaussian(f, factor):
    """One half at the Nyquist frequency of the samples that are left."""
    return np.exp2(-((f * 2 * factor) ** 2))


def lanczos(f, factor):
    """sinc(k/n)·sinc(k/3n), |k| < 3n, over its sum."""
    k = np.arange(1 - 3 * factor, 3 * factor)
    kind = f.dtype.type
    place = np.where(k == 0, 1, k)
    wave = turns(kind, k, 2 * factor).imag * turns(kind, k, 6 * factor).imag
    taps = np.where(k == 0, 1, wave * 3 * factor**2 / (kind(PI) * place) ** 2)
    return np.cos(2 * kind(PI) * np.multiply.outer(f, k)) @ taps / taps.sum()


LOW_PASSES = {"box": box, "gaussian": gaussian, "lanczos": lanczos}
