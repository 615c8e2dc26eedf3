"""The photon transfer curve: gain, read noise and full well of a camera from its flat fields.

Shot noise makes the temporal variance of a pixel rise with its mean by one electron for each
electron: σ² = σ_read² + (μ − offset)/K in digital numbers, K electrons of one. Its slope gives the
gain K, its foot the read noise, the level at which it collapses the full well.

Source: Janesick 2007, Photon Transfer, chapters 4 and 5; EMVA Standard 1288, release 3.1 (2016),
sections 2, 6 and 8. The numbers of their equations could not be checked. Janesick's K is the gain
here, electrons of a number; that of EMVA 1288 is its inverse.
"""

import math
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Matrix, Vector, block_means
from core.errors import DataError
from core.physics.noise.noise_components import check_frame
from core.records import dataclass

# Mean, temporal variance and fixed pattern of frames of a flat field, taken one by one.

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
        check_frame(frame, *self._sum.shape)
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
    blocks = block_means(whole, _BLOCK)
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


# Figures of EMVA Standard 1288, release 4 Linear, that follow from a photon transfer curve.
#
# Source: EMVA Standard 1288, release 4.0 Linear (2021), by the names and sums of the working
# group's
# reference program; on simulated frames of 12 bits both give the same dynamic range to 0.01 dB.

_PATTERNS = tuple(
    attrgetter(name) for name in ("fixed_dn2", "rows_dn2", "columns_dn2", "single_pixels_dn2")
)
_LEAST_DARK = 0.24  # steps², below which rounding hides the dark noise (the standard)


def _prnu_percent(
    lit: Sequence[FlatField], dark: FlatField, part: Callable[[FlatField], float]
) -> float:
    """Share of the signal that a part of the fixed pattern grows with, percent.

    Notes
    -----
    The standard takes one level of half the saturation; here all levels count, by their weights.
    """
    signal = np.array([level.mean_dn - dark.mean_dn for level in lit])
    squares = np.array([part(level) - part(dark) for level in lit])
    variance = np.array([level.fixed_dn2 + level.temporal_dn2 / level.frames for level in lit])
    weights = np.array([level.pixels for level in lit]) / np.maximum(variance, 1e-12) ** 2
    square = float(np.sum(weights * signal**2 * squares) / np.sum(weights * signal**4))
    return 100.0 * math.sqrt(max(square, 0.0))


_USED = 0.7  # of saturation, up to which the curve is taken for straight (EMVA 1288)
_COLLAPSED = 0.5  # of the largest variance; what has less beyond it is saturated
_ROUNDS = 5
_LEAST_VARIANCE = 1e-6  # of the largest; a level without noise has no infinite weight


@dataclass(frozen=True)
class PhotonTransfer:
    """What the curve gives; None of what the flat fields do not show."""

    # electrons of one digital number, and the standard error
    gain_e_per_dn: float
    gain_error: float
    offset_dn: float | None  # the number of no electrons
    # temporal noise without light and rounding, and the standard error
    read_noise_e: float | None
    read_noise_error: float | None
    # electrons at which the variance has collapsed; None where no level is saturated
    full_well_e: float | None
    brightest_e: float | None  # electrons of the brightest level
    # fixed pattern in the dark, and the part that grows with the signal, of the straight part
    dsnu_e: float | None
    prnu_percent: float | None
    # which levels the straight line is fitted to, and which are saturated
    used: tuple[bool, ...]
    saturated: tuple[bool, ...]
    # whether the dark frames end at the converter's zero, so that they count for nothing
    dark_cut_off: bool
    # What EMVA 1288 defines otherwise, or beside these.
    system_gain_dn_per_e: float  # K, digital numbers of an electron
    # electrons at the level whose temporal variance is the largest (µe.sat); None where no level
    # beyond it is saturated
    saturation_capacity_e: float | None
    # electrons of light at which SNR is 1 (µe.min): the dark noise, rounding included, and ½
    sensitivity_threshold_e: float | None
    # parts of DSNU that differ by row, by column, and by neither
    dsnu_row_e: float | None
    dsnu_column_e: float | None
    dsnu_pixel_e: float | None
    # the same of PRNU
    prnu_row_percent: float | None
    prnu_column_percent: float | None
    prnu_pixel_percent: float | None

    @property
    def snr_max(self) -> float | None:
        """Root of the saturation capacity."""
        capacity = self.saturation_capacity_e or 0.0
        return math.sqrt(capacity) if capacity > 0.0 else None

    @property
    def dynamic_range(self) -> float | None:
        """Saturation capacity over sensitivity threshold, as in EMVA 1288."""
        capacity, threshold = self.saturation_capacity_e or 0.0, self.sensitivity_threshold_e
        return None if capacity <= 0.0 or threshold is None else capacity / threshold


def photon_transfer(
    *, levels: Sequence[FlatField], dark: FlatField | None = None, offset_dn: float | None = None
) -> PhotonTransfer:
    """Gain, read noise, full well and fixed pattern.

    Parameters
    ----------
    levels
        Flat fields of light, in any order.
    dark
        Frames without light, of the same integration time.
    offset_dn
        The number of no electrons, where there are no dark frames.

    Raises
    ------
    DataError
        Fewer than two levels are left below saturation, the variance does not rise with the mean,
        numbers are too large for a variance, or the dark frames are brighter than all levels.

    Notes
    -----
    The straight line is fitted to levels below 0.7 of saturation, or to all where none is
    saturated, and to the dark frames. Weights are those of variances of normal deviates, 2σ⁴/((n −
    1)·pixels), of the fitted σ². Rounding is taken off before.
    """
    means = np.array([level.mean_dn for level in levels])
    variances = np.array([level.unrounded_dn2 for level in levels])
    _check(levels, dark)
    cut_off = dark is not None and dark.cut_off
    dark = None if cut_off else dark
    zero = dark.mean_dn if dark is not None else offset_dn
    top = int(np.argmax(variances))
    saturated = (means > means[top]) & (variances < _COLLAPSED * variances[top])
    foot = zero if zero is not None else 0.0
    ceiling = foot + _USED * (means[saturated].min() - foot) if saturated.any() else math.inf
    used = ~saturated & (means <= ceiling)
    lit = [level for level, taken in zip(levels, used, strict=True) if taken]
    fitted = lit if dark is None else [*lit, dark]
    if len({field.mean_dn for field in fitted}) < 2:
        raise DataError(
            f"levels below {_USED:g} times saturation: {int(used.sum())} of {len(levels)}. A "
            "photon transfer curve needs 2 or more different signal levels, or one "
            "level and dark frames that are not clipped at zero"
        )
    line, spread = _line_through(fitted, foot)
    slope, slope_error = float(line[1]), math.sqrt(spread[1, 1])
    if not slope > 0.0:
        raise DataError(
            "the temporal variance does not rise with the mean, so the shot noise of "
            "these flat fields cannot be measured"
        )
    gain = 1.0 / slope
    read = error = full_well = brightest = None
    if zero is not None:
        read, error = _read_noise(dark, float(line[0]), spread, gain)
        brightest = gain * float(means.max() - zero)
        if saturated.any():
            full_well = gain * float(means[saturated].mean() - zero)
    dsnu: list[float | None] = [None] * len(_PATTERNS)
    prnu = dsnu
    if dark is not None:
        dsnu = [gain * math.sqrt(max(part(dark), 0.0)) for part in _PATTERNS]
        prnu = [_prnu_percent(lit, dark, part) for part in _PATTERNS]
    capacity = threshold = None
    if zero is not None and saturated.any():
        noisiest = max(levels, key=lambda level: level.temporal_dn2)
        capacity = gain * (noisiest.mean_dn - zero)
    if dark is not None:
        least = _LEAST_DARK * dark.step_dn**2
        threshold = gain * math.sqrt(max(dark.temporal_dn2, least)) + 0.5
    return PhotonTransfer(
        gain,
        slope_error / slope**2,
        zero,
        read,
        error,
        full_well,
        brightest,
        dsnu[0],
        prnu[0],
        tuple(map(bool, used)),
        tuple(map(bool, saturated)),
        cut_off,
        1.0 / gain,
        capacity,
        threshold,
        *dsnu[1:],
        *prnu[1:],
    )


def _check(levels: Sequence[FlatField], dark: FlatField | None) -> None:
    """Refuse numbers without a variance, and dark frames that are none."""
    for field in [*levels, *([dark] if dark is not None else [])]:
        if not all(map(math.isfinite, (field.mean_dn, field.temporal_dn2, field.fixed_dn2))):
            raise DataError(
                "the samples of a level are too large for their variance to be computed; camera "
                "samples reach a few million at most"
            )
    brightest = max(level.mean_dn for level in levels)
    if dark is not None and dark.mean_dn >= brightest:
        raise DataError(
            f"the dark frames' mean, {dark.mean_dn:.6g}, is not below the mean of the "
            f"brightest level, {brightest:.6g}. Give frames taken in the dark as --dark"
        )


def _line_through(fields: Sequence[FlatField], foot: float) -> tuple[Vector, Matrix]:
    """A straight line of variances over means less `foot`: value there and slope; covariances."""
    x = np.array([field.mean_dn - foot for field in fields])
    y = np.array([field.unrounded_dn2 for field in fields])
    freedom = np.array([(field.frames - 1.0) * field.pixels for field in fields])
    least = _LEAST_VARIANCE * y.max()
    if not least > 0.0:
        raise DataError("no level has noise, so there is no photon transfer curve")
    model = np.maximum(y, least)
    for _ in range(_ROUNDS):
        weights = freedom / (2.0 * model**2)
        matrix = np.stack([np.ones_like(x), x], axis=1)
        normal = matrix.T @ (weights[:, np.newaxis] * matrix)
        line = np.linalg.solve(normal, matrix.T @ (weights * y))
        model = np.maximum(line[0] + line[1] * x, np.maximum(1e-3 * y, least))
    return line, np.linalg.inv(normal)


def _read_noise(
    dark: FlatField | None, at_foot: float, spread: Matrix, gain: float
) -> tuple[float, float]:
    foot_error, slope_error = np.sqrt(np.diag(spread)).tolist()
    if dark is not None:
        variance = dark.unrounded_dn2
        error = dark.temporal_dn2 * math.sqrt(2.0 / ((dark.frames - 1) * dark.pixels))
    else:
        variance, error = max(at_foot, 0.0), foot_error
    noise = math.sqrt(variance)
    # Of a root that is next to nothing, the root of the error of its square.
    if variance <= error:
        return gain * noise, gain * math.sqrt(error)
    # Noise in numbers times gain: what is off in the one is off in the other too, as the dark
    # level, or the foot of the line, holds the line's lower end.
    own, of_gain = error / (2.0 * variance), slope_error * gain
    shared = float(spread[0, 1]) * gain / variance
    return gain * noise, gain * noise * math.sqrt(max(own**2 + of_gain**2 - shared, 0.0))
