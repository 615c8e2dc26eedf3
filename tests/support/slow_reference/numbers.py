"""Constants, intervals and Fourier matrices in the type of the samples they are for."""

from functools import lru_cache

import numpy as np

PI = np.longdouble("3.14159265358979323846264338327950288")


def like(values, number):
    """The number as precise as the values are."""
    return values.dtype.type(number)


def sinc(x):
    turn = like(x, PI) * x
    return np.where(x == 0, 1, np.sin(turn) / np.where(x == 0, 1, turn))


def turns(kind, parts, size):
    """exp(2πi·parts/size) of whole numbers, which are reduced before anything is rounded."""
    angle = 2 * kind(PI) * (np.asarray(parts) % size).astype(kind) / size
    return np.cos(angle) + 1j * np.sin(angle)


@lru_cache(maxsize=48)
def periodic_matrices(kind, size):
    """Matrices from samples to their Fourier sums and back."""
    index = np.arange(size)
    back = turns(kind, np.outer(index, index), size)
    return np.conj(back), back / size


@lru_cache(maxsize=48)
def mirrored_matrices(kind, size):
    """From samples to the Fourier sums of the frame mirrored at its end, and back to the frame."""
    index = np.arange(2 * size)
    back = turns(kind, np.outer(index, index), 2 * size)
    forward = np.conj(back)
    # The mirrored frame repeats each sample: sums over it are sums of two columns.
    return forward[:, :size] + forward[:, : size - 1 : -1], back[:size] / (2 * size)


def frequencies(interval, size, edges):
    """Cycles per unit of the interval, in the order of the sums; Nyquist is negative."""
    number = 2 * size if edges == "reflect" else size
    index = np.arange(number)
    signed = np.where(2 * index >= number, index - number, index)
    return signed.astype(interval.dtype) / (number * interval)
