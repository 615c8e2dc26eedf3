"""A picture in blocks of 8 × 8 samples: the level of a block, and its power by frequency.

White noise has the same variance in all coefficients of an orthonormal cosine transform, and those
of normal noise are independent. So the blocks can be chosen by some coefficients, and the noise
measured in others: the choice leaves no bias (Ponomarenko et al. 2007).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]

SIDE = 8
_STRIP = 64  # rows of blocks at a time
_ORDER = np.arange(SIDE)
_DOWN, _ACROSS = (order.ravel() for order in np.meshgrid(_ORDER, _ORDER, indexing="ij"))
_BOTH = (_DOWN > 0) & (_ACROSS > 0)  # neither a row's nor a column's own offset
FINE = (_DOWN >= SIDE // 2) & (_ACROSS >= SIDE // 2)  # where the scene's power is least
COARSE = _BOTH & (_DOWN + _ACROSS >= 3) & (_DOWN + _ACROSS <= 6)
MIDDLE = _BOTH & (_DOWN + _ACROSS >= 7) & ~FINE
MIDDLE_DOWN = MIDDLE & (_DOWN > _ACROSS)  # as many as the others, those finer across
_WAVES_DOWN = (_ACROSS == 0) & (_DOWN >= 1)
_WAVES_ACROSS = (_DOWN == 0) & (_ACROSS >= 1)
WAVES = SIDE - 2  # of rows or columns; the first one is mostly shading


@dataclass(frozen=True)
class PictureBlocks:
    """Blocks without bad samples, in the order of the picture's rows.

    Parameters
    ----------
    level : ndarray, shape (blocks,)
        Mean of the samples.
    power : ndarray, shape (blocks, 64)
        Squares of the coefficients, by frequency down and across; the first is 0.
    rows, columns : ndarray, shape (blocks, 6)
        Coefficients of the waves down, and across, with their signs, less a ramp through the block.
    place : ndarray of int, shape (blocks,)
        Which block of the picture: row of blocks times blocks in a row, plus column.
    grid : tuple of int
        Rows and columns of blocks of the picture.
    """

    level: Vector
    power: NDArray[np.float32]
    rows: NDArray[np.float32]
    columns: NDArray[np.float32]
    place: NDArray[np.intp]
    grid: tuple[int, int]

    def axis_power(self) -> Vector:
        """Mean square of the waves along one axis alone, of a block: edges along the axes too."""
        squares = np.square(self.rows).sum(axis=1) + np.square(self.columns).sum(axis=1)
        return np.asarray(squares / (2.0 * WAVES), np.float64)

    def mean_power(self, coefficients: Mask) -> Vector:
        """Mean square of these coefficients of a block."""
        chosen = np.flatnonzero(coefficients)
        weight = np.zeros(SIDE * SIDE, np.float32)
        weight[chosen] = 1.0 / len(chosen)
        return np.asarray(self.power @ weight, np.float64)


def picture_blocks(
    *, picture: Matrix, good: Mask | None = None, check: Callable[[], None] = lambda: None
) -> PictureBlocks:
    """Level and power of the blocks whose samples are all good.

    Parameters
    ----------
    picture : ndarray, shape (rows, columns)
        Samples; what is left of whole blocks at the right and below is not looked at.
    good : ndarray of bool, optional
        Which samples count; all.
    check : callable
        Called between strips; may raise to stop.
    """
    grid = picture.shape[0] // SIDE, picture.shape[1] // SIDE
    transform = _transform()
    level, power, rows, columns, place = [], [], [], [], []
    for first in range(0, grid[0], _STRIP):
        check()
        last = min(first + _STRIP, grid[0])
        samples = _in_blocks(picture, first, last, grid[1])
        at = np.arange(first * grid[1], last * grid[1])
        if good is not None:
            whole = _in_blocks(good, first, last, grid[1]).all(axis=1)
            samples, at = samples[whole], at[whole]
        mean = samples.mean(axis=1)
        residual = (samples - mean[:, np.newaxis]).astype(np.float32)
        coefficients = residual @ transform
        rows.append(_level_waves(coefficients[:, _WAVES_DOWN]))
        columns.append(_level_waves(coefficients[:, _WAVES_ACROSS]))
        level.append(mean)
        power.append(np.square(coefficients, out=coefficients))
        place.append(at)
    if not level:
        empty = np.zeros(0)
        waves = np.zeros((0, WAVES), np.float32)
        nothing = np.zeros((0, SIDE * SIDE), np.float32)
        return PictureBlocks(empty, nothing, waves, waves, np.zeros(0, np.intp), grid)
    return PictureBlocks(
        np.concatenate(level),
        np.concatenate(power),
        np.concatenate(rows),
        np.concatenate(columns),
        np.concatenate(place),
        grid,
    )


def _in_blocks(picture: NDArray[Any], first: int, last: int, across: int) -> NDArray[Any]:
    """Rows of blocks, samples of a block in a row."""
    strip = picture[first * SIDE : last * SIDE, : across * SIDE]
    blocks = strip.reshape(last - first, SIDE, across, SIDE).transpose(0, 2, 1, 3)
    return blocks.reshape(-1, SIDE * SIDE)


def _level_waves(waves: NDArray[np.float32]) -> NDArray[np.float32]:
    """Waves from the second on, less those of the ramp that the first one shows."""
    ramp = (_cosines()[1:] @ (_ORDER - _ORDER.mean())).astype(np.float32)
    return np.asarray(waves[:, 1:] - waves[:, :1] * (ramp[1:] / ramp[0]), np.float32)


def _transform() -> NDArray[np.float32]:
    """Orthonormal cosine transform of a block, to be multiplied from the right."""
    one = _cosines()
    return np.kron(one, one).T.astype(np.float32)


def _cosines() -> Matrix:
    """The waves of a line of samples (type II), orthonormal."""
    angle = math.pi * np.outer(_ORDER, _ORDER + 0.5) / SIDE
    one = math.sqrt(2.0 / SIDE) * np.cos(angle)
    one[0] = math.sqrt(1.0 / SIDE)
    return one
