"""Periodic noise of a picture: frequency, amplitude and phase of sine waves all over it."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from core.physics.measurement.noise.flat_blocks import (
    COARSE,
    FINE,
    SIDE,
    FlatBlocks,
    PictureBlocks,
    flat_blocks,
    picture_blocks,
)

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Single = NDArray[np.float32]
Mask = NDArray[np.bool_]

_MEAN = 9  # samples whose mean is taken off: what the scene has at low frequencies
_LOWEST = 0.07  # cycles per sample, below which a line is not told from the scene
_LIMIT = 3.0  # deviations at which the residual is cut: edges
_CELL = 16  # bins over which the floor is a median
_ON_AXIS = 2  # bins beside an axis, where rows and columns have power
_CHANCE = 1e-3  # that noise alone shows a line
_MOST = 8
_BESIDE = 3  # bins round a line that are its own
_LEAST = 64  # samples along a side
_AGREE = 0.15  # of the power, by which quarters of the blocks may differ beyond chance
_PARTS = 4
_MOST_BLOCKS = 400
_ROUNDS, _SETTLED = 4, 0.02  # rounds; bins of the spectrum
_MOST_SIDE = 2048  # samples along a side that the lines are looked for in


@dataclass(frozen=True)
class PeriodicLine:
    """A sine wave all over the picture, amplitude · cos(2π (x·across + y·down) + phase)."""

    # cycles per sample along the rows, 0 to 0.5, and along the columns, −0.5 to 0.5
    across: float
    down: float
    # in the picture's unit, and the standard error
    amplitude: float
    amplitude_error: float
    phase: float  # radians, at the middle of the first sample

    @property
    def frequency(self) -> float:
        """Cycles per sample along the wave's normal."""
        return math.hypot(self.across, self.down)

    def at(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Matrix:
        """The wave at rows and columns, which are broadcast."""
        # A sum of angles splits into products of what is short along one axis.
        down = 2.0 * math.pi * self.down * rows + self.phase
        across = 2.0 * math.pi * self.across * columns
        wave = np.cos(down) * np.cos(across) - np.sin(down) * np.sin(across)
        return np.asarray(self.amplitude * wave, np.float64)


Lines = tuple[PeriodicLine, ...]


def line_frequencies(
    *, picture: Matrix, check: Callable[[], None] = lambda: None
) -> tuple[tuple[float, float], ...]:
    """Frequencies across and down at which a picture's spectrum has lines, the strongest first.

    Notes
    -----
    The power of white noise over its mean is exponentially distributed: a line is what no bin of so
    many reaches by chance. The floor is the median of the bins round about.
    """
    if min(picture.shape) < _LEAST:
        return ()
    first = [max(0, (size - _MOST_SIDE) // 2) for size in picture.shape]
    picture = picture[first[0] : first[0] + _MOST_SIDE, first[1] : first[1] + _MOST_SIDE]
    residual = _residual(picture)
    check()
    spectrum = scipy.fft.rfft2(residual, workers=1)
    check()
    power = (spectrum.real**2 + spectrum.imag**2).astype(np.float32)
    down = scipy.fft.fftfreq(picture.shape[0])
    across = scipy.fft.rfftfreq(picture.shape[1])
    # What the local mean leaves of white noise rises from zero: its floor must not.
    left = 1.0 - np.outer(_mean_response(down), _mean_response(across))
    power /= np.maximum(left**2, 1e-3).astype(np.float32)
    power /= _floor(power)
    power[np.hypot(down[:, np.newaxis], across) < _LOWEST] = 0.0
    # The spectrum repeats itself on the first column and, of even sizes, on the last.
    power[len(down) // 2 + 1 :, 0] = 0.0
    limit = math.log(power.size / _CHANCE)
    found: list[tuple[float, float]] = []
    for _ in range(_MOST):
        row, column = divmod(int(np.argmax(power)), power.shape[1])
        if power[row, column] <= limit:
            break
        found.append(_peak(spectrum, row, column, picture.shape))
        rows = np.arange(row - _BESIDE, row + _BESIDE + 1) % power.shape[0]
        power[rows, max(column - _BESIDE, 0) : column + _BESIDE + 1] = 0.0
    return tuple(found)


def _residual(picture: Matrix) -> Single:
    """The picture less its local mean, cut at its own noise, tapered towards the sides."""
    residual: Single = (picture - picture.mean()).astype(np.float32)
    residual -= _local_mean(_local_mean(residual, 0), 1)
    spots = np.abs(residual[:: max(1, residual.shape[0] // 256)])
    spread = float(np.median(spots)) * 1.4826
    if spread > 0.0:
        np.clip(residual, -_LIMIT * spread, _LIMIT * spread, out=residual)
    for axis, size in enumerate(residual.shape):
        taper = np.sin(math.pi * (np.arange(size) + 0.5) / size).astype(np.float32) ** 2
        residual *= taper[:, np.newaxis] if axis == 0 else taper
    return residual


def _local_mean(samples: Single, axis: int) -> Single:
    """Mean of the samples round about along an axis; at the ends of those inside."""
    half = _MEAN // 2
    wide = np.pad(samples, [(half + 1, half) if k == axis else (0, 0) for k in (0, 1)], "reflect")
    sums = np.cumsum(wide, axis=axis, dtype=np.float64)
    size = samples.shape[axis]
    later = np.take(sums, np.arange(_MEAN, _MEAN + size), axis=axis)
    mean = (later - np.take(sums, np.arange(size), axis=axis)) / _MEAN
    return np.asarray(mean, np.float32)


def _mean_response(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Transfer function of the mean of samples round about."""
    cosines = np.cos(2.0 * math.pi * np.outer(np.arange(1, _MEAN // 2 + 1), frequency))
    return np.asarray((1.0 + 2.0 * cosines.sum(axis=0)) / _MEAN, np.float64)


def _floor(power: Single) -> Single:
    """Mean power round about a bin, by the median: of an exponential distribution."""
    rows, columns = power.shape
    down, across = math.ceil(rows / _CELL), math.ceil(columns / _CELL)
    wide = np.pad(power, ((0, down * _CELL - rows), (0, across * _CELL - columns)), "reflect")
    cells = wide.reshape(down, _CELL, across, _CELL).transpose(0, 2, 1, 3)
    middle = np.median(cells.reshape(down, across, -1), axis=2) / math.log(2.0)
    cell = np.repeat(np.repeat(middle, _CELL, 0), _CELL, 1)
    floor = np.asarray(cell[:rows, :columns], np.float32)
    # Rows and columns of their own have power along the axes, at all frequencies of the other.
    near = np.minimum(np.arange(rows), rows - np.arange(rows)) <= _ON_AXIS
    floor[near] = np.maximum(floor[near], _along(power[near], 1))
    floor[:, : _ON_AXIS + 1] = np.maximum(
        floor[:, : _ON_AXIS + 1], _along(power[:, : _ON_AXIS + 1], 0)
    )
    return np.asarray(np.maximum(floor, 1e-30), np.float32)


def _along(power: Single, axis: int) -> Single:
    """Mean power by the median of the bins along an axis."""
    size = power.shape[axis]
    parts = np.array_split(np.arange(size), max(1, size // (2 * _CELL)))
    floor = np.empty_like(power)
    for part in parts:
        values = np.take(power, part, axis=axis)
        middle = np.median(values, axis=axis, keepdims=True) / math.log(2.0)
        place = (slice(part[0], part[-1] + 1), slice(None))
        floor[place if axis == 0 else place[::-1]] = middle
    return floor


def _peak(
    spectrum: NDArray[np.complex64], row: int, column: int, shape: tuple[int, ...]
) -> tuple[float, float]:
    """Frequencies of a line between its bins, of a cos²-tapered picture."""
    rows = spectrum.shape[0]
    modulus = np.abs(spectrum[[(row - 1) % rows, row, (row + 1) % rows], column])
    down = (row + _between(*map(float, modulus))) / shape[0]
    before = spectrum[row, column - 1] if column else np.conj(spectrum[-row % rows, 1])
    last = column + 1 >= spectrum.shape[1]
    after = np.conj(spectrum[-row % rows, column - 1]) if last else spectrum[row, column + 1]
    middle = float(np.abs(spectrum[row, column]))
    across = (column + _between(float(np.abs(before)), middle, float(np.abs(after)))) / shape[1]
    return (across, down - 1.0 if down > 0.5 else down)


def _between(before: float, middle: float, after: float) -> float:
    """Place of the peak of a cos² taper's spectrum from the modulus of three bins.

    Of the larger neighbour b and the middle bin a: (2 b − a) / (b + a) (Grandke 1983).
    """
    side, sign = (after, 1.0) if after >= before else (before, -1.0)
    if not middle + side > 0.0:
        return 0.0
    return sign * (2.0 * side - middle) / (side + middle)


def fitted_lines(
    *,
    picture: Matrix,
    frequencies: tuple[tuple[float, float], ...],
    places: NDArray[np.intp],
    grid: tuple[int, int],
    variance: float,
    structure: NDArray[np.float64] | None = None,
) -> Lines:
    """Amplitudes and phases of waves in blocks of the picture, less a plane through each.

    `variance` is that of the white noise, `structure` the power of each block that is not of the
    waves. Given are those whose power noise alone reaches in one of a thousand pictures, that
    quarters of the blocks agree on, and that the half with less structure shows by itself: the
    tails of a pattern's edges are in the other half alone.
    """
    if not frequencies or not len(places):
        return ()
    every = max(1, len(places) // _MOST_BLOCKS)
    places = places[::every]
    row, column = np.divmod(places, grid[1])
    offsets = np.arange(SIDE)
    y = (row[:, np.newaxis, np.newaxis] * SIDE + offsets[:, np.newaxis]).astype(np.intp)
    x = (column[:, np.newaxis, np.newaxis] * SIDE + offsets).astype(np.intp)
    samples = picture[y, x].reshape(-1, SIDE * SIDE)
    samples = (samples - samples.mean(axis=1, keepdims=True)) @ _off_plane()
    fit = _Fit(x, y, picture.shape, samples)
    at = np.array(frequencies)
    for _ in range(_ROUNDS):
        weights, _ = fit.weights(at)
        step = fit.steps(at, weights)
        at = at + step
        if np.abs(step).max() < _SETTLED / max(picture.shape):
            break
    weights, covariance = fit.weights(at)
    parts = fit.quarters(at)
    plain = np.full(len(at), math.inf)
    if structure is not None:
        plain = fit.power_over_noise(at, structure[::every] <= np.median(structure[::every]))
    limit = math.log(0.5 * picture.size / _CHANCE)  # of as many frequencies as there are
    lines = []
    for k, (across, down) in enumerate(at):
        value = complex(weights[2 * k], weights[2 * k + 1])
        spread = variance * float(covariance[2 * k, 2 * k] + covariance[2 * k + 1, 2 * k + 1]) / 2.0
        power = abs(value) ** 2
        scatter = float(np.mean(np.abs(parts[:, k] - value) ** 2))
        agreed = scatter <= _AGREE * power + 4.0 * 2.0 * _PARTS * spread
        if not agreed or power <= 2.0 * limit * spread:
            continue
        if plain[k] <= -2.0 * math.log(_CHANCE) * variance:
            continue
        amplitude = math.sqrt(power)
        # The phase was fitted about the middle of the picture.
        middle = across * fit.middle[1] + down * fit.middle[0]
        phase = math.remainder(cmath.phase(value) - 2.0 * math.pi * middle, 2.0 * math.pi)
        # Structure of the scene makes quarters differ by more than noise does.
        error = math.sqrt(max(spread, 0.5 * scatter / (_PARTS - 1.0)))
        lines.append(PeriodicLine(float(across), float(down), amplitude, error, phase))
    return tuple(sorted(lines, key=lambda line: -line.amplitude))


class _Fit:
    """Least squares of waves to the samples of blocks, less a plane through each."""

    def __init__(
        self, x: NDArray[np.intp], y: NDArray[np.intp], shape: tuple[int, ...], samples: Matrix
    ) -> None:
        self.middle = (shape[0] - 1) / 2.0, (shape[1] - 1) / 2.0
        self._x = np.broadcast_to(x - self.middle[1], (len(x), SIDE, SIDE)).reshape(len(x), -1)
        self._y = np.broadcast_to(y - self.middle[0], (len(y), SIDE, SIDE)).reshape(len(y), -1)
        self._samples = samples
        self._off_plane = _off_plane()

    def weights(self, at: Matrix) -> tuple[NDArray[np.float64], Matrix]:
        """Real and imaginary amplitude of each wave, and what noise of variance 1 adds to them."""
        return self._fitted(self._waves(at), self._samples)

    def steps(self, at: Matrix, weights: NDArray[np.float64]) -> Matrix:
        """By how much the frequencies are off: a step of Gauss and Newton."""
        waves = self._waves(at)
        turns = []
        for k in range(len(at)):
            cosine, sine = waves[2 * k], -waves[2 * k + 1]
            turned = -2.0 * math.pi * (weights[2 * k] * sine + weights[2 * k + 1] * cosine)
            turns += [
                turned * self._x / (2.0 * self.middle[1]),
                turned * self._y / (2.0 * self.middle[0]),
            ]
        # In bins of the spectrum: all columns of one size.
        size = np.array([2.0 * self.middle[1], 2.0 * self.middle[0]])
        fitted, _ = self._fitted([*waves, *turns], self._samples)
        # No further than the bins of the spectrum that showed the line.
        return np.asarray(np.clip(fitted[len(waves) :].reshape(-1, 2), -0.5, 0.5) / size)

    def quarters(self, at: Matrix) -> NDArray[np.complex128]:
        """Complex amplitudes by quarters of the blocks, from the top to the bottom."""
        waves = self._waves(at)
        fits = []
        for part in np.array_split(np.arange(len(self._samples)), _PARTS):
            fitted, _ = self._fitted([wave[part] for wave in waves], self._samples[part])
            fits.append(fitted[::2] + 1j * fitted[1::2])
        return np.array(fits)

    def power_over_noise(self, at: Matrix, part: Mask) -> NDArray[np.float64]:
        """Squared amplitudes in part of the blocks over what noise of variance 1 adds to each."""
        waves = [wave[part] for wave in self._waves(at)]
        fitted, covariance = self._fitted(waves, self._samples[part])
        spread = np.diag(covariance)
        own = 0.5 * (spread[::2] + spread[1::2])
        return np.asarray((fitted[::2] ** 2 + fitted[1::2] ** 2) / own, np.float64)

    def _waves(self, at: Matrix) -> list[Matrix]:
        waves = []
        for across, down in at:
            angle = 2.0 * math.pi * (across * self._x + down * self._y)
            waves += [np.cos(angle), -np.sin(angle)]
        return waves

    def _fitted(self, waves: list[Matrix], samples: Matrix) -> tuple[NDArray[np.float64], Matrix]:
        """Weights of waves, and what noise of variance 1 adds to them."""
        matrix = np.stack([(wave @ self._off_plane).ravel() for wave in waves], axis=1)
        covariance = np.asarray(np.linalg.pinv(matrix.T @ matrix), np.float64)
        return covariance @ (matrix.T @ samples.ravel()), covariance


def _off_plane() -> Matrix:
    """Projection of a block's samples off its mean and its slopes."""
    y, x = np.indices((SIDE, SIDE)).reshape(2, -1) - (SIDE - 1) / 2.0
    plane = np.stack([np.full(SIDE * SIDE, 1.0 / SIDE), x / np.sqrt(x @ x), y / np.sqrt(y @ y)])
    return np.asarray(np.eye(SIDE * SIDE) - plane.T @ plane, np.float64)


# Blocks of a picture free of its periodic lines, which would hide what is flat.

_QUIET = 0.4  # of the blocks, in which lines are fitted to begin with
_EDGE = 4.0  # times the median power of waves along an axis
_REMOVALS = 2


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
) -> tuple[PictureBlocks, FlatBlocks | None, Lines]:
    """Blocks without periodic lines, the flat ones of them, and these lines."""
    lines: Lines = ()
    frequencies = line_frequencies(picture=picture, check=check)
    if frequencies:
        structure = blocks.mean_power(COARSE) + blocks.axis_power()
        quiet = structure <= np.quantile(structure, _QUIET)
        variance = float(np.median(blocks.mean_power(FINE)[quiet]))
        lines = _fitted(picture, blocks, quiet, frequencies, variance)
    free = _less(picture, good, blocks, lines, check)
    flat = flat_blocks(blocks=free, at=at, least=least, low=low, high=high)
    for _ in range(_REMOVALS if lines else 0):
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
    return free, flat, lines


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
