"""How far the canvas reaches: what a file puts further away cannot be drawn."""

from __future__ import annotations

FARTHEST = 1e7
"""In units of the canvas; drawn at the largest zoom, it still counts in Qt's 32-bit pixels."""


def is_in_reach(*numbers: float) -> bool:
    """Whether places and sizes lie on the canvas; NaN and infinity do not."""
    return all(-FARTHEST <= number <= FARTHEST for number in numbers)
