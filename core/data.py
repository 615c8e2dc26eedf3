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
class CurveData:
    """Curves that share their axes."""

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]


@dataclass(frozen=True)
class TableRow:
    """A named figure."""

    name: str
    value: float | int | str | None
    unit: str = ""
    meaning: str = ""


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
