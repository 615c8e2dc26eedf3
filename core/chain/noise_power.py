"""Variance by frequency of a noise on a frame, and what a chain makes of it.

A frame of samples is a sum of waves: the cosines of the frame mirrored at its edges, or those of
the frame repeated. Noise that is the same everywhere has independent amplitudes on these, so a
transfer function multiplies their variances by |H|². Interpolation, and odd phases on mirrored
frames, make several waves of one; a matrix for each axis then gives how much of each first wave is
in each present one.

Source: Papoulis 1991, Probability, Random Variables, and Stochastic Processes, chapter 10, for
linear systems with stochastic inputs; the cosine form is the DCT-II's orthonormal basis.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core import kernels, machine
from core.arrays import Array, Matrix, Vector
from core.errors import DataError
from core.evaluation.work import Work
from core.physics.noise.noise_components import NoiseVariances, components_of_moments
from core.records import dataclass, replace
from core.transfer.factors import Edges, Factor, Grid, Product, nyquist_lines

Operator = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class NoisePower:
    """Variances of the amplitudes of a frame's orthonormal waves."""

    rows: int  # size of the frame
    columns: int
    # Variances that broadcast to (rows, columns): of the cosines k = 0 … n − 1 of a mirrored frame,
    # in FFT order of a periodic one. Their mean is the variance of a sample.
    power: Array
    axes: Edges = "reflect"  # which waves: those of a frame mirrored at its edges, or repeated
    # Of the samples, where these are independent but not alike: `power` is their mean then.
    variances: Array | None = None
    # Amplitude in each wave of the frame, (rows,) or (columns,), that each wave of `power` has.
    along: Array | None = None
    across: Array | None = None

    @classmethod
    def white(cls, rows: int, columns: int, variance: float | Array) -> NoisePower:
        """Of samples independent of each other, of one variance or each of its own."""
        variances = np.asarray(variance, np.float64)
        power = np.full((1, 1), float(np.mean(variances)))
        return cls(rows, columns, power, variances=variances if variances.ndim else None)

    @classmethod
    def of_pattern(cls, samples: Array) -> NoisePower:
        """Of a pattern that is known: the squares of its amplitudes."""
        amplitudes = kernels.dctn(np.asarray(samples, np.float64), type=2, norm="ortho")
        rows, columns = amplitudes.shape
        return cls(rows, columns, amplitudes**2)

    @property
    def shown(self) -> Array:
        """Variances of the waves of the frame as it is now; broadcasts to (rows, columns)."""
        power = self.power
        for axis in (0, 1):
            if (matrix := self._matrix(axis)) is not None:
                power = _carried(power, np.abs(matrix) ** 2, axis)
        return power

    @property
    def _whole(self) -> Array:
        return np.broadcast_to(self.shown, (self.rows, self.columns))

    @property
    def variance(self) -> float:
        """Of a sample."""
        return float(np.mean(self._whole))

    def components(self, *, temporal: bool) -> NoiseVariances:
        """What unbiased estimates of the components are on average."""
        whole, rows, columns = self._whole, self.rows, self.columns
        return components_of_moments(
            sample=self.variance,
            row_mean=float(np.mean(whole[:, 0])) / columns,
            column_mean=float(np.mean(whole[0])) / rows,
            frame_mean=float(whole[0, 0]) / (rows * columns),
            rows=rows,
            columns=columns,
            temporal=temporal,
        )

    def scaled(self, factor: float) -> NoisePower:
        variances = None if self.variances is None else self.variances * factor**2
        return replace(self, power=self.power * factor**2, variances=variances)

    def filtered(
        self, work: Work, factors: tuple[Factor, ...], grid: Grid, axes: Edges
    ) -> NoisePower:
        """Behind transfer functions on a frame of these edges."""
        product = Product(factors)
        xi, eta = (grid.xi(), grid.eta()) if axes == "periodic" else grid.axes(axes)
        changed = self.on(axes)
        if axes == "periodic" and not product.symmetric:
            # At Nyquist the Hermitian part of all factors together acts, which has no axes.
            whole = np.array(product.total(work, xi, eta), np.complex128)
            for place, mean in nyquist_lines(lambda x, y: product.total(work, x, y), xi, eta):
                whole[place] = mean
            power = changed.shown * np.abs(whole) ** 2
            return replace(changed, power=power, along=None, across=None, variances=None)
        plane = product.plane(work, xi, eta)
        if plane is not None:
            # A plane does not act on an axis alone: what several waves have in common is let go.
            power = changed.shown * np.abs(plane) ** 2
            changed = replace(changed, power=power, along=None, across=None)
        responses = product.along(work, eta), product.across(work, xi)
        for axis, response in enumerate(responses):
            changed = changed._filtered(axis, response)
        return changed

    def averaged(self, factor_x: int, factor_y: int) -> NoisePower:
        """Behind the mean of blocks of pixels; what is left over is cropped."""
        changed = self
        for axis, factor in ((0, factor_y), (1, factor_x)):
            size, matrix = changed._size(axis), changed._matrix(axis)
            if factor > 1 and (size % factor or matrix is not None):
                changed = changed.operated(axis, _block_mean(factor), size // factor)
            elif factor > 1:
                changed = changed._folded(axis, factor, average=True)
        return changed

    def sampled(self, factor_x: int, factor_y: int) -> NoisePower | None:
        """In the middles of blocks that divide the frame; None where its waves are mixed."""
        if not self._plain or self.rows % factor_y or self.columns % factor_x:
            return None
        changed = self
        for axis, factor in ((0, factor_y), (1, factor_x)):
            if factor > 1:
                changed = changed._folded(axis, factor, average=False)
        return changed

    def cropped(self, rows: slice, columns: slice) -> NoisePower:
        new = rows.stop - rows.start, columns.stop - columns.start
        if self.power.shape == (1, 1) and self._plain:
            if self.variances is not None:
                return NoisePower.white(*new, self.variances[rows, columns])
            return replace(self, rows=new[0], columns=new[1])
        high = self.operated(0, lambda waves: waves[rows], new[0])
        return high.operated(1, lambda waves: waves[columns], new[1])

    def resampled(self, new: tuple[int, int], along: Operator, across: Operator) -> NoisePower:
        """Behind linear operators on columns (rows → new rows) and on rows of samples."""
        changed = self
        for axis, operator in ((0, along), (1, across)):
            if new[axis] != self._size(axis):
                changed = changed.operated(axis, operator, new[axis])
        return changed

    def on(self, axes: Edges) -> NoisePower:
        """On the waves of other edges."""
        if self.variances is not None and axes == "reflect":
            return replace(self, power=_cosine_variances(self.variances), axes=axes, variances=None)
        if axes == self.axes or (self.power.shape == (1, 1) and self._plain):
            return replace(self, axes=axes, variances=None)
        changed = self
        for axis in (0, 1):
            changed = changed.operated(axis, lambda waves: waves, axes=axes)
        return replace(changed, axes=axes)

    @property
    def _plain(self) -> bool:
        return self.along is None and self.across is None

    def _size(self, axis: int) -> int:
        return (self.rows, self.columns)[axis]

    def _matrix(self, axis: int) -> Matrix | None:
        return (self.along, self.across)[axis]

    def _filtered(self, axis: int, response: Array) -> NoisePower:
        size, matrix = len(response), self._matrix(axis)
        if self.axes == "reflect" and np.iscomplexobj(response):
            _refuse_dense(size)
            made = np.eye(size) if matrix is None else matrix
            return self._with(axis, size, _cosines_of(_behind(made, response)))
        if self.axes == "periodic" and size % 2 == 0:
            # At Nyquist the Hermitian part acts.
            nyquist = np.arange(size) == size // 2
            response = np.where(nyquist, response.real, response)
        if matrix is not None:
            return self._with(axis, size, response[:, np.newaxis] * matrix)
        power = self.power * np.expand_dims(np.abs(response) ** 2, 1 - axis)
        return replace(self, power=power, variances=None)

    def _folded(self, axis: int, factor: int, *, average: bool) -> NoisePower:
        """Whole blocks carry each wave to one wave, and no matrix is needed."""
        size = self._size(axis)
        new = size // factor
        number = np.arange(size)
        step = np.pi * number / (size if self.axes == "periodic" else 2 * size)
        kernel = np.ones(size)
        if average:
            kernel[1:] = np.sin(factor * step[1:]) / (factor * np.sin(step[1:]))
        target = number % new
        if self.axes == "reflect":
            target = np.abs((number + new) % (2 * new) - new)
            if not average:
                # The mean's wave is not a cosine's: its norm is half of theirs.
                kernel[(target == 0) & (number > 0)] = np.sqrt(2.0)
        elif not average and factor % 2 == 0:
            kernel[2 * number == size] = 0.0  # half-way between samples there is nothing of it
        shape = (size, self.power.shape[1]) if axis == 0 else (self.power.shape[0], size)
        power = np.moveaxis(np.broadcast_to(self.power, shape), axis, 0)
        folded = np.zeros((new + 1, power.shape[1]))
        np.add.at(folded, target, power * (kernel**2 / factor)[:, np.newaxis])
        # Wave `new` is 0 at the centre of every block.
        made = replace(self, power=np.moveaxis(folded[:new], 0, axis))
        return made._with(axis, new, None)

    def operated(
        self, axis: int, operator: Operator, new: int | None = None, axes: Edges | None = None
    ) -> NoisePower:
        """Behind an operator on the samples of an axis, taken to the waves of these edges."""
        size, matrix = self._size(axis), self._matrix(axis)
        waves = _samples_of(np.eye(size) if matrix is None else matrix, self.axes)
        made = operator(waves)
        periodic = (axes or self.axes) == "periodic"
        transformed = kernels.fft(made, axis=0, norm="ortho") if periodic else _cosines_of(made)
        return self._with(axis, new or size, transformed)

    def _with(self, axis: int, size: int, matrix: Array | None) -> NoisePower:
        if axis == 0:
            return replace(self, rows=size, along=matrix, variances=None)
        return replace(self, columns=size, across=matrix, variances=None)


def _refuse_dense(size: int) -> None:
    """Waves that a phase mixes need a matrix, which memory has to hold five times."""
    needed, usable = 40 * size**2, machine.usable_bytes()
    if usable is not None and needed > usable // 2:
        raise DataError(
            f"the noise of {size} samples in a row or column, mixed by a phase at mirrored edges, "
            f"needs {machine.amount_text(needed)} of memory, but at most "
            f"{machine.amount_text(usable // 2)} may be used. Use a smaller picture, or edges = "
            "periodic on Init & Trans"
        )


def _samples_of(amplitudes: Array, axes: Edges) -> Array:
    """Samples of columns of waves' amplitudes."""
    if axes == "periodic":
        return np.asarray(kernels.ifft(amplitudes, axis=0, norm="ortho"))
    return _each_part(amplitudes, lambda part: kernels.idct(part, type=2, axis=0, norm="ortho"))


def _cosines_of(samples: Array) -> Array:
    """Amplitudes of a mirrored frame's cosines in columns of samples."""
    return _each_part(samples, lambda part: kernels.dct(part, type=2, axis=0, norm="ortho"))


def _each_part(values: Array, transform: Operator) -> Array:
    if np.iscomplexobj(values):
        return np.asarray(transform(values.real) + 1j * transform(values.imag))
    return np.asarray(transform(values))


def _behind(amplitudes: Array, response: Array) -> Array:
    """Samples of cosines behind R + iI: each becomes R·cos − I·sin."""
    even = _samples_of(response.real[:, np.newaxis] * amplitudes, "reflect")
    # Sine k stands at index k − 1 of the DST-II; wave 0 has none.
    odd = np.zeros_like(amplitudes)
    odd[:-1] = response.imag[1:, np.newaxis] * amplitudes[1:]
    sines = _each_part(odd, lambda part: kernels.idst(part, type=2, axis=0, norm="ortho"))
    return np.asarray(even - sines)


def _cosine_variances(variances: Array) -> Array:
    """Variances of the cosines' amplitudes of independent samples: Σ of variance × cosine².

    By cos² = (1 + cos of twice the argument)/2, so that a transform has them all.
    """
    made = variances
    for axis in (0, 1):
        size = made.shape[axis]
        waves = 0.5 * kernels.dct(np.moveaxis(made, axis, 0), type=2, axis=0)
        twice = 2 * np.arange(1, size)
        doubled = (
            np.where(twice > size, -1.0, 1.0)[:, np.newaxis]
            * waves[np.where(twice > size, 2 * size - twice, twice) % size]
        )
        doubled[twice == size] = 0.0
        waves[1:] = waves[0] + doubled
        made = np.moveaxis(waves / size, 0, axis)
    return np.asarray(made)


def _carried(power: Array, shares: Array, axis: int) -> Array:
    """Variances of new waves, each a share of those of the old ones."""
    if power.shape[axis] == 1:
        return np.asarray(power * np.expand_dims(shares.sum(axis=1), 1 - axis))
    return np.asarray(shares @ power if axis == 0 else power @ shares.T)


def _block_mean(factor: int) -> Operator:
    def mean(waves: Array) -> Array:
        blocks = len(waves) // factor
        return np.asarray(waves[: blocks * factor].reshape(blocks, factor, -1).mean(axis=1))

    return mean


# Spectrum of a picture's noise in equal cells of frequency, whatever waves it is known on.

CELLS = 48  # filters of sensors are smooth: more change no share of a noise by 1e-3


def spectrum_of(powers: list[NoisePower], cells: int = CELLS) -> Vector | None:
    """Power of all of these independent noises of one picture together, of frames of one size.

    It is the mean power in each cell from frequency zero to Nyquist's, shape (along, across),
    either 1 where all cells of an axis are alike; None without any noise. A frame has no more cells
    along an axis than samples, and as many whatever waves its noises are known on.
    """
    total: Vector | None = None
    for power in powers:
        shown = np.asarray(power.shown, np.float64)
        for axis, size in ((0, power.rows), (1, power.columns)):
            if shown.shape[axis] > 1:
                shares = _shares(size, power.axes, min(cells, size))
                shown = shares @ shown if axis == 0 else shown @ shares.T
        total = shown if total is None else total + shown
    return total if total is not None and total.sum() > 0.0 else None


def _shares(size: int, axes: Edges, cells: int) -> Vector:
    """Share that each wave has in the mean over each cell, shape (cells, waves).

    A wave stands for the frequencies nearer to its own than to its neighbours'.
    """
    if axes == "reflect":
        place = np.arange(size) / size  # of Nyquist's frequency
        twice = np.ones(size)
        order = np.arange(size)
    else:
        order = np.minimum(np.arange(size), size - np.arange(size))
        place = np.arange(size // 2 + 1) / (size / 2.0)
        twice = np.bincount(order).astype(float)
    bounds = np.concatenate([[0.0], (place[1:] + place[:-1]) / 2.0, [1.0]])
    edges = np.linspace(0.0, 1.0, cells + 1)
    low = np.maximum(edges[:-1, np.newaxis], bounds[:-1])
    high = np.minimum(edges[1:, np.newaxis], bounds[1:])
    part = np.clip(high - low, 0.0, None) * (len(edges) - 1)
    return np.asarray((part / twice)[:, order], np.float64)
