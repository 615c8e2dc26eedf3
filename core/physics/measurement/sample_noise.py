"""Noise of a sample: what digitising leaves of it, and its variance over the level."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Mask, Matrix, Vector
from core.errors import DataError, percent
from core.physics.measurement.flat_blocks import SIDE, VarianceLine
from core.records import dataclass

# What digitising leaves in a picture: clipping, rounding steps, blocks of compression.


_LEAST = 64  # samples at the end of the values that make a pile


def clipped_ends(*, picture: Matrix) -> tuple[float | None, float | None]:
    """Lowest and highest value where samples pile up there: clipped."""
    low, high = float(picture.min()), float(picture.max())
    if not (math.isfinite(low) and math.isfinite(high)):
        raise DataError(
            "the picture has samples that are not finite numbers, so its noise cannot be measured"
        )
    if low == high:
        return None, None
    return (
        low if _piled_up(picture, low, np.min) else None,
        high if _piled_up(picture, high, np.max) else None,
    )


def _piled_up(picture: Matrix, end: float, nearest: Callable[[Matrix], Any]) -> bool:
    """Whether the end of the values holds at least as many samples as what lies next to it."""
    at_end = picture == end
    many = int(np.count_nonzero(at_end))
    if many < _LEAST:
        return False
    others = picture[~at_end]
    return many >= int(np.count_nonzero(others == nearest(others)))


def samples_that_count(
    *, picture: Matrix, avoid: Mask | None, low: float | None, high: float | None
) -> Mask | None:
    """Samples that count: not avoided, and not clipped; None where all do."""
    good = None if avoid is None else ~avoid
    for end in (low, high):
        if end is not None:
            free = picture != end
            good = free if good is None else good & free
    return good


# The step of the converter, from the values that occur in a picture.

_MOST = 1 << 19  # samples that are looked at
_REPEATED = 0.75  # values per sample beyond which there is no step
_LIKE = 0.05  # by how much steps may differ, as in numbers turned to radiance
_MOST_ALIKE = 0.9  # of the gaps that are whole steps


def rounding_step(*, picture: Matrix) -> float | None:
    """Smallest distance of two values where all are whole multiples of it; None of others.

    Notes
    -----
    Steps that differ by some percent count as one: a table has turned the numbers to another
    quantity. Noise of fewer values than samples is what shows a step at all.
    """
    every = max(1, picture.size // _MOST)
    values, many = np.unique(picture[::every], return_counts=True)
    if len(values) < 2 or len(values) > _REPEATED * many.sum():
        return None
    gaps = np.diff(values)
    step = float(np.quantile(gaps, 0.25, method="lower"))
    if not step > 1e-12 * float(np.abs(values).max()):
        return None
    steps = gaps / step
    whole = np.rint(steps)
    like = (whole >= 1.0) & (np.abs(steps - whole) <= _LIKE * whole)
    if float(np.mean(like)) < _MOST_ALIKE:
        return None
    return float(np.median(gaps[like] / whole[like]))


# Whether a picture was compressed in blocks of 8 × 8 samples, as JPEG does.

_RANKED = 4  # parts of a picture, whose steps are ranked
_SURE, _SURE_EITHER = 7.0, 2.5  # standard deviations: across and down together, and either


def compressed_in_blocks(*, picture: NDArray[np.floating], period: int = 1) -> bool:
    """Whether steps at the borders of blocks are larger than those within them.

    Steps of a block may repeat with another `period`: then only those of one phase are compared.
    """
    if min(picture.shape) <= SIDE:
        return False
    sure = [_block_steps(view, period) for view in (picture, picture.T)]
    return min(sure) > _SURE_EITHER and math.hypot(*sure) > _SURE


def _block_steps(picture: NDArray[np.floating], period: int) -> float:
    """How sure it is that steps between columns are larger at borders of blocks than in them.

    The mean rank of the border among the eight steps of a block, in standard deviations of the
    mean of so many random ranks (Wilcoxon); a scene's own edges are large in few blocks only. The
    borders are taken where the steps are largest: a picture may have been cropped.
    """
    blocks = (picture.shape[1] - 1) // SIDE
    sums = np.zeros((_RANKED, blocks, SIDE))
    for k, rows in enumerate(np.array_split(np.arange(picture.shape[0]), _RANKED)):
        part = np.asarray(picture[rows[0] : rows[-1] + 1, : blocks * SIDE + 1], np.float64)
        sums[k] = np.abs(np.diff(part, axis=1)).mean(axis=0).reshape(blocks, SIDE)
    best = -math.inf
    for phase in range(period):
        values = sums[:, :, phase::period, np.newaxis]
        ordered, count = values[..., 0][..., np.newaxis, :], SIDE // period
        rank = ((ordered < values).sum(axis=3) + (ordered <= values).sum(axis=3) - count) / 2.0
        means = rank.mean(axis=(0, 1))
        best = max(best, float(means.max()) * math.sqrt(_RANKED * blocks * 12.0 / (count**2 - 1)))
    return best


# Variance of blocks over the level: by steps, and the gain and read noise of its line.


_LEVELS = 16
_LEAST_IN_LEVEL = 12
_RISES = 3.0  # standard errors by which the variance must rise for a gain
# The gain is given where it is known to 5 % with a confidence of 99 %, read noise to a quarter: of
# most pictures it is known about so well, and what is just known must not be off at that.
_CONFIDENCE = 2.576
_GAIN_WITHIN, _READ_WITHIN = 0.05, 0.25


@dataclass(frozen=True)
class LevelVariance:
    """Noise at one level."""

    # mean level, variance of a sample and its standard error
    level: float
    variance: float
    variance_error: float
    samples: int  # in flat areas of that level


@dataclass(frozen=True)
class LineNoise:
    """What whole rows, or columns, have of their own."""

    # unbiased square of the offsets' standard deviation, which may come out below zero, and the
    # standard error
    variance: float
    variance_error: float

    @property
    def sigma(self) -> float:
        """Standard deviation of the offsets; 0 where none shows."""
        return math.sqrt(max(self.variance, 0.0))

    @property
    def significant(self) -> bool:
        """Whether it stands out by three standard errors."""
        return self.variance > 3.0 * self.variance_error

    @property
    def shown(self) -> float:
        """Standard deviation where it stands out, else 0."""
        return self.sigma if self.significant else 0.0


@dataclass(frozen=True, kw_only=True)
class SampleNoise:
    """Noise of a sample; None, with a reason, of what is not shown."""

    mean_level: float  # of the pictures, which `sigma` is for
    offset_dn: float  # the level without light, which the read noise is for
    step: float | None  # of the converter; None where the samples show none
    # standard deviation at the mean level, rounding included, and its standard error
    sigma: float | None = None
    sigma_error: float | None = None
    sigma_reason: str = ""
    # electrons of one unit of the picture
    gain_e_per_dn: float | None = None
    gain_error: float | None = None
    gain_reason: str = ""
    # noise at the level without light, rounding taken off
    read_noise_dn: float | None = None
    read_noise_error: float | None = None
    read_noise_reason: str = ""
    levels: tuple[LevelVariance, ...] = ()  # variance over the level, from dark to bright
    # offsets of rows, and of columns, that hold across the picture; None with too few flat areas
    rows: LineNoise | None = None
    columns: LineNoise | None = None
    remarks: tuple[str, ...] = ()  # what to know of the figures

    @property
    def row_sigma(self) -> float | None:
        """Standard deviation of whole rows; 0 where none stands out."""
        return None if self.rows is None else self.rows.shown

    @property
    def column_sigma(self) -> float | None:
        """The same of whole columns."""
        return None if self.columns is None else self.columns.shown

    @property
    def reason(self) -> str:
        """Why gain and read noise are missing; empty where they are not."""
        no_gain = self.gain_reason if self.gain_e_per_dn is None else ""
        no_read = self.read_noise_reason if self.read_noise_dn is None else ""
        if no_gain and no_gain == no_read:
            return f"no gain and no read noise: {no_gain}"
        parts = (("no gain", no_gain), ("no read noise", no_read))
        return "; ".join(f"{what}: {why}" for what, why in parts if why)


def no_noise(reason: str, **known: Any) -> SampleNoise:
    """A noise of which no figure is shown, for that reason."""
    return SampleNoise(sigma_reason=reason, gain_reason=reason, read_noise_reason=reason, **known)


def gain_and_read_noise(
    *, line: VarianceLine, level: Vector, rounding: float, offset: float
) -> dict[str, Any]:
    """Gain and read noise, each with its standard error or the reason why there is none.

    `level` is that of the blocks which the line is of, `rounding` the variance that it adds,
    `offset` the level without light.
    """
    gain = _gain(line, level)
    return gain | _read_noise(line, level, rounding, offset, with_gain="gain_e_per_dn" in gain)


def _gain(line: VarianceLine, level: Vector) -> dict[str, Any]:
    between = f"between levels {level.min():.4g} and {level.max():.4g}"
    if line.slope <= _RISES * line.slope_error:
        reason = (
            f"the variance does not rise clearly with the level: its slope is "
            f"{line.slope:.3g} ± {line.slope_error:.2g} {between}"
        )
        return {"gain_reason": reason}
    gain, error = 1.0 / line.slope, line.slope_error / line.slope**2
    if _CONFIDENCE * error > _GAIN_WITHIN * gain:
        reason = (
            f"the gain cannot be determined from these levels: {gain:.4g} ± {error:.2g} {between}, "
            f"uncertain by {percent(_CONFIDENCE * error / gain, 1)} at 99 % confidence; allowed: "
            f"at most {percent(_GAIN_WITHIN)}"
        )
        return {"gain_reason": reason}
    return {"gain_e_per_dn": gain, "gain_error": error}


def _read_noise(
    line: VarianceLine, level: Vector, rounding: float, offset: float, *, with_gain: bool
) -> dict[str, Any]:
    low, high = np.quantile(level, (0.01, 0.99))
    if not with_gain and not low <= offset <= high:
        reason = (
            f"the flat areas have levels from {level.min():.4g} to {level.max():.4g}, too far from "
            f"the dark level, {offset:.4g}"
        )
        return {"read_noise_reason": reason}
    variance, error = line.at(offset)
    variance -= rounding
    if variance <= 0.0 or _CONFIDENCE * error > 2.0 * _READ_WITHIN * variance:
        reason = (
            f"the variance at level {offset:.4g}, used as the dark level, is "
            f"{variance:.3g} ± {error:.2g} after subtracting quantization noise: dark areas are "
            "missing, or the level is wrong"
        )
        return {"read_noise_reason": reason}
    sigma = math.sqrt(variance)
    return {"read_noise_dn": sigma, "read_noise_error": error / (2.0 * sigma)}


def level_variances(*, level: Vector, variance: Vector) -> tuple[LevelVariance, ...]:
    """Blocks in steps of level, those with few left out."""
    low, high = float(level.min()), float(level.max())
    width = (high - low) / _LEVELS
    bins = np.minimum((level - low) / width, _LEVELS - 1.0).astype(int) if width > 0.0 else None
    parts = [np.ones(len(level), bool)] if bins is None else [bins == k for k in range(_LEVELS)]
    measured = []
    for part in parts:
        many = int(np.count_nonzero(part))
        if many < min(_LEAST_IN_LEVEL, len(level)):
            continue
        values = variance[part]
        error = float(values.std(ddof=1)) / math.sqrt(many)
        measured.append(
            LevelVariance(
                float(level[part].mean()), float(values.mean()), error, many * SIDE * SIDE
            )
        )
    return tuple(measured)
