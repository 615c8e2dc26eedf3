"""Weighted sums of an ENVI file's bands, read block by block: the cube is never in memory whole."""

from __future__ import annotations

import mmap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from core.threads import ForEach, in_turn
from nodes.files.headers.envi_header import EnviLayout

Array = NDArray[Any]
_BLOCK_BYTES = 1 << 23  # of samples as the file has them; two threads hold two blocks
_MOST_MAPPED = 1 << 28
_PIECE = 1 << 13  # samples of one matrix product: a larger one would start threads of its own


def weighted_sums(
    layout: EnviLayout,
    weights: NDArray[np.float64],
    *,
    dtype: np.dtype[Any],
    fill: Callable[[Array], None] | None = None,
    for_each: ForEach = in_turn,
) -> Array:
    """Σ_b w_b·L_b for a few rows of weights, in one pass over the file.

    Parameters
    ----------
    layout : EnviLayout
        Of the file.
    weights : ndarray, (sums, bands)
        Bands whose weights are all 0 are not read where they lie by themselves.
    dtype : dtype
        Of the sums and of the samples as they are multiplied.
    fill : callable, optional
        Is given every block, (bands, samples), with NaN for what is missing, to put numbers in
        place of those.
    for_each : callable
        Calls a function on every block of rows: `Work.for_each`.

    Returns
    -------
    ndarray, (sums, rows, columns)
        Not finite where a sample is not and has not been filled.
    """
    used = np.flatnonzero(np.any(weights != 0.0, axis=0))
    sums = np.zeros((len(weights), layout.rows, layout.columns), dtype)
    if len(used) == 0:
        return sums
    blocks = list(_row_blocks(layout, len(used)))
    if fill is None and layout.missing is None and layout.dtype == dtype:
        with _mapped(layout) as mapped:
            factors = weights.astype(dtype)

            def direct(rows: slice) -> None:
                _multiply(mapped.cube, rows, factors, sums, layout.interleave)
                mapped.let_go()

            for_each(direct, blocks)
        return sums
    chosen = np.ascontiguousarray(weights[:, used].astype(dtype))

    def one(rows: slice) -> None:
        block = _block(layout, rows, used, dtype)
        if fill is not None:
            fill(block)
        made = sums[:, rows].reshape(len(weights), -1)  # a copy where rows are not all
        for left in range(0, block.shape[1], _PIECE):
            part = slice(left, left + _PIECE)
            made[:, part] = chosen @ block[:, part]
        sums[:, rows] = made.reshape(sums[:, rows].shape)

    for_each(one, blocks)
    return sums


def _multiply(cube: Array, rows: slice, factors: Array, sums: Array, order: str) -> None:
    """Σ_b w_b·L_b of some rows, straight from the file's samples as they lie."""
    if order == "bil":
        for row in range(rows.start, rows.stop):
            np.matmul(factors, cube[row], out=sums[:, row])
        return
    columns = sums.shape[2]
    step = max(1, _PIECE // columns)
    for start in range(rows.start, rows.stop, step):
        part = slice(start, min(start + step, rows.stop))
        # Views: rows of a band, and all bands of a sample, lie side by side.
        if order == "bsq":
            samples = cube[:, part].reshape(len(cube), -1)
        else:
            samples = cube[part].reshape(-1, cube.shape[2]).T
        made = sums[:, part].reshape(len(sums), -1)
        made[...] = factors @ samples
        sums[:, part] = made.reshape(sums[:, part].shape)


class _Mapped:
    """A file's samples in its own order, of which pages that were read are let go again."""

    def __init__(self, layout: EnviLayout) -> None:
        shapes = {
            "bsq": (layout.bands, layout.rows, layout.columns),
            "bil": (layout.rows, layout.bands, layout.columns),
            "bip": (layout.rows, layout.columns, layout.bands),
        }
        try:
            self.cube: Array = np.memmap(
                layout.data,
                layout.dtype,
                mode="r",
                offset=layout.offset_bytes,
                shape=shapes[layout.interleave],
            )
        except (OSError, ValueError) as error:
            raise FileError(f"{layout.data}: cannot be mapped: {error}") from error
        self._is_large = self.cube.nbytes > _MOST_MAPPED

    def let_go(self) -> None:
        """Of a large file no more than what is being read counts as memory in use."""
        base: Any = getattr(self.cube, "_mmap", None)
        if self._is_large and hasattr(base, "madvise"):  # not on every system
            base.madvise(mmap.MADV_DONTNEED)


@contextmanager
def _mapped(layout: EnviLayout) -> Iterator[_Mapped]:
    yield _Mapped(layout)


def band_totals(
    layout: EnviLayout, *, for_each: ForEach = in_turn
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Sum of every band's finite samples, and their number."""
    blocks = list(_row_blocks(layout, layout.bands))
    totals = np.zeros((len(blocks), layout.bands))
    counts = np.zeros((len(blocks), layout.bands), np.int64)
    every = np.arange(layout.bands)

    def one(item: tuple[int, slice]) -> None:
        number, rows = item
        block = _block(layout, rows, every, np.dtype(np.float64))
        finite = np.isfinite(block)
        counts[number] = finite.sum(axis=1)
        totals[number] = np.where(finite, block, 0.0).sum(axis=1)

    for_each(one, list(enumerate(blocks)))
    return totals.sum(axis=0), counts.sum(axis=0)


def mean_spectrum(layout: EnviLayout, rows: slice, columns: slice) -> NDArray[np.float64]:
    """Mean of all bands over some samples, (bands,); NaN where one is missing."""
    every = np.arange(layout.bands)
    block = _block(layout, rows, every, np.dtype(np.float64))
    samples = block.reshape(layout.bands, -1, layout.columns)[:, :, columns]
    return np.asarray(samples.mean(axis=(1, 2)))


def _row_blocks(layout: EnviLayout, bands: int) -> Iterator[slice]:
    read = bands if layout.interleave == "bsq" else layout.bands
    of_row = layout.columns * read * layout.dtype.itemsize
    step = max(1, _BLOCK_BYTES // of_row)
    for start in range(0, layout.rows, step):
        yield slice(start, min(start + step, layout.rows))


def _block(layout: EnviLayout, rows: slice, bands: Array, dtype: np.dtype[Any]) -> Array:
    """Samples of some rows, (bands, rows·columns), NaN where they are missing."""
    count = rows.stop - rows.start
    columns, every = layout.columns, layout.bands
    try:
        with layout.data.open("rb") as file:
            if layout.interleave == "bsq":
                stored = np.empty((len(bands), count * columns), layout.dtype)
                for place, band in enumerate(bands):
                    first = (int(band) * layout.rows + rows.start) * columns
                    stored[place] = _read(file, layout, first, count * columns)
            else:
                flat = _read(file, layout, rows.start * columns * every, count * columns * every)
                if layout.interleave == "bil":
                    lines = flat.reshape(count, every, columns)[:, bands]
                    stored = lines.transpose(1, 0, 2).reshape(len(bands), -1)
                else:
                    stored = flat.reshape(-1, every).T[bands]
    except OSError as error:
        raise FileError(f"{layout.data}: cannot be read: {error}") from error
    samples = np.ascontiguousarray(stored, dtype)
    if layout.missing is not None:
        if samples is stored:
            samples = samples.copy()
        samples[stored == layout.missing] = np.nan
    return samples


def _read(file: Any, layout: EnviLayout, first: int, count: int) -> Array:
    file.seek(layout.offset_bytes + first * layout.dtype.itemsize)
    samples = np.fromfile(file, layout.dtype, count)
    if len(samples) != count:
        raise FileError(f"{layout.data}: ends before its last sample")
    return samples
