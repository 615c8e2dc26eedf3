"""A long row of columns broken into several, so that it can be read on a canvas of any shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from core.editing.layout.boxes import Point

_MOST_ROWS = 64
_GAIN = 1.1  # how much larger all must become for another row


@dataclass(frozen=True)
class Column:
    """Nodes above each other: their upper edges by name, the width, the lowest edge of all."""

    tops: Mapping[str, float]
    width: float
    bottom: float

    @property
    def top(self) -> float:
        """The highest edge."""
        return min(self.tops.values(), default=0.0)


def wrapped(
    columns: Sequence[Column],
    room: tuple[float, float] | None,
    column_gap: float,
    row_gap: float,
) -> dict[str, Point]:
    """Points of the nodes, the columns in as many rows as show them largest.

    Parameters
    ----------
    columns : sequence of Column
        From left to right.
    room : (width, height) or None
        What the canvas shows at its natural zoom: what fits stays in one row. None: it always does.
    column_gap, row_gap : float
        Kept free between columns and between rows, for wires.

    Returns
    -------
    dict of str to point
        In several rows all columns are equally wide, so that the gaps between them stand below each
        other: a wire to another row goes down in one.
    """
    rows = [list(columns)]
    best = _extent(rows, column_gap, row_gap, pitch=None)
    pitch: float | None = None
    if room is not None and not (best[0] <= room[0] and best[1] <= room[1]):
        even = max((column.width for column in columns), default=0.0) + column_gap
        for number in range(2, min(len(columns), _MOST_ROWS) + 1):
            tried = _broken(columns, number)
            extent = _extent(tried, column_gap, row_gap, pitch=even)
            if _zoom(extent, room) > _GAIN * _zoom(best, room):
                rows, best, pitch = tried, extent, even
    points: dict[str, Point] = {}
    top = 0.0
    for row in rows:
        highest = min((column.top for column in row), default=0.0) if pitch is not None else 0.0
        left = 0.0
        for column in row:
            points |= {name: (left, y - highest + top) for name, y in column.tops.items()}
            left += column.width + column_gap if pitch is None else pitch
        top += _height(row) + row_gap
    return points


def _broken(columns: Sequence[Column], rows: int) -> list[list[Column]]:
    """In rows of as equal numbers of columns as can be, the first ones the longest."""
    length = -(-len(columns) // rows)
    return [list(columns[at : at + length]) for at in range(0, len(columns), length)]


def _extent(
    rows: Sequence[Sequence[Column]], column_gap: float, row_gap: float, *, pitch: float | None
) -> tuple[float, float]:
    widths = [
        len(row) * pitch if pitch is not None else sum(column.width + column_gap for column in row)
        for row in rows
    ]
    return max(widths, default=0.0), sum(_height(row) + row_gap for row in rows) - row_gap


def _height(row: Sequence[Column]) -> float:
    top = min((column.top for column in row), default=0.0)
    return max((column.bottom for column in row), default=0.0) - top


def _zoom(extent: tuple[float, float], room: tuple[float, float]) -> float:
    """How large all can be drawn."""
    return min(room[0] / max(extent[0], 1.0), room[1] / max(extent[1], 1.0))
