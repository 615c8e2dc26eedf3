"""Mean, temporal variance and fixed pattern of frames of a flat field, taken one by one."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError

_FAR = 8.0  # robust deviations beyond which a pixel is a bad one: a normal one is so 1e-15 times
_NORMAL = 1.4826  # deviation over the median of absolute deviations, of a normal distribution
_ROUNDED = 1e-6  # of the level, by which pixels alike may differ in samples that are not whole
_REACHES = 3.0  # deviations below the mean
_ROUNDING = 1.0 / 12.0  # variance of it, in steps squared
_LARGEST_WHOLE = 2.0**53
_BLOCK, _LEAST_BLOCKS = 8, 4


@dataclass(frozen=True)
class FlatField:
    """What frames of one level show, of the pixels that are no bad ones."""

    mean_dn: float  # of all of them
    # variance of a pixel from frame to frame, the mean of all, without what whole frames share
    temporal_dn2: float
    # variance among the pixels' means in time, less what temporal noise leaves in these
    fixed_dn2: float
    # how many frames, pixels that count, and bad ones
    frames: int
    pixels: int
    bad: int
    # of the converter: the largest whole number that the samples are apart by multiples of; 0 of
    # samples that are not whole
    step_dn: float
    least_dn: float
    # variance of what is wider than 8 pixels, beyond what unlike pixels, rows and columns leave
    # there; 0 of frames below 32 × 32 pixels
    structure_dn2: float = 0.0
    # parts of `fixed_dn2` that whole rows, and whole columns, have of their own: unbiased, and
    # below 0 by chance where there is next to nothing
    rows_dn2: float = 0.0
    columns_dn2: float = 0.0

    @property
    def single_pixels_dn2(self) -> float:
        """Part of the fixed pattern that is neither of whole rows nor of whole columns."""
        return self.fixed_dn2 - self.rows_dn2 - self.columns_dn2

    @property
    def structure_share(self) -> float:
        """Share of the fixed pattern that is structure of the field, not pixels that differ."""
        if self.fixed_dn2 <= 0.0:
            return 0.0
        return min(self.structure_dn2 / self.fixed_dn2, 1.0)

    @property
    def cut_off(self) -> bool:
        """Whether noise reaches down to zero, where a converter ends: mean and variance are off."""
        deviation = math.sqrt(max(self.temporal_dn2 + self.fixed_dn2, 0.0))
        return self.least_dn == 0.0 and self.mean_dn < _REACHES * deviation

    @property
    def unrounded_dn2(self) -> float:
        """Temporal variance less that of rounding to steps (Bennett 1948)."""
        return max(self.temporal_dn2 - _ROUNDING * self.step_dn**2, 0.0)


class FlatFrames:
    """Takes frames of a flat field, of so many rows and columns, one by one; keeps sums alone."""

    def __init__(self, rows: int, columns: int) -> None:
        self._first: NDArray[np.float64] | None = None
        self._sum = np.zeros((rows, columns))
        self._squares = np.zeros((rows, columns))
        self._levels = 0.0
        self._frames = 0
        self._whole = True
        self._step = 0
        self._origin: float | None = None
        self._least = math.inf

    def add(self, frame: NDArray[Any]) -> None:
        """Take another frame, shape (rows, columns)."""
        if frame.shape != self._sum.shape:
            raise DataError(
                f"a frame of {frame.shape[0]} × {frame.shape[1]} samples does not match the "
                f"earlier frames, {self._sum.shape[0]} × {self._sum.shape[1]}"
            )
        samples = frame.astype(np.float64)
        # Double precision has whole numbers up to that exactly.
        self._whole &= bool((samples == np.rint(samples)).all())
        self._whole &= bool(np.abs(samples).max() < _LARGEST_WHOLE)
        self._origin = float(samples[0, 0]) if self._origin is None else self._origin
        if self._whole and self._step != 1:  # 12 bits are often stored as 16, 16 apart
            steps = (samples - self._origin).astype(np.int64)
            self._step = int(np.gcd(self._step, np.gcd.reduce(steps, axis=None)))
        self._least = min(self._least, float(samples.min()))
        # A lamp flickers: whole frames differ. (A median of whole numbers would jump by one.)
        level = float(samples.mean())
        samples -= level
        self._levels += level
        self._frames += 1
        if self._first is None:
            self._first = samples.copy()
        samples -= self._first  # what all frames share would cost the squares their digits
        self._sum += samples
        self._squares += samples * samples

    def good_pixels(self) -> NDArray[np.bool_]:
        """Pixels that are no bad ones, in the frames so far."""
        return _near(self._means(), whole=self._whole)

    def _means(self) -> NDArray[np.float64]:
        n = self._frames
        if n < 2 or self._first is None:
            raise DataError(f"a flat field needs 2 frames or more, not {n}")
        return np.asarray(self._first + self._sum / n + self._levels / n)

    def measured(self) -> FlatField:
        """What the frames so far show; two or more are needed."""
        n, means = self._frames, self._means()
        drift = self._sum / n
        variances = (self._squares - n * drift**2) / (n - 1)
        variances *= variances.size / max(variances.size - 1, 1)  # each frame's mean took a share
        good = _near(means, whole=self._whole)
        pixels = int(np.count_nonzero(good))
        temporal = float(variances[good].mean())
        fixed = float(np.var(means[good], ddof=1)) - temporal / n if pixels > 1 else 0.0
        usual = np.where(good, means, np.median(means))
        return FlatField(
            float(means[good].mean()),
            temporal,
            fixed,
            n,
            pixels,
            good.size - pixels,
            float(max(self._step, 1)) if self._whole else 0.0,
            self._least,
            structure_variance(usual),
            *line_variances(usual),
        )


def structure_variance(means: NDArray[np.float64]) -> float:
    """Variance of what is wider than 8 pixels, beyond what white patterns leave there.

    Returns
    -------
    float
        Variance of the means of 8 × 8 pixels less what pixels, rows and columns that differ at
        random leave in them; 0 where that is no more than chance, or the frame is below 32 × 32.

    Notes
    -----
    Differences of neighbours have twice the variance of a white pattern, and next to nothing of a
    smooth field (von Neumann 1941).
    """
    rows, columns = (size // _BLOCK * _BLOCK for size in means.shape)
    if min(rows, columns) < _LEAST_BLOCKS * _BLOCK:
        return 0.0
    whole = means[:rows, :columns]
    blocks = whole.reshape(rows // _BLOCK, _BLOCK, columns // _BLOCK, _BLOCK).mean(axis=(1, 3))
    pixels = float(np.mean(np.diff(np.diff(whole, axis=0), axis=1) ** 2)) / 4.0
    white = pixels / _BLOCK**2
    for axis in (0, 1):
        lines = whole.mean(axis=axis)
        own = float(np.mean(np.diff(lines) ** 2)) / 2.0 - pixels / whole.shape[axis]
        white += max(own, 0.0) / _BLOCK
    # Row and column patterns leave as many independent values as there are blocks along a side.
    chance = white * _FAR * math.sqrt(2.0 / min(blocks.shape))
    structure = float(np.var(blocks)) - white
    return structure if structure > chance else 0.0


def line_variances(means: NDArray[np.float64]) -> tuple[float, float]:
    """Variances that whole rows, and whole columns, have of their own.

    Returns
    -------
    tuple of float
        Of rows and of columns; 0 where there is a single one.

    Notes
    -----
    Means of rows also differ by what single pixels leave in them, 1/columns of their variance,
    which follows from what is left without row and column means (EMVA 1288, release 4, splits
    DSNU and PRNU so; Searle, Casella and McCulloch 1992, section 4.3).
    """
    rows, columns = means.shape
    if min(rows, columns) < 2:
        return 0.0, 0.0
    of_rows, of_columns = means.mean(axis=1), means.mean(axis=0)
    left = means - of_rows[:, np.newaxis] - of_columns + means.mean()
    single = float(np.vdot(left, left)) / ((rows - 1) * (columns - 1))
    return (
        float(np.var(of_rows, ddof=1)) - single / columns,
        float(np.var(of_columns, ddof=1)) - single / rows,
    )


def _near(means: NDArray[np.float64], *, whole: bool) -> NDArray[np.bool_]:
    """Pixels that are not far from the others: dead and hot ones are."""
    middle = float(np.median(means))
    away = np.abs(means - middle)
    spread = _NORMAL * float(np.median(away))
    least = 1.0 if whole else _ROUNDED * abs(middle)
    return np.asarray(away <= max(_FAR * spread, least))
