"""The seven components of three-dimensional noise, and how variances of averages give them.

A sequence of frames of a uniform scene, less its mean, is taken as a sum of independent fields that
vary with time (t), row (v, vertical) and column (h, horizontal), alone or together: N_t + N_v + N_h
+ N_tv + N_th + N_vh + N_tvh.

Source: D'Agostino and Webb 1991, Three-dimensional analysis framework and measurement methodology
for imaging system noise, Proc. SPIE 1488; used by FLIR92 (Scott and D'Agostino 1992).
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Vector
from core.errors import DataError, ParameterError
from core.records import dataclass, fields


@dataclass(frozen=True)
class NoiseVariances:
    """Variance of each component, in the picture's unit squared.

    Parameters
    ----------
    tvh : float
        Random from sample to sample and frame to frame.
    vh : float
        Fixed pattern from sample to sample.
    v, h : float
        Fixed from row to row, from column to column.
    t : float
        Of whole frames from one to the next.
    tv, th : float
        Of rows, of columns, from one frame to the next.

    Notes
    -----
    An unbiased estimate of a variance that is next to nothing comes out below zero half the time.
    """

    tvh: float = 0.0
    vh: float = 0.0
    v: float = 0.0
    h: float = 0.0
    t: float = 0.0
    tv: float = 0.0
    th: float = 0.0

    def __add__(self, other: "NoiseVariances") -> "NoiseVariances":
        """Of two independent noises together."""
        return NoiseVariances(*(getattr(self, n) + getattr(other, n) for n in COMPONENTS))

    def variance(self, name: str) -> float:
        """Variance of one component."""
        if name not in COMPONENTS:
            raise ParameterError("component", name, f"one of {', '.join(COMPONENTS)}")
        return float(getattr(self, name))

    def sigma(self, name: str) -> float:
        """Standard deviation of one component; of a variance estimated below zero −√(−variance)."""
        variance = self.variance(name)
        return math.copysign(math.sqrt(abs(variance)), variance)

    @property
    def temporal(self) -> float:
        """Variance of a sample from frame to frame."""
        return self.tvh + self.tv + self.th + self.t

    @property
    def fixed(self) -> float:
        """Variance of what stays the same from frame to frame."""
        return self.vh + self.v + self.h

    @property
    def total(self) -> float:
        """Variance of all together."""
        return self.temporal + self.fixed


COMPONENTS = tuple(field.name for field in fields(NoiseVariances))
MEANINGS = {
    "tvh": "random noise of each sample",
    "vh": "fixed-pattern noise of each sample",
    "v": "fixed row noise",
    "h": "fixed column noise",
    "t": "frame-to-frame noise",
    "tv": "temporal row noise",
    "th": "temporal column noise",
}


def components_of_moments(
    *,
    sample: float,
    row_mean: float,
    column_mean: float,
    frame_mean: float,
    rows: int,
    columns: int,
    temporal: bool,
) -> NoiseVariances:
    """Components that unbiased estimates have on average, for a noise of any correlation.

    Given are the expected variances of a sample and of the means of a row, a column and the frame.
    They are about zero: over the frames if `temporal`, else over all the patterns a sensor of
    this kind may have. Gives tvh, tv, th and t of a temporal noise; vh, v and h of a fixed one,
    whose mean over the frame counts as none.

    The variances of sample, row mean, column mean and frame mean are linear in the four components
    (Searle, Casella and McCulloch 1992, Variance Components, table 4.1), and this solves them:
    sample = t + v + h + vh, row mean = t + v + (h + vh)/columns, column mean = t + h +
    (v + vh)/rows, frame mean = t + v/rows + h/columns + vh/(rows·columns).
    """
    if rows < 2 or columns < 2:
        raise DataError(f"noise components need at least 2 × 2 samples, not {columns} × {rows}")
    kept_columns, kept_rows = 1.0 - 1.0 / columns, 1.0 - 1.0 / rows
    across = (sample - row_mean) / kept_columns
    across_of_means = (column_mean - frame_mean) / kept_columns
    single = (across - across_of_means) / kept_rows
    column = across - single
    row = (sample - column_mean) / kept_rows - single
    whole = sample - single - column - row
    rounding = 1e-13 * sample
    single, column, row, whole = (
        component if abs(component) > rounding else 0.0
        for component in (single, column, row, whole)
    )
    if temporal:
        return NoiseVariances(tvh=single, tv=row, th=column, t=whole)
    return NoiseVariances(vh=single, v=row, h=column)


# The seven noise components of a sequence of frames, by unbiased estimates, frame after frame.


@dataclass(frozen=True)
class MeasuredNoise:
    """Components of a sequence, and the standard errors of their variances."""

    variances: NoiseVariances
    errors: NoiseVariances
    mean: float
    frames: int
    rows: int
    columns: int


def check_frame(frame: NDArray[Any], rows: int, columns: int) -> None:
    """Refuse a frame that is not as large as those before."""
    if frame.shape != (rows, columns):
        raise DataError(
            f"a frame of {frame.shape[1]} × {frame.shape[0]} samples does not match the "
            f"earlier frames, {columns} × {rows}"
        )


class NoiseCube:
    """Takes frames one by one, each best less the noise-free picture, and keeps sums alone.

    The components are those of an analysis of variance with three crossed random factors and one
    sample a cell. The directional averages of D'Agostino and Webb 1991 are biased: of purely random
    noise they also show σ/√n in the averages of n samples; the mean squares here take that out.
    Source: Searle, Casella and McCulloch 1992, Variance Components, sections 4.2 and 5.2; for
    standard errors, the variance 2·MS²/df of a mean square of normal deviates (section 4.5a).
    Where noise is correlated between neighbours these errors are too small.
    """

    def __init__(self, rows: int, columns: int) -> None:
        if rows < 2 or columns < 2:
            raise DataError(f"noise components need at least 2 × 2 samples, not {columns} × {rows}")
        self.rows, self.columns = rows, columns
        self._offset: float | None = None
        self._squares = 0.0
        self._sum = np.zeros((rows, columns))
        self._row_means: list[Vector] = []
        self._column_means: list[Vector] = []

    def add(self, frame: NDArray[Any]) -> None:
        """Take another frame, shape (rows, columns)."""
        check_frame(frame, self.rows, self.columns)
        if self._offset is None:
            # What all frames have in common would cost the sums of squares their digits.
            self._offset = float(np.mean(frame, dtype=np.float64))
        samples = np.subtract(frame, self._offset, dtype=np.float64)
        self._squares += float(np.vdot(samples, samples))
        self._sum += samples
        self._row_means.append(samples.mean(axis=1))
        self._column_means.append(samples.mean(axis=0))

    def measured(self) -> MeasuredNoise:
        """The components of the frames so far, two or more."""
        frames, rows, columns = len(self._row_means), self.rows, self.columns
        if frames < 2:
            raise DataError(f"noise components need at least 2 frames, not {frames}")
        tv, th = np.array(self._row_means), np.array(self._column_means)
        vh = self._sum / frames
        v, h, t = vh.mean(axis=1), vh.mean(axis=0), tv.mean(axis=1)
        mean = float(t.mean())
        # Sums of squares about the mean, of each kind of average over what it leaves out.
        sums = {
            "t": rows * columns * _squares(t - mean),
            "v": frames * columns * _squares(v - mean),
            "h": frames * rows * _squares(h - mean),
        }
        sums["tv"] = columns * _squares(tv - mean) - sums["t"] - sums["v"]
        sums["th"] = rows * _squares(th - mean) - sums["t"] - sums["h"]
        sums["vh"] = frames * _squares(vh - mean) - sums["v"] - sums["h"]
        left = self._squares - frames * rows * columns * mean**2
        for part in sums.values():
            left -= part
        sums["tvh"] = left
        free = {"t": frames - 1, "v": rows - 1, "h": columns - 1}
        degrees = {name: math.prod(free[axis] for axis in name) for name in COMPONENTS}
        squares = {name: max(sums[name], 0.0) / degrees[name] for name in COMPONENTS}
        counts = {"t": frames, "v": rows, "h": columns}
        variances, errors = {}, {}
        for name in COMPONENTS:
            averaged = math.prod(count for axis, count in counts.items() if axis not in name)
            parts = _estimate(name)
            variances[name] = math.fsum(sign * squares[other] for other, sign in parts) / averaged
            spread = math.fsum(2.0 * squares[other] ** 2 / degrees[other] for other, _ in parts)
            errors[name] = math.sqrt(spread) / averaged
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
