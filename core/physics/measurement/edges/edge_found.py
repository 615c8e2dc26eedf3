"""An edge found in a picture: where it runs, and what of the picture belongs to it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class FoundEdge:
    """A straight, or slightly bent, step between two levels of a picture.

    Parameters
    ----------
    x, y : float
        Middle of the edge; the middle of the sample in row i and column j is x = j, y = i.
    angle_deg : float
        Of the normal towards the brighter side, from the x axis towards +y, in (-180, 180].
    length : float
        Samples along the edge.
    reach : float
        Samples on both sides, along the normal, that belong to this edge alone.
    low, high : float
        Levels on both sides.
    noise_sigma : float
        Standard deviation of a sample on the flat sides, mean square of both.
    used : bool
        Whether its MTF can be measured.
    why_not : str
        Why not; empty when used.
    bend : float
        Samples, towards the brighter side, by which both ends lie off the line through the middle.
    softness : float
        Standard deviation of the Gaussian with the line spread's height, samples, the height taken
        after a blur of one sample; 0 where it was not measured.
    """

    x: float
    y: float
    angle_deg: float
    length: float
    reach: float
    low: float
    high: float
    noise_sigma: float
    used: bool
    why_not: str = ""
    bend: float = 0.0
    softness: float = 0.0

    @property
    def contrast(self) -> float:
        """Difference of the levels."""
        return self.high - self.low

    @property
    def normal(self) -> tuple[float, float]:
        """Unit vector (x, y) towards the brighter side."""
        angle = math.radians(self.angle_deg)
        return math.cos(angle), math.sin(angle)

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The two ends (x, y) of the edge."""
        (across_x, across_y), half = self.normal, self.length / 2.0
        x, y = self.x + self.bend * across_x, self.y + self.bend * across_y
        return (
            (x + half * across_y, y - half * across_x),
            (x - half * across_y, y + half * across_x),
        )
