"""An edge found in a picture: where it runs, and what of the picture belongs to it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class FoundEdge:
    """A straight, or slightly bent, step between two levels of a picture."""

    # its middle; that of the sample in row i and column j is x = j, y = i
    x: float
    y: float
    angle_deg: float  # of the normal to the brighter side, from the x axis to +y, in (-180, 180]
    length: float  # samples
    reach: float  # samples on both sides, along the normal, that belong to this edge alone
    # levels on both sides
    low: float
    high: float
    noise_sigma: float  # of a sample on the flat sides, mean square of both
    used: bool  # whether its MTF can be measured
    why_not: str = ""  # why not
    bend: float = 0.0  # samples, to the brighter side, of both ends off the line through the middle
    # standard deviation of the Gaussian with the line spread's height, samples, the height taken
    # after a blur of one sample; 0 where it was not measured
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


# The samples of a picture that belong to an edge, by their distance from it.


@dataclass(frozen=True)
class EdgeSamples:
    """Samples about an edge, in the order of the picture's rows."""

    # of each sample's middle from the edge along its normal, positive on the brighter side
    distance: Vector
    along: Vector  # place along the edge, 0 at its middle
    value: Vector


def edge_samples(*, picture: NDArray[np.floating], edge: FoundEdge) -> EdgeSamples:
    """Take the samples within an edge's reach and length."""
    return rectangle_samples(
        picture=picture,
        middle=(edge.x, edge.y),
        angle_deg=edge.angle_deg,
        half_length=edge.length / 2.0,
        reach=edge.reach,
        bend=edge.bend,
    )


def rectangle_samples(
    *,
    picture: NDArray[np.floating],
    middle: tuple[float, float],
    angle_deg: float,
    half_length: float,
    reach: float,
    bend: float = 0.0,
) -> EdgeSamples:
    """Take the samples of a turned rectangle, whose long axis may be a parabola.

    `angle_deg` is that of its normal, `half_length` and `reach` half its sides along and across,
    and `bend` the distance of the axis's ends from the tangent at its middle, along the normal.
    """
    across_x, across_y = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    wide = reach + abs(bend)
    half_x = abs(across_x) * wide + abs(across_y) * half_length
    half_y = abs(across_y) * wide + abs(across_x) * half_length
    rows, columns = picture.shape
    top, left = max(0, math.ceil(middle[1] - half_y)), max(0, math.ceil(middle[0] - half_x))
    bottom = min(rows, math.floor(middle[1] + half_y) + 1)
    right = min(columns, math.floor(middle[0] + half_x) + 1)
    x = np.arange(left, max(left, right)) - middle[0]
    y = (np.arange(top, max(top, bottom)) - middle[1])[:, np.newaxis]
    along = across_x * y - across_y * x
    distance = across_x * x + across_y * y - bend * (along / half_length) ** 2
    inside = (np.abs(distance) <= reach) & (np.abs(along) <= half_length)
    value = picture[top : max(top, bottom), left : max(left, right)][inside]
    return EdgeSamples(distance[inside], along[inside], value.astype(np.float64))
