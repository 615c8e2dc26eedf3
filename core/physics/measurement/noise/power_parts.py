"""Parts of the noise power of a picture: white, of rows, of columns, periodic lines."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.noise.flat_blocks import SIDE, FlatBlocks, PictureBlocks
from core.physics.measurement.noise.periodic_lines import PeriodicLine

Vector = NDArray[np.float64]

_LEAST_IN_ROW = 4  # flat blocks, for a median of a row of blocks
_LEAST_ROWS = 4  # rows of blocks
_NORMAL = 1.4826  # deviation over the median of absolute deviations, of a normal distribution
_MEDIAN = math.pi / 2.0  # variance of a median over that of a mean
_MEDIAN_SQUARE = 0.4549  # of a normal deviate
_FAR_SQUARE, _WITHIN_FAR, _MEAN_WITHIN = 9.0, 0.9973, 0.9733  # share, and mean square, below 3 σ
_ROUNDS = 30


@dataclass(frozen=True)
class LineNoise:
    """What whole rows, or columns, have of their own.

    Parameters
    ----------
    sigma : float
        Standard deviation of the rows' offsets; 0 where none shows.
    variance, variance_error : float
        Its unbiased square, which may come out below zero, and the standard error.
    """

    sigma: float
    variance: float
    variance_error: float

    @property
    def significant(self) -> bool:
        """Whether it stands out by three standard errors."""
        return self.variance > 3.0 * self.variance_error


@dataclass(frozen=True)
class NoisePower:
    """Variances of a sample by kind; None of rows or columns with too few flat areas.

    Parameters
    ----------
    white, white_error : float
        Of noise of equal power at all frequencies, rounding included, and the standard error.
    rows, columns : LineNoise or None
        Offsets of rows, and of columns, that hold across the picture.
    lines : tuple of PeriodicLine
        Sine waves all over the picture, the strongest first.
    """

    white: float
    white_error: float
    rows: LineNoise | None
    columns: LineNoise | None
    lines: tuple[PeriodicLine, ...]


def noise_power(
    *,
    blocks: PictureBlocks,
    flat: FlatBlocks,
    white: float,
    white_error: float,
    lines: tuple[PeriodicLine, ...] = (),
    check: Callable[[], None] = lambda: None,
) -> NoisePower:
    """Tell the parts of the power in the flat blocks apart.

    Parameters
    ----------
    blocks, flat
        Of the picture, and those of noise alone.
    white, white_error : float
        Variance of the white part.
    lines
        Periodic ones, which the blocks are free of.
    check : callable
        Called between steps; may raise to stop.
    """
    place = blocks.place[flat.chosen]
    down, across = np.divmod(place, blocks.grid[1])
    noise = flat.line.over(blocks.level[flat.chosen])
    rows = line_noise(waves=blocks.rows[flat.chosen], noise=noise, line=down)
    check()
    columns = line_noise(waves=blocks.columns[flat.chosen], noise=noise, line=across)
    return NoisePower(white, white_error, rows, columns, lines)


def line_noise(
    *, waves: NDArray[np.float32], noise: Vector, line: NDArray[np.intp]
) -> LineNoise | None:
    """Offsets of rows from the waves down of the blocks that lie side by side.

    Parameters
    ----------
    waves : ndarray, shape (blocks, waves)
        Coefficients of waves down, constant across.
    noise : ndarray, shape (blocks,)
        Variance of a sample of each.
    line : ndarray of int, shape (blocks,)
        Which row of blocks.

    Notes
    -----
    What a row has of its own is common to all blocks of it, and so in their median, beyond the
    chance that their scatter leaves there. An edge along some blocks does not move a median; along
    all of them it is left out, as more than three deviations of the others.
    """
    order = np.argsort(line, kind="stable")
    ends = np.flatnonzero(np.diff(line[order])) + 1
    middles, spreads, chances = [], [], []
    for part in np.split(order, ends):
        if len(part) < _LEAST_IN_ROW:
            continue
        values = waves[part] / np.sqrt(noise[part])[:, np.newaxis]
        middle = np.median(values, axis=0)
        # The deviation of few values comes out low by that much.
        less = len(part) / (len(part) - 0.8)
        spreads.append((less * _NORMAL * np.median(np.abs(values - middle), axis=0)) ** 2)
        middles.append(np.median(waves[part], axis=0))
        density = float(np.mean(1.0 / np.sqrt(noise[part])))  # at the median, of unlike normals
        chances.append(_MEDIAN / (len(part) * density**2))
    if len(middles) < _LEAST_ROWS:
        return None
    # Scatter beyond the white noise, that of structure, is that of its wave all over the picture.
    scatter = np.median(spreads, axis=0)
    square = np.square(middles).ravel().astype(np.float64)
    chance = np.outer(chances, scatter).ravel()
    if not chance.min() > 0.0:
        return None
    own, error = _common_variance(square, chance)
    # A wave down of offsets σ is SIDE · σ² in an orthonormal transform of SIDE equal columns.
    variance, error = own / SIDE, error / SIDE
    return LineNoise(math.sqrt(max(variance, 0.0)), variance, error)


def _common_variance(square: Vector, chance: Vector) -> tuple[float, float]:
    """Variance beyond chance that normal deviates with these squares have, and its error."""
    low, high = -float(chance.min()), float(square.max())
    for _ in range(60):
        middle = 0.5 * (low + high)
        if float(np.median(square / np.maximum(middle + chance, 1e-300))) > _MEDIAN_SQUARE:
            low = middle
        else:
            high = middle
    own = high
    for _ in range(_ROUNDS):
        total = max(own, 0.0) + chance
        near = square < _FAR_SQUARE * total
        weight = 1.0 / total[near] ** 2
        scale = _WITHIN_FAR / _MEAN_WITHIN
        before = own
        own = float(weight @ (scale * square[near] - chance[near]) / weight.sum())
        if abs(own - before) <= 1e-6 * float(total.mean()):
            break
    total = max(own, 0.0) + chance
    return own, math.sqrt(2.0 / float((1.0 / total**2).sum()))
