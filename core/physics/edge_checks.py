"""Reasons not to trust the spread of an edge, told instead of a wrong MTF."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.edge_line import EdgeLine, Target
from core.physics.edge_spread import BINS_PER_SAMPLE, EdgeSpread

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

_UNSETTLED = 0.02  # share of the contrast by which a side's level may still change
_NOISE_MATTERS = 1e-3  # share of the contrast
_CUT_BY_WINDOW = 0.02  # share of the step outside the window's level half
_SAME = 1e-9  # share of the range by which equal samples may differ
_CORNER = 0.03  # of the steepest slope: how far a quarter sample before its end the edge has to go
_PIXEL_RAMP = 1.6  # samples: an edge with no blur but the pixel's own is no wider


def check_spread(*, picture: Matrix, line: EdgeLine, spread: EdgeSpread, target: Target) -> None:
    """Refuse an edge that is not one, does not settle in the region, or is clipped.

    Raises
    ------
    DataError
        Saying which.
    """
    values = spread.values
    left, right = spread.levels
    height = abs(right - left) if target == "edge" else _line_height(spread)
    count = picture.shape[0] / (BINS_PER_SAMPLE + abs(line.slope))
    error = spread.noise / np.sqrt(max(1.0, count))  # of one bin
    if height < 0.5 * float(np.ptp(values)) or height < 5.0 * error:
        raise DataError(
            f"no single {target} found: the levels beside it differ by {height:.3g} of the "
            f"region's range and by {height / max(spread.noise, 1e-300):.2g} times the noise. "
            f"Choose a region with one {target} and little else"
        )
    for side in spread.sides:
        near, far = np.array_split(values[side], 2)
        change = abs(float(np.mean(near)) - float(np.mean(far)))
        doubt = 4.0 * error * np.sqrt(2.0 / len(near))
        if change > _UNSETTLED * height + doubt:
            raise DataError(
                f"the region is too small: {spread.away[-1]:.3g} samples from the {target} its "
                f"level still changes by {change / height:.0%} of the contrast. Widen the region"
            )
    _refuse_piled_up(picture, line, spread, height)
    if target == "edge":
        _refuse_narrow(spread, height, error)
        _refuse_corner(picture, line, spread)


def _refuse_narrow(spread: EdgeSpread, height: float, error: float) -> None:
    """The window tapers over the outer half of the spread: little of the step may be there."""
    quarter = len(spread.values) // 4
    near = max(1, quarter // 8)
    left, right = (
        float(np.mean(spread.values[k - near : k + near + 1])) for k in (quarter, -1 - quarter)
    )
    outside = abs(left - spread.levels[0]) + abs(right - spread.levels[1])
    if outside > _CUT_BY_WINDOW * height + 6.0 * error / np.sqrt(near):
        raise DataError(
            f"the region is too small: {outside / height:.0%} of the edge's step lie more than "
            f"{spread.away[-1] / 2:.3g} samples from it. Widen the region"
        )


def _line_height(spread: EdgeSpread) -> float:
    background = np.linspace(*spread.levels, len(spread.values))
    return float(np.max(np.abs(spread.values - background)))


def _refuse_piled_up(picture: Matrix, line: EdgeLine, spread: EdgeSpread, height: float) -> None:
    """Noise cut off at a limit leaves many samples at exactly that value."""
    away = np.arange(picture.shape[1]) - line.columns()[:, np.newaxis]
    end = spread.away[-1]
    lowest, highest = float(picture.min()), float(picture.max())
    for side, scatter in zip((-away, away), spread.sides, strict=True):
        noise = float(np.mean(spread.scatter[scatter]))
        if noise < _NOISE_MATTERS * height:
            continue
        samples = picture[(side > 0.75 * end) & (side <= end)]
        for limit in (lowest, highest):
            at_limit = int(np.count_nonzero(samples == limit))
            others, counts = np.unique(samples[samples != limit], return_counts=True)
            usual = int(counts.max()) if len(counts) else 0
            if at_limit > 0.1 * len(samples) and len(others) >= 4 and at_limit > 3 * usual:
                raise DataError(
                    f"the picture is clipped: {at_limit / len(samples):.0%} of the samples beside "
                    "the edge have the same extreme value. Expose less, or widen the range"
                )


def _refuse_corner(picture: Matrix, line: EdgeLine, spread: EdgeSpread) -> None:
    """An edge wider than a pixel that runs into its extreme value in a corner was cut off there.

    Blurs end softly: even a box's ends are rounded by the pixel.
    """
    away = np.arange(picture.shape[1]) - line.columns()[:, np.newaxis]
    inside = np.abs(away) <= spread.away[-1]
    lowest, highest = float(picture.min()), float(picture.max())
    away, values = away[inside], (picture[inside] - lowest) / (highest - lowest)
    between = away[(values > 0.01) & (values < 0.99)]
    if len(between) == 0 or float(np.ptp(between)) <= _PIXEL_RAMP:
        return
    rising = spread.levels[1] > spread.levels[0]
    slopes = np.abs(np.diff(spread.values)) / (highest - lowest)
    steepest = float(np.max(slopes)) * BINS_PER_SAMPLE
    for deficit, outward in ((1.0 - values, rising), (values, not rising)):
        outer = away if outward else -away
        short = deficit > _SAME
        end = float(np.max(outer[short]))
        if end > spread.away[-1] - 1.0:
            continue  # nothing beyond it is level
        last = deficit[short & (outer > end - 1.0 / BINS_PER_SAMPLE)]
        step = float(np.min(deficit[short]))  # of a quantized picture
        if float(np.mean(last)) - step > _CORNER * steepest:
            raise DataError(
                "the picture is clipped: the edge runs into its extreme value in a sharp corner. "
                "Expose less, or widen the range"
            )
