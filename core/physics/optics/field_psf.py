"""Blur that changes over the field, in overlapping tiles.

The frame is parted into square cells. Each corner of a cell has the OTF of its place; within the
cell the pictures blurred by these four are weighted bilinearly. So every sample has a PSF that is
interpolated between the corners, with an error that falls with the square of the cell's side.

Source: Nagy and O'Leary 1998, SIAM J. Sci. Comput. 19, 1063 (interpolated PSFs).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True)
class Cell:
    """Cells of one axis: samples `start` … `stop` − 1 lie between the nodes at `low` and `high`."""

    start: int
    stop: int
    low: float
    high: float

    @property
    def weights(self) -> tuple[Array, Array]:
        """Of the lower and the higher node, for each sample."""
        share = (np.arange(self.start, self.stop) - self.low) / (self.high - self.low)
        return 1.0 - share, share


def cells_of(*, size: int, tile: int) -> tuple[Cell, ...]:
    """Cells that cover `size` samples, `tile` samples wide and symmetric about the middle."""
    count = max(1, math.ceil((size - 1) / tile))
    first = 0.5 * (size - 1 - count * tile)
    nodes = [first + number * tile for number in range(count + 1)]
    starts = [0, *(math.ceil(node) for node in nodes[1:-1]), size]
    ends = zip(starts[:-1], starts[1:], nodes[:-1], nodes[1:], strict=True)
    return tuple(Cell(*end) for end in ends)


def field_frequencies(*, xi: Array, eta: Array, x: float, y: float) -> tuple[Array, Array]:
    """Frequencies across and along of a lens' data, at the place x, y of the field.

    The data belong to a place straight above the axis: their columns run across, their rows point
    to the axis. So the tangential frequency, along the radius, is the second one.
    """
    angle = math.atan2(x, -y) if x or y else 0.0
    cos, sin = math.cos(angle), math.sin(angle)
    return xi * cos + eta * sin, eta * cos - xi * sin


def blended(*, patch: Array, otfs: Sequence[Array], along: Cell, across: Cell, reach: int) -> Array:
    """A cell's samples, blurred by the OTFs at its corners, those of the upper ones first.

    The patch, of shape (n, n), begins `reach` samples before the cell; the OTFs are at the
    frequencies of its `rfft2`.
    """
    spectrum = scipy.fft.rfft2(patch)
    weights = [np.multiply.outer(v, h) for v in along.weights for h in across.weights]
    rows, columns = weights[0].shape
    total = np.zeros((rows, columns), patch.dtype)
    for otf, weight in zip(otfs, weights, strict=True):
        made = scipy.fft.irfft2(spectrum * otf, patch.shape)
        total += made[reach : reach + rows, reach : reach + columns] * weight.astype(patch.dtype)
    return total


def light_within(*, otf: Array, side: int, reach: int) -> float:
    """Share of a PSF's light that falls within `reach` samples along both axes."""
    psf = scipy.fft.irfft2(otf, (side, side))
    near = np.abs(scipy.fft.fftfreq(side, 1.0 / side)) <= reach
    return float(psf[near][:, near].sum() / psf.sum())


def blending_error(*, otfs: Sequence[Array], own: Array, side: int, reach: int) -> float:
    """Limit of a sample's error that blends these OTFs alike, as a share of the picture's range.

    Half the sum of the moduli of the difference of the PSFs, and what of its own PSF lies beyond
    `reach` samples, which a patch of this side folds back. Both are seen through a mean of
    neighbours, 1/4, 1/2, 1/4: for pictures without detail at Nyquist's frequency.
    """
    means = [np.square(np.cos(np.pi * f)) for f in
             (scipy.fft.fftfreq(side), scipy.fft.rfftfreq(side))]  # fmt: skip
    smooth = np.multiply.outer(*means)
    mean = sum(otfs[1:], start=otfs[0]) / len(otfs)
    blend = scipy.fft.irfft2((mean - own) * smooth, (side, side))
    spread = scipy.fft.irfft2(own * smooth, (side, side))
    far = np.abs(scipy.fft.fftfreq(side, 1.0 / side)) > reach
    beyond = np.abs(spread[far[:, np.newaxis] | far]).sum()
    return float(0.5 * np.abs(blend).sum() + beyond)
