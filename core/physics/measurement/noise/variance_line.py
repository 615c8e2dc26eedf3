"""Noise variance over level: a straight line through blocks, its gain and its read noise.

Shot noise adds an electron of variance for each electron: σ² = σ_read² + (level − offset)/K in
digital numbers, K electrons of one.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
_ROUNDS = 6
_SURE = 0.04  # standard error over slope
_LEAST = 0.05  # of the mean variance, below which no level counts for more


@dataclass(frozen=True)
class VarianceLine:
    """Variance = `middle` + `slope` · (level − `centre`), and the covariance of both."""

    centre: float  # mean level of the blocks, by weight
    # variance there, and by how much it rises with the level
    middle: float
    slope: float
    # standard errors, from the scatter of the blocks themselves
    middle_error: float
    slope_error: float
    covariance: float

    def at(self, level: float) -> tuple[float, float]:
        """Variance at a level, and its standard error."""
        away = level - self.centre
        variance = (
            self.middle_error**2 + 2.0 * away * self.covariance + (away * self.slope_error) ** 2
        )
        return self.middle + self.slope * away, math.sqrt(max(variance, 0.0))

    def doubted(self, *, level: Vector, left: Vector) -> "VarianceLine":
        """The line, with what may be left of structure in the variance of the blocks it is of.

        `left` is one standard error, of all blocks together: few blocks with structure, at levels
        that the line leans on, make its slope uncertain more than its middle.
        """
        weight = 1.0 / self.over(level) ** 2
        away = level - self.centre
        middle = float(weight @ left / weight.sum())
        spread = float(weight @ (away * away))
        slope = float(weight @ (away * left)) / spread if spread > 0.0 else 0.0
        return replace(
            self,
            middle_error=math.hypot(self.middle_error, middle),
            slope_error=math.hypot(self.slope_error, slope),
            covariance=self.covariance + middle * slope,
        )

    def rounded(self, *, level: Vector, step: float) -> "VarianceLine":
        """The line, with what rounding adds beyond 1/12 of its step's square.

        Of normal noise of s steps it is up to (4 s² + 1/π²) · exp(−2π² s²) squares of a step, by a
        cosine of where between two steps the level lies (Widrow and Kollár 2008).
        """
        weight = 1.0 / self.over(level) ** 2
        away = level - self.centre
        noise = np.maximum(self.over(level) / step**2 - 1.0 / 12.0, 0.0)
        wave = step**2 * (4.0 * noise + 1.0 / math.pi**2) * np.exp(-2.0 * math.pi**2 * noise)
        # The areas of a picture have few levels: that of one is that of all its blocks.
        total, spread = 2.0 * float(weight.sum()), float(weight @ (away * away))
        middle = math.sqrt(float(weight @ wave**2) / total)
        slope = middle / math.sqrt(2.0 * spread / total) if spread > 0.0 else 0.0
        return replace(
            self,
            middle_error=math.hypot(self.middle_error, middle),
            slope_error=math.hypot(self.slope_error, slope),
        )

    def bounded(self, offset: float) -> "VarianceLine":
        """The line with what physics knows of its slope, for levels it was not measured at.

        From none to all of the variance is shot noise of the light above `offset`. A slope that is
        known well stays as it is.
        """
        light = self.centre - offset
        sure = self.slope_error <= _SURE * abs(self.slope)
        if light <= 0.0 or self.slope_error <= 0.0 or sure:
            return self
        half = 0.5 * self.middle / light
        weights = 1.0 / self.slope_error**2, 1.0 / half**2
        slope = (self.slope * weights[0] + half * weights[1]) / sum(weights)
        # A few blocks with structure, brighter than the others, make it steeper than light can.
        slope = min(max(slope, 0.0), 2.0 * half)
        share = weights[0] / sum(weights)
        error = math.sqrt(1.0 / sum(weights))
        return replace(self, slope=slope, slope_error=error, covariance=share * self.covariance)

    def over(self, level: Vector) -> Vector:
        """Variance at levels, never below a small share of the mean."""
        return np.maximum(self.middle + self.slope * (level - self.centre), _LEAST * self.middle)


def variance_line(*, level: Vector, variance: Vector) -> VarianceLine:
    """Fit the line to the variance of blocks.

    Notes
    -----
    Weights are those of normal noise of the line's own variance, iterated (a weight from a block's
    own estimate would favour those that came out low). The errors are those that hold whatever the
    blocks' scatter (White 1980; MacKinnon and White 1985, HC3).
    """
    mean = float(variance.mean())
    if not mean > 0.0:
        return VarianceLine(float(level.mean()), 0.0, 0.0, 0.0, 0.0, 0.0)
    model = np.full(len(level), mean)
    for _ in range(_ROUNDS):
        weight = 1.0 / model**2
        total = weight.sum()
        centre = float(weight @ level / total)
        away = level - centre
        spread = float(weight @ (away * away))
        middle = float(weight @ variance / total)
        slope = float(weight @ (away * variance)) / spread if spread > 0.0 else 0.0
        line = middle + slope * away
        model = np.maximum(line, _LEAST * mean)
    # A block that the line leans on lies nearer to it than to the truth.
    lever = weight / total + (weight * away * away / spread if spread > 0.0 else 0.0)
    off = weight * (variance - line) / np.maximum(1.0 - lever, _LEAST)
    middle_error = math.sqrt(float(off @ off)) / total
    turned = off * away
    slope_error = covariance = 0.0
    if spread > 0.0:
        slope_error = math.sqrt(float(turned @ turned)) / spread
        covariance = float(off @ turned) / (total * spread)
    return VarianceLine(centre, middle, slope, middle_error, slope_error, covariance)
