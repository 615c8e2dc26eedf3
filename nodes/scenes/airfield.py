"""A wide scene for cameras that look down: an airfield among fields, woods and straight roads.

Roads and runway are straight and lie askew, so that a camera's distortion shows. Drawn from
continuous coordinates, 0 to 1 in x and y: thought of as 2 km square, 0.01 is 20 m.
"""

import numpy as np

from nodes.scenes.scene_canvas import (
    GOLDEN_STEPS,
    Drawing,
    Mix,
    between,
    difference,
    mottle,
    scatter,
)

Place = tuple[float, float]

FIELDS = (
    # left, top, right, low, from lawn to bare soil
    (0.00, 0.00, 0.17, 0.23, 0.35),
    (0.17, 0.00, 0.40, 0.14, 0.12),
    (0.63, 0.00, 0.82, 0.12, 0.30),
    (0.00, 0.40, 0.10, 0.66, 0.20),
    (0.84, 0.50, 1.00, 0.74, 0.28),
    (0.58, 0.86, 0.78, 1.00, 0.40),
    (0.30, 0.90, 0.58, 1.00, 0.15),
)
WOODS = (
    # x, y, radius, trees, seed
    (0.52, 0.08, 0.075, 260, 701),
    (0.08, 0.31, 0.060, 180, 711),
    (0.93, 0.86, 0.080, 300, 721),
    (0.13, 0.93, 0.060, 180, 731),
    (0.94, 0.40, 0.045, 110, 741),
)
RUNWAY = ((0.10, 0.66), (0.72, 0.16))
TAXIWAY = ((0.16, 0.70), (0.80, 0.184))
ROADS = (
    # where from, where to, width
    ((-0.02, 0.10), (1.02, 0.98), 0.0060),
    ((-0.02, 0.905), (1.02, 0.025), 0.0060),
    ((0.79, -0.02), (0.47, 1.02), 0.0045),
    ((0.205, -0.02), (0.205, 1.02), 0.0035),
    ((-0.02, 0.795), (1.02, 0.795), 0.0035),
)


def airfield() -> Drawing:
    drawing = Drawing("lawn")
    _fields(drawing)
    drawing.paint_ellipse("shade", 0.885, 0.215, 0.063, 0.046)
    drawing.paint_ellipse("water", 0.885, 0.215, 0.059, 0.042)
    for start, end, width in ROADS:
        _strip(drawing, "kerb", start, end, 1.5 * width)
        _strip(drawing, "asphalt", start, end, width)
    _runway(drawing)
    _hangars(drawing)
    _village(drawing)
    for x, y, radius, trees, seed in WOODS:
        _wood(drawing, x, y, radius, trees, seed)
    _traffic(drawing)
    return drawing


def _fields(drawing: Drawing) -> None:
    for left, top, right, low, share in FIELDS:
        drawing.paint_box("shade", left, top, right, low)
        drawing.paint_box(between("lawn", "soil", share), left, top, right - 0.002, low - 0.002)
    nearer = difference("lawn_near", "lawn")
    for coarse, fine, amplitude, seed in ((2.0, 16.0, 0.5, 751), (30.0, 300.0, 0.35, 761)):
        contrast = {name: amplitude * part for name, part in nearer.items()}
        surfaces, waves = ("lawn", "lawn_near", "shade"), {"coarse": coarse, "fine": fine}
        mottle(drawing, contrast, surfaces, box=(0.0, 0.0, 1.0, 1.0), **waves, count=20, seed=seed)


def _strip(drawing: Drawing, surface: Mix | str, start: Place, end: Place, width: float) -> None:
    """A straight strip between two places, with ends along x, or along y where it is level."""
    (x0, y0), (x1, y1) = (start, end) if start[1] <= end[1] else (end, start)
    length = float(np.hypot(x1 - x0, y1 - y0))
    if y1 == y0:
        drawing.paint_box(surface, min(x0, x1), y0 - 0.5 * width, max(x0, x1), y0 + 0.5 * width)
        return
    reach = 0.5 * width * length / (y1 - y0)
    drawing.paint_trapezoid(surface, (y0, x0 - reach, x0 + reach), (y1, x1 - reach, x1 + reach))


def _between(line: tuple[Place, Place], share: float) -> Place:
    (x0, y0), (x1, y1) = line
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0)


def _runway(drawing: Drawing) -> None:
    _strip(drawing, "asphalt", *TAXIWAY, 0.010)
    for share in (0.03, 0.35, 0.65, 0.97):
        _strip(drawing, "asphalt", _between(RUNWAY, share), _between(TAXIWAY, share), 0.009)
    _strip(drawing, "kerb", *RUNWAY, 0.026)
    _strip(drawing, "concrete", *RUNWAY, 0.022)
    for share in np.arange(0.06, 0.93, 0.035).tolist():
        ends = (_between(RUNWAY, share), _between(RUNWAY, share + 0.018))
        _strip(drawing, "marking", *ends, 0.0016)
    for share in (0.012, 0.962):
        for aside in (-0.0085, -0.0051, -0.0017, 0.0017, 0.0051, 0.0085):
            first, last = _between(RUNWAY, share), _between(RUNWAY, share + 0.026)
            along = np.subtract(RUNWAY[1], RUNWAY[0]) / np.hypot(*np.subtract(*RUNWAY))
            off_x, off_y = -aside * along[1], aside * along[0]
            _strip(
                drawing,
                "marking",
                (first[0] + off_x, first[1] + off_y),
                (last[0] + off_x, last[1] + off_y),
                0.0018,
            )


def _hangars(drawing: Drawing) -> None:
    drawing.paint_box("paving", 0.60, 0.37, 0.80, 0.50)
    for number, left in enumerate((0.615, 0.670, 0.725)):
        drawing.paint_box("shade", left + 0.008, 0.46, left + 0.050, 0.506)
        drawing.paint_box("roof" if number % 2 else "slab", left, 0.453, left + 0.042, 0.498)
        drawing.paint_box("metal", left + 0.019, 0.453, left + 0.023, 0.498)
    for number, x in enumerate((0.632, 0.668, 0.704, 0.740)):
        y, hull = 0.405, "car_cool" if number != 2 else "car_warm"
        drawing.paint_ellipse("shade", x + 0.003, y + 0.003, 0.013, 0.0025)
        drawing.paint_ellipse(hull, x, y, 0.013, 0.0024)
        drawing.paint_ellipse("shade", x + 0.003, y + 0.005, 0.0019, 0.014)
        drawing.paint_ellipse(hull, x, y + 0.002, 0.0019, 0.014)
        drawing.paint_ellipse(hull, x, y + 0.013, 0.005, 0.0013)
        if number == 2:
            for aside in (-0.0045, 0.0045):
                drawing.paint_ellipse("engine", x + aside, y, 0.0011, 0.0022)
                drawing.paint_ellipse("plume", x + aside, y + 0.006, 0.0009, 0.0035)


def _village(drawing: Drawing) -> None:
    tone = scatter(200, seed=771)
    for index, (row, place) in enumerate(np.ndindex(4, 11)):
        x = 0.225 + 0.0225 * place + 0.004 * tone[index]
        y = (0.757, 0.777, 0.803, 0.823)[row] + 0.003 * tone[index + 60]
        wide, tall = 0.010 + 0.004 * tone[index + 120], 0.008
        roof = between("brick", "roof", float(tone[index + 60]))
        drawing.paint_box("shade", x + 0.002, y + 0.002, x + wide + 0.002, y + tall + 0.002)
        drawing.paint_box(roof, x, y, x + wide, y + tall)
        drawing.paint_box("coping", x, y + 0.45 * tall, x + wide, y + 0.55 * tall)
        if tone[index + 100] > 0.6:
            drawing.paint_box(
                "exhaust", x + 0.3 * wide, y + 0.001, x + 0.3 * wide + 0.0015, y + 0.0025
            )


def _wood(drawing: Drawing, x: float, y: float, radius: float, trees: int, seed: int) -> None:
    """Crowns evenly over a disc, each with its shadow, by a sequence that never clusters."""
    number = np.arange(1, trees + 1)
    away = radius * np.sqrt((0.5 + number * GOLDEN_STEPS[0]) % 1.0)
    turn = 2.0 * np.pi * ((0.5 + number * GOLDEN_STEPS[1]) % 1.0)
    across, down = x + away * np.cos(turn), y + 0.8 * away * np.sin(turn)
    size = (0.55 + 0.45 * scatter(trees, seed=seed)) * radius * 2.0 / np.sqrt(trees)
    tone = scatter(trees, seed=seed + 1).tolist()
    shade: list[Mix] = [{"shade": 1.0}] * trees
    crown = [between("leaf_cool", "leaf_warm", share) for share in tone]
    mixes = [mix for pair in zip(shade, crown, strict=True) for mix in pair]
    off = np.tile([0.0025, 0.0], trees)
    drawing.paint_ellipses(
        mixes,
        np.repeat(across, 2) + off,
        np.repeat(down, 2) + off,
        np.repeat(size, 2),
        np.repeat(size, 2),
    )


def _traffic(drawing: Drawing) -> None:
    shares = scatter(36, seed=781)
    for index, share in enumerate(shares.tolist()):
        start, end, width = ROADS[index % 3]
        along = np.subtract(end, start) / np.hypot(*np.subtract(end, start))
        side = 0.22 * width * (1 if index % 2 else -1)
        x, y = _between((start, end), share)
        x, y = x - side * along[1], y + side * along[0]
        drawing.paint_ellipse("engine" if index % 4 else "car_cool", x, y, 0.0013, 0.0011)
