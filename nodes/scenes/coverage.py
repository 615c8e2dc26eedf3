"""Exact share of each sample's area that a shape covers, and exact means of functions of x or y.

Edges are the borders between samples, rising, in any unit: n samples have n + 1. Results are means
over a sample's area, so nothing is aliased.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from core.arrays import Floats
from core.kernels import special
from core.records import dataclass


def cell_edges(*, count: int, start: int = 0, stop: int | None = None) -> Floats:
    """Edges of samples `start` to `stop`, or all, of `count` samples that fill 0 to 1."""
    return np.arange(start, (count if stop is None else stop) + 1, dtype=np.float64) / count


def edge_fraction(distance: Floats, *, extent_a: Floats, extent_b: Floats) -> Floats:
    """Share of a rectangular sample on the positive side of a straight edge.

    `distance` is that of the sample's centre, positive on the covered side; the extents are the
    lengths of the shadows of its two sides on the edge's normal. The sample's shadow is a
    trapezoid, the convolution of two boxes: its integral is quadratic near both ends and linear
    between.
    """
    long_side = np.maximum(extent_a, extent_b)
    short_side = np.minimum(extent_a, extent_b)
    # Measured from the nearer end of the trapezoid, which keeps full relative accuracy there.
    inside = 0.5 * (extent_a + extent_b) - np.abs(distance)
    corner = np.clip(inside, 0.0, short_side)
    ratio = corner / np.where(short_side > 0.0, short_side, 1.0)
    smaller = (0.5 * corner * ratio + np.maximum(inside - short_side, 0.0)) / long_side
    fraction: Floats = np.where(distance > 0.0, 1.0 - smaller, smaller)
    return fraction


def half_plane_coverage(
    x_edges: Floats, y_edges: Floats, *, normal_x: float, normal_y: float, offset: float
) -> Floats:
    """Share of each sample inside normal_x·x + normal_y·y > offset, (rows, columns)."""
    x_mid = 0.5 * (x_edges[1:] + x_edges[:-1])
    y_mid = 0.5 * (y_edges[1:] + y_edges[:-1])
    distance = normal_x * x_mid + (normal_y * y_mid - offset)[:, None]
    return edge_fraction(
        distance,
        extent_a=abs(normal_x) * np.diff(x_edges),
        extent_b=abs(normal_y) * np.diff(y_edges)[:, None],
    )


def _quadrant_area(x: Floats, y: Floats) -> Floats:
    """Area of the unit disc left of x and before y, for every pair; x, y within -1 to 1."""
    chord = np.sqrt(1.0 - y * y)

    def primitive(u: Floats) -> Floats:
        area: Floats = 0.5 * (u * np.sqrt(1.0 - u * u) + np.arcsin(u))
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
    x_edges: Floats,
    y_edges: Floats,
    *,
    centre_x: npt.ArrayLike,
    centre_y: npt.ArrayLike,
    radius_x: npt.ArrayLike,
    radius_y: npt.ArrayLike,
) -> Floats:
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


def star_coverage(x_edges: Floats, y_edges: Floats, *, spokes: int) -> Floats:
    """Share of each sample, of unit size, inside a star about the origin, cos(spokes·θ) > 0."""
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
    share: Floats = np.add.reduceat(weighted, first, axis=0) / np.diff(y_edges)[:, None]
    return share


def _upper_star(x_edges: Floats, y_edges: Floats, spokes: int) -> Floats:
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


# Functions of one coordinate. A profile is zero outside `low` to `high` and known by its integral,
# so that its mean over a sample is a difference of two values, whatever the size of the picture.


@dataclass(frozen=True)
class Profile:
    """A function on `low` to `high` by its indefinite integral; of several, an axis in front."""

    low: float
    high: float
    integral: Callable[[Floats], Floats]

    def means(self, edges: Floats) -> Floats:
        sums = self.integral(np.minimum(np.maximum(edges, self.low), self.high))
        means: Floats = (sums[..., 1:] - sums[..., :-1]) / (edges[1:] - edges[:-1])
        return means


def span(low: float, high: float, edges: Floats) -> slice:
    """The samples between `edges` that `low` to `high` touches."""
    # Searching by numpy gives other threads no turn: it lets go of Python and takes it again
    # within microseconds, sooner than one that waits wakes up.
    first = bisect_right(edges, low) - 1
    last = bisect_left(edges, high)
    first = min(max(first, 0), edges.size - 1)
    return slice(first, max(min(last, edges.size - 1), first))


def band(low: float, high: float) -> Profile:
    return Profile(low, high, lambda e: e)


def steps(starts: npt.ArrayLike, ends: npt.ArrayLike, values: npt.ArrayLike = 1.0) -> Profile:
    """`values` on disjoint intervals in increasing order, 0 between them."""
    begin = np.asarray(starts, dtype=np.float64)
    end = np.asarray(ends, dtype=np.float64)
    single = (end - begin) * np.asarray(values, dtype=np.float64)
    area = np.cumsum(single)
    knots = np.column_stack([begin, end]).ravel()
    sums = np.column_stack([area - single, area]).ravel()
    return Profile(float(begin[0]), float(end[-1]), lambda e: np.interp(e, knots, sums))


def power(low: float, high: float, exponent: int) -> Profile:
    """((u - low) / (high - low))^exponent."""
    width, next_one = high - low, exponent + 1
    return Profile(low, high, lambda e: width / next_one * ((e - low) / width) ** next_one)


def wave(
    low: float,
    high: float,
    *,
    cycles: npt.ArrayLike,
    phase: npt.ArrayLike,
    height: npt.ArrayLike = 1.0,
) -> Profile:
    """height·cos(2π·cycles·u + phase), with `cycles` per unit and not 0; several from arrays."""
    k = 2.0 * np.pi * np.asarray(cycles, dtype=np.float64)[..., None]
    start = np.asarray(phase, dtype=np.float64)[..., None]
    scale = np.asarray(height, dtype=np.float64)[..., None] / k
    return Profile(low, high, lambda e: scale * np.sin(k * e + start))


def bell(centre: float, sigma: float, height: float = 1.0) -> Profile:
    """A Gaussian of the given height, cut at 5 sigma."""
    scale = height * sigma * float(np.sqrt(2.0 * np.pi))
    low, high = centre - 5.0 * sigma, centre + 5.0 * sigma
    return Profile(low, high, lambda e: scale * special("ndtr")((e - centre) / sigma))


def bells(centres: Floats, sigma: float, heights: Floats) -> Profile:
    """A sum of equal Gaussians side by side, cut at 5 sigma beyond the first and the last."""
    scale = heights * (sigma * float(np.sqrt(2.0 * np.pi)))
    low, high = float(centres[0]) - 5.0 * sigma, float(centres[-1]) + 5.0 * sigma
    places = centres[:, None]
    return Profile(low, high, lambda e: scale @ special("ndtr")((e - places) / sigma))
