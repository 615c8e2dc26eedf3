"""Convolution of a frame in space, tap by tap, on blocks that stay in the processor's cache."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.float_guard import require_finite
from core.evaluation.work import Work
from core.scratch.scratch_disk import is_on_disk
from core.transfer.grid import Edges
from nodes.analysis.space.impulse_response import Kernel, Kernels

Array = NDArray[Any]
BLOCK_SAMPLES = 1 << 14


def convolved(work: Work, image: Array, kernels: Kernels, *, edges: Edges) -> Array:
    """The frame through every kernel in turn, its mean taken off before and put back after."""
    mean = float(np.mean(image, dtype=np.float64))
    values: Array = np.subtract(image, mean, out=work.empty(image.shape), dtype=work.policy.dtype)
    for kernel in kernels.passes:
        values = _one_pass(work, values, kernel, edges)
    require_finite(values)
    values += values.dtype.type(mean * kernels.at_zero)
    return values


def _one_pass(work: Work, image: Array, kernel: Kernel, edges: Edges) -> Array:
    """Sum over taps of tap × frame moved by the tap's lag; blocks of rows, or of columns."""
    (rows, columns), (high, wide) = image.shape, kernel.taps.shape
    # A tap before lag 0 takes samples from after: the frame goes on by as many there.
    down = _places(rows, high - 1 - kernel.before_y, kernel.before_y, edges)
    across = _places(columns, wide - 1 - kernel.before_x, kernel.before_x, edges)
    result: Array = work.empty(image.shape, image.dtype)
    taps = kernel.taps[::-1, ::-1].astype(image.dtype)

    def one(block: tuple[slice, slice]) -> None:
        y, x = block
        part = image[:, x] if wide == 1 else image
        part = part[down[y.start : y.stop + high - 1]]
        if wide > 1:
            part = np.take(part, across[x.start : x.stop + wide - 1], axis=1)
        size = y.stop - y.start, x.stop - x.start
        total, product = np.zeros(size, image.dtype), np.empty(size, image.dtype)
        for row in range(high):
            work.check()
            for column in range(wide):
                moved = part[row : row + size[0], column : column + size[1]]
                total += np.multiply(moved, taps[row, column], out=product)
        result[block] = total

    along = high > wide
    step = BLOCK_SAMPLES // (rows if along else columns)
    if is_on_disk(result):  # as wide as memory has it: of a column each row is a page to be read
        assert work.blocks is not None
        step = work.blocks.disk.slab_rows(rows if along else columns, result.itemsize)
    work.for_each(one, _blocks(rows, columns, step, along=along))
    return result


def _blocks(rows: int, columns: int, step: int, *, along: bool) -> list[tuple[slice, slice]]:
    if along:  # whole columns, for the frame to be extended once
        step = max(16, step)
        starts = range(0, columns, step)
        return [(slice(0, rows), slice(x, min(x + step, columns))) for x in starts]
    step = max(1, step)
    return [(slice(y, min(y + step, rows)), slice(0, columns)) for y in range(0, rows, step)]


def _places(size: int, before: int, after: int, edges: Edges) -> NDArray[np.intp]:
    """Samples of the frame that stand from `before` samples ahead of it to `after` behind it."""
    place = np.arange(-before, size + after)
    if edges == "periodic":
        return place % size
    place %= 2 * size
    return np.where(place < size, place, 2 * size - 1 - place)
