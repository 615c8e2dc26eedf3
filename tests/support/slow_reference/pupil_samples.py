"""A sampled pupil: its samples, wavefront error, autocorrelation lag by lag, and in between."""

import numpy as np

from slow_reference.numbers import PI, like
from slow_reference.pupil_area import inside

# Noll 1976, table I, in x = ρ·cos θ and y = ρ·sin θ; from j = 1, of unit rms over the disc.
NOLL = (
    lambda x, y: 1 + 0 * x * y,
    lambda x, y: 2 * x + 0 * y,
    lambda x, y: 2 * y + 0 * x,
    lambda x, y: root(x, 3) * (2 * (x * x + y * y) - 1),
    lambda x, y: root(x, 6) * 2 * x * y,
    lambda x, y: root(x, 6) * (x * x - y * y),
    lambda x, y: root(x, 8) * (3 * (x * x + y * y) - 2) * y,
    lambda x, y: root(x, 8) * (3 * (x * x + y * y) - 2) * x,
    lambda x, y: root(x, 8) * (3 * x * x - y * y) * y,
    lambda x, y: root(x, 8) * (x * x - 3 * y * y) * x,
    lambda x, y: root(x, 5) * (6 * (x * x + y * y) ** 2 - 6 * (x * x + y * y) + 1),
)


def root(x, number):
    return np.sqrt(like(x, number))


def places(kind, size, fine):
    """Centres of the samples, in whole samples from the middle, each divided into `fine`."""
    return (2 * np.arange(size * fine) - (size * fine - 1)).astype(kind) / (2 * fine)


def transmission(p, kind, fine=1):
    x, y = places(kind, p["size_x"], fine), places(kind, p["size_y"], fine)[:, np.newaxis]
    return inside(p, x, y).astype(kind)


def with_wavefront(p, samples, ratio, fine=1):
    """Samples times exp(2πi·W), W in waves scaled by `ratio`."""
    kind = samples.dtype.type
    rows, columns = samples.shape
    y, x = (places(kind, size // fine, fine) / kind(p["radius"]) for size in (rows, columns))
    y = y[:, np.newaxis]
    waves = p["defocus_waves"] * (x * x + y * y)
    for coefficient, polynomial in zip(p["zernike_waves"], NOLL, strict=False):
        waves = waves + coefficient * polynomial(x, y)
    angle = 2 * kind(PI) * ratio * waves
    return samples * (np.cos(angle) + 1j * np.sin(angle))


def autocorrelation(samples):
    """Σ P(p + s)·P*(p) / Σ|P|² at every whole lag, zero in the middle: row by row of the pupil."""
    rows, columns = samples.shape
    found = np.zeros((2 * rows - 1, 2 * columns - 1), samples.dtype)
    for one in range(rows):
        for other in range(rows):
            line = np.convolve(samples[one], np.conj(samples[other, ::-1]))
            found[rows - 1 + one - other] += line
    return found / np.sum(np.abs(samples) ** 2)


def between(correlation, lag_x, lag_y, interpolation):
    """Interpolated by two or, in triangles, three numbers for each lag; 0 beyond the outermost.

    Whole lags are counted away from zero lag, and a triangle's long side leaves from there.
    """
    lag_x, lag_y = np.broadcast_arrays(lag_x, lag_y)
    rows, columns = correlation.shape
    framed = np.pad(correlation, 2)
    x, y = (
        np.minimum(np.abs(lag), size // 2 + 1) for lag, size in ((lag_x, columns), (lag_y, rows))
    )
    left, low = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - left, y - low
    side_x, side_y = np.where(lag_x < 0, -1, 1), np.where(lag_y < 0, -1, 1)

    def at(right, up):
        row, column = side_y * (low + up), side_x * (left + right)
        return framed[row + rows // 2 + 2, column + columns // 2 + 2]

    if interpolation == "bilinear":
        lower = at(0, 0) * (1 - u) + at(1, 0) * u
        return lower * (1 - v) + (at(0, 1) * (1 - u) + at(1, 1) * u) * v
    under = at(0, 0) * (1 - u) + at(1, 0) * (u - v) + at(1, 1) * v
    over = at(0, 0) * (1 - v) + at(0, 1) * (v - u) + at(1, 1) * u
    return np.where(u >= v, under, over)
