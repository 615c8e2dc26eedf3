"""Random cameras, and scenes for the development of what finds edges, measures and fits.

A scene is drawn for a frame's size and the electrons of full scale. The scenes that judge in the
end are another family, of other shapes.
"""

import math

import numpy as np

from oversampled_camera import Camera
from oversampled_scene import Scene, Shape

GLYPHS = {  # x and y of the corners, a digit each
    "E": "00 30 31 11 12 32 33 13 14 34 35 05",
    "H": "00 10 12 22 20 30 35 25 23 13 15 05",
    "T": "00 30 31 21 25 15 11 01",
    "L": "00 10 14 34 35 05",
}


def drawn_camera(rng):
    """A camera, with the electrons of its full scale; its MTF at Nyquist is 0.02 to 0.5."""
    optics = rng.random() < 0.8
    bits = int(rng.integers(8, 15))
    full = 10 ** rng.uniform(3.7, 5.3)
    jitter = rng.uniform(0.1, 0.6)
    camera = Camera(
        cutoff=rng.uniform(0.7, 2.5) if optics else None,
        obscuration=rng.uniform(0.2, 0.4) if optics and rng.random() < 0.3 else 0.0,
        defocus=rng.uniform(0.1, 0.5) if optics and rng.random() < 0.4 else 0.0,
        gaussian=(0.0, 0.0) if optics else (rng.uniform(0.2, 0.6), rng.uniform(0.2, 0.6)),
        jitter=jitter if rng.random() < 0.6 else 0.0,
        motion=rng.uniform(0.3, 1.6) if rng.random() < 0.25 else 0.0,
        motion_deg=rng.uniform(0, 180),
        pixel=(rng.uniform(0.8, 1.0), rng.uniform(0.8, 1.0)),
        electronics=rng.uniform(0.1, 0.3) if rng.random() < 0.15 else 0.0,
        read_e=full * 10 ** rng.uniform(-4.3, -2.7),
        gain_e_per_dn=full / 2**bits,
        offset_dn=2**bits * rng.uniform(0, 0.05),
        bits=bits,
    )
    return camera, 0.9 * full


def turned(corners, angle_deg, middle):
    """Corners turned about their mean, which comes to lie at the middle."""
    corners = np.asarray(corners, float)
    angle = math.radians(angle_deg)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return (corners - corners.mean(axis=0)) @ turn + np.asarray(middle)


def box(width, height):
    return np.array([[0, 0], [width, 0], [width, height], [0, height]], float)


def disc(middle, radius, sides=360):
    angle = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    return np.asarray(middle) + radius * np.column_stack((np.cos(angle), np.sin(angle)))


def levels(rng, full, count):
    """Levels from 0.08 to 0.9 of full scale, neighbours in the row at least 0.12 apart."""
    values = [rng.uniform(0.08, 0.9)]
    while len(values) < count:
        value = rng.uniform(0.08, 0.9)
        if abs(value - values[-1]) > 0.12:
            values.append(value)
    return np.array(values) * full


def rectangles(rng, rows, columns, full):
    side = min(rows, columns)
    shapes = []
    for k in range(4):
        low, high = levels(rng, full, 2)
        middle = columns * (0.27 + 0.46 * (k % 2)), rows * (0.27 + 0.46 * (k // 2))
        size = side * rng.uniform(0.22, 0.3, 2)
        shapes.append(Shape(turned(box(*size), rng.uniform(0, 360), middle), high))
    return Scene(background=low, shapes=tuple(shapes))


def bars(rng, rows, columns, full):
    low, high = levels(rng, full, 2)
    angle = rng.uniform(0, 360)
    width = rng.uniform(3, 14)
    length = 0.5 * min(rows, columns)
    turn = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    middle = np.array([columns, rows]) / 2
    shapes = [
        Shape(turned(box(width, length), angle, middle + k * 2 * width * turn), high)
        for k in range(-2, 3)
    ]
    return Scene(background=low, shapes=tuple(shapes))


def checker(rng, rows, columns, full):
    low, high = levels(rng, full, 2)
    angle, size = rng.uniform(0, 360), rng.uniform(20, 40)
    middle = np.array([columns, rows]) / 2 + rng.uniform(-9, 9, 2)
    turn = math.radians(angle)
    one = size * np.array([math.cos(turn), math.sin(turn)])
    two = size * np.array([-math.sin(turn), math.cos(turn)])
    reach = int(max(rows, columns) / size) + 1
    shapes = [
        Shape(turned(box(size, size), angle, middle + i * one + j * two), high)
        for i in range(-reach, reach + 1)
        for j in range(-reach, reach + 1)
        if (i + j) % 2 == 0
    ]
    return Scene(background=low, shapes=tuple(shapes))


def star(rng, rows, columns, full):
    low, high = levels(rng, full, 2)
    middle = np.array([columns, rows]) / 2
    spokes, start = int(rng.integers(5, 13)), rng.uniform(0, 2 * math.pi)
    shapes = []
    for k in range(spokes):
        one, two = (start + math.pi * (2 * k + e) / spokes for e in (0, 1))
        rim = (
            0.45
            * min(rows, columns)
            * np.array([[math.cos(one), math.sin(one)], [math.cos(two), math.sin(two)]])
        )
        shapes.append(Shape(np.vstack((middle, middle + rim)), high))
    return Scene(background=low, shapes=tuple(shapes))


def letters(rng, rows, columns, full):
    low, high = levels(rng, full, 2)
    size = min(rows, columns) / 12 * rng.uniform(0.7, 1.1)
    shapes = []
    for k, glyph in enumerate(GLYPHS.values()):
        corners = size * np.array([[int(digit) for digit in pair] for pair in glyph.split()])
        middle = columns * (0.27 + 0.46 * (k % 2)), rows * (0.27 + 0.46 * (k // 2))
        shapes.append(Shape(turned(corners, rng.uniform(-25, 25), middle), high))
    return Scene(background=low, shapes=tuple(shapes), shading=tuple(rng.uniform(-0.02, 0.02, 2)))


def leaves(rng, rows, columns, full):
    """Discs that hide one another, and two quadrilaterals, on a 1/f ground."""
    shapes = []
    for _ in range(40):
        radius = min(rows, columns) * 0.02 / (1 - rng.uniform(0, 0.96)) ** 0.5
        middle = rng.uniform(0, 1, 2) * (columns, rows)
        shapes.append(
            Shape(disc(middle, radius), levels(rng, full, 1)[0], straight=False, texture=0.03)
        )
    for k in (0.3, 0.7):
        size = min(rows, columns) * rng.uniform(0.3, 0.45, 2)
        middle = columns * k, rows * rng.uniform(0.3, 0.7)
        one = turned(box(*size), rng.uniform(0, 360), middle)
        shapes.append(Shape(one, levels(rng, full, 1)[0]))
    return Scene(
        background=0.4 * full,
        shapes=tuple(shapes),
        texture=0.08,
        texture_seed=int(rng.integers(1 << 30)),
    )


def discs(rng, rows, columns, full):
    """No straight edge."""
    shapes = []
    for _ in range(9):
        middle = rng.uniform(0.1, 0.9, 2) * (columns, rows)
        radius = rng.uniform(4, 24)
        shapes.append(Shape(disc(middle, radius), levels(rng, full, 1)[0], straight=False))
    return Scene(background=0.3 * full, shapes=tuple(shapes))


def texture(rng, rows, columns, full):
    """No edge: a shaded 1/f field."""
    return Scene(
        background=0.4 * full,
        texture=rng.uniform(0.05, 0.2),
        texture_power=rng.uniform(1.6, 2.4),
        texture_seed=int(rng.integers(1 << 30)),
        shading=tuple(rng.uniform(-0.1, 0.1, 2)),
    )


def points(rng, rows, columns, full):
    """No edge: points on an even ground."""
    count = rows * columns // 400
    place = rng.uniform(0, 1, (count, 2)) * (columns - 1, rows - 1)
    return Scene(
        background=0.1 * full, points=np.column_stack((place, full * rng.uniform(0.05, 1.5, count)))
    )


def flat(rng, rows, columns, full):
    """No edge: two gentle slopes."""
    return Scene(background=levels(rng, full, 1)[0], shading=tuple(rng.uniform(-0.05, 0.05, 2)))


DEVELOPMENT = {
    one.__name__: one
    for one in (rectangles, bars, checker, star, letters, leaves, discs, texture, points, flat)
}


def half(angle, middle, size=1000):
    """Corners of the half-plane on one side of an edge."""
    away = size / 2 * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    return turned(box(size, size), angle, np.asarray(middle) + away)
