"""Noise of frames of one scene that does not move: by kinds, and temporal noise over the level."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from core.errors import DataError
from core.physics.measurement.noise.clipped_ends import clipped_ends
from core.physics.measurement.noise.picture_blocks import SIDE
from core.physics.measurement.noise.rounding_step import rounding_step
from core.physics.measurement.noise.variance_levels import (
    LevelVariance,
    gain_figure,
    level_variances,
    read_noise_figure,
)
from core.physics.measurement.noise.variance_line import VarianceLine, variance_line
from core.physics.noise.noise_cube import MeasuredNoise, NoiseCube

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

_LEAST_BLOCKS = 24
_KEPT = 0.999  # of the blocks of noise alone that count
_MOVED = 0.3  # of the blocks with more, beyond which the scene moves
_FROM_END = 5.0  # deviations from a clipped end within which noise is cut
_ROUNDS = 10
_COARSE_STEPS = 0.5  # deviations of the noise in steps, below which rounding hides it


@dataclass(frozen=True)
class FramesNoise:
    """What frames show of their noise; None, with a reason, of what they do not.

    Parameters
    ----------
    sigma, sigma_error, sigma_reason
        Temporal noise of a sample at the mean level, rounding included, without what whole rows,
        columns and frames share.
    mean_level : float
        Of all frames.
    gain_e_per_dn, gain_error, gain_reason
        Electrons of one unit of the frames.
    read_noise_dn, read_noise_error, read_noise_reason
        Noise at the level without light, rounding taken off.
    levels : tuple of LevelVariance
        Temporal variance over the level.
    components : MeasuredNoise
        The seven of 3-D noise; the fixed ones hold the scene.
    step : float or None
        Of the converter; None where the samples show none.
    """

    sigma: float | None
    sigma_error: float | None
    sigma_reason: str
    mean_level: float
    gain_e_per_dn: float | None
    gain_error: float | None
    gain_reason: str
    read_noise_dn: float | None
    read_noise_error: float | None
    read_noise_reason: str
    levels: tuple[LevelVariance, ...]
    components: MeasuredNoise
    step: float | None


class SceneFrames:
    """Takes frames of a scene one by one and keeps sums alone.

    Parameters
    ----------
    rows, columns : int
        Size of the frames, 2 or more.

    Notes
    -----
    A sample's variance in time needs no flat area. What whole rows, columns and frames share is
    taken off each frame against the first, by the means of their difference.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self._cube = NoiseCube(rows, columns)
        self._first: Matrix | None = None
        self._sum = np.zeros((rows, columns))
        self._squares = np.zeros((rows, columns))
        self._own = np.zeros((rows, columns))
        self._frames = 0

    def add(self, frame: NDArray[Any]) -> None:
        """Take another frame, shape (rows, columns).

        Raises
        ------
        DataError
            For a frame of another size, or samples that are not finite.
        """
        samples = np.asarray(frame, np.float64)
        if not np.isfinite(samples).all():
            raise DataError("a frame has samples that are not finite numbers: noise needs finite")
        self._cube.add(samples)
        if self._first is None:
            self._first = samples.copy()
        away = samples - self._first
        self._sum += away
        rows = away.mean(axis=1, keepdims=True)
        away -= rows + away.mean(axis=0) - rows.mean()
        self._squares += away * away
        self._frames += 1
        self._own += away

    def measured(self, *, offset: float = 0.0) -> FramesNoise:
        """The noise of the frames so far; `offset` is the level without light.

        Raises
        ------
        DataError
            With fewer than two frames.
        """
        components = self._cube.measured()
        n = self._frames
        assert self._first is not None
        rows, columns = self._first.shape
        # Row and column means took so many degrees of freedom along with them.
        left = (rows - 1) * (columns - 1) / (rows * columns)
        variance = (self._squares - self._own**2 / n) / ((n - 1) * left)
        low, high = clipped_ends(picture=self._first)
        step = rounding_step(picture=self._first)
        level, power = _blocks(self._first + self._sum / n), _blocks(variance)
        freedom = (n - 1) * SIDE * SIDE
        rounding = 0.0 if step is None else step**2 / 12.0
        line, chosen, reason = _settled(level, power, freedom, low, high)
        mean = components.mean
        if float(np.median(power)) <= rounding + (_COARSE_STEPS * (step or 0.0)) ** 2:
            reason = "rounding hides the noise" if step else "the frames have no temporal noise"
        if line is None or reason:
            nothing = None, None, reason
            return FramesNoise(*nothing, mean, *nothing, *nothing, (), components, step)
        at_mean, error = line.bounded(offset).at(mean)
        gain = gain_figure(line=line, level=level[chosen])
        return FramesNoise(
            math.sqrt(at_mean),
            error / (2.0 * math.sqrt(at_mean)),
            "",
            mean,
            *gain,
            *read_noise_figure(
                line=line,
                level=level[chosen],
                with_gain=gain[0] is not None,
                rounding=rounding,
                offset=offset,
            ),
            level_variances(level=level[chosen], variance=power[chosen]),
            components,
            step,
        )


def _blocks(samples: Matrix) -> Vector:
    """Means of blocks of 8 × 8 samples, all of them in one row."""
    rows, columns = (size // SIDE for size in samples.shape)
    whole = samples[: rows * SIDE, : columns * SIDE]
    return np.asarray(whole.reshape(rows, SIDE, columns, SIDE).mean(axis=(1, 3)).ravel())


def _settled(
    level: Vector, power: Vector, freedom: int, low: float | None, high: float | None
) -> tuple[VarianceLine | None, NDArray[np.bool_], str]:
    """Line through the blocks that have no more than noise, these, and why there is none."""
    chosen = np.ones(len(level), bool)
    if low is not None:
        chosen &= level - _FROM_END * np.sqrt(power) > low
    if high is not None:
        chosen &= level + _FROM_END * np.sqrt(power) < high
    inside = chosen.copy()
    if np.count_nonzero(inside) < _LEAST_BLOCKS:
        return None, chosen, f"fewer than {_LEAST_BLOCKS} blocks of {SIDE} × {SIDE} are not clipped"
    limit = 2.0 * float(special.gammaincinv(freedom / 2.0, _KEPT)) / freedom
    chosen &= power <= 2.0 * np.median(power[chosen])
    line = variance_line(level=level[chosen], variance=power[chosen])
    for _ in range(_ROUNDS):
        before = chosen
        chosen = inside & (power <= limit * line.over(level))
        if np.count_nonzero(chosen) < _LEAST_BLOCKS:
            break
        line = variance_line(level=level[chosen], variance=power[chosen])
        if np.array_equal(before, chosen):
            break
    moved = 1.0 - np.count_nonzero(chosen) / np.count_nonzero(inside)
    if moved > _MOVED or np.count_nonzero(chosen) < _LEAST_BLOCKS:
        return None, chosen, f"{moved:.0%} of the scene change between the frames: it moves"
    return line, chosen, ""
