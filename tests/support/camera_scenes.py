"""Random cameras, and scenes for what finds edges, measures and fits.

A scene is drawn for a frame's size and the electrons of full scale. Numbers below 1000 are for
development; those from there on judge in the end, and are left alone meanwhile.
"""

import math

import numpy as np
from scipy.spatial import Delaunay

from oversampled_camera import Camera
from oversampled_scene import Scene, Shape


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


def houses(rng, rows, columns, full):
    """Gables with windows and doors before a sky that darkens, on textured ground."""
    sky, wall, roof, window = levels(rng, full, 4)
    shapes = []
    horizon = rows * rng.uniform(0.7, 0.85)
    for k in range(3):
        width, height = columns * rng.uniform(0.2, 0.28), rows * rng.uniform(0.3, 0.45)
        left = columns * (0.05 + 0.32 * k) + rng.uniform(-4, 4)
        lean = rng.uniform(-3, 3)
        shade = rng.uniform(0.9, 1.1)
        base, top = horizon + 8, horizon - height
        right = left + width
        body = [[left, base], [left + lean, top], [right + lean, top], [right, base]]
        eaves = [[left + lean - 4, top + 2], [right + lean + 4, top + 2]]
        peak = [left + width / 2 + lean, top - height * rng.uniform(0.3, 0.6)]
        shapes.append(Shape(np.array(body), wall * shade))
        shapes.append(Shape(np.array([eaves[0], peak, eaves[1]]), roof * shade))
        pane = box(width * 0.25, height * 0.3)
        place = left + width * rng.uniform(0.3, 0.7), horizon - height * 0.55
        shapes.append(Shape(turned(pane, lean, place), window))
    ground = np.array(
        [[-99, horizon], [columns + 99, horizon + 3], [columns + 99, 2 * rows], [-99, 2 * rows]]
    )
    shapes.append(Shape(ground, 0.5 * wall, straight=False, texture=0.1))
    return Scene(
        background=sky, shapes=tuple(shapes), shading=(0.0, rng.uniform(-0.03, 0.03)),
        texture_seed=int(rng.integers(1 << 30)),
    )  # fmt: skip


def roads(rng, rows, columns, full):
    """Two roads with dashed middle lines over even or rough terrain."""
    terrain, asphalt = levels(rng, full, 2)
    shapes = []
    first = rng.uniform(0, 180)
    for angle in (first, first + rng.uniform(50, 130)):
        width = rng.uniform(20, 34)
        middle = np.array([columns, rows]) * rng.uniform(0.35, 0.65, 2)
        shapes.append(Shape(turned(box(999, width), angle, middle), asphalt))
        along = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
        shapes += [
            Shape(turned(box(9, 2.2), angle, middle + along * 20 * n), 1.4 * asphalt)
            for n in range(-9, 10)
            if abs(20 * n) > 30
        ]
    return Scene(
        background=terrain, shapes=tuple(shapes), texture=float(rng.choice([0.0, 0.004, 0.05])),
        texture_seed=int(rng.integers(1 << 30)),
    )  # fmt: skip


def mosaic(rng, rows, columns, full):
    """Triangles of all levels that cover everything."""
    count = int(rng.integers(6, 16))
    places = rng.uniform(0, 1, (count, 2)) * (columns, rows)
    frame = np.array([[-90, -90], [columns + 90, -90], [columns + 90, rows + 90], [-90, rows + 90]])
    places = np.vstack((places, frame))
    shapes = [
        Shape(places[corners], levels(rng, full, 1)[0]) for corners in Delaunay(places).simplices
    ]
    return Scene(background=0.5 * full, shapes=tuple(shapes), disjoint=True)


def stairs(rng, rows, columns, full):
    """A staircase wall, seen at a slant."""
    low, high = levels(rng, full, 2)
    step = rng.uniform(26, 44)
    count = int(max(rows, columns) / step) + 6
    corners = [[0.0, 0.0]]
    for _ in range(count):
        x, y = corners[-1]
        corners += [[x + step, y], [x + step, y + step]]
    corners.append([0.0, corners[-1][1]])
    turn = rng.uniform(-40, 40)
    corners = np.array(corners) - np.array(corners[-2]) / 2
    angle = math.radians(turn)
    rotation = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return Scene(
        background=low,
        shapes=(Shape(corners @ rotation + np.array([columns, rows]) / 2, high),),
        shading=tuple(rng.uniform(-0.03, 0.03, 2)),
    )


def frames(rng, rows, columns, full):
    """Frames within frames."""
    values = levels(rng, full, 5)
    side = 0.9 * min(rows, columns)
    angle = rng.uniform(0, 90)
    shapes = [
        Shape(
            turned(box(side * size, side * size * 0.9), angle + rng.uniform(-6, 6),
                   (columns / 2, rows / 2)),
            level,
        )
        for size, level in zip((1.0, 0.72, 0.45, 0.22), values[1:], strict=True)
    ]  # fmt: skip
    return Scene(background=values[0], shapes=tuple(shapes))


def wedge(rng, rows, columns, full):
    """Rings, a wedge that narrows, and a mast."""
    low, high = levels(rng, full, 2)
    place = columns * 0.25, rows * 0.35
    shapes = [
        Shape(disc(place, radius), high if k % 2 == 0 else low, straight=False)
        for k, radius in enumerate((30, 22, 13, 5))
    ]
    tip = np.array([columns * 0.95, rows * rng.uniform(0.2, 0.5)])
    foot = np.array([columns * 0.45, rows * rng.uniform(0.5, 0.7)])
    across = rng.uniform(12, 20) * np.array([-(tip - foot)[1], (tip - foot)[0]])
    across = across / np.hypot(*(tip - foot))
    shapes.append(Shape(np.array([tip, foot + across, foot - across]), high))
    mast = turned(
        box(rng.uniform(8, 16), rows * 0.3), rng.uniform(-12, 12), (columns * 0.25, rows * 0.8)
    )
    shapes.append(Shape(mast, high))
    return Scene(background=low, shapes=tuple(shapes))


def field(rng, rows, columns, full):
    """One boundary across the whole frame, the fainter the more often."""
    low = full * rng.uniform(0.15, 0.6)
    high = low * (1 + 10 ** rng.uniform(-1.3, -0.3))
    angle = rng.uniform(0, 360)
    middle = np.array([columns, rows]) * rng.uniform(0.35, 0.65, 2)
    away = 500 * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    return Scene(
        background=low, shapes=(Shape(turned(box(1000, 1000), angle, middle + away), high),)
    )


def aerial(rng, rows, columns, full):
    """A runway, hangars and a round tank on grass."""
    grass, concrete, hangar = levels(rng, full, 3)
    angle = rng.uniform(0, 180)
    along = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    across = np.array([-along[1], along[0]])
    middle = np.array([columns, rows]) / 2
    shapes = [Shape(turned(box(999, 36), angle, middle - 25 * across), concrete)]
    shapes += [
        Shape(
            turned(box(40, 30), angle + rng.uniform(-8, 8), middle + n * along + 40 * across),
            hangar,
        )
        for n in (-62, 0, 62)
    ]
    shapes.append(Shape(disc(middle + 85 * across, 15), concrete, straight=False))
    return Scene(
        background=grass, shapes=tuple(shapes), texture=0.02, texture_power=1.8,
        texture_seed=int(rng.integers(1 << 30)),
    )  # fmt: skip


def clouds(rng, rows, columns, full):
    """No edge: steep 1/f."""
    return Scene(
        background=0.5 * full, texture=rng.uniform(0.1, 0.25), texture_power=rng.uniform(2.6, 3.4),
        texture_seed=int(rng.integers(1 << 30)),
    )  # fmt: skip


def ellipses(rng, rows, columns, full):
    """No straight edge."""
    shapes = []
    for _ in range(7):
        one = disc((0, 0), 1) * rng.uniform(8, 22, 2)
        place = rng.uniform(0.1, 0.9, 2) * (columns, rows)
        shapes.append(
            Shape(turned(one, rng.uniform(0, 180), place), levels(rng, full, 1)[0], False)
        )
    return Scene(background=0.35 * full, shapes=tuple(shapes))


SCENES = {
    one.__name__: one
    for one in (houses, roads, mosaic, stairs, frames, wedge, field, aerial, clouds, ellipses)
}
