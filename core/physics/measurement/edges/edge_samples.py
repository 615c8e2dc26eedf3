"""The samples of a picture that belong to an edge, by their distance from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_found import FoundEdge

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class EdgeSamples:
    """Samples about an edge, in the order of the picture's rows.

    Parameters
    ----------
    distance : ndarray
        Of each sample's middle from the edge along its normal, positive on the brighter side.
    along : ndarray
        Place along the edge, 0 at its middle.
    value : ndarray
        The samples.
    """

    distance: Vector
    along: Vector
    value: Vector


def edge_samples(*, picture: NDArray[np.floating], edge: FoundEdge) -> EdgeSamples:
    """Take the samples within an edge's reach and length.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns).
    edge : FoundEdge
        Where to take them.

    Returns
    -------
    EdgeSamples
        Those at most `reach` from the edge and half its length from its middle.
    """
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

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns).
    middle : tuple of float
        x and y of the rectangle's middle.
    angle_deg : float
        Of the normal.
    half_length, reach : float
        Half the sides along and across, samples.
    bend : float
        Distance of the axis's ends from the tangent at its middle, along the normal.

    Returns
    -------
    EdgeSamples
        Samples within it; what lies outside the picture is left out.
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
