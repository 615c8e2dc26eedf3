"""Variance of blocks over the level: by steps, and the gain and read noise of its line."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.noise.flat_blocks import SIDE
from core.physics.measurement.noise.variance_line import VarianceLine

Vector = NDArray[np.float64]

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


@dataclass(frozen=True, kw_only=True)
class SampleNoise:
    """Noise of a sample; None, with a reason, of what is not shown."""

    mean_level: float
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


def withheld(reason: str) -> dict[str, Any]:
    """The reason, for all figures of a noise."""
    return dict.fromkeys(("sigma_reason", "gain_reason", "read_noise_reason"), reason)


Figure = tuple[float | None, float | None, str]


def gain_and_read_noise(
    *, line: VarianceLine, level: Vector, rounding: float, offset: float
) -> dict[str, Any]:
    """Gain and read noise, each with its standard error or the reason why there is none.

    `level` is that of the blocks which the line is of, `rounding` the variance that it adds,
    `offset` the level without light.
    """
    gain = _gain(line, level)
    read = _read_noise(line, level, rounding, offset, with_gain=gain[0] is not None)
    names = ("gain_e_per_dn", "gain_error", "gain_reason")
    of_read = ("read_noise_dn", "read_noise_error", "read_noise_reason")
    return dict(zip((*names, *of_read), (*gain, *read), strict=True))


def _gain(line: VarianceLine, level: Vector) -> Figure:
    """Electrons of one unit, and the standard error, where the variance rises with the level."""
    between = f"between levels {level.min():.4g} and {level.max():.4g}"
    if line.slope <= _RISES * line.slope_error:
        reason = (
            f"the variance does not rise clearly with the level: its slope is "
            f"{line.slope:.3g} ± {line.slope_error:.2g} {between}"
        )
        return None, None, reason
    gain, error = 1.0 / line.slope, line.slope_error / line.slope**2
    if _CONFIDENCE * error > _GAIN_WITHIN * gain:
        reason = (
            f"the gain cannot be determined from these levels: {gain:.4g} ± {error:.2g} {between}, "
            f"uncertain by {_CONFIDENCE * error / gain:.1%} at 99 % confidence; allowed: at "
            f"most {_GAIN_WITHIN:.0%}"
        )
        return None, None, reason
    return gain, error, ""


def _read_noise(
    line: VarianceLine, level: Vector, rounding: float, offset: float, *, with_gain: bool
) -> Figure:
    """Where the line meets the level without light."""
    low, high = np.quantile(level, (0.01, 0.99))
    if not with_gain and not low <= offset <= high:
        reason = (
            f"the flat areas have levels from {level.min():.4g} to {level.max():.4g}, too far from "
            f"the level without light, {offset:.4g}"
        )
        return None, None, reason
    variance, error = line.at(offset)
    variance -= rounding
    if variance <= 0.0 or _CONFIDENCE * error > 2.0 * _READ_WITHIN * variance:
        reason = (
            f"the variance at level {offset:.4g}, used as the level without light, is "
            f"{variance:.3g} ± {error:.2g} after subtracting rounding noise: dark areas are "
            "missing, or the level is wrong"
        )
        return None, None, reason
    return math.sqrt(variance), error / (2.0 * math.sqrt(variance)), ""


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
