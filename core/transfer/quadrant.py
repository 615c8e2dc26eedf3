"""The quarter of a spectrum on which a symmetric factor is evaluated: within its support."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

MARGIN = 1e-9  # of a cutoff: so much further the factor is evaluated, and found to be 0


@dataclass(frozen=True)
class Quarter:
    """Frequencies across and along, neither negative, and where a grid's rows are among them.

    Parameters
    ----------
    xi, eta : ndarray
        Ascending, as far as the factor is not 0.
    places : ndarray
        For every row of the grid its place in `eta`; beyond the end the row is 0.
    columns : int
        Columns of the grid; from ``len(xi)`` on they are 0.
    """

    xi: Array
    eta: Array
    places: Array
    columns: int

    @classmethod
    def of(cls, xi: Array, eta: Array, cutoff: tuple[float, float] | None) -> Quarter:
        """Of a spectrum's frequencies: `xi` ascending from 0, `eta` of both signs or one."""
        columns, lines = len(xi), np.abs(eta)
        places = np.arange(len(lines))
        if np.any(eta < 0.0):
            lines, places = np.unique(lines, return_inverse=True)
        if cutoff is None:
            return cls(xi, lines, places, columns)
        across, along = ((1.0 + MARGIN) * limit for limit in cutoff)
        return cls(xi[xi <= across], lines[lines <= along], places, columns)

    @property
    def samples(self) -> int:
        """Number of frequency pairs."""
        return len(self.xi) * len(self.eta)

    def rows(self, rows: slice) -> tuple[slice | Array, Array | None]:
        """Places in `eta` of those of the grid's rows that are not 0, and which these are.

        The places are a slice where they can be, and which is None for all rows.
        """
        places = self.places[rows]
        inside = places < len(self.eta)
        if inside.all():
            return _sliced(places), None
        return _sliced(places[inside]), inside


def _sliced(places: Array) -> slice | Array:
    """A slice instead of indices in steps of one."""
    if len(places) == 0:
        return slice(0, 0)
    first, last = int(places[0]), int(places[-1])
    step = 1 if last >= first else -1
    if abs(last - first) + 1 != len(places) or np.any(np.diff(places) != step):
        return places
    end = last + step
    return slice(first, end if end >= 0 else None, step)
