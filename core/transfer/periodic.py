"""Filtering a frame that repeats without end, as the plain FFT sees it (the 1996 way).

At the Nyquist row or column of an even size the Hermitian part of H acts: the mean of H at +Nyquist
and −Nyquist, for a separable factor the real part of its axis.
"""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from core import kernels
from core.arrays import Array, Vector
from core.errors import require_finite
from core.evaluation.recipes import Region, ends_lineage
from core.evaluation.work import Work
from core.machine import StripArray
from core.transfer.factors import Edges, Grid, Product
from core.transfer.mirrored import BLOCK_SAMPLES, MeanFree, MirroredTerms, column_blocks, row_blocks
from core.transfer.planar_blocks import Planes


@ends_lineage
def periodic_spectrum(work: Work, image: Array) -> MeanFree:
    """Half spectrum (rows, columns // 2 + 1) of the frame less its mean."""
    mean = float(np.mean(image))
    kind = np.result_type(work.policy.dtype, np.complex64)
    lines = work.strips((image.shape[0], image.shape[1] // 2 + 1), kind)

    def one(rows: slice) -> None:
        values = np.subtract(image[rows], mean, dtype=work.policy.dtype)
        lines[rows] = fourier().rfft(values, axis=1, overwrite_x=True)

    work.for_each(one, row_blocks(image.shape))
    _each_column(work, lines, lambda block: fourier().fft(block, axis=0, overwrite_x=True))
    return lines, mean


def crossed_spectrum(
    work: Work, modulus: Array | None, phase: Array | None, grid: Grid
) -> MeanFree:
    """|A|·exp(i·∠B) of two different frames; a missing one has modulus 1 or phase 0.

    The mean is the modulus at zero frequency with the sign of B's mean.
    """
    size, workers = grid.rows * grid.columns, work.policy.workers
    if modulus is None:
        mean = 1.0 / size
        values: Array = np.ones((grid.rows, grid.columns // 2 + 1), work.policy.dtype)
    else:
        mean = abs(float(np.mean(modulus, dtype=np.float64)))
        values = np.abs(periodic_spectrum(work, modulus)[0])
    if phase is not None:
        other = fourier().rfft2(phase, overwrite_x=False, workers=workers)
        other[0, 0] = np.sum(phase, dtype=np.float64)
        size_of = np.abs(other)
        # A frequency that is absent has phase 0.
        values = values * np.where(size_of > 0, other / np.where(size_of > 0, size_of, 1), 1)
        mean *= -1.0 if other[0, 0].real < 0 else 1.0
    values = values.astype(np.result_type(work.policy.dtype, np.complex64))
    values[0, 0] = 0
    return values, mean


def periodic_filter(
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

    Parameters and result as for `core.transfer.mirrored.mirrored_filter`.
    """
    rows, columns = grid.rows // factor_y, grid.columns // factor_x
    response = PeriodicResponse(work, product, grid, factor_x, factor_y, average)
    direct, turned = _fold(work, spectrum[0], response, factor_x, factor_y)
    if turned is not None:
        # An alias beyond Nyquist is the conjugate of the mirrored frequency's value.
        flip = -np.arange(rows) % rows
        for target, source in zip(column_blocks(direct), column_blocks(turned), strict=True):
            np.add(target, source[flip].conj(), out=target)
    # All columns, then rows, each sample scaled last of all: the bits of irfft2.
    how: dict[str, Any] = {"norm": "forward", "overwrite_x": True}
    _each_column(work, direct, lambda block: fourier().ifft(block, axis=0, **how))
    whole = Region(0, 0, rows, columns)
    # Of scipy's transforms it is known that a row's bits do not depend on the other rows.
    made = region if region is not None and backend() == "scipy.fft" else whole
    image: Array = work.empty(made.shape)
    scale = image.dtype.type(np.longdouble(1) / (rows * columns))
    added = np.asarray(spectrum[1] * product.at_zero(work), image.dtype)

    def one(block: slice) -> None:
        lines = slice(made.top + block.start, min(made.top + block.stop, made.bottom))
        part = fourier().irfft(direct[lines], n=columns, axis=1, **how)
        part = part[:, made.left : made.right] * scale
        require_finite(part)
        part += added
        image[block] = part

    work.for_each(one, row_blocks(image.shape))
    return image if region is None or made is region else region.cut(image)


def _each_column(
    work: Work, lines: Array | StripArray, transform: Callable[[Array], Array]
) -> None:
    def one(block: Array) -> None:
        block[...] = transform(np.ascontiguousarray(block))

    work.for_each(one, column_blocks(lines))


def _fold(
    work: Work, spectrum: Array, response: "PeriodicResponse", factor_x: int, factor_y: int
) -> tuple[Array | StripArray, Array | StripArray | None]:
    """Multiply and fold: the aliases up to Nyquist, and those beyond it, still unturned."""
    grid = response.grid
    rows, columns = grid.rows // factor_y, grid.columns // factor_x
    width = columns // 2 + 1
    direct: Array | StripArray = work.strips((rows, width), spectrum.dtype)
    turned: Array | StripArray | None = None
    if factor_x > 1:
        turned = work.strips((rows, width), spectrum.dtype)
    height = max(1, BLOCK_SAMPLES // (spectrum.shape[1] * factor_y))

    def one(start: int) -> None:
        stop = min(start + height, rows)
        total: Array | None = None
        for alias in range(factor_y):
            lines = slice(alias * rows + start, alias * rows + stop)
            values = response.apply(spectrum[lines], lines)
            total = values if total is None else np.add(total, values, out=total)
        assert total is not None
        if turned is None:
            direct[start:stop] = total
        else:
            direct[start:stop] = _aliases_up(total, columns, width)
            turned[start:stop] = _aliases_beyond(total, grid.columns, columns, width)

    work.for_each(one, range(0, rows, height))
    return direct, turned


def mean_kernel(size: int, factor: int) -> Array:
    """Response of the mean of samples n … n + factor − 1 at the FFT's frequencies."""
    kernel = np.ones(size, np.complex128)
    if factor > 1:
        half = np.pi * np.arange(1, size) / size
        kernel[1:] = (
            np.sin(half * factor) / (factor * np.sin(half)) * np.exp(1j * half * (factor - 1))
        )
    return kernel


def middle_kernel(size: int, factor: int) -> Array:
    """Response of the middle of samples n … n + factor − 1, at Nyquist its Hermitian part."""
    number = np.arange(size)
    turns = np.where(2 * number > size, number - size, number) * (np.pi * (factor - 1) / size)
    kernel = np.exp(1j * turns)
    nyquist = 2 * number == size
    # Half-way between samples the wave at Nyquist is nothing.
    kernel[nyquist] = 0.0 if factor % 2 == 0 else np.rint(kernel[nyquist].real)
    return np.asarray(kernel)


def _aliases_up(values: Array, columns: int, width: int) -> Array:
    """Sum the columns k' + j·columns that lie in the half spectrum."""
    folded = values[:, :width].copy()
    for first in range(columns, values.shape[1], columns):
        part = values[:, first : first + width]
        folded[:, : part.shape[1]] += part
    return folded


def _aliases_beyond(values: Array, size: int, columns: int, width: int) -> Array:
    """Sum the columns j·columns − k' that stand for the other half of the spectrum."""
    folded = np.zeros((values.shape[0], width), values.dtype)
    place = np.arange(width)
    for multiple in range(columns, size + 1, columns):
        source = multiple - place
        # The other half is size/2 < size − source, that is 0 < source < size/2.
        inside = (source > 0) & (2 * source < size)
        folded[:, place[inside]] += values[:, source[inside]]
    return folded


class PeriodicResponse:
    """H on blocks of rows of the half spectrum, Hermitian at Nyquist, with the mean's kernel."""

    def __init__(
        self,
        work: Work,
        product: Product,
        grid: Grid,
        factor_x: int = 1,
        factor_y: int = 1,
        average: bool = True,
    ) -> None:
        self.work, self.product, self.grid = work, product, grid
        self.xi, self.eta = grid.axes("periodic")
        self.across = product.across(work, self.xi)
        self.along = product.along(work, self.eta)
        self.planes = Planes(work, product, grid, "periodic") if product.symmetric else None
        # 1/f undoes the difference between the forward and the smaller inverse transform.
        kernel = mean_kernel if average else middle_kernel
        kernel_x = kernel(grid.columns, factor_x)[: len(self.xi)] / factor_x
        kernel_y = kernel(grid.rows, factor_y) / factor_y
        self.kernels = (kernel_x, kernel_y) if factor_x > 1 or factor_y > 1 else None
        if product.symmetric:
            if grid.columns % 2 == 0:
                self.across[-1] = self.across[-1].real
            if grid.rows % 2 == 0:
                self.along[grid.rows // 2] = self.along[grid.rows // 2].real
            if factor_x > 1:
                self.across = self.across * kernel_x
            if factor_y > 1:
                self.along = self.along * kernel_y

    def apply(self, values: Array, rows: slice) -> Array:
        """H times a block of the spectrum; a new array."""
        real = values.real.dtype
        if self.planes is None:
            total = self._general(rows)
            if self.kernels is not None:
                total *= self.kernels[1][rows, np.newaxis] * self.kernels[0]
            return np.asarray(values * total.astype(values.dtype))
        result = values * _narrow(self.along[rows, np.newaxis], real)
        plane = self.planes.block(rows)
        if plane is not None:
            result *= plane
        result *= _narrow(self.across, real)
        return np.asarray(result)

    def _general(self, rows: slice) -> Array:
        total = self._plane(self.xi, self.eta[rows])
        size_y, size_x = self.grid.shape
        nyquist = np.arange(size_y)[rows] * 2 == size_y
        if nyquist.any():
            other = self._plane(self.xi, -self.eta[rows][nyquist])
            total[nyquist] = 0.5 * (total[nyquist] + other)
        if size_x % 2 == 0:
            last = self.xi[-1:]
            column = self._plane(-last, self.eta[rows])[:, 0]
            if nyquist.any():
                turned = self._plane(-last, -self.eta[rows][nyquist])[:, 0]
                column[nyquist] = 0.5 * (column[nyquist] + turned)
            total[:, -1] = 0.5 * (total[:, -1] + column)
        return total

    def _plane(self, xi: Array, eta: Array) -> Array:
        return np.asarray(self.product.total(self.work, xi, eta), np.complex128)


def _narrow(values: Array, real: np.dtype[Any]) -> Array:
    kind = np.result_type(real, np.complex64) if np.iscomplexobj(values) else real
    return np.asarray(values.astype(kind))


# The Fourier transforms in use: those of scipy, or Intel's where they are installed.
#
# With `mkl_fft` (extra `fast`) periodic frames take 0.8 of scipy's time at 1024², 0.7 at 4096²,
# measured on one thread of an AMD processor. It has no cosine transforms: mirrored frames stay as
# they are.


@cache
def fourier() -> Any:
    try:
        return import_module("mkl_fft.interfaces.scipy_fft")
    except (ImportError, OSError, AttributeError):  # not there, or its libraries are not
        return kernels


def backend() -> str:
    return "scipy.fft" if fourier() is kernels else "mkl_fft"


# The waves of a frame at places between its samples: band-limited interpolation, exactly.
#
# A mirrored frame is a sum of cosines, and behind an odd filter of sines too; a periodic one a sum
# of complex waves, at Nyquist a cosine alone. Their values at any places are known, so that a
# matrix for each axis takes the place of the inverse transform: as exact as that, for any ratio of
# the samples. It takes samples × places multiplications a line.


def mirrored_waves(size: int, places: Vector, *, odd: bool) -> Array:
    """Cosines k = 0 … size − 1 of the inverse DCT-II at places, or sines of the inverse DST-II.

    Places count in samples from the middle of the first one; shape (size, places). Sine 0 is 0.
    """
    angle = np.outer(np.arange(size), (places + 0.5) / size) * np.pi
    waves = (np.sin(angle) if odd else np.cos(angle)) / size
    waves[0] *= 0.5
    return np.asarray(waves)


def periodic_waves(size: int, places: Vector, *, half: bool) -> Array:
    """Waves of the inverse FFT at places, as for `mirrored_waves`.

    `half`: those of the half spectrum, of which the real part is taken afterwards.
    """
    number = np.arange(size)
    number = number[: size // 2 + 1] if half else np.where(2 * number > size, number - size, number)
    angle = np.outer(number, places / size) * (2.0 * np.pi)
    waves = np.exp(1j * angle) / size
    nyquist = 2 * np.abs(number) == size
    waves[nyquist] = waves[nyquist].real
    if half:
        waves[(number > 0) & ~nyquist] *= 2.0
    return np.asarray(waves)


def sampled_columns(samples: Array, places: Vector, edges: Edges) -> Array:
    """Columns of samples at places between them; the frame goes on mirrored or periodic."""
    size = len(samples)
    if edges == "reflect":
        whole = np.concatenate([samples, samples[::-1]])
        twice = periodic_waves(2 * size, places, half=False)
    else:
        whole, twice = samples, periodic_waves(size, places, half=False)
    made = twice.T @ np.fft.fft(whole, axis=0)
    return np.asarray(made if np.iscomplexobj(samples) else made.real)


def sampled_filter(
    work: Work,
    spectrum: MeanFree,
    product: Product,
    grid: Grid,
    edges: Edges,
    places_x: Vector,
    places_y: Vector,
) -> Array:
    """The filtered frame at columns and rows between its samples, from the first one's middle."""
    made = _mirrored if edges == "reflect" else _periodic
    image = made(work, spectrum[0], product, grid, places_x, places_y)
    require_finite(image)
    image += np.asarray(spectrum[1] * product.at_zero(work), image.dtype)
    return image


def _mirrored(
    work: Work, spectrum: Array, product: Product, grid: Grid, places_x: Vector, places_y: Vector
) -> Array:
    terms = MirroredTerms(work, product, grid)
    kind = spectrum.dtype
    across = {
        odd: mirrored_waves(grid.columns, places_x, odd=odd).astype(kind) for odd in terms.odd_x
    }
    total = np.zeros((len(places_y), len(places_x)), kind)
    height = max(1, BLOCK_SAMPLES // grid.columns)
    for odd_y in terms.odd_y:
        lines = np.zeros((grid.rows, len(places_x)), kind)

        def one(start: int, odd_y: bool = odd_y, lines: Array = lines) -> None:
            stop = min(start + height, grid.rows)
            for odd_x, values in terms.apply(spectrum, start, stop, odd_y):
                lines[start:stop] += values @ across[odd_x]

        work.for_each(one, range(0, grid.rows, height))
        along = mirrored_waves(grid.rows, places_y, odd=odd_y).astype(kind)
        if odd_y:
            along, lines = along[1:], lines[:-1]  # sine k stands at index k − 1
        total += along.T @ lines
    return total


def _periodic(
    work: Work, spectrum: Array, product: Product, grid: Grid, places_x: Vector, places_y: Vector
) -> Array:
    response = PeriodicResponse(work, product, grid)
    kind = spectrum.dtype
    across = periodic_waves(grid.columns, places_x, half=True).astype(kind)
    lines = np.empty((grid.rows, len(places_x)), kind)
    height = max(1, BLOCK_SAMPLES // grid.columns)

    def one(start: int) -> None:
        rows = slice(start, min(start + height, grid.rows))
        lines[rows] = response.apply(spectrum[rows], rows) @ across

    work.for_each(one, range(0, grid.rows, height))
    along = periodic_waves(grid.rows, places_y, half=False).astype(kind)
    return np.ascontiguousarray((along.T @ lines).real)
