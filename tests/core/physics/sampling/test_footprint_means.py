"""Means over footprints against clipped polygons, closed forms and block means."""

import math

import numpy as np
import pytest

from core.physics.sampling.footprint_means import (
    footprint_coverage,
    footprint_means,
    footprints,
    strips_error,
)
from core.physics.sampling.ground_geometry import (
    Camera,
    across,
    along,
    ground_matrix,
    ground_points,
    line_widths,
)


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


def laid(cam, shape, dx=1.0, dy=1.0, strips=4):
    rows, columns = shape
    u, v = np.arange(cam.columns + 1.0), np.arange(cam.rows + 1.0)
    pixels = np.array([[1 / dx, 0, columns / 2], [0, 1 / dy, rows / 2], [0, 0, 1]])
    return footprints(
        matrix=pixels @ ground_matrix(camera=cam),
        across=across(camera=cam, u=u),
        along=along(camera=cam, v=v),
        middles=along(camera=cam, v=v[:-1] + 0.5),
        widths=line_widths(camera=cam, u=u[:-1] + 0.5),
        scene=shape,
        strips=strips,
    )


def means(scene, cam, kind="area", dx=1.0, dy=1.0, strips=4, **more):
    return footprint_means(
        scene=scene,
        laid=laid(cam, scene.shape, dx, dy, strips),
        between_samples=kind,
        dtype=np.float64,
        **more,
    )


def corners(cam, row, column, shape, dx=1.0, dy=1.0):
    """Of a sample's footprint, in the scene's samples; `line_widths` is tested by itself."""
    reach = 0.5 * float(line_widths(camera=cam, u=column + 0.5))
    u = [column, column + 1, column + 1, column]
    v = [row + 0.5 - reach] * 2 + [row + 0.5 + reach] * 2
    x, y = ground_points(camera=cam, u=u, v=v)
    return list(zip(x / dx + shape[1] / 2, y / dy + shape[0] / 2, strict=True))


def scene_of(rows, columns):
    return np.random.default_rng(7).random((rows, columns)) + 5.0


SHAPE = (40, 37)
GROUND = {"dx": 1.3, "dy": 0.9}
SIZE = {
    "altitude_m": 30.0, "columns": 7, "rows": 5, "step_x_mrad": 80.0, "step_y_mrad": 60.0,
    "line_spacing_m": 1.8,
}  # fmt: skip
SQUARE = [
    Camera("line", **SIZE),
    Camera("line", **SIZE, yaw_deg=180.0, offset_x_m=1.0),
    Camera("line", **{**SIZE, "line_spacing_m": 2.6}, roll_deg=8.0, pitch_deg=5.0),
    Camera("line", **SIZE, yaw_deg=90.0),
    Camera("pushbroom", **SIZE),
    Camera("pushbroom", **SIZE, roll_deg=10.0),
    Camera("framing", **SIZE),
    Camera("framing", **SIZE, pitch_deg=10.0),
    Camera("framing", **SIZE, roll_deg=-12.0),
    Camera("framing", **SIZE, yaw_deg=-90.0),
    Camera("framing", **SIZE, yaw_deg=90.0, roll_deg=9.0),
]
ASKEW = [
    Camera("line", **SIZE, yaw_deg=25.0),
    Camera("pushbroom", **SIZE, yaw_deg=-110.0, roll_deg=4.0),
    Camera("framing", **SIZE, yaw_deg=45.0),
    Camera("framing", **SIZE, roll_deg=8.0, pitch_deg=7.0, yaw_deg=70.0),
]


def named(cam):
    return f"{cam.kind}-{cam.roll_deg:g}-{cam.pitch_deg:g}-{cam.yaw_deg:g}"


def clipped(scene, cam):
    found = [
        clipped_mean(scene, corners(cam, row, column, scene.shape, **GROUND))
        for row in range(cam.rows)
        for column in range(cam.columns)
    ]
    values, shares = np.array(found).T.reshape(2, cam.rows, cam.columns)
    return values, shares


@pytest.mark.parametrize("cam", SQUARE, ids=named)
def test_square_footprints_are_clipped_polygons(cam):
    """To rounding where borders are parallel.

    A keystone's sides lean, which each row is told at its top and bottom: measured 10⁻⁴.
    """
    scene = scene_of(*SHAPE)
    assert laid(cam, SHAPE, **GROUND).level
    expected, shares = clipped(scene, cam)
    assert shares == pytest.approx(np.ones(shares.shape), abs=1e-9)
    keystone = cam.kind == "framing" and (cam.roll_deg or cam.pitch_deg)
    found = means(scene, cam, **GROUND)
    assert np.abs(found - expected).max() < (5e-4 if keystone else 1e-11)


@pytest.mark.parametrize("cam", ASKEW, ids=named)
def test_askew_footprints_come_near_clipped_polygons_with_more_strips(cam):
    scene = scene_of(*SHAPE)
    expected, shares = clipped(scene, cam)
    assert shares == pytest.approx(np.ones(shares.shape), abs=1e-9)
    coarse, fine = (
        np.abs(means(scene, cam, strips=strips, **GROUND) - expected).max() for strips in (1, 8)
    )
    assert fine < 0.02
    assert fine < 0.5 * coarse


SINE = 2 * math.pi / 24.0
TENT = np.sinc(1 / 24) ** 3


@pytest.mark.parametrize(
    ("kind", "swing", "close"),
    [
        # The integral up to a border is off by max |f'|/8 at most, at both borders of 2.2.
        ("area", 1.0, 2 * SINE / 8 / 2.2),
        # Means of samples, joined straight: sinc · sinc². Images at n ± 1/24 cycles, of (1/23)²
        # at most, of which the mean over 2.2 samples passes 1/(2.2·π·23/24).
        ("bilinear", TENT, 1.2 * 2 / 23**2 / (2.2 * math.pi * 23 / 24)),
        # Catmull and Rom's curve misses x³ by t(1−t)(1−2t) < 0.0963, and f'' is k².
        ("cubic", 1.0, 1.1 * 2 * SINE**2 / 6 * 0.0963 / 2.2),
    ],
)
def test_a_sine_on_the_ground_is_averaged_over_each_footprint(kind, swing, close):
    """cos(k·x) over [tan a, tan b]: (sin(k·tan b) − sin(k·tan a))/(k·(tan b − tan a)).

    The scene's samples are means too.
    """
    count, height = 600, 100.0
    edges = np.arange(count + 1) - count / 2
    k = SINE
    scene = np.tile(np.diff(np.sin(k * edges)) / k, (40, 1))
    cam = Camera("line", height, 90, 8, 22.0, 22.0, line_spacing_m=2.2)
    found = means(scene, cam, kind)
    ends = height * np.tan((np.arange(91) - 45) * 0.022)
    expected = swing * np.diff(np.sin(k * ends)) / (k * np.diff(ends))
    assert np.abs(found - expected).max() < close
    assert np.ptp(found, axis=0).max() < 1e-12  # every line the same
    assert np.abs(expected[[0, -1]]).max() < 0.9 < expected.max()  # it is blurred at the ends


@pytest.mark.parametrize("kind", ["area", "cubic"])
def test_footprints_that_cover_a_scene_hold_all_of_its_energy(kind):
    """Samples of a line scanner, weighted with their areas, sum to the whole scene."""
    scene = scene_of(24, 60)
    # ±30° over ±30 m; the pushbroom's lines join, so that nothing is seen twice.
    step = 2000 * math.tan(math.pi / 6) / 17
    height = 30 / math.tan(math.pi / 6)
    cam = Camera("pushbroom", height, 17, 9, step, step, line_spacing_m=height * step / 1000)
    cam = Camera(**{**vars(cam), "line_spacing_m": 24 / 9, "step_y_mrad": 24 / 9 / height * 1000})
    seen = means(scene, cam, kind)
    assert seen.mean() == pytest.approx(scene.mean(), rel=1e-13)
    line = Camera("line", height, 17, 9, 1000 * math.pi / 3 / 17, 0.0, 24 / 9)
    line = Camera(**{**vars(line), "step_y_mrad": 24 / 9 / height * 1000})
    rows = np.tile(scene.mean(axis=0), (200, 1))  # alike along, as its lines overlap
    widths = np.diff(np.tan((np.arange(18) / 17 - 0.5) * math.pi / 3)) * height
    assert float(means(rows, line, kind)[4] @ widths) == pytest.approx(scene.mean() * 60, rel=1e-12)


@pytest.mark.parametrize("cam", SQUARE + ASKEW, ids=named)
def test_outside_the_fill_is_seen_by_its_share(cam):
    scene = scene_of(9, 10)
    own = laid(cam, scene.shape, strips=8, **GROUND)
    share = footprint_coverage(laid=own, dtype=np.float64)
    expected, inside = clipped(scene, cam)
    assert 0.0 <= share.min() < 1.0
    assert np.abs(share - inside).max() < (1e-12 if own.level and cam.kind != "framing" else 0.02)
    if own.level:
        assert (share[inside > 1 - 1e-9] == 1.0).all()
    found = footprint_means(
        scene=scene, laid=own, between_samples="area", dtype=np.float64, coverage=share, fill=-3.0
    )
    wanted = expected + (1 - inside) * -3.0
    close = 1e-11 if own.level and cam.kind != "framing" else 0.02 * 9  # 9: from fill to scene
    assert np.abs(found - wanted).max() < close


def test_the_error_told_is_about_that_of_the_strips():
    scene = scene_of(*SHAPE)
    cam = ASKEW[2]
    expected, _ = clipped(scene, cam)
    actual = np.abs(means(scene, cam, **GROUND) - expected).max() / np.ptp(scene)
    told = strips_error(
        scene=scene,
        laid=laid(cam, SHAPE, **GROUND),
        finer=laid(cam, SHAPE, **GROUND, strips=16),
        between_samples="area",
    )
    assert 0.4 * actual < told < 2.5 * actual
    square = laid(SQUARE[0], SHAPE, **GROUND)
    assert strips_error(scene=scene, laid=square, finer=square, between_samples="area") == 0.0
