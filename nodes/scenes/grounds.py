"""What surrounds the dormitory: sky, hills, lawn, drive, path, trees, lamps and parked cars."""

from __future__ import annotations

import numpy as np

from nodes.scenes.building import BASE, draw_building
from nodes.scenes.coverage import between, difference
from nodes.scenes.profiles import band, bell, power, steps
from nodes.scenes.scene_canvas import Drawing
from nodes.scenes.texture import GOLDEN_STEPS, mottle, scatter

DRIVE = (0.800, 0.858)


def draw_sky(drawing: Drawing) -> None:
    """Cold zenith to a warmer horizon, with a few thin clouds."""
    drawing.paint("horizon", power(0.0, BASE, 2), band(0.0, 1.0))
    for k, (x, y, wide, tall) in enumerate(
        (
            (0.12, 0.13, 0.075, 0.010),
            (0.18, 0.145, 0.060, 0.008),
            (0.07, 0.16, 0.070, 0.006),
            (0.78, 0.095, 0.085, 0.012),
            (0.70, 0.110, 0.070, 0.008),
            (0.87, 0.118, 0.075, 0.007),
            (0.93, 0.26, 0.070, 0.006),
            (0.84, 0.27, 0.050, 0.004),
        )
    ):
        drawing.paint("cloud", bell(y, tall, 0.75 - 0.06 * k), bell(x, wide))


def draw_hills(drawing: Drawing) -> None:
    """A line of distant trees behind the building."""
    size = scatter(46, seed=401)
    tone = scatter(46, seed=402)
    drawing.paint_ellipses(
        [between("hills", "lawn", 0.4 * share) for share in tone.tolist()],
        np.arange(46) / 44.0 - 0.01,
        np.full(46, 0.715),
        np.full(46, 0.024),
        0.022 + 0.030 * size,
    )
    drawing.paint_box("hills", 0.0, 0.715, 1.0, BASE)


def draw_ground(drawing: Drawing) -> None:
    """Lawn with mottling, walk along the building, drive with markings, and the path."""
    drawing.paint_box("lawn", 0.0, BASE, 1.0, 1.0)
    nearer = difference("lawn_near", "lawn")
    drawing.add(nearer, (power(BASE, 1.0, 1), band(0.0, 1.0)))
    for coarse, fine, amplitude, seed in ((3.0, 24.0, 0.45, 501), (40.0, 260.0, 0.45, 511)):
        mottle(
            drawing,
            box=(0.0, BASE, 1.0, 1.0),
            amplitude={name: amplitude * part for name, part in nearer.items()},
            limit=0.4,
            surfaces=("lawn", "lawn_near"),
            coarse=coarse,
            fine=fine,
            stretch=2.0,
            count=28,
            seed=seed,
        )
    drawing.paint_trapezoid(
        "paving", top=BASE, low=1.0, top_span=(0.368, 0.452), low_span=(0.300, 0.520)
    )
    # Joints of the path lie closer together with distance.
    depth = BASE + 0.26 * (np.arange(1, 13) / 12.5) ** 1.7
    for y in depth.tolist():
        reach = (y - BASE) / (1.0 - BASE)
        drawing.paint_box(
            "joint", 0.368 - 0.068 * reach, y, 0.452 + 0.068 * reach, y + 0.001 + 0.0016 * reach
        )
    drawing.paint_box("paving", 0.0, BASE, 1.0, BASE + 0.008)
    top, low = DRIVE
    drawing.paint_box("asphalt", 0.0, top, 1.0, low)
    mottle(
        drawing,
        box=(0.0, top, 1.0, low),
        amplitude={"asphalt": 0.08, "lawn": -0.08},
        limit=0.4,
        surfaces=("asphalt",),
        coarse=4.0,
        fine=40.0,
        stretch=2.0,
        count=8,
        seed=521,
    )
    drawing.paint_box("kerb", 0.0, top - 0.003, 1.0, top)
    drawing.paint_box("kerb", 0.0, low, 1.0, low + 0.004)
    dashes = np.arange(0.01, 1.0, 0.05)
    drawing.paint("marking", band(0.8455, 0.8475), steps(dashes, dashes + 0.026))


def draw_tree(
    drawing: Drawing,
    *,
    x: float,
    y: float,
    radius: tuple[float, float],
    foot: float,
    seed: int,
) -> None:
    """A tree: its shadow, trunk, and a crown of many leafy tufts, cooler towards the sky."""
    wide, tall = radius
    drawing.paint_ellipse("shade", x + 0.4 * wide, foot, 1.05 * wide, 0.10 * wide)
    drawing.paint_trapezoid(
        "bark",
        top=y,
        low=foot,
        top_span=(x - 0.04 * wide, x + 0.04 * wide),
        low_span=(x - 0.10 * wide, x + 0.10 * wide),
    )
    middle = between("leaf_cool", "leaf_warm", 0.4)
    drawing.paint_ellipse(middle, x, y, 0.86 * wide, 0.86 * tall)
    count = 90 if wide < 0.05 else 380
    # Even over the disc, by a sequence that never clusters.
    number = np.arange(1, count + 1)
    away = np.sqrt((0.5 + number * GOLDEN_STEPS[0]) % 1.0)
    turn = 2.0 * np.pi * ((0.5 + number * GOLDEN_STEPS[1]) % 1.0)
    across, down = away * np.cos(turn), away * np.sin(turn)
    tone = scatter(count, seed=seed)
    warm = np.clip(0.45 + 0.25 * down - 0.15 * across + 0.8 * (tone - 0.5), 0.0, 1.0)
    tuft = (1.6 / np.sqrt(count)) * (0.45 + 0.75 * scatter(count, seed=seed + 1))
    drawing.paint_ellipses(
        [between("leaf_cool", "leaf_warm", share) for share in warm.tolist()],
        x + wide * 0.93 * across,
        y + tall * 0.93 * down,
        wide * tuft,
        tall * tuft * 0.7,
    )


def draw_car(drawing: Drawing, *, left: float, foot: float, body: str, running: bool) -> None:
    """A parked car from the side, nose to the right."""
    length, height = 0.096, 0.036

    def at(u: float) -> float:
        return left + u * length

    def up(v: float) -> float:
        return foot - v * height

    drawing.paint_ellipse("shade", at(0.5), foot, 0.52 * length, 0.10 * height)
    drawing.paint_trapezoid(
        body,
        top=up(1.0),
        low=up(0.58),
        top_span=(at(0.27), at(0.62)),
        low_span=(at(0.13), at(0.76)),
    )
    drawing.paint_trapezoid(
        "car_glass",
        top=up(0.94),
        low=up(0.60),
        top_span=(at(0.285), at(0.605)),
        low_span=(at(0.18), at(0.715)),
    )
    drawing.paint_box(body, at(0.43), up(0.97), at(0.455), up(0.58))
    drawing.paint_trapezoid(
        body,
        top=up(0.62),
        low=up(0.42),
        top_span=(at(0.04), at(0.93)),
        low_span=(at(0.0), at(1.0)),
    )
    drawing.paint_box(body, at(0.0), up(0.42), at(1.0), up(0.14))
    if running:
        drawing.paint_trapezoid(
            "engine",
            top=up(0.62),
            low=up(0.50),
            top_span=(at(0.76), at(0.93)),
            low_span=(at(0.75), at(0.965)),
        )
        drawing.paint_box("engine", at(0.97), up(0.36), at(1.0), up(0.20))
        drawing.paint_box("exhaust", at(-0.012), up(0.20), at(0.02), up(0.13))
    drawing.paint_box("joint", at(0.01), up(0.33), at(0.99), up(0.31))
    for u in (0.20, 0.79):
        radius = 0.095 * length
        drawing.paint_ellipse("tyre", at(u), up(0.16), radius, radius)
        drawing.paint_ellipse("metal", at(u), up(0.16), 0.52 * radius, 0.52 * radius)


def draw_lamp(drawing: Drawing, *, x: float, foot: float) -> None:
    """A lamp post with one bright head."""
    drawing.paint_box("metal", x - 0.0011, foot - 0.125, x + 0.0011, foot)
    drawing.paint_box("metal", x, foot - 0.1255, x + 0.016, foot - 0.1235)
    drawing.paint_ellipse("lamp", x + 0.017, foot - 0.1225, 0.005, 0.0032)


# The default scene: the front of a student residence seen from across its lawn.
#
# A dormitory was the target of Tantalo 1996, figure F.2. This one is drawn from continuous
# coordinates, 0 to 1 in x and y, and so is the same building at every size of the picture.

CARS = (
    (0.055, "car_cool", False),
    (0.185, "car_warm", False),
    (0.560, "car_warm", True),
    (0.690, "car_cool", False),
    (0.850, "car_warm", False),
)


def dormitory() -> Drawing:
    """Compose the scene, back to front, of the surfaces in `materials`."""
    drawing = Drawing("zenith")
    draw_sky(drawing)
    draw_hills(drawing)
    draw_building(drawing)
    draw_ground(drawing)
    for x, y, radius, foot, seed in (
        (0.520, 0.690, (0.026, 0.036), 0.765, 601),
        (0.640, 0.684, (0.028, 0.040), 0.770, 611),
        (0.265, 0.688, (0.026, 0.038), 0.768, 621),
        (0.955, 0.600, (0.075, 0.105), 0.785, 631),
    ):
        draw_tree(drawing, x=x, y=y, radius=radius, foot=foot, seed=seed)
    for left, body, running in CARS:
        draw_car(drawing, left=left, foot=0.832, body=body, running=running)
    for x in (0.292, 0.792):
        draw_lamp(drawing, x=x, foot=0.872)
    draw_tree(drawing, x=0.030, y=0.610, radius=(0.088, 0.140), foot=0.905, seed=641)
    return drawing
