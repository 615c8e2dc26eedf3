"""Exact share of each sample's area that a shape covers.

Edges are the borders between samples, in increasing order and in any unit: n samples have n + 1
edges. Every result is a mean over the sample's area, so pictures drawn with it are not aliased
and the mean of 2 × 2 samples is the sample of twice the size.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def cell_edges(*, count: int, start: int = 0, stop: int | None = None) -> FloatArray:
    """Edges of samples `start` to `stop`, or all, of `count` samples that fill 0 to 1."""
    return np.arange(start, (count if stop is None else stop) + 1, dtype=np.float64) / count


def edge_fraction(
    distance: FloatArray, *, extent_a: FloatArray, extent_b: FloatArray
) -> FloatArray:
    """Share of a rectangular sample on the positive side of a straight edge.

    The sample's shadow on the edge's normal is a trapezoid, the convolution of two boxes; its
    integral is quadratic near both ends and linear between.

    Parameters
    ----------
    distance : ndarray
        Signed distance of the sample's centre from the edge, positive on the covered side.
    extent_a, extent_b : ndarray
        Lengths of the shadows of the sample's two sides on the normal, in the same unit.

    Returns
    -------
    ndarray
        0 to 1.
    """
    long_side = np.maximum(extent_a, extent_b)
    short_side = np.minimum(extent_a, extent_b)
    # Measured from the nearer end of the trapezoid, which keeps full relative accuracy there.
    inside = 0.5 * (extent_a + extent_b) - np.abs(distance)
    corner = np.clip(inside, 0.0, short_side)
    ratio = corner / np.where(short_side > 0.0, short_side, 1.0)
    smaller = (0.5 * corner * ratio + np.maximum(inside - short_side, 0.0)) / long_side
    fraction: FloatArray = np.where(distance > 0.0, 1.0 - smaller, smaller)
    return fraction


def half_plane_coverage(
    x_edges: FloatArray, y_edges: FloatArray, *, normal_x: float, normal_y: float, offset: float
) -> FloatArray:
    """Share of each sample inside the half plane normal_x·x + normal_y·y > offset, (rows, columns).

    The edges are the samples' borders; the normal may have any length but 0.
    """
    x_mid = 0.5 * (x_edges[1:] + x_edges[:-1])
    y_mid = 0.5 * (y_edges[1:] + y_edges[:-1])
    distance = normal_x * x_mid + (normal_y * y_mid - offset)[:, None]
    return edge_fraction(
        distance,
        extent_a=abs(normal_x) * np.diff(x_edges),
        extent_b=abs(normal_y) * np.diff(y_edges)[:, None],
    )


def _quadrant_area(x: FloatArray, y: FloatArray) -> FloatArray:
    """Area of the unit disc left of x and before y, for every pair; x, y within -1 to 1."""
    chord = np.sqrt(1.0 - y * y)

    def primitive(u: FloatArray) -> FloatArray:
        area: FloatArray = 0.5 * (u * np.sqrt(1.0 - u * u) + np.arcsin(u))
        return area

    s_x, s_chord = primitive(x)[..., None, :], primitive(chord)[..., None]
    x, y, chord = x[..., None, :], y[..., None], chord[..., None]
    # The primitive is monotone, so it commutes with min and max and stays one-dimensional.
    cut = np.minimum(np.maximum(x, -chord), chord)
    cut += chord
    cut *= np.abs(y)
    cut += np.minimum(s_x, -s_chord)
    cut += np.maximum(s_x, s_chord)
    cut += 0.25 * np.pi - s_chord
    cut *= np.sign(y)
    cut += s_x + 0.25 * np.pi
    return cut


def ellipse_coverage(
    x_edges: FloatArray,
    y_edges: FloatArray,
    *,
    centre_x: npt.ArrayLike,
    centre_y: npt.ArrayLike,
    radius_x: npt.ArrayLike,
    radius_y: npt.ArrayLike,
) -> FloatArray:
    """Share of each sample inside an ellipse with axes along x and y, (…, rows, columns).

    Centre and half axes are in the unit of the edges; of several ellipses each has edges of its
    own.
    """
    u = (x_edges - np.asarray(centre_x)[..., None]) / np.asarray(radius_x)[..., None]
    v = (y_edges - np.asarray(centre_y)[..., None]) / np.asarray(radius_y)[..., None]
    left, right, above, below = u[..., :-1], u[..., 1:], v[..., :-1], v[..., 1:]
    corner = _quadrant_area(
        np.minimum(np.maximum(u, -1.0), 1.0), np.minimum(np.maximum(v, -1.0), 1.0)
    )
    side = corner[..., 1:, :] - corner[..., :-1, :]
    share = side[..., 1:] - side[..., :-1]
    share /= (below - above)[..., None] * (right - left)[..., None, :]
    np.minimum(np.maximum(share, 0.0, out=share), 1.0, out=share)
    # The differences above lose digits as the square of the size in samples; that would show as
    # noise on even areas, so samples off the rim get their exact value.
    far_u, far_v = np.maximum(right, -left), np.maximum(below, -above)
    near_u = np.maximum(np.maximum(left, -right), 0.0)
    near_v = np.maximum(np.maximum(above, -below), 0.0)
    inside = (far_u * far_u)[..., None, :] + (far_v * far_v)[..., None] <= 1.0
    outside = (near_u * near_u)[..., None, :] + (near_v * near_v)[..., None] >= 1.0
    np.copyto(share, 1.0, where=inside)
    np.copyto(share, 0.0, where=outside)
    return share


def star_coverage(x_edges: FloatArray, y_edges: FloatArray, *, spokes: int) -> FloatArray:
    """Share of each sample inside the sectors of a star about the origin, cos(spokes·θ) > 0.

    The samples must have unit size.
    """
    cuts = np.unique(np.append(y_edges, np.clip(0.0, y_edges[0], y_edges[-1])))
    upper = cuts[cuts >= 0.0]
    lower = cuts[cuts <= 0.0]
    parts = []
    if lower.size > 1:
        # Half a turn maps the lower half on the upper; an odd star changes sign with it.
        turned = _upper_star(-x_edges[::-1], -lower[::-1], spokes)[::-1, ::-1]
        parts.append(1.0 - turned if spokes % 2 else turned)
    if upper.size > 1:
        parts.append(_upper_star(x_edges, upper, spokes))
    rows = np.concatenate(parts)
    if rows.shape[0] == y_edges.size - 1:
        return rows
    weighted = rows * np.diff(cuts)[:, None]
    first = np.searchsorted(cuts, y_edges[:-1])
    share: FloatArray = np.add.reduceat(weighted, first, axis=0) / np.diff(y_edges)[:, None]
    return share


def _upper_star(x_edges: FloatArray, y_edges: FloatArray, spokes: int) -> FloatArray:
    """Star coverage where y >= 0: every border is a line through the origin."""
    angle = (np.arange(spokes) + 0.5) * np.pi / spokes
    sine, cosine = np.sin(angle), np.cos(angle)
    x = 0.5 * (x_edges[1:] + x_edges[:-1])
    y = 0.5 * (y_edges[1:] + y_edges[:-1])[:, None]
    height = np.diff(y_edges)[:, None]
    nearest = np.clip((np.arctan2(y, x) * (spokes / np.pi)).astype(np.intp), 0, spokes - 1)
    beyond = edge_fraction(
        y * cosine[nearest] - x * sine[nearest],
        extent_a=sine[nearest],
        extent_b=np.abs(cosine[nearest]) * height,
    )
    share = np.where(nearest % 2 == 0, 1.0 - beyond, beyond)
    # Nearer than this several borders can cross one sample: there, the alternating sum of all.
    reach = 0.5 * spokes + 2.0
    columns = slice(*np.searchsorted(x, [-reach, reach]))
    rows = slice(0, int(np.searchsorted(y[:, 0], reach)))
    inner_x, inner_y = x_edges[columns.start : columns.stop + 1], y_edges[: rows.stop + 1]
    if inner_x.size > 1 and inner_y.size > 1:
        total = np.ones((inner_y.size - 1, inner_x.size - 1))
        for k in range(spokes):
            part = half_plane_coverage(
                inner_x, inner_y, normal_x=-sine[k], normal_y=cosine[k], offset=0.0
            )
            total += part if k % 2 else -part
        share[rows, columns] = np.clip(total, 0.0, 1.0)
    return share


Kind = Literal[
    "dormitory",
    "airfield",
    "slanted_edge",
    "four_bar",
    "siemens_star",
    "point",
    "sine",
    "two_panel",
    "uniform",
]
KINDS: tuple[Kind, ...] = get_args(Kind)


# Radiances that are not known yet: a drawing names surfaces, and numbers come when it is shown.

Radiances = Mapping[str, float]
"""Radiance by surface name [W m⁻² sr⁻¹]."""

Mix = Mapping[str, float]
"""Parts of named radiances: they sum to 1 for a surface, and to 0 for a difference."""


def between(first: str, second: str, share: float) -> Mix:
    """From `first` at 0 to `second` at 1."""
    return {first: 1.0 - share, second: share}


def difference(of: str, against: str) -> Mix:
    """How much more one surface has than another."""
    return {of: 1.0, against: -1.0}


def radiance_of(mix: Mix, radiances: Radiances) -> float:
    """Radiance of a mix."""
    return sum(part * radiances[name] for name, part in mix.items())


@dataclass(frozen=True)
class Texture:
    """How strong a texture is drawn; `name` stands for that, like a surface's for its radiance.

    `amplitude` is the strength as given, and `reach` the texture's largest value at strength 1. It
    stays within the share `limit` of the least radiance among the `surfaces` that it is on, so that
    no radiance falls below 0.
    """

    name: str
    amplitude: Mix
    reach: float
    limit: float
    surfaces: tuple[str, ...]

    def strength(self, radiances: Radiances) -> float:
        """What the texture is multiplied with."""
        given = radiance_of(self.amplitude, radiances)
        allowed = self.limit * min(radiances[name] for name in self.surfaces)
        reach = abs(given) * self.reach
        return given * allowed / reach if reach > allowed else given
