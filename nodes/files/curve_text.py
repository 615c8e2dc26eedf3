"""Curves as CSV where numbers alone do not describe them: names of bars, and values without end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import zip_longest
from typing import Any

import numpy as np

from core.chain.results import CurveData
from nodes.files.common.table_cells import csv_lines


def is_plain(curves: CurveData) -> bool:
    """Whether finite numbers are all there is to them."""
    return not curves.bars and all(np.isfinite(series.y).all() for series in curves.series)


def columns_text(curves: CurveData, columns: Mapping[str, Iterable[Any]]) -> str:
    """Columns by name as CSV; of bars, their names take the place of the abscissa.

    Infinite values are written as ``inf``, missing ones as ``nan``.
    """
    names, values = list(columns), [list(column) for column in columns.values()]
    if curves.bars and names:
        names[0], values[0] = curves.x_label or "name", list(curves.bars)
    rows = ([_cell(cell) for cell in row] for row in zip_longest(*values, fillvalue=""))
    return csv_lines([names, *rows])


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))
