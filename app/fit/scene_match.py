"""A simulated picture registered to a real one, and compared wave by wave.

Shift, scale, gain and offset are no parameters of the chain: for every simulated picture they are
fitted too. Between its samples the simulated picture is that of its own waves, exactly. What is
left is weighted by the power of the noise at each frequency: white, of rows and of columns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from core.errors import DataError
from core.transfer.sampled_waves import mirrored_waves

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

OWN = 5  # shift across and down, scale, gain, offset
_MARGIN = 0.06  # of a side, over which the window rises
_HIGH, _LINES, _LOW = 0.3, 0.05, 0.25  # cycles per sample
_STILL = 1e-6  # of the largest sample: what single precision leaves
_STEP = 0.02  # samples, for derivatives by place
_LEAST_MATCH = 0.2  # correlation, below which the pictures are not of one scene
_MOST_LEFT = 0.5  # of the picture's variance beyond noise, when all is fitted
FIT_EDGES = "fit its edges instead, without a known scene"
LEAVE_OUT = "leave out --known-scene"
_MOST_SCALE = 2.0  # a corner of a scene, magnified, is like any edge


@dataclass(frozen=True)
class Registration:
    # samples, to the right and down
    shift_x: float = 0.0
    shift_y: float = 0.0
    scale: float = 1.0  # about the middle; above 1 the real picture is larger
    # what the simulated samples are multiplied by, and what is added
    gain: float = 1.0
    offset: float = 0.0

    @property
    def place(self) -> tuple[float, float, float]:
        return self.shift_x, self.shift_y, self.scale

    def moved(self, by: Vector) -> Registration:
        names = ("shift_x", "shift_y", "scale", "gain", "offset")
        changes = {
            name: getattr(self, name) + float(change)
            for name, change in zip(names, by, strict=True)
        }
        return replace(self, **changes)


@dataclass(frozen=True)
class SceneFit:
    # the picture, and the fitted network's where the picture has it
    real: Matrix
    simulated: Matrix
    noise_sigma: float  # white noise of the picture's samples


class SceneMatch:
    """A real picture, with the window and the weights of its waves, which begin alike."""

    def __init__(self, picture: Matrix, power: Matrix | None = None) -> None:
        self.picture = picture
        rows, columns = picture.shape
        self._window = np.outer(_window(rows), _window(columns))
        twice = np.full(columns // 2 + 1, 2.0)  # waves that stand for those of −f too
        twice[0] = 1.0
        if columns % 2 == 0:
            twice[-1] = 1.0
        if power is None:
            power = np.full((rows, columns // 2 + 1), max(float(picture.var()), 1e-300))
        self._weight = np.sqrt(twice / (power * rows * columns))
        self._twice = twice
        self.noise_sigma = float(np.sqrt(np.median(power)))
        self.samples = float(np.sum(self._window**2))

    def reweighted(self, difference: Matrix) -> SceneMatch:
        """With the power of the noise that a difference shows: white, of rows and of columns.

        Taken where a scene has least, at high frequencies; medians, which single waves do not move.
        """
        rows, columns = self.picture.shape
        spectrum = scipy.fft.rfft2(difference * self._window)
        seen = (spectrum.real**2 + spectrum.imag**2) / self.samples
        across = np.abs(scipy.fft.rfftfreq(columns))
        down = np.abs(scipy.fft.fftfreq(rows))
        high = np.hypot(across[np.newaxis, :], down[:, np.newaxis]) > _HIGH
        high[:, :2] = high[:2, :] = False
        # Powers of noise are exponential: their median is ln 2 of the mean.
        white = float(np.median(seen[high])) / math.log(2.0)
        if not white > (_STILL * float(np.abs(self.picture).max())) ** 2:
            raise DataError(
                "the picture and the network's picture do not differ by any noise; the noise "
                "weights the fit, so no errors can be given"
            )
        power = np.full(seen.shape, white)
        power[:, 0] = max(white, float(np.median(seen[down > _LINES, 0])) / math.log(2.0))
        power[0, :] = max(white, float(np.median(seen[0, across > _LINES])) / math.log(2.0))
        return SceneMatch(self.picture, power)

    def check_same_scene(self, difference: Matrix, how: Registration) -> None:
        """Refuse a fit that leaves most of the picture: another scene meets any by chance."""
        if not 1.0 / _MOST_SCALE <= how.scale <= _MOST_SCALE:
            raise DataError(
                "the picture does not show the network's scene: it fits best at "
                f"{how.scale:.3g} times the size, allowed: {1.0 / _MOST_SCALE:g} to "
                f"{_MOST_SCALE:g} times; {FIT_EDGES}",
                hint=LEAVE_OUT,
            )
        noise = self.noise_sigma**2
        whole = float(np.var(self.picture[self._window == 1.0])) - noise
        left = float(np.var(difference[self._window == 1.0])) - noise
        if left > _MOST_LEFT * max(whole, 0.0):
            raise DataError(
                "the picture does not show the network's scene: at the best position, "
                f"{how.shift_x:.1f}, {how.shift_y:.1f} samples away and {how.scale:.3g} times "
                f"as large, {100.0 * min(left / max(whole, 1e-300), 1.0):.0f} % of its "
                f"contrast (variance) is left, allowed: {100.0 * _MOST_LEFT:.0f} %; {FIT_EDGES}",
                hint=LEAVE_OUT,
            )

    def low_waves(self, residual: Vector) -> tuple[float, int]:
        """Sum of squares of the waves at which scenes have most, and how many there are."""
        rows, columns = self.picture.shape
        across = scipy.fft.rfftfreq(columns)[np.newaxis, :]
        low = np.hypot(across, scipy.fft.fftfreq(rows)[:, np.newaxis]) < _LOW
        both = np.concatenate([low.ravel(), low.ravel()])
        share = float(np.sum(low * self._twice)) / (rows * columns)
        return float(residual[both] @ residual[both]), int(share * self.samples)

    def waves(self, difference: Matrix) -> Vector:
        """A difference of pictures, windowed, as weighted waves: real parts, then imaginary."""
        spectrum = scipy.fft.rfft2(difference * self._window) * self._weight
        return np.concatenate([spectrum.real.ravel(), spectrum.imag.ravel()])

    def coarse(self, simulated: Matrix) -> Registration:
        """Whole samples of shift, gain and offset."""
        real, made = ((one - one.mean()) * self._window for one in (self.picture, simulated))
        product = scipy.fft.rfft2(real) * np.conj(scipy.fft.rfft2(made))
        common = scipy.fft.irfft2(product, real.shape)
        rows, columns = real.shape
        row, column = np.unravel_index(int(np.argmax(common)), common.shape)
        size = float(np.linalg.norm(real) * np.linalg.norm(made))
        # A picture all of one level has nothing in common with any scene.
        match = float(common[row, column]) / size if size > 0.0 else 0.0
        if not match > _LEAST_MATCH:
            raise DataError(
                "the picture does not show the network's scene: their best correlation is "
                f"{match:.2f}, needed: {_LEAST_MATCH:g}; {FIT_EDGES}",
                hint=LEAVE_OUT,
            )
        shift_y = float(row if row <= rows // 2 else row - rows)
        shift_x = float(column if column <= columns // 2 else column - columns)
        gain = match * float(np.linalg.norm(real) / np.linalg.norm(made))
        offset = float(self.picture.mean()) - gain * float(simulated.mean())
        return Registration(shift_x, shift_y, 1.0, gain, offset)

    def registered(self, simulated: Matrix, how: Registration) -> Matrix:
        return how.gain * resampled(simulated, how) + how.offset

    def columns(self, simulated: Matrix, how: Registration) -> list[Vector]:
        """Derivatives of the registered picture's waves by shift, scale, gain and offset."""
        rows, columns = simulated.shape
        x = (np.arange(columns) - (columns - 1) / 2.0)[np.newaxis, :] / how.scale
        y = (np.arange(rows) - (rows - 1) / 2.0)[:, np.newaxis] / how.scale
        here = resampled(simulated, how)
        step = np.zeros(OWN)
        slopes = []
        for axis in range(2):
            step[:] = 0.0
            step[axis] = _STEP
            right, left = how.moved(step), how.moved(-step)
            slopes.append((resampled(simulated, right) - resampled(simulated, left)) / (2 * _STEP))
        by_x, by_y = slopes
        made = (
            how.gain * by_x, how.gain * by_y, how.gain * (x * by_x + y * by_y),
            here, np.ones_like(here),
        )  # fmt: skip
        return [self.waves(one) for one in made]


def resampled(simulated: Matrix, how: Registration) -> Matrix:
    """The picture at the places that the real one's samples have in it, by its own waves."""
    if (how.shift_x, how.shift_y, how.scale) == (0.0, 0.0, 1.0):
        return simulated
    made = simulated
    mean = float(made.mean())
    made = (made - mean).astype(np.float32)
    for axis, shift in ((1, how.shift_x), (0, how.shift_y)):
        size = made.shape[axis]
        middle = (size - 1) / 2.0
        places = (np.arange(size) - middle - shift) / how.scale + middle
        waves = mirrored_waves(size, places, odd=False).astype(np.float32)
        lines = scipy.fft.dct(made, axis=axis)
        made = lines @ waves if axis == 1 else waves.T @ lines
    return np.asarray(made, np.float64) + mean


def _window(size: int) -> Vector:
    """1, but for a rise over a margin at both ends (Tukey)."""
    rise = max(4, round(_MARGIN * size))
    window = np.ones(size)
    ramp = 0.5 - 0.5 * np.cos(np.pi * (np.arange(rise) + 0.5) / rise)
    window[:rise], window[-rise:] = ramp, ramp[::-1]
    return window
