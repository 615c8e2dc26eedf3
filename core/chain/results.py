"""Computed values that are not plain arrays: curves, tables, sampled transfer functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Series:
    """One curve: abscissa and ordinate of equal length."""

    label: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]


@dataclass(frozen=True)
class CurveMark:
    """An abscissa that is marked, such as the Nyquist frequency."""

    text: str
    x: float


@dataclass(frozen=True)
class CurveData:
    """Curves that share their axes, or bars that share their names.

    `bars` names the bars in order; each series then holds one height for each of them, at
    x = 0, 1, 2 and so on. With `log_y` the ordinate is shown by its logarithm, with `log_x` the
    abscissa; values that are infinite or not above 0 leave a gap. `marks` are abscissae to be
    marked.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    bars: tuple[str, ...] = ()
    log_y: bool = False
    log_x: bool = False
    marks: tuple[CurveMark, ...] = ()


@dataclass(frozen=True)
class TableRow:
    """A named figure; `reason` is why it has no value, where that is known."""

    name: str
    value: float | int | str | None
    unit: str = ""
    meaning: str = ""
    reason: str = ""


@dataclass(frozen=True)
class TableData:
    """Named figures in order."""

    rows: tuple[TableRow, ...]

    def as_dict(self) -> dict[str, float | int | str | None]:
        """Values by name."""
        return {row.name: row.value for row in self.rows}


@dataclass(frozen=True)
class SampledTransfer:
    """A transfer function at frequencies of its own, in FFT order."""

    values: NDArray[Any]
    interval_x: float
    interval_y: float
