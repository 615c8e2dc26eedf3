"""Blocks of a picture free of its periodic lines, which would hide what is flat."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.noise.flat_blocks import (
    COARSE,
    FINE,
    FlatBlocks,
    PictureBlocks,
    flat_blocks,
    picture_blocks,
)
from core.physics.measurement.noise.line_patterns import scene_pattern
from core.physics.measurement.noise.periodic_lines import (
    PeriodicLine,
    fitted_lines,
    line_frequencies,
)

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]
Lines = tuple[PeriodicLine, ...]

_QUIET = 0.4  # of the blocks, in which lines are fitted to begin with
_EDGE = 4.0  # times the median power of waves along an axis
_ROUNDS = 2


def flat_without_lines(
    *,
    picture: Matrix,
    good: Mask | None,
    blocks: PictureBlocks,
    at: float,
    least: float,
    low: float | None,
    high: float | None,
    check: Callable[[], None],
) -> tuple[PictureBlocks, FlatBlocks | None, Lines, Lines]:
    """Blocks without periodic lines, the flat ones of them, these lines, and those of the scene.

    Parameters
    ----------
    picture, good
        Samples, and which of them count.
    blocks
        Of the picture as it is.
    at, least, low, high
        As `flat_blocks` takes them.
    check : callable
        Called between steps; may raise to stop.

    Notes
    -----
    Waves of a pattern of the scene are not taken off: they are few of many, and end where it does.
    """
    lines: Lines = ()
    frequencies = line_frequencies(picture=picture, check=check)
    if frequencies:
        structure = blocks.mean_power(COARSE) + blocks.axis_power()
        quiet = structure <= np.quantile(structure, _QUIET)
        variance = float(np.median(blocks.mean_power(FINE)[quiet]))
        lines = _fitted(picture, blocks, quiet, frequencies, variance)
    free = _less(picture, good, blocks, lines, check)
    flat = flat_blocks(blocks=free, at=at, least=least, low=low, high=high)
    for _ in range(_ROUNDS if lines else 0):
        check()
        if flat is None:
            break
        # An edge along an axis is none to the coarse waves, and all to a line's own.
        model = flat.line.over(free.level)
        across = free.axis_power() / model
        even = flat.chosen & (across <= _EDGE * np.median(across[flat.chosen]))
        places = tuple((line.across, line.down) for line in lines)
        structure = free.mean_power(COARSE) / model + across
        lines = _fitted(picture, free, even, places, flat.line.middle, structure)
        free = _less(picture, good, blocks, lines, check)
        flat = flat_blocks(blocks=free, at=at, least=least, low=low, high=high)
    pattern: Lines = ()
    if flat is not None and lines:
        sigma = math.sqrt(max(flat.line.middle, 0.0))
        pattern = scene_pattern(lines=lines, sigma=sigma, shape=picture.shape)
    if pattern:
        lines = tuple(line for line in lines if line not in pattern)
        free = _less(picture, good, blocks, lines, check)
        flat = flat_blocks(blocks=free, at=at, least=least, low=low, high=high)
    return free, flat, lines, pattern


def _less(
    picture: Matrix,
    good: Mask | None,
    blocks: PictureBlocks,
    lines: Lines,
    check: Callable[[], None],
) -> PictureBlocks:
    """Blocks of the picture less lines."""
    if not lines:
        return blocks
    rows, columns = np.ogrid[: picture.shape[0], : picture.shape[1]]
    free = picture.copy()
    for line in lines:
        check()
        free -= line.at(rows, columns)
    return picture_blocks(picture=free, good=good, check=check)


def _fitted(
    picture: Matrix,
    blocks: PictureBlocks,
    chosen: Mask,
    frequencies: tuple[tuple[float, float], ...],
    variance: float,
    structure: Vector | None = None,
) -> Lines:
    return fitted_lines(
        picture=picture,
        frequencies=frequencies,
        places=blocks.place[chosen],
        grid=blocks.grid,
        variance=variance,
        structure=None if structure is None else structure[chosen],
    )
