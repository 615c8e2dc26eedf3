"""Reasons not to trust the spread of an edge, given instead of a wrong MTF."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.edges.edge_clipping import (
    refuse_corner,
    refuse_piled_up,
    refuse_quiet_side,
)
from core.physics.measurement.edges.edge_line import EdgeLine, Target
from core.physics.measurement.edges.edge_spread import BINS_PER_SAMPLE, EdgeSpread

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

_UNSETTLED = 0.02  # share of the contrast by which a side's level may still change
_CUT_BY_WINDOW = 0.02  # share of the step outside the window's level half


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
    refuse_piled_up(picture=picture, line=line, spread=spread, height=height)
    if target == "edge":
        _refuse_narrow(spread, height, error)
        refuse_corner(picture=picture, line=line, spread=spread)
        refuse_quiet_side(picture=picture, line=line, spread=spread)


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
