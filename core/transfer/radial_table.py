"""A function of the radial frequency, tabulated for linear interpolation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Function = Callable[[Array], Array]  # values at radii, shape (radii,)

INTERVALS = (1 << 8, 1 << 11, 1 << 13)  # tried in turn
MOST_ROUGH = 0.1  # share of the last one's intervals that may be too rough to interpolate


@dataclass(frozen=True)
class RadialTable:
    """Values at even radii and the steps between them.

    Steps are NaN where interpolation would not do, as at the edge of a support: the function itself
    is evaluated there. Beyond the end the last value holds.
    """

    per_radius: float
    values: Array
    steps: Array

    @classmethod
    def of(cls, function: Function, *, reach: float, error: float) -> RadialTable | None:
        """Tabulate a function of radii up to `reach`.

        Parameters
        ----------
        function : callable
            What is tabulated.
        reach : float
            Largest radius, above 0.
        error : float
            Largest error of interpolated values, as that of places halfway between others shows it.

        Returns
        -------
        RadialTable or None
            None where it would have to be evaluated too often.
        """
        for intervals in INTERVALS:
            values = np.asarray(function(np.linspace(0.0, reach, 2 * intervals + 1)), np.float64)
            halfway = 0.5 * (values[:-1:2] + values[2::2])
            # Within half the interval the error is a quarter of this, at a kink at most a half.
            rough = np.abs(halfway - values[1::2]) > 2.0 * error
            rough[1:] |= rough[:-1]
            rough[:-1] |= rough[1:]
            allowed = MOST_ROUGH * intervals if intervals == INTERVALS[-1] else 0
            if np.count_nonzero(rough) <= allowed:
                steps = np.where(np.repeat(rough, 2), np.nan, np.diff(values))
                return cls(2 * intervals / reach, values, np.append(steps, 0.0))
        return None

    @property
    def rough(self) -> bool:
        """Whether the function has a kink on the way."""
        return bool(np.isnan(self.steps).any())

    def at(self, square: Array, function: Function) -> Array:
        """Values at the squares of radii, of the function that was tabulated."""
        radius = np.sqrt(square)
        place = radius * self.per_radius
        np.minimum(place, len(self.values) - 1, out=place)
        index = place.astype(np.intp)
        place -= index
        values: Array = self.steps.take(index)
        values *= place
        values += self.values.take(index)
        rough = np.isnan(values)
        if rough.any():
            values[rough] = function(radius[rough])
        return values
