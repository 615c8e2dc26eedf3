"""Noise of frames of one scene that does not move: by kinds, and temporal noise over the level."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from core.errors import DataError
from core.physics.measurement.noise.digitisation import clipped_ends, rounding_step
from core.physics.measurement.noise.flat_blocks import SIDE, clear_of_ends
from core.physics.measurement.noise.variance_levels import (
    SampleNoise,
    gain_and_read_noise,
    level_variances,
    withheld,
)
from core.physics.measurement.noise.variance_line import VarianceLine, variance_line
from core.physics.noise.noise_components import MeasuredNoise, NoiseCube

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

_LEAST_BLOCKS = 24
_KEPT = 0.999  # of the blocks of noise alone that count
_MOVED = 0.3  # of the blocks with more, beyond which the scene moves
_STILL = 6.0  # deviations of what differs from the first frame, beyond which something moves
_NORMAL = 1.4826  # deviation over the median of absolute deviations, of a normal distribution
_ROUNDS = 10
_MOST_GROUPS = 16  # of levels
_COARSE_STEPS = 0.5  # deviations of the noise in steps, below which rounding hides it


@dataclass(frozen=True, kw_only=True)
class FramesNoise(SampleNoise):
    """What changes from frame to frame, without what whole rows, columns and frames share."""

    components: MeasuredNoise  # the seven of 3-D noise; the fixed ones hold the scene


class SceneFrames:
    """Takes frames of a scene, of 2 rows and columns or more, one by one; keeps sums alone.

    A sample's variance in time needs no flat area. What whole rows, columns and frames share is
    taken off each frame against the first, by the means of their difference where nothing passes
    through.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self._cube = NoiseCube(rows, columns)
        self._first: Matrix | None = None
        self._squares = np.zeros((rows, columns))
        self._own = np.zeros((rows, columns))
        self._still_squares = np.zeros((rows, columns))
        self._frames = 0

    def add(self, frame: NDArray[Any]) -> None:
        """Take another frame, shape (rows, columns)."""
        samples = np.asarray(frame, np.float64)
        if not np.isfinite(samples).all():
            raise DataError(
                "a frame has samples that are not finite numbers, so the noise cannot be measured"
            )
        self._cube.add(samples)
        if self._first is None:
            self._first = samples.copy()
        away = samples - self._first
        still = _still(away)
        away -= _means(away, still, 1)
        away -= _means(away, still, 0)
        self._own += away
        away *= away
        self._squares += away
        away *= still
        self._still_squares += away
        self._frames += 1

    def measured(self, *, offset: float = 0.0) -> FramesNoise:
        """The noise of the frames so far, two or more; `offset` is the level without light."""
        components = self._cube.measured()
        n = self._frames
        assert self._first is not None
        variance = (self._squares - self._own**2 / n) / (n - 1)
        # Of that, what went into the means of rows and columns.
        share = self._still_squares / np.maximum(self._squares, np.finfo(np.float64).tiny)
        variance = _with_means(variance, variance * share)
        low, high = clipped_ends(picture=self._first)
        step = rounding_step(picture=self._first)
        level, power = _blocks(self._first), _blocks(variance)
        freedom = (n - 1) * SIDE * SIDE
        rounding = 0.0 if step is None else step**2 / 12.0
        line, chosen, reason = _settled(level, power, freedom, low, high)
        mean = components.mean
        if float(np.median(power)) <= rounding + (_COARSE_STEPS * (step or 0.0)) ** 2:
            reason = "rounding hides the noise" if step else "the frames have no temporal noise"
        if line is None or reason:
            return FramesNoise(
                mean_level=mean, step=step, components=components, **withheld(reason)
            )
        at_mean, error = line.bounded(offset).at(mean)
        level, power = level[chosen], power[chosen]
        return FramesNoise(
            mean_level=mean,
            step=step,
            sigma=math.sqrt(at_mean),
            sigma_error=error / (2.0 * math.sqrt(at_mean)),
            levels=level_variances(level=level, variance=power),
            components=components,
            **gain_and_read_noise(line=line, level=level, rounding=rounding, offset=offset),
        )


def _still(away: Matrix) -> NDArray[np.bool_]:
    """Samples that differ from the first frame's as most do: what passes through the scene not."""
    from_most = np.abs(away - np.median(away))
    spread = _NORMAL * float(np.median(from_most))
    if not spread > 0.0:
        return np.ones(away.shape, bool)
    return np.asarray(from_most <= _STILL * spread)


def _means(away: Matrix, still: NDArray[np.bool_], axis: int) -> Matrix:
    """Means along an axis of what stands still; of all, where that is less than half."""
    counts = still.sum(axis=axis, keepdims=True)
    enough = 2 * counts >= away.shape[axis]
    of_still = np.sum(away, axis=axis, keepdims=True, where=still) / np.maximum(counts, 1)
    return np.asarray(np.where(enough, of_still, away.mean(axis=axis, keepdims=True)))


def _with_means(variance: Matrix, averaged: Matrix) -> Matrix:
    """Variances of samples, of those of the samples less the means of their rows and columns.

    `averaged` is the part of their variance that went into the means, both of shape (rows,
    columns). A sample less the mean of n that it is in has lost 2/n of its own variance, and got
    1/n of the mean variance of all n: shot noise of what is bright beside it. Exact for equal
    variances.
    """
    rows, columns = variance.shape
    whole = averaged / ((1.0 - 1.0 / rows) * (1.0 - 1.0 / columns))
    return np.asarray(
        variance
        + whole * (2.0 / rows + 2.0 / columns)
        - whole.mean(axis=1, keepdims=True) / columns
        - whole.mean(axis=0, keepdims=True) / rows
        - whole.mean() / (rows * columns)
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
    inside = clear_of_ends(level=level, variance=power, low=low, high=high)
    if np.count_nonzero(inside) < _LEAST_BLOCKS:
        reason = (
            f"fewer than {_LEAST_BLOCKS} blocks of {SIDE} × {SIDE} samples are free of clipping"
        )
        return None, inside, reason
    limit = 2.0 * float(special.gammaincinv(freedom / 2.0, _KEPT)) / freedom
    chosen = inside & (power <= 2.0 * _by_level(level, power, inside))
    for _ in range(_ROUNDS):
        if np.count_nonzero(chosen) < _LEAST_BLOCKS:
            return None, inside, _it_moves(1.0)
        line = variance_line(level=level[chosen], variance=power[chosen])
        before, chosen = chosen, inside & (power <= limit * line.over(level))
        if np.array_equal(before, chosen):
            break
    moved = 1.0 - np.count_nonzero(chosen) / np.count_nonzero(inside)
    if moved > _MOVED or np.count_nonzero(chosen) < _LEAST_BLOCKS:
        return None, chosen, _it_moves(moved)
    return line, chosen, ""


def _it_moves(share: float) -> str:
    return f"{share:.0%} of the pixels change between the frames: the scene or the camera moved"


def _by_level(level: Vector, power: Vector, inside: NDArray[np.bool_]) -> Vector:
    """Median variance of the blocks of about a block's level: bright ones have more by light alone.

    Where most blocks are dark, that of all blocks would leave out every bright one.
    """
    order = np.flatnonzero(inside)[np.argsort(level[inside], kind="stable")]
    groups = min(max(len(order) // _LEAST_BLOCKS, 1), _MOST_GROUPS)
    usual = np.zeros_like(power)
    for group in np.array_split(order, groups):
        usual[group] = np.median(power[group])
    return usual
