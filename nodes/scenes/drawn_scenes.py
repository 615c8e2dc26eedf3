"""The drawn scenes: a student residence seen from across its lawn, and an airfield from above.

A dormitory was the target of Tantalo 1996, figure F.2. Both are drawn from continuous coordinates,
0 to 1 in x and y, and so are the same at every size of the picture.
"""

import numpy as np

from core.arrays import Floats
from core.records import dataclass
from nodes.scenes.coverage import band, bell, bells, power, steps
from nodes.scenes.scene_canvas import (
    GOLDEN_STEPS,
    Drawing,
    Mix,
    Side,
    Term,
    between,
    difference,
    mottle,
    scatter,
)

BASE = 0.74
"""Where the building meets the ground."""

STOREY = 0.07
COURSE = 0.005
BRICK = 0.0125
JOINT = 0.0011


@dataclass(frozen=True)
class Front:
    """One brick front with a regular grid of windows."""

    left: float
    top: float
    right: float
    bays: int
    storeys: int
    window: float
    brick: str
    seed: int

    def columns(self) -> Floats:
        pitch = (self.right - self.left) / self.bays
        centres = self.left + pitch * (np.arange(self.bays) + 0.5)
        return np.asarray(centres - 0.5 * self.window, dtype=np.float64)

    def rows(self) -> Floats:
        above = STOREY * np.arange(self.storeys, 0, -1)
        return np.asarray(BASE - 0.011 - above, dtype=np.float64)


WINDOW_HEIGHT = 0.040
FRONTS = (
    Front(0.215, 0.205, 0.605, 11, 7, 0.022, "brick", 11),
    Front(0.675, 0.405, 0.925, 7, 4, 0.023, "brick", 29),
)


def _brickwork(drawing: Drawing, front: Front) -> None:
    """Wall, courses in running bond, floor slabs that leak heat, coping and plinth."""
    box = (front.left, front.top, front.right, BASE)
    drawing.paint_box(front.brick, *box)
    _courses(drawing, front.brick, box)
    contrast = {"concrete": 0.10, "brick": -0.10}
    waves = {"coarse": 2.0, "fine": 14.0}
    mottle(drawing, contrast, ("brick", "mortar"), box=box, **waves, count=8, seed=front.seed)
    tops = front.rows() - 0.014
    drawing.paint("slab", steps(tops - 0.0035, tops + 0.0035), band(front.left, front.right))
    piers = np.linspace(front.left, front.right - 0.005, 3 if front.bays < 9 else 4)
    drawing.paint("concrete", band(front.top, BASE), steps(piers, piers + 0.005))
    drawing.paint_box(
        "coping", front.left - 0.003, front.top - 0.008, front.right + 0.003, front.top + 0.004
    )
    drawing.paint_box("concrete", front.left, BASE - 0.018, front.right, BASE)


def _courses(drawing: Drawing, brick: str, box: tuple[float, float, float, float]) -> None:
    left, top, right, low = box
    beds = np.arange(top, low - COURSE, COURSE)
    terms: list[Term] = [(steps(beds, beds + JOINT), band(left, right))]
    for parity in (0, 1):
        heads = np.arange(left + 0.5 * BRICK * (1 + parity), right - JOINT, BRICK)
        faces = beds[parity::2]
        terms.append((steps(faces + JOINT, faces + COURSE), steps(heads, heads + JOINT)))
    drawing.add(difference("mortar", brick), *terms)


def _windows(drawing: Drawing, front: Front) -> None:
    """Frames, panes in their own state, mullions, and warm air above and below."""
    x, y = front.columns(), front.rows()
    w, h = front.window, WINDOW_HEIGHT
    # Heaters under the sills warm the wall in a soft patch, which the window then covers.
    warm = scatter(y.size * x.size, seed=front.seed + 5).reshape(y.size, x.size)
    for j, sill in enumerate(y + WINDOW_HEIGHT + 0.006):
        patch = bells(x + 0.5 * front.window, 0.007, (0.45 * warm)[j])
        drawing.paint("grille", bell(float(sill), 0.004), patch)
    rows, columns = steps(y, y + h), steps(x, x + w)
    drawing.paint("frame", rows, columns)
    f, m = 0.0018, 0.0013
    middle = x + 0.5 * (w - m)
    panes = np.column_stack([x + f, middle + m]).ravel()
    pane_ends = np.column_stack([middle, x + w - f]).ravel()
    transom = y + 0.013
    glass = [steps([y[j] + f, transom[j] + m], [transom[j], y[j] + h - f]) for j in range(y.size)]
    drawing.add({"frame": -1.0}, *((down, steps(panes, pane_ends)) for down in glass))
    for state, shares in _pane_states(front).items():
        across = [steps(panes, pane_ends, share) for share in shares]
        drawing.add({state: 1.0}, *zip(glass, across, strict=True))
    # Half-drawn blinds hide the warm room in part of the windows.
    blind = scatter(y.size * x.size, seed=front.seed + 9).reshape(y.size, x.size) < 0.22
    for j, i in np.argwhere(blind):
        slats = y[j] + f + 0.0022 * np.arange(9)
        drawing.paint(
            between("glass_mid", "brick", 0.4),
            steps(slats, slats + 0.0012),
            band(x[i] + f, x[i] + w - f),
        )
    drawing.paint("coping", steps(y + h, y + h + 0.0025), steps(x - 0.0015, x + w + 0.0015))


def _pane_states(front: Front) -> dict[str, Floats]:
    """Share of each state of the glass in each half window, (storeys, 2·bays)."""
    shape = (front.storeys, front.bays)
    count = front.storeys * front.bays
    draw = scatter(count, seed=front.seed).reshape(shape)
    shade = scatter(count, seed=front.seed + 3).reshape(shape)
    cool = draw < 0.60
    room = {
        "glass_cool": np.where(cool, 1.0 - shade, 0.0),
        "glass_mid": np.where(cool, shade, 0.5 * shade),
        "glass_lit": np.where(cool, 0.0, 1.0 - 0.5 * shade),
        "glass_open": np.zeros(shape),
    }
    both = {state: np.repeat(share, 2, axis=1) for state, share in room.items()}
    opened = np.argwhere(draw > 0.90)
    for state, share in both.items():
        share[opened[:, 0], 2 * opened[:, 1]] = 1.0 if state == "glass_open" else 0.0
    return both


def _roof_line(drawing: Drawing) -> None:
    for step in range(9):
        rise = 0.012 * step
        drawing.paint(
            "plume",
            bell(0.098 - rise, 0.008 + 0.0018 * step, 0.75 * 0.8**step),
            bell(0.283 + 0.010 * step + 0.0012 * step**2, 0.006 + 0.0030 * step),
        )
    drawing.paint_box("brick_shade", 0.39, 0.148, 0.50, 0.21)
    _courses(drawing, "brick_shade", (0.39, 0.148, 0.50, 0.20))
    drawing.paint_box("coping", 0.387, 0.143, 0.503, 0.150)
    slats = 0.160 + 0.004 * np.arange(8)
    drawing.paint("grille", steps(slats, slats + 0.002), steps([0.405, 0.462], [0.428, 0.485]))
    drawing.paint_box("brick", 0.270, 0.108, 0.296, 0.21)
    _courses(drawing, "brick", (0.270, 0.112, 0.296, 0.20))
    drawing.paint_box("exhaust", 0.267, 0.102, 0.299, 0.112)
    pipes = np.array([0.233, 0.320, 0.341, 0.520, 0.573])
    heights = (0.180, 0.172, 0.184, 0.176, 0.181)
    for k, (x, top) in enumerate(zip(pipes.tolist(), heights, strict=True)):
        name = "vent" if k % 2 else "metal"
        drawing.paint_box(name, x, top, x + 0.008, 0.20)
        drawing.paint_box(name, x - 0.003, top - 0.004, x + 0.011, top)
    drawing.paint_box("metal", 0.5450, 0.070, 0.5464, 0.20)
    bars = 0.078 + 0.012 * np.arange(5)
    drawing.paint("metal", steps(bars, bars + 0.0012), band(0.535, 0.5564))
    for x, top in ((0.72, 0.378), (0.80, 0.384), (0.86, 0.372)):
        drawing.paint_box("vent", x, top, x + 0.014, 0.400)


def _stair_tower(drawing: Drawing) -> None:
    """Plain brick with one tall strip of glass, in shade, between the two fronts."""
    box = (0.605, 0.168, 0.675, BASE)
    drawing.paint_box("brick_shade", *box)
    _courses(drawing, "brick_shade", box)
    drawing.paint_box("coping", 0.602, 0.160, 0.678, 0.170)
    drawing.paint_box("glass_mid", 0.630, 0.200, 0.652, 0.700)
    landings = 0.235 + STOREY * np.arange(7)
    warm = difference("glass_lit", "glass_mid")
    weights = np.linspace(1.0, 0.2, 7)
    drawing.add(warm, (steps(landings - 0.026, landings + 0.018, weights), band(0.630, 0.652)))
    bars = 0.200 + 0.0125 * np.arange(41)
    drawing.paint("frame", steps(bars - 0.0007, bars + 0.0007), band(0.630, 0.652))
    drawing.paint(
        "frame", band(0.200, 0.700), steps([0.629, 0.6403, 0.6512], [0.6308, 0.6417, 0.653])
    )
    drawing.paint_box("concrete", 0.605, BASE - 0.018, 0.675, BASE)


def _lounge(drawing: Drawing) -> None:
    posts = 0.062 + 0.0042 * np.arange(37)
    drawing.paint("metal", band(0.588, 0.612), steps(posts, posts + 0.0013))
    drawing.paint_box("metal", 0.060, 0.5855, 0.215, 0.5885)
    drawing.paint_box("concrete", 0.055, 0.612, 0.215, BASE)
    drawing.paint_box("coping", 0.050, 0.607, 0.215, 0.618)
    drawing.paint_box("glass_lit", 0.066, 0.640, 0.206, 0.728)
    cooler = difference("glass_mid", "glass_lit")
    edges = np.linspace(0.066, 0.206, 8)
    shares = 0.6 * scatter(7, seed=71)
    drawing.add(cooler, (band(0.640, 0.728), steps(edges[:-1], edges[1:], shares)))
    drawing.paint("frame", band(0.640, 0.728), steps(edges - 0.001, edges + 0.001))
    drawing.paint("frame", steps([0.6395, 0.664], [0.6415, 0.666]), band(0.066, 0.206))


def _balconies(drawing: Drawing, front: Front) -> None:
    """Galleries of the right wing: slabs and railings of fine bars."""
    rows = front.rows()
    left, right = front.left + 0.012, front.right - 0.012
    feet = rows + WINDOW_HEIGHT + 0.011
    bars = np.arange(left, right, 0.0040)
    drawing.paint("metal", steps(feet - 0.024, feet), steps(bars, bars + 0.0012))
    drawing.paint("metal", steps(feet - 0.026, feet - 0.0235), band(left, right))
    drawing.paint("slab", steps(feet, feet + 0.005), band(left - 0.004, right + 0.004))


def _entrance(drawing: Drawing) -> None:
    drawing.paint_box("brick_shade", 0.345, 0.645, 0.475, BASE)
    drawing.paint_box("door", 0.368, 0.672, 0.452, BASE)
    panels = np.linspace(0.368, 0.452, 7)
    drawing.paint("frame", band(0.672, BASE), steps(panels - 0.001, panels + 0.001))
    drawing.paint("frame", steps([0.671, 0.688], [0.673, 0.690]), band(0.368, 0.452))
    drawing.paint_box("concrete", 0.335, 0.648, 0.485, 0.662)
    drawing.paint_box("coping", 0.335, 0.645, 0.485, 0.649)
    for x in (0.345, 0.467):
        drawing.paint_box("concrete", x, 0.662, x + 0.008, BASE)
    drawing.paint_ellipse("lamp", 0.410, 0.666, 0.006, 0.0035)


# What surrounds the building.

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
    contrast = {name: 0.45 * part for name, part in nearer.items()}
    box, surfaces = (0.0, BASE, 1.0, 1.0), ("lawn", "lawn_near")
    for coarse, fine, seed in ((3.0, 24.0, 501), (40.0, 260.0, 511)):
        waves = {"coarse": coarse, "fine": fine, "stretch": 2.0}
        mottle(drawing, contrast, surfaces, box=box, **waves, count=28, seed=seed)
    drawing.paint_trapezoid("paving", (BASE, 0.368, 0.452), (1.0, 0.300, 0.520))
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
    contrast, box = {"asphalt": 0.08, "lawn": -0.08}, (0.0, top, 1.0, low)
    waves = {"coarse": 4.0, "fine": 40.0, "stretch": 2.0}
    mottle(drawing, contrast, ("asphalt",), box=box, **waves, count=8, seed=521)
    drawing.paint_box("kerb", 0.0, top - 0.003, 1.0, top)
    drawing.paint_box("kerb", 0.0, low, 1.0, low + 0.004)
    dashes = np.arange(0.01, 1.0, 0.05)
    drawing.paint("marking", band(0.8455, 0.8475), steps(dashes, dashes + 0.026))


def draw_tree(
    drawing: Drawing, *, x: float, y: float, radius: tuple[float, float], foot: float, seed: int
) -> None:
    """A tree: its shadow, trunk, and a crown of many leafy tufts, cooler towards the sky."""
    wide, tall = radius
    drawing.paint_ellipse("shade", x + 0.4 * wide, foot, 1.05 * wide, 0.10 * wide)
    upper, lower = (y, x - 0.04 * wide, x + 0.04 * wide), (foot, x - 0.10 * wide, x + 0.10 * wide)
    drawing.paint_trapezoid("bark", upper, lower)
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

    def side(v: float, start: float, end: float) -> Side:
        return up(v), at(start), at(end)

    drawing.paint_ellipse("shade", at(0.5), foot, 0.52 * length, 0.10 * height)
    drawing.paint_trapezoid(body, side(1.0, 0.27, 0.62), side(0.58, 0.13, 0.76))
    drawing.paint_trapezoid("car_glass", side(0.94, 0.285, 0.605), side(0.60, 0.18, 0.715))
    drawing.paint_box(body, at(0.43), up(0.97), at(0.455), up(0.58))
    drawing.paint_trapezoid(body, side(0.62, 0.04, 0.93), side(0.42, 0.0, 1.0))
    drawing.paint_box(body, at(0.0), up(0.42), at(1.0), up(0.14))
    if running:
        drawing.paint_trapezoid("engine", side(0.62, 0.76, 0.93), side(0.50, 0.75, 0.965))
        drawing.paint_box("engine", at(0.97), up(0.36), at(1.0), up(0.20))
        drawing.paint_box("exhaust", at(-0.012), up(0.20), at(0.02), up(0.13))
    drawing.paint_box("joint", at(0.01), up(0.33), at(0.99), up(0.31))
    for u in (0.20, 0.79):
        radius = 0.095 * length
        drawing.paint_ellipse("tyre", at(u), up(0.16), radius, radius)
        drawing.paint_ellipse("metal", at(u), up(0.16), 0.52 * radius, 0.52 * radius)


CARS = (
    (0.055, "car_cool", False),
    (0.185, "car_warm", False),
    (0.560, "car_warm", True),
    (0.690, "car_cool", False),
    (0.850, "car_warm", False),
)


def dormitory() -> Drawing:
    drawing = Drawing("zenith")
    draw_sky(drawing)
    draw_hills(drawing)
    _roof_line(drawing)
    for front in FRONTS:
        _brickwork(drawing, front)
        _windows(drawing, front)
    _stair_tower(drawing)
    _lounge(drawing)
    _balconies(drawing, FRONTS[1])
    _entrance(drawing)
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
    foot = 0.872
    for x in (0.292, 0.792):
        drawing.paint_box("metal", x - 0.0011, foot - 0.125, x + 0.0011, foot)
        drawing.paint_box("metal", x, foot - 0.1255, x + 0.016, foot - 0.1235)
        drawing.paint_ellipse("lamp", x + 0.017, foot - 0.1225, 0.005, 0.0032)
    draw_tree(drawing, x=0.030, y=0.610, radius=(0.088, 0.140), foot=0.905, seed=641)
    return drawing


# A wide scene for cameras that look down: an airfield among fields, woods and straight roads.
#
# Roads and runway are straight and lie askew, so that a camera's distortion shows. Thought of as
# 2 km square, 0.01 is 20 m.

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
