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


# Which periodic lines are a pattern of the scene: bars have waves at multiples of a frequency.

_MOST = 9  # times the frequency of the pattern
_TWO = 2  # lines of a pattern that is strong; weak ones may be two by chance
_BINS = 0.5  # of the spectrum, by which a multiple may be missed


def scene_pattern(
    *, lines: tuple[PeriodicLine, ...], sigma: float, shape: tuple[int, int]
) -> tuple[PeriodicLine, ...]:
    """Lines at whole multiples of one frequency: three, or two and the strongest above the noise.

    Notes
    -----
    Bars and other repeated shapes of a scene have harmonics, folded where they pass half a cycle a
    sample; what electronics pick up is mostly one wave, or weak. The fundamental itself may be too
    low to be looked for.
    """
    if not lines:
        return ()
    best: tuple[PeriodicLine, ...] = ()
    for order in range(1, _MOST + 1):
        base = lines[0].across / order, lines[0].down / order
        family = tuple(line for line in lines if _is_multiple(line, base, order, shape))
        if len(family) > max(1, len(best)):
            best = family
    enough = _TWO if lines[0].amplitude > sigma else _TWO + 1
    return best if len(best) >= enough else ()


def _is_multiple(
    line: PeriodicLine, base: tuple[float, float], order: int, shape: tuple[int, int]
) -> bool:
    """Whether a line lies at a whole multiple of a frequency known by its `order`-th multiple."""
    rows, columns = shape
    for times in range(1, _MOST + 1):
        bins = _BINS * max(1.0, times / order)
        for sign in (1.0, -1.0):
            across = _folded(times * base[0] - sign * line.across)
            down = _folded(times * base[1] - sign * line.down)
            if abs(across) * columns <= bins and abs(down) * rows <= bins:
                return True
    return False


def _folded(frequency: float) -> float:
    """The frequency, −0.5 to 0.5 cycles per sample, that samples take it for."""
    return frequency - round(frequency)
