"""Filtering by direct sums: forward matrix, transfer function, backward matrix."""

import numpy as np

from slow_reference.camera import at_places
from slow_reference.numbers import frequencies, mirrored_matrices, periodic_matrices


def matrices(samples, edges):
    kind = samples.dtype.type
    make = mirrored_matrices if edges == "reflect" else periodic_matrices
    return make(kind, samples.shape[0]), make(kind, samples.shape[1])


def filtered(samples, transfer, intervals, edges):
    """The frame behind `transfer`, a function of xi (a row) and eta (a column)."""
    (down, up), (across, back) = matrices(samples, edges)
    h = hermitian(transfer, intervals, samples.shape, edges)
    return (up @ (down @ samples @ across.T * h) @ back.T).real


def filtered_at(samples, transfer, intervals, edges, places):
    """The waves of the frame behind `transfer` between its samples, at (down, across) places."""
    (down, _), (across, _) = matrices(samples, edges)
    h = hermitian(transfer, intervals, samples.shape, edges)
    kind = samples.dtype.type
    up, back = (
        at_places(place, size, edges, kind)
        for place, size in zip(places, samples.shape, strict=True)
    )
    return (up @ (down @ samples @ across.T * h) @ back.T).real


def filtered_lines(samples, transfer, interval, edges):
    """Each line behind `transfer`, a function of xi alone."""
    _, (across, back) = matrices(samples, edges)
    xi = frequencies(interval, samples.shape[1], edges)
    h = transfer(xi)
    if edges == "periodic" and len(xi) % 2 == 0:
        h[len(xi) // 2] = h[len(xi) // 2].real
    return (samples @ across.T * h @ back.T).real


def crossed(modulus, phase, transfer, shape, intervals):
    """Modulus of one frame's spectrum with the phase of another's; a missing one is 1.

    Also the change by an error of 1 in each sample of the other frame, the errors independent: the
    phase of what is hardly there is hardly known.
    """
    h = hermitian(transfer, intervals, shape, "periodic")
    kind = intervals[0].dtype.type
    (down, up), (across, back) = (periodic_matrices(kind, size) for size in shape)
    size = 1 if modulus is None else np.abs(down @ modulus @ across.T)
    if phase is None:
        return (up @ (size * h) @ back.T).real, 0.0
    other = down @ phase @ across.T
    sizes = np.abs(other)
    doubt = np.sqrt(np.sum(np.abs(size * h / sizes) ** 2) / h.size)
    return (up @ (size * other / sizes * h) @ back.T).real, doubt


def hermitian(transfer, intervals, shape, edges):
    """H on the grid of the sums; at Nyquist, which stands for both signs, their mean.

    A mirrored frame has nothing at Nyquist, so that its value there does not matter.
    """
    xi = frequencies(intervals[0], shape[1], edges)
    eta = frequencies(intervals[1], shape[0], edges)
    h = transfer(xi[np.newaxis, :], eta[:, np.newaxis])
    if edges == "reflect":
        return h
    row, column = shape[0] // 2, shape[1] // 2
    if shape[0] % 2 == 0:
        h[row] = (h[row] + transfer(xi[np.newaxis, :], -eta[row : row + 1, np.newaxis])[0]) / 2
    if shape[1] % 2 == 0:
        last = -xi[np.newaxis, column : column + 1]
        other = transfer(last, eta[:, np.newaxis])[:, 0]
        if shape[0] % 2 == 0:
            turned = transfer(last, -eta[row : row + 1, np.newaxis])[0, 0]
            other[row] = (other[row] + turned) / 2
        h[:, column] = (h[:, column] + other) / 2
    return h
