"""A rectangle of a picture's samples, for when the rest of the picture is not needed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import ParameterError

Array = NDArray[Any]


@dataclass(frozen=True)
class Region:
    """Samples from row `top` and column `left` on, counted from 0; at least one.

    Raises `ParameterError` for a number that is negative or not whole, or an empty region.
    """

    top: int
    left: int
    rows: int
    columns: int

    def __post_init__(self) -> None:
        for name, least in (("top", 0), ("left", 0), ("rows", 1), ("columns", 1)):
            value = getattr(self, name)
            if not isinstance(value, Integral) or value < least:
                raise ParameterError(f"region's {name}", value, f"a whole number, {least} or more")

    def __str__(self) -> str:
        return f"{self.top}:{self.bottom},{self.left}:{self.right}"

    @property
    def bottom(self) -> int:
        return self.top + self.rows

    @property
    def right(self) -> int:
        return self.left + self.columns

    @property
    def shape(self) -> tuple[int, int]:
        return self.rows, self.columns

    @property
    def slices(self) -> tuple[slice, slice]:
        return slice(self.top, self.bottom), slice(self.left, self.right)

    def within(self, shape: tuple[int, int]) -> Region:
        """The region itself if a picture of that shape has all of it.

        Raises `ParameterError` if it goes beyond.
        """
        if self.bottom > shape[0] or self.right > shape[1]:
            picture = f"within the picture's {shape[0]} rows and {shape[1]} columns"
            raise ParameterError("region", str(self), picture)
        return self

    def broadcast(self, shape: tuple[int, int]) -> Region:
        """The region of an array broadcast against the picture: an axis of length 1 whole."""
        top, rows = (0, 1) if shape[0] == 1 else (self.top, self.rows)
        left, columns = (0, 1) if shape[1] == 1 else (self.left, self.columns)
        return Region(top, left, rows, columns)

    def cut(self, array: Array) -> Array:
        """A copy of the samples of an array, itself perhaps broadcast."""
        rows, columns = array.shape
        return array[self.broadcast((rows, columns)).slices].copy()

    def overlap(self, other: Region) -> Region | None:
        """What both regions have, if anything."""
        top, left = max(self.top, other.top), max(self.left, other.left)
        rows = min(self.bottom, other.bottom) - top
        columns = min(self.right, other.right) - left
        return Region(top, left, rows, columns) if rows > 0 and columns > 0 else None

    def seen_from(self, other: Region) -> tuple[slice, slice]:
        """Index of the samples in the array of a region around this one."""
        top, left = self.top - other.top, self.left - other.left
        return slice(top, top + self.rows), slice(left, left + self.columns)

    def blocks(self, columns: int, size: int) -> list[int]:
        """Which blocks of `size` samples the region covers, in a picture of so many columns."""
        lines = np.arange(self.top, self.bottom) * columns
        first, last = (lines + self.left) // size, (lines + self.right - 1) // size
        bounds = set(zip(first.tolist(), last.tolist(), strict=True))
        return sorted({block for low, high in bounds for block in range(low, high + 1)})


def runs(start: int, stop: int, columns: int) -> Iterator[Region]:
    """Samples start … stop − 1 of a picture, line after line, as rectangles.

    These are the end of a row, whole rows and the beginning of a row, as far as there are any.
    """
    row, column = divmod(start, columns)
    if column:
        width = min(stop - start, columns - column)
        yield Region(row, column, 1, width)
        start += width
    if rows := (stop - start) // columns:
        yield Region(start // columns, 0, rows, columns)
        start += rows * columns
    if start < stop:
        yield Region(start // columns, 0, 1, stop - start)
