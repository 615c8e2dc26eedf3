"""Areas that footprints and samples have in common, by clipping polygons: exact, and slow."""

from __future__ import annotations

import numpy as np


def common_area(corners, left, top):
    """Of a convex polygon and the square from (left, top) to one further along both axes."""
    points = [tuple(map(float, corner)) for corner in corners]
    for axis, bound, sign in ((0, left, 1), (0, left + 1, -1), (1, top, 1), (1, top + 1, -1)):
        kept = []
        for first, second in zip(points, points[1:] + points[:1], strict=True):
            one, two = sign * (first[axis] - bound), sign * (second[axis] - bound)
            if one >= 0:
                kept.append(first)
            if one * two < 0:
                share = one / (one - two)
                kept.append(tuple(a + share * (b - a) for a, b in zip(first, second, strict=True)))
        points = kept
        if not points:
            return 0.0
    return area(points)


def area(corners):
    """Of a polygon, by the shoelace formula."""
    x, y = np.array(corners).T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


def clipped_mean(scene, corners):
    """Mean over a footprint of a scene whose samples hold all over their extent, and its share."""
    rows, columns = scene.shape
    total = inside = 0.0
    x, y = np.array(corners).T
    for row in range(max(int(y.min()), 0), min(int(y.max()) + 1, rows)):
        for column in range(max(int(x.min()), 0), min(int(x.max()) + 1, columns)):
            common = common_area(corners, column, row)
            total += common * float(scene[row, column])
            inside += common
    return total / area(corners), inside / area(corners)
