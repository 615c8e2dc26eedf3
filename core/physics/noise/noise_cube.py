"""The seven noise components of a sequence of frames, by unbiased estimates, frame after frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.noise.noise_components import COMPONENTS, NoiseVariances

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class MeasuredNoise:
    """Components of a sequence, and the standard errors of their variances."""

    variances: NoiseVariances
    errors: NoiseVariances
    mean: float
    frames: int
    rows: int
    columns: int


class NoiseCube:
    """Takes frames one by one and keeps sums alone.

    Parameters
    ----------
    rows, columns : int
        Size of the frames, 2 or more.

    Raises
    ------
    DataError
        For a single row or column.

    Notes
    -----
    The components are those of an analysis of variance with three crossed random factors and one
    sample a cell. The directional averages of D'Agostino and Webb 1991 are biased: of purely random
    noise they also show σ/√n in the averages of n samples; the mean squares here take that out.
    Source: Searle, Casella and McCulloch 1992, Variance Components, sections 4.2 and 5.2; for
    standard errors, the variance 2·MS²/df of a mean square of normal deviates (section 4.5a).
    Where noise is correlated between neighbours these errors are too small.
    """

    def __init__(self, rows: int, columns: int) -> None:
        if rows < 2 or columns < 2:
            raise DataError(
                f"components of noise need 2 × 2 samples or more, not {columns} × {rows}"
            )
        self.rows, self.columns = rows, columns
        self._offset: float | None = None
        self._squares = 0.0
        self._sum = np.zeros((rows, columns))
        self._row_means: list[Vector] = []
        self._column_means: list[Vector] = []

    def add(self, frame: NDArray[Any]) -> None:
        """Take another frame, shape (rows, columns), best less the noise-free picture.

        Raises
        ------
        DataError
            For a frame of another size.
        """
        if frame.shape != (self.rows, self.columns):
            raise DataError(
                f"a frame of {frame.shape[1]} × {frame.shape[0]} samples does not go with "
                f"{self.columns} × {self.rows}"
            )
        if self._offset is None:
            # What all frames have in common would cost the sums of squares their digits.
            self._offset = float(np.mean(frame, dtype=np.float64))
        samples = np.subtract(frame, self._offset, dtype=np.float64)
        self._squares += float(np.vdot(samples, samples))
        self._sum += samples
        self._row_means.append(samples.mean(axis=1))
        self._column_means.append(samples.mean(axis=0))

    def measured(self) -> MeasuredNoise:
        """The components of the frames so far.

        Raises
        ------
        DataError
            With fewer than two frames.
        """
        frames, rows, columns = len(self._row_means), self.rows, self.columns
        if frames < 2:
            raise DataError(f"components of noise need 2 frames or more, not {frames}")
        tv, th = np.array(self._row_means), np.array(self._column_means)
        vh = self._sum / frames
        v, h, t = vh.mean(axis=1), vh.mean(axis=0), tv.mean(axis=1)
        mean = float(t.mean())
        # Sums of squares about the mean, of each kind of average over what it leaves out.
        whole = self._squares - frames * rows * columns * mean**2
        of_t = rows * columns * _squares(t - mean)
        of_v = frames * columns * _squares(v - mean)
        of_h = frames * rows * _squares(h - mean)
        of_tv = columns * _squares(tv - mean) - of_t - of_v
        of_th = rows * _squares(th - mean) - of_t - of_h
        of_vh = frames * _squares(vh - mean) - of_v - of_h
        of_tvh = whole - of_t - of_v - of_h - of_tv - of_th - of_vh
        free = {"t": frames - 1, "v": rows - 1, "h": columns - 1}
        axes = ("tvh", "vh", "v", "h", "t", "tv", "th")
        sums = dict(zip(axes, (of_tvh, of_vh, of_v, of_h, of_t, of_tv, of_th), strict=True))
        degrees = {name: math.prod(free[axis] for axis in name) for name in COMPONENTS}
        squares = {name: max(sums[name], 0.0) / degrees[name] for name in COMPONENTS}
        counts = {"t": frames, "v": rows, "h": columns}
        variances, errors = {}, {}
        for name in COMPONENTS:
            averaged = math.prod(count for axis, count in counts.items() if axis not in name)
            parts = _estimate(name)
            variances[name] = math.fsum(sign * squares[other] for other, sign in parts) / averaged
            errors[name] = (
                math.sqrt(
                    math.fsum(2.0 * squares[other] ** 2 / degrees[other] for other, _ in parts)
                )
                / averaged
            )
        return MeasuredNoise(
            NoiseVariances(**variances),
            NoiseVariances(**errors),
            mean + (self._offset or 0.0),
            frames,
            rows,
            columns,
        )


def _squares(deviations: Vector) -> float:
    return float(np.vdot(deviations, deviations))


def _estimate(name: str) -> list[tuple[str, int]]:
    """Mean squares whose signed sum is n times the component: of all that contain its axes."""
    return [
        (other, (-1) ** (len(other) - len(name))) for other in COMPONENTS if set(name) <= set(other)
    ]
