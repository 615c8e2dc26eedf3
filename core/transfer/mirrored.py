"""Filtering a frame that is mirrored at its edges without end (half-sample symmetric).

The mirrored frame's spectrum is a DCT-II. Acting on cos(ax)·cos(by), a real filter's
H = R + iI with parts even (e) or odd (o) in each axis gives

    R_ee·cos·cos − R_oo·sin·sin − I_oe·sin·cos − I_eo·cos·sin,

so the even part comes back by the inverse DCT-II and an odd part, moved by one index, by the
inverse DST-II. Nothing is padded and nothing wraps round. Pixel means fold here as on any
spectrum: index k = 2M·j ± k' acts as ±(−1)^j at k' on a frame of M samples. Without the mean's
kernel that is the frame in the middles of the blocks.
"""

from collections.abc import Callable, Iterator
from typing import Literal

import numpy as np

from core import kernels
from core.arrays import Array
from core.errors import require_finite
from core.evaluation.recipes import Region, ends_lineage
from core.evaluation.work import Work
from core.machine import StripArray
from core.transfer.factors import Grid, Product
from core.transfer.planar_blocks import Planes

# Of the spectrum, that a block of rows is made of. In smaller ones two threads wait for each other
# between the calls: 4.2 ms in 2^17, 3.6 in 2^18 for the Kodak optics.
BLOCK_SAMPLES = 1 << 18


MeanFree = tuple[Array, float]
"""A spectrum without its mean, and the mean; on disk its values are a `StripArray`."""


@ends_lineage
def mirrored_spectrum(work: Work, image: Array) -> MeanFree:
    """DCT-II of the frame less its mean, which keeps single precision precise.

    Whatever the mean's own rounding leaves over stays in the spectrum.
    """
    mean = float(np.mean(image))
    values = work.strips(image.shape)

    def one(rows: slice) -> None:
        place = values[rows] if isinstance(values, np.ndarray) else None
        part = np.subtract(image[rows], mean, out=place, dtype=values.dtype)
        values[rows] = transform_block(part, "dct", axis=1)

    def column(block: Array) -> None:
        block[...] = transform_block(np.ascontiguousarray(block), "dct", axis=0)

    work.for_each(one, row_blocks(image.shape))
    work.for_each(column, column_blocks(values))
    return values, mean


def mirrored_filter(
    work: Work,
    spectrum: MeanFree,
    product: Product,
    grid: Grid,
    factor_x: int = 1,
    factor_y: int = 1,
    region: Region | None = None,
    *,
    average: bool = True,
) -> Array:
    """The filtered frame, its `factor_y` × `factor_x` blocks averaged, or their middles alone.

    Each factor divides the frame's size. Of a `region` of the result only the columns are
    transformed along y.
    """
    terms = MirroredTerms(work, product, grid, factor_x, factor_y, average)
    whole = Region(0, 0, *terms.shape)
    rows, columns = (region or whole).slices
    values, mean = spectrum
    added = mean * terms.at_zero()
    total: Array | None = None
    for odd_y in terms.odd_y:
        lines = _lines(work, values, terms, odd_y, columns)
        last = odd_y == terms.odd_y[-1]
        total = _summed(work, lines, odd_y, rows, total, added if last else None)
    assert total is not None
    return total


def _summed(
    work: Work,
    lines: Array | StripArray,
    odd_y: bool,
    rows: slice,
    total: Array | None,
    added: float | None,
) -> Array:
    """The last transform of lines, and the sum with other terms and the mean."""
    if total is not None:
        made = total
    elif isinstance(lines, np.ndarray) and len(lines) == rows.stop - rows.start:
        made = lines
    else:
        made = work.empty((rows.stop - rows.start, lines.shape[1]), lines.dtype)

    def one(both: tuple[Array, Array]) -> None:
        block, out = both
        part = transform_block(np.ascontiguousarray(block), _inverse(odd_y), axis=0)[rows]
        part = part if total is None else np.add(out, part, out=part)
        if added is not None:
            require_finite(part)
            part += np.asarray(added, part.dtype)
        out[...] = part

    blocks = column_blocks(lines)
    ends = np.cumsum([block.shape[1] for block in blocks])
    work.for_each(one, list(zip(blocks, np.split(made, ends[:-1], axis=1), strict=True)))
    return made


class MirroredTerms:
    """The even and odd parts of H, with the pixel mean's kernel, applied to blocks of rows."""

    def __init__(
        self,
        work: Work,
        product: Product,
        grid: Grid,
        factor_x: int = 1,
        factor_y: int = 1,
        average: bool = True,
    ) -> None:
        self.work, self.product = work, product
        self.factor_x, self.factor_y = factor_x, factor_y
        self.shape = grid.rows // factor_y, grid.columns // factor_x
        self.xi, self.eta = grid.axes("reflect")
        # 1/f undoes the difference between the forward and the smaller inverse transform.
        self.across, self.along = product.across(work, self.xi), product.along(work, self.eta)
        if average:
            self.across = self.across * mean_kernel(grid.columns, factor_x)
            self.along = self.along * mean_kernel(grid.rows, factor_y)
        self.across, self.along = self.across / factor_x, self.along / factor_y
        self.general = not product.symmetric
        self.planes = None if self.general else Planes(work, product, grid, "reflect")
        self.odd_x = (False, True) if self.general or product.has_phase_x else (False,)
        self.odd_y = (False, True) if self.general or product.has_phase_y else (False,)
        self.fold_x = {odd: column_fold(self.shape[1], factor_x, odd) for odd in self.odd_x}
        dtype = work.policy.dtype
        self.parts_x = {odd: _part(self.across, odd).astype(dtype) for odd in self.odd_x}
        self.parts_y = {odd: _part(self.along, odd).astype(dtype) for odd in self.odd_y}

    def at_zero(self) -> float:
        """H(0, 0), of which the axes' parts are known already."""
        axes = self.across[0] * self.along[0] * self.factor_x * self.factor_y
        return self.product.at_zero(self.work, axes)

    def apply(
        self, spectrum: Array, start: int, stop: int, odd_y: bool
    ) -> Iterator[tuple[bool, Array]]:
        """Each term's coefficients on output rows start … stop − 1, folded along y."""
        sums: dict[bool, Array] = {}
        for places, rows, weights in alias_rows(start, stop, self.shape[0], self.factor_y, odd_y):
            for odd_x, part in self._multiplied(spectrum[rows], rows, weights, odd_y):
                if odd_x not in sums and len(part) == stop - start:
                    sums[odd_x] = part
                    continue
                if odd_x not in sums:
                    sums[odd_x] = np.zeros((stop - start, part.shape[1]), part.dtype)
                sums[odd_x][places.start - start : places.stop - start] += part
        if self.planes is None:
            yield from sums.items()
            return
        for odd_x in self.odd_x if sums else ():
            shared = sums[False]
            # i·i = −1 turns −sin·sin round; a single odd part keeps its minus.
            across = self.parts_x[odd_x]
            across = -across if odd_x != odd_y else across
            last = odd_x == self.odd_x[-1]
            yield odd_x, np.multiply(shared, across, out=shared if last else None)

    def _multiplied(
        self, values: Array, rows: slice, weights: Array, odd_y: bool
    ) -> Iterator[tuple[bool, Array]]:
        """The factors that differ from row to row; all of them where H does not separate."""
        if self.planes is None:
            for odd_x, block in self._general(rows, odd_y):
                yield odd_x, values * (block * weights[:, np.newaxis]).astype(values.dtype)
            return
        along = self.parts_y[odd_y][rows] * weights.astype(values.dtype)
        values = values * along[:, np.newaxis]
        plane = self.planes.block(rows)
        if plane is not None:
            values *= plane
        yield False, values

    def _general(self, rows: slice, odd_y: bool) -> Iterator[tuple[bool, Array]]:
        eta = self.eta[rows]
        up = self.product.plane(self.work, self.xi, eta)
        down = self.product.plane(self.work, self.xi, -eta)
        along, across = self.along[rows][:, np.newaxis], self.across
        plus = along * across if up is None else along * across * up
        minus = along.conj() * across if down is None else along.conj() * across * down
        for odd_x in self.odd_x:
            if odd_x == odd_y:
                value = np.real(plus - minus if odd_x else plus + minus)
            else:
                value = np.imag(plus + minus if odd_x else plus - minus)
            yield odd_x, 0.5 * (-value if odd_x or odd_y else value)


def _part(response: Array, odd: bool) -> Array:
    return np.imag(response) if odd else np.real(response)


def _lines(
    work: Work, spectrum: Array, terms: MirroredTerms, odd_y: bool, columns: slice
) -> Array | StripArray:
    """Multiply, fold and transform back along x, all in one pass over blocks of output rows.

    Of each row those columns are kept.
    """
    rows_out = terms.shape[0]
    lines: Array | StripArray = work.strips(
        (rows_out, columns.stop - columns.start), spectrum.dtype
    )
    height = max(1, BLOCK_SAMPLES // (spectrum.shape[1] * terms.factor_y))

    def one(start: int) -> None:
        stop = min(start + height, rows_out)
        total: Array | None = None
        for odd_x, values in terms.apply(spectrum, start, stop, odd_y):
            part = transform_block(terms.fold_x[odd_x](values), _inverse(odd_x), axis=1)
            total = part if total is None else np.add(total, part, out=total)
        lines[start:stop] = 0 if total is None else total[:, columns]

    work.for_each(one, range(0, rows_out, height))
    return lines


def _inverse(odd: bool) -> "Kind":
    return "idst" if odd else "idct"


# Folding a mirrored frame's spectrum, as averaging blocks of pixels does.
#
# On a frame of M samples index k = 2M·j ± k' acts as ±(−1)^j at k'.


def mean_kernel(size: int, factor: int) -> Array:
    """Response of the mean of `factor` samples at the mirrored frequencies k/(2·size)."""
    kernel = np.ones(size)
    if factor > 1:
        half = np.pi * np.arange(1, size) / (2 * size)
        kernel[1:] = np.sin(half * factor) / (factor * np.sin(half))
    return kernel


def alias_rows(
    start: int, stop: int, size: int, factor: int, odd: bool
) -> Iterator[tuple[slice, slice, Array]]:
    """Which indices k of a mirrored spectrum fold into places start … stop − 1.

    A place is k' for the even part and k' − 1 for the odd part. Yields (places, indices k,
    weights); the one place that an inverse transform counts once gets weight 2.
    """
    for segment in range(factor):
        j, backward = (segment + 1) // 2, segment % 2 == 1
        # A forward segment holds k' = 0 … size − 1, a backward one k' = size … 1. Even terms
        # have nothing at k' = size, odd ones nothing at 0.
        low, high = (1, size) if backward else (0, size - 1)
        low, high = (max(low, 1), high) if odd else (low, min(high, size - 1))
        shift = 1 if odd else 0
        first, last = max(low, start + shift), min(high, stop - 1 + shift)
        if first > last:
            continue
        wanted = np.arange(first, last + 1)
        sign = (-1.0) ** j * (-1.0 if backward and odd else 1.0)
        weights = np.full(len(wanted), sign)
        if odd or segment > 0:
            weights[wanted == (size if odd else 0)] *= 2.0
        if backward:
            end = 2 * size * j - last - 1
            rows = slice(2 * size * j - first, end if end >= 0 else None, -1)
        else:
            rows = slice(2 * size * j + first, 2 * size * j + last + 1)
        yield slice(first - shift, last - shift + 1), rows, weights


def column_fold(size: int, factor: int, odd: bool) -> Callable[[Array], Array]:
    """Folds columns of a mirrored spectrum, `factor` times as many, into `size` places.

    `odd`: whether they belong to sines. Of a block of rows, which may be overwritten.
    """
    segments = []  # places, columns, whether they count negative, and which column counts twice
    for places, columns, weights in alias_rows(0, size, size, factor, odd):
        twice = np.flatnonzero(np.abs(weights) == 2.0)
        edge = int(twice[0]) if len(twice) else None
        segments.append((places, columns, bool(weights[0] < 0), edge))

    def fold(values: Array) -> Array:
        folded = np.zeros((len(values), size), values.dtype) if odd else values[:, :size]
        for places, columns, negative, edge in segments if odd else segments[1:]:  # one is in place
            target, part = folded[:, places], values[:, columns]
            (np.subtract if negative else np.add)(target, part, out=target)
            if edge is not None:
                target[:, edge] += -part[:, edge] if negative else part[:, edge]
        return folded

    return fold


# Cosine and sine transforms along one axis of a picture, in place, block by block.
#
# The lines of a picture whose width is a power of two fall on the same places of the cache, so
# that a transform along columns waits for memory. Blocks of columns are therefore copied together
# first: at 1024² that takes 2.0 ms for 3.4, at 8192² 200 ms for 310 (one thread). Blocks do not
# depend on the number of threads, and neither do the values.
#
# No other library is clearly better: on one thread of an AMD processor, single precision, at
# 512², 1024², 2048² and 4096², ducc0 took 0.64, 1.28, 1.12 and 0.97 of this time, FFTW 1.4, 1.7,
# 1.9 and 3.4, and the cosine transform on MKL's real one of the same length 1.9, 2.5, 2.7 and 2.5.

Kind = Literal["dct", "idct", "dst", "idst"]

LEAST_BLOCKS = 4  # of a picture that would fit into one, for several threads to share
LEAST_COLUMNS = 64  # narrower blocks are copied in pieces shorter than a line of the cache


def transform_block(values: Array, kind: Kind, axis: int) -> Array:
    """One block transformed along an axis; `values` may be overwritten."""
    transform = getattr(kernels, kind)
    return np.asarray(transform(values, type=2, axis=axis, overwrite_x=True))


def column_blocks(values: Array | StripArray) -> list[Array]:
    """Views of blocks of columns, of a size to be copied together; in order."""
    blocks = []
    for strip in values.strips if isinstance(values, StripArray) else [values]:
        rows, columns = strip.shape
        step = max(LEAST_COLUMNS, min(BLOCK_SAMPLES // rows, -(-columns // LEAST_BLOCKS)))
        blocks += [
            strip[:, start : min(start + step, columns)] for start in range(0, columns, step)
        ]
    return blocks


def row_blocks(shape: tuple[int, ...]) -> list[slice]:
    """Blocks of rows that stay in a core's cache."""
    height = max(1, min(BLOCK_SAMPLES // shape[1], -(-shape[0] // LEAST_BLOCKS)))
    return [slice(start, start + height) for start in range(0, shape[0], height)]
