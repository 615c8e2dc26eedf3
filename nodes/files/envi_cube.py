"""Weighted sums of an ENVI file's bands, read block by block: the cube is never in memory whole."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.machine import ForEach, in_turn
from core.scratch import Empty
from nodes.files.common.stored_bytes import stored_bytes
from nodes.files.envi_header import EnviLayout

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class CubeInMemory:
    """Samples (bands, rows, columns) that are read as those of a file are."""

    samples: Array
    interleave: str = "bsq"
    missing: np.generic | None = None
    scaling: None = None

    @property
    def bands(self) -> int:
        return int(self.samples.shape[0])

    @property
    def rows(self) -> int:
        return int(self.samples.shape[1])

    @property
    def columns(self) -> int:
        return int(self.samples.shape[2])

    @property
    def dtype(self) -> np.dtype[Any]:
        return self.samples.dtype


Layout = EnviLayout | CubeInMemory
_BLOCK_BYTES = 1 << 21  # of samples as the file has them, so that they stay in a core's cache
_PIECE = 1 << 13  # samples of one matrix product: a larger one would start threads of its own


def weighted_sums(
    layout: Layout,
    weights: NDArray[np.float64],
    *,
    dtype: np.dtype[Any],
    fill: Callable[[Array], None] | None = None,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Array:
    """Σ_b w_b·L_b for a few rows of weights (sums, bands), in one pass over the file.

    Bands whose weights are all 0 are not read where they lie by themselves. Samples are multiplied
    and summed in `dtype`. `fill` is given every block, (bands, samples), with NaN for what is
    missing, to put numbers in place of those; without, such sums are not finite.
    """
    used = np.flatnonzero(np.any(weights != 0.0, axis=0))
    sums = empty((len(weights), layout.rows, layout.columns), dtype)
    if len(used) == 0:
        sums.fill(0.0)
        return sums
    chosen = np.ascontiguousarray(weights[:, used].astype(dtype))
    as_stored = fill is None and layout.missing is None and layout.dtype == dtype
    as_stored = as_stored and layout.scaling is None
    in_a_row = int(used[-1]) - int(used[0]) == len(used) - 1

    def one(rows: slice) -> None:
        if as_stored and in_a_row and layout.interleave != "bsq":
            # A band that does not count, which may be no number, is left out by a view.
            stored = _stored_rows(layout, rows, used)
            bands = slice(int(used[0]), int(used[-1]) + 1)
            _multiply(stored, bands, chosen, sums[:, rows], layout.interleave)
            return
        block = sample_block(layout, rows, used, dtype)
        if fill is not None:
            fill(block)
        made = sums[:, rows].reshape(len(weights), -1)  # a copy where rows are not all
        for left in range(0, block.shape[1], _PIECE):
            part = slice(left, left + _PIECE)
            made[:, part] = chosen @ block[:, part]
        sums[:, rows] = made.reshape(sums[:, rows].shape)

    for_each(one, list(row_blocks(layout, len(used))))
    return sums


def _multiply(stored: Array, bands: slice, factors: Array, sums: Array, order: str) -> None:
    """Σ_b w_b·L_b of some rows, straight from the file's samples as they lie."""
    if order == "bil":
        for row in range(len(stored)):
            np.matmul(factors, stored[row, bands], out=sums[:, row])
        return
    columns = sums.shape[2]
    step = max(1, _PIECE // columns)
    for start in range(0, len(stored), step):
        part = slice(start, start + step)
        samples = stored[part, :, bands].reshape(-1, factors.shape[1]).T
        made = sums[:, part].reshape(len(sums), -1)
        made[...] = factors @ samples
        sums[:, part] = made.reshape(sums[:, part].shape)


def band_totals(
    layout: Layout, *, for_each: ForEach = in_turn
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Sum of every band's finite samples, and their number."""
    blocks = list(row_blocks(layout, layout.bands))
    totals = np.zeros((len(blocks), layout.bands))
    counts = np.zeros((len(blocks), layout.bands), np.int64)
    every = np.arange(layout.bands)

    def one(item: tuple[int, slice]) -> None:
        number, rows = item
        block = sample_block(layout, rows, every, np.dtype(np.float64))
        finite = np.isfinite(block)
        counts[number] = finite.sum(axis=1)
        totals[number] = np.where(finite, block, 0.0).sum(axis=1)

    for_each(one, list(enumerate(blocks)))
    return totals.sum(axis=0), counts.sum(axis=0)


def mean_spectrum(layout: Layout, rows: slice, columns: slice) -> NDArray[np.float64]:
    """Mean of all bands over some samples, (bands,); NaN where one is missing."""
    every = np.arange(layout.bands)
    block = sample_block(layout, rows, every, np.dtype(np.float64))
    samples = block.reshape(layout.bands, -1, layout.columns)[:, :, columns]
    return np.asarray(samples.mean(axis=(1, 2)))


def row_blocks(layout: Layout, bands: int) -> Iterator[slice]:
    """Rows that are read at a time where so many bands count."""
    read = bands if layout.interleave == "bsq" else layout.bands
    of_row = layout.columns * read * layout.dtype.itemsize
    step = max(1, _BLOCK_BYTES // of_row)
    for start in range(0, layout.rows, step):
        yield slice(start, min(start + step, layout.rows))


def sample_block(layout: Layout, rows: slice, bands: Array, dtype: np.dtype[Any]) -> Array:
    """Samples of some rows, (bands, rows·columns), by gain and offset; NaN where missing."""
    stored = _stored_rows(layout, rows, bands)
    if layout.interleave == "bil":
        stored = stored[:, bands].transpose(1, 0, 2)
    elif layout.interleave == "bip":
        stored = stored.reshape(-1, layout.bands).T[bands]
    stored = stored.reshape(len(bands), -1)
    samples = np.ascontiguousarray(stored, dtype)
    missing = None if layout.missing is None else stored == layout.missing
    if layout.scaling is not None:  # in place: only a file's samples, which are nobody else's
        gains, offsets = layout.scaling[:, bands]
        samples *= gains[:, None]
        samples += offsets[:, None]
    if missing is not None:
        samples[missing] = np.nan
    return samples


def _stored_rows(layout: Layout, rows: slice, bands: Array) -> Array:
    """Samples of some rows in the file's order; of its bands only these where they lie apart."""
    if isinstance(layout, CubeInMemory):
        return layout.samples[bands, rows]
    count = rows.stop - rows.start
    columns, every = layout.columns, layout.bands
    start, size = layout.offset_bytes, layout.dtype.itemsize
    with stored_bytes(layout.data) as file:
        if layout.interleave == "bsq":
            stored = np.empty((len(bands), count, columns), layout.dtype)
            for place, band in enumerate(bands):
                first = (int(band) * layout.rows + rows.start) * columns
                file.fill(stored[place], start + first * size)
            return stored
        inner = (every, columns) if layout.interleave == "bil" else (columns, every)
        stored = np.empty((count, *inner), layout.dtype)
        file.fill(stored, start + rows.start * columns * every * size)
    return stored
