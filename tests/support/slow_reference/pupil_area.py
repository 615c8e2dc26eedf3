"""Overlap of a geometric pupil with itself moved, by strips and cells whose areas are known.

The plane is cut along x wherever two outlines cross, an outline ends or stands upright. Within
such a strip the outlines do not cross, and the cell between two neighbours lies wholly inside both
pupils or not at all: a point at its middle tells. Its area is the difference of two integrals, of
circles or lines. Nothing is approximated.
"""

from itertools import combinations

import numpy as np

from slow_reference.numbers import PI

OBSCURED = ("cassegrain", "cassegrain_slit", "spider")
BARRED = ("hinged", "cassegrain_slit")
AT_ONCE = 200_000  # cells


def inside(p, x, y):
    """Whether points are transparent; x and y in samples from the centre."""
    square = x * x + y * y
    clear = square <= p["radius"] ** 2
    if p["shape"] in OBSCURED:
        clear &= square >= p["obscuration_radius"] ** 2
    if p["shape"] == "half_moon":
        clear &= x >= 0
    if p["shape"] in BARRED and p["slit_width"]:
        clear &= np.abs(x) > p["slit_width"] / 2
    for cos, sin in vanes(p, x):
        vane = np.abs(cos * y - sin * x) <= p["vane_width"] / 2
        clear &= ~(vane & (cos * x + sin * y >= 0))
    return clear


def vanes(p, like):
    """Directions of the vanes that there are."""
    if p["shape"] != "spider" or not p["vane_width"]:
        return []
    kind = like.dtype.type
    found = []
    for index in range(p["vanes"]):
        quarters, rest = divmod(4 * index, p["vanes"])
        if rest == 0:
            found.append(((1, 0), (0, 1), (-1, 0), (0, -1))[quarters])
        else:
            angle = 2 * kind(PI) * index / p["vanes"]
            found.append((np.cos(angle), np.sin(angle)))
    return found


def overlap(p, lag_x, lag_y):
    """Area shared by the pupil and the pupil moved by each lag (1-D arrays), square samples."""
    curves = 4 * len(circles(p)) + 2 * len(edges(p, lag_x))
    step = max(1, AT_ONCE // curves**3)
    return np.concatenate(
        [
            cells(p, lag_x[start : start + step], lag_y[start : start + step])
            for start in range(0, len(lag_x), step)
        ]
    )


def circles(p):
    inner = p["obscuration_radius"] if p["shape"] in OBSCURED else 0
    return [p["radius"], inner] if inner else [p["radius"]]


def edges(p, like):
    """Straight outlines as (x, y) of a point and (dx, dy) of the direction."""
    found = []
    if p["shape"] == "half_moon":
        found.append((0, 0, 0, 1))
    if p["shape"] in BARRED and p["slit_width"]:
        found += [(side * p["slit_width"] / 2, 0, 0, 1) for side in (-1, 1)]
    for cos, sin in vanes(p, like):
        half = p["vane_width"] / 2
        found += [(-side * half * sin, side * half * cos, cos, sin) for side in (-1, 1)]
        found.append((0, 0, -sin, cos))
    return found


def cells(p, a, b):
    rounds = [(x, y, r) for x, y in ((0 * a, 0 * b), (a, b)) for r in circles(p)]
    straight = [
        (x + dx, y + dy, u, v) for x, y in ((0 * a, 0 * b), (a, b)) for dx, dy, u, v in edges(p, a)
    ]
    sloped = [line for line in straight if line[2] != 0]
    places = [x + side * r for x, _, r in rounds for side in (-1, 1)]
    places += [x for x, _, u, _ in straight if u == 0]
    places += crossings(rounds, sloped)
    low = np.maximum(-p["radius"], a - p["radius"])
    high = np.maximum(low, np.minimum(p["radius"], a + p["radius"]))
    cuts = np.sort(np.clip(np.array(places), low, high), axis=0)  # (cuts, lags)
    middle = (cuts[1:] + cuts[:-1]) / 2
    heights, primitives = [], []
    for x, y, r in rounds:
        for side in (-1, 1):
            heights.append(y + side * np.sqrt(np.maximum((r - middle + x) * (r + middle - x), 0)))
            primitives.append(y * cuts + side * circle_primitive(cuts - x, r))
    for x, y, u, v in sloped:
        heights.append(y + (middle - x) * v / u)
        primitives.append(y * cuts + (cuts - x) ** 2 * v / (2 * u))
    heights, primitives = np.array(heights), np.array(primitives)
    order = np.argsort(heights, axis=0)
    heights = np.take_along_axis(heights, order, axis=0)
    below = np.take_along_axis(np.diff(primitives, axis=1), order, axis=0)
    height = (heights[1:] + heights[:-1]) / 2
    lit = inside(p, middle, height) & inside(p, middle - a, height - b)
    return np.sum(np.where(lit, below[1:] - below[:-1], 0), axis=(0, 1))


def circle_primitive(x, r):
    """∫√(r² − x²) dx, constant beyond the circle."""
    x = np.clip(x, -r, r)
    root = np.sqrt((r - x) * (r + x))
    return (x * root + r * r * np.arctan2(x, root)) / 2


def crossings(rounds, sloped):
    """Where along x two outlines meet; anywhere at all for those that do not."""
    found = []
    for (x, y, r), (p, q, t) in combinations(rounds, 2):
        dx, dy = p - x, q - y
        square = dx * dx + dy * dy
        square = np.where(square == 0, 1, square)
        along = (square + r * r - t * t) / (2 * square)
        off = np.sqrt(np.maximum(r * r / square - along * along, 0))
        found += [x + along * dx - side * off * dy for side in (-1, 1)]
    for cx, cy, r in rounds:
        for x, y, u, v in sloped:
            along = (cx - x) * u + (cy - y) * v
            gap = (cx - x) * v - (cy - y) * u
            half = np.sqrt(np.maximum((r - gap) * (r + gap), 0))
            found += [x + u * (along + side * half) for side in (-1, 1)]
    for (x, y, u, v), (p, q, s, t) in combinations(sloped, 2):
        turn = u * t - v * s
        if turn != 0:
            found.append(x + u * ((p - x) * t - (q - y) * s) / turn)
    return found
