"""Mean, temporal variance and fixed pattern of frames of a flat field, taken one by one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.edges.edge_line import Target
from core.physics.measurement.edges.slanted_edge import jackknife_error

_FAR = 8.0  # robust deviations beyond which a pixel is a bad one: a normal one is so 1e-15 times
_NORMAL = 1.4826  # deviation over the median of absolute deviations, of a normal distribution
_ROUNDED = 1e-6  # of the level, by which pixels alike may differ in samples that are not whole
_REACHES = 3.0  # deviations below the mean
_ROUNDING = 1.0 / 12.0  # variance of it, in steps squared
_LARGEST_WHOLE = 2.0**53
_BLOCK, _LEAST_BLOCKS = 8, 4


@dataclass(frozen=True)
class FlatField:
    """What frames of one level show, of the pixels that are no bad ones.

    Parameters
    ----------
    mean_dn : float
        Of all of them.
    temporal_dn2 : float
        Variance of a pixel from frame to frame, the mean of all, without what whole frames share.
    fixed_dn2 : float
        Variance among the pixels' means in time, less what temporal noise leaves in these.
    frames, pixels, bad : int
        How many frames, pixels that count, and bad ones.
    step_dn : float
        Of the converter: the largest whole number that the samples are apart by multiples of; 0 of
        samples that are not whole.
    least_dn : float
        The least sample.
    structure_dn2 : float
        Variance of what is wider than 8 pixels, beyond what unlike pixels, rows and columns leave
        there; 0 of frames below 32 × 32 pixels.
    rows_dn2, columns_dn2 : float
        Parts of `fixed_dn2` that whole rows, and whole columns, have of their own: unbiased, and
        below 0 by chance where there is next to nothing.
    """

    mean_dn: float
    temporal_dn2: float
    fixed_dn2: float
    frames: int
    pixels: int
    bad: int
    step_dn: float
    least_dn: float
    structure_dn2: float = 0.0
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
    """Takes frames of a flat field one by one and keeps sums alone.

    Parameters
    ----------
    rows, columns : int
        Size of the frames.
    """

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
        """Take another frame, shape (rows, columns).

        Raises
        ------
        DataError
            For a frame of another size.
        """
        if frame.shape != self._sum.shape:
            raise DataError(
                f"a frame of {frame.shape[0]} × {frame.shape[1]} samples does not go with "
                f"{self._sum.shape[0]} × {self._sum.shape[1]}"
            )
        samples = frame.astype(np.float64)
        self._whole = self._whole and _is_whole(samples)
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
        """Pixels that are no bad ones, in the frames so far.

        Raises
        ------
        DataError
            With fewer than two frames.
        """
        return _near(self._means(), whole=self._whole)

    def _means(self) -> NDArray[np.float64]:
        n = self._frames
        if n < 2 or self._first is None:
            raise DataError(f"a flat field needs 2 frames or more, not {n}")
        return np.asarray(self._first + self._sum / n + self._levels / n)

    def measured(self) -> FlatField:
        """What the frames so far show.

        Raises
        ------
        DataError
            With fewer than two frames.
        """
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


def _is_whole(samples: NDArray[np.float64]) -> bool:
    """Whether all samples are whole numbers that double precision has exactly."""
    return bool((samples == np.rint(samples)).all() and np.abs(samples).max() < _LARGEST_WHOLE)


def structure_variance(means: NDArray[np.float64]) -> float:
    """Variance of what is wider than 8 pixels, beyond what white patterns leave there.

    Parameters
    ----------
    means : ndarray, shape (rows, columns)
        A uniform field, each pixel's mean in time.

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

    Parameters
    ----------
    means : ndarray, shape (rows, columns)
        A uniform field, each pixel's mean in time.

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


# MTF from the mean of rows across an upright edge or line, as the thesis measured it.

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

LEAST_SAMPLES = 8
_GROUPS = 24
_LEAST_CONTRAST = 5.0  # times the standard error of a mean of rows


@dataclass(frozen=True)
class RowAverage:
    """MTF measured from the mean of rows.

    Parameters
    ----------
    frequency : ndarray
        Cycles per sample, from 0 to 1/2.
    mtf, error : ndarray
        Modulus divided by its largest, and standard error.
    profile, clipped : ndarray
        Mean of the rows, and the same with level ends.
    left, right : int
        First and last sample between these.
    contrast, noise : float
        Step, or height of the line, and standard deviation of a sample about its column's mean.
    """

    frequency: Vector
    mtf: Vector
    error: Vector
    profile: Vector
    clipped: Vector
    left: int
    right: int
    contrast: float
    noise: float


def row_average(
    *,
    picture: Matrix,
    target: Target = "edge",
    clip_left: int | None = None,
    clip_right: int | None = None,
) -> RowAverage:
    """Measure the MTF across an edge, or line, that runs upright down a picture.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite, of a size near 1: squares are taken.
    target : {'edge', 'line'}
        Only of an edge the derivative is taken.
    clip_left, clip_right : int, optional
        First and last sample of the transition: the ends beyond are set to their mean. If not
        given, three times as far from the middle as where a tenth of the step is left.

    Returns
    -------
    RowAverage
        MTF at the frequencies of the transform, standard error by leaving out groups of rows.

    Raises
    ------
    DataError
        If the picture is too small, has no edge, or nothing is left between the clipped ends.

    Notes
    -----
    Source: Tantalo 1996, eqs. 5.67 to 5.70 and appendix B. The thesis' "line spread" is the edge
    spread, and its derivative the line spread. The difference of neighbours has a response of its
    own, sinc(f), 0.64 at Nyquist, that the thesis leaves in, and so does this; a slant of the edge
    blurs too.
    """
    rows, columns = picture.shape
    if columns < LEAST_SAMPLES:
        raise DataError(
            f"the region is too small: {columns} samples across the edge, of at least "
            f"{LEAST_SAMPLES}"
        )
    profile = np.mean(picture, axis=0)
    noise = float(np.sqrt(np.mean((picture - profile) ** 2)))
    left, right, contrast = _transition(profile, target)
    outer = max(2, columns // 8)
    # Of a single row nothing but its ends shows the noise.
    ends = max(float(np.std(profile[:outer])), float(np.std(profile[-outer:])))
    doubt = max(noise / np.sqrt(rows), ends / np.sqrt(outer))
    if not contrast > _LEAST_CONTRAST * doubt or contrast < 1e-9:
        raise DataError(
            f"no {target} found: the levels differ by {contrast:.3g} of the region's range, and "
            f"the mean of {rows} rows scatters by {doubt:.2g}"
        )
    left = left if clip_left is None else clip_left
    right = right if clip_right is None else clip_right
    if not 0 <= left < right < columns:
        raise DataError(
            f"nothing is left between the clipped ends: first sample {left}, last sample {right} "
            f"of a region of {columns}"
        )
    clipped = with_level_ends(profile=profile, left=left, right=right)
    mtf = profile_mtf(profile=clipped, target=target)
    frequency = np.asarray(scipy.fft.rfftfreq(columns - (target == "edge")), np.float64)
    groups = min(_GROUPS, rows)
    error = np.zeros_like(mtf)
    if groups > 1:
        group = np.arange(rows) % groups
        replicas = [
            with_level_ends(profile=picture[group != g].mean(axis=0), left=left, right=right)
            for g in range(groups)
        ]
        moduli = np.array([profile_mtf(profile=replica, target=target) for replica in replicas])
        error = jackknife_error(replicas=moduli)
    return RowAverage(frequency, mtf, error, profile, clipped, left, right, contrast, noise)


def with_level_ends(*, profile: Vector, left: int, right: int) -> Vector:
    """The profile with the ends before `left` and after `right` set to their mean."""
    clipped = profile.copy()
    if left > 0:
        clipped[:left] = np.mean(profile[:left])
    if right + 1 < len(profile):
        clipped[right + 1 :] = np.mean(profile[right + 1 :])
    return clipped


def profile_mtf(*, profile: Vector, target: Target) -> Vector:
    """Modulus of the transform of a profile's derivative, divided by its largest.

    Of a line the background, a ramp between its ends, is taken off instead.
    """
    if target == "edge":
        spread = np.diff(profile)
    else:
        spread = profile - np.linspace(profile[0], profile[-1], len(profile))
    modulus = np.abs(scipy.fft.rfft(spread))
    largest = float(modulus.max())
    if not largest > 0.0:
        raise DataError(f"no {target} found: the mean of the rows is level")
    return np.asarray(modulus / largest, np.float64)


def _transition(profile: Vector, target: Target) -> tuple[int, int, float]:
    """First and last sample of the transition, and the step or height."""
    columns = len(profile)
    outer = max(2, columns // 8)
    start, end = float(np.mean(profile[:outer])), float(np.mean(profile[-outer:]))
    if target == "edge":
        share = (profile - start) / (end - start) if end != start else np.zeros(columns)
        within = np.flatnonzero((share > 0.1) & (share < 0.9))
        middle = int(np.argmax(np.abs(np.diff(profile))))
        contrast = abs(end - start)
    else:
        height = np.abs(profile - np.linspace(start, end, columns))
        middle, contrast = int(np.argmax(height)), float(height.max())
        within = np.flatnonzero(height > 0.1 * contrast)
    reach = 2.0 if len(within) == 0 else max(2.0, 1.5 * (within[-1] - within[0] + 1))
    return max(0, int(middle - reach)), min(columns - 1, int(middle + 1 + reach)), contrast
