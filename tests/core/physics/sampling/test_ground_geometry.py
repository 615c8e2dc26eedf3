"""Where cameras look: against rays turned and followed to the ground one by one."""

import math

import mpmath as mp
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.sampling.ground_geometry import (
    Camera,
    check_horizon,
    field_deg,
    ground_bounds,
    ground_points,
    ground_sample,
    line_widths,
    orbit_view,
    step_of_field_mrad,
)

DEGREE = math.pi / 180


def camera(kind, **changes):
    given = {
        "altitude_m": 800.0, "columns": 40, "rows": 30, "step_x_mrad": 12.0, "step_y_mrad": 9.0,
        "line_spacing_m": 11.0,
    }  # fmt: skip
    return Camera(kind, **{**given, **changes})


def turned(ray, roll, pitch, yaw):
    """A ray (right, ahead, down) turned about the axes in turn, angle by angle."""
    x, y, z = ray
    length, angle = math.hypot(x, z), math.atan2(x, z) + roll * DEGREE
    x, z = length * math.sin(angle), length * math.cos(angle)
    length, angle = math.hypot(y, z), math.atan2(y, z) + pitch * DEGREE
    y, z = length * math.sin(angle), length * math.cos(angle)
    length, angle = math.hypot(x, y), math.atan2(y, x) + yaw * DEGREE
    return length * math.cos(angle), length * math.sin(angle), z


def followed(cam, u, v):
    """Where a ray meets the ground."""
    away_x, away_y = u - cam.columns / 2, v - cam.rows / 2
    flown = 0.0
    if cam.kind == "line":
        angle = away_x * cam.step_x_mrad / 1000
        ray, flown = (math.sin(angle), 0.0, math.cos(angle)), away_y * cam.line_spacing_m
    elif cam.kind == "pushbroom":
        ray, flown = (away_x * cam.step_x_mrad, 0.0, 1000.0), away_y * cam.line_spacing_m
    else:
        ray = (away_x * cam.step_x_mrad, away_y * cam.step_y_mrad, 1000.0)
    x, y, z = turned(ray, cam.roll_deg, cam.pitch_deg, cam.yaw_deg)
    heading = cam.yaw_deg * DEGREE
    return (
        cam.offset_x_m + cam.altitude_m * x / z - flown * math.sin(heading),
        cam.offset_y_m + cam.altitude_m * y / z + flown * math.cos(heading),
    )


ATTITUDES = [
    {},
    {"roll_deg": 15.0},
    {"pitch_deg": -20.0},
    {"yaw_deg": 33.0},
    {"roll_deg": -9.0, "pitch_deg": 12.0, "yaw_deg": -140.0, "offset_x_m": 70.0, "offset_y_m": -8},
]


@pytest.mark.parametrize("attitude", ATTITUDES, ids=str)
@pytest.mark.parametrize("kind", ["line", "pushbroom", "framing"])
def test_rays_meet_the_ground_where_they_are_followed_to(kind, attitude):
    cam = camera(kind, **attitude)
    for u, v in ((0, 0), (40, 0), (13.5, 22.25), (0, 30), (40, 30)):
        found = ground_points(camera=cam, u=u, v=v)
        np.testing.assert_allclose(np.array(found), followed(cam, u, v), rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("attitude", ATTITUDES, ids=str)
@pytest.mark.parametrize("kind", ["line", "pushbroom", "framing"])
def test_bounds_hold_all_that_is_seen(kind, attitude):
    cam = camera(kind, **attitude, step_y_mrad=11.0 / 0.8)  # lines join at nadir
    left, right, top, bottom = ground_bounds(camera=cam)
    u, v = np.meshgrid(np.linspace(0, 40, 21), np.linspace(0, 30, 31))
    x, y = (np.asarray(each) for each in ground_points(camera=cam, u=u, v=v))
    assert left <= x.min() + 1e-9
    assert right >= x.max() - 1e-9
    assert top <= y.min() + 1e-9
    assert bottom >= y.max() - 1e-9
    assert right - left < 1.25 * (x.max() - x.min())


def test_panoramic_distortion_of_a_line_scanner():
    """90° in 900 samples at 1 km: tan 45° = 1; h·Δ·sec²θ and h·Δ·sec θ with 2 and √2 at the end."""
    step = step_of_field_mrad(kind="line", fov_deg=90, columns=900)
    assert step == pytest.approx(1000 * math.pi / 1800, rel=1e-14)
    cam = Camera("line", 1000.0, 900, 10, step, step, line_spacing_m=step)
    x, y = ground_points(camera=cam, u=[0, 450, 900], v=5)
    assert x.tolist() == pytest.approx([-1000, 0, 1000], abs=1e-9)
    assert y.tolist() == pytest.approx([0, 0, 0], abs=1e-12)
    across, _ = ground_sample(camera=cam, u=450, v=5)
    assert across == pytest.approx(1000 * 2 * math.tan(math.pi / 3600), rel=1e-12)
    for angle in (0.0, 30.0, 44.95):
        across, along = ground_sample(camera=cam, u=450 + angle * 10, v=5)
        secant = 1 / math.cos(angle * DEGREE)
        assert across == pytest.approx(step * secant**2, rel=2e-6)
        assert along == pytest.approx(step * secant, rel=1e-12)


def test_a_pushbroom_has_equal_ground_samples():
    cam = camera("pushbroom")
    for u in (0.5, 20, 39.5):
        across, along = ground_sample(camera=cam, u=u, v=3)
        assert across == pytest.approx(9.6, rel=1e-12)  # 12 mrad · 800 m
        assert along == pytest.approx(7.2, rel=1e-12)  # 9 mrad · 800 m
    assert step_of_field_mrad(kind="pushbroom", fov_deg=90, columns=200) == pytest.approx(10)


@pytest.mark.parametrize("kind", ["line", "pushbroom"])
@pytest.mark.parametrize("roll", [0.0, 25.0])
@pytest.mark.parametrize("pitch", [0.0, -17.0])
def test_samples_along_the_flight_as_thin_rays_show_them(kind, roll, pitch):
    """The extent is that between two rays on both sides of the plane of the scan."""
    cam = camera(kind, roll_deg=roll, pitch_deg=pitch)
    half = 1e-6
    for u in (0.5, 11.0, 39.5):
        away = (u - 20) * 0.012
        aside = (math.sin(away), math.cos(away)) if kind == "line" else (away, 1.0)
        ends = []
        for side in (-half, half):
            _, y, z = turned((aside[0], side, aside[1]), roll, pitch, 0.0)
            ends.append(800.0 * y / z)
        lines = (ends[1] - ends[0]) / (2 * half) * 0.009 / 11.0
        assert float(line_widths(camera=cam, u=u)) == pytest.approx(lines, rel=1e-8)


@pytest.mark.parametrize("kind", ["line", "pushbroom"])
def test_a_scan_past_the_horizon_is_refused(kind):
    half = field_deg(camera=camera(kind)) / 2
    check_horizon(camera=camera(kind, roll_deg=89.9 - half))
    with pytest.raises(ParameterError, match="meets the ground"):
        check_horizon(camera=camera(kind, roll_deg=-90.1 + half))
    with pytest.raises(ParameterError):
        check_horizon(camera=camera("line", step_x_mrad=80.0))


# A circular orbit's view of the ground, against traced rays and motion.

GM, R = mp.mpf("398600.4418"), mp.mpf("6378.137")  # km³/s², km


def traced(altitude_km, look_deg, direction):
    """Slant range, elevation, and the image's angular rate for a camera that turns with its orbit.

    The satellite is at (0, 0, r) and flies along x; the target is where the ray meets the sphere.
    The rate is that of the direction to this fixed point, seen in the axes of the satellite, by a
    numerical derivative of its position.
    """
    r = R + mp.mpf(altitude_km)
    turn = mp.sqrt(GM / r**3)
    look = mp.radians(mp.mpf(look_deg))
    tilted = mp.matrix([mp.sin(look) * (direction == "along"),
                        mp.sin(look) * (direction == "across"), -mp.cos(look)])  # fmt: skip
    place = mp.matrix([0, 0, r])
    far = mp.findroot(lambda d: mp.norm(place + d * tilted) - R, mp.mpf(altitude_km))
    target = place + far * tilted
    up = target / R
    elevation = mp.degrees(mp.asin(-sum(up[i] * tilted[i] for i in range(3))))

    def seen(t):
        """Direction to the target in the satellite's axes, after the orbit's turn about y."""
        c, s = mp.cos(turn * t), mp.sin(turn * t)
        own = mp.matrix([c * target[0] - s * target[2], target[1], s * target[0] + c * target[2]])
        way = own - place
        return way / mp.norm(way)

    rate = mp.norm(mp.matrix([mp.diff(lambda t, i=i: seen(t)[i], 0) for i in range(3)]))
    return 1000 * far, elevation, rate, 1000 * turn * R


@pytest.mark.parametrize("direction", ["across", "along"])
@pytest.mark.parametrize(("altitude", "look"), [(694, 0), (600, 30), (400, 65), (1500, 20.5)])
def test_traced_rays_and_motion(altitude, look, direction):
    found = orbit_view(altitude_km=altitude, look_angle_deg=look, direction=direction)
    range_m, elevation, rate, ground = traced(altitude, look, direction)
    assert found.range_m == pytest.approx(float(range_m), rel=1e-13)
    assert found.elevation_deg == pytest.approx(float(elevation), rel=1e-12)
    assert found.ground_speed_m_per_s == pytest.approx(float(ground), rel=1e-14)
    assert found.velocity_m_per_s / found.range_m == pytest.approx(float(rate), rel=1e-11)


@pytest.mark.parametrize("look", [64.5, 120.0])
def test_a_line_of_sight_beyond_the_horizon_or_upwards_misses_the_earth(look):
    """From 694 km the horizon is at asin(6378.137/7072.137) = 64.4°."""
    with pytest.raises(
        ParameterError, match=r"look_angle_deg = \S+ deg .* 0 to below 64\.4; .*misses"
    ):
        orbit_view(altitude_km=694.0, look_angle_deg=look)


def test_published_orbits():
    """Pléiades, 694 km: 98.6 min; SPOT, 822 km: lines of 10 m in 1.504 ms, with Earth's turn."""
    pleiades = orbit_view(altitude_km=694.0)
    period_min = 2 * mp.pi * 6378137.0 / pleiades.ground_speed_m_per_s / 60
    assert float(period_min) == pytest.approx(98.6, abs=0.1)
    spot = orbit_view(altitude_km=822.0).ground_speed_m_per_s
    assert spot == pytest.approx(10 / 1.504e-3, rel=0.01)


def test_the_ground_distance_of_samples():
    assert orbit_view(altitude_km=600.0).ground_gsd(0.5, 0.6) == (0.5, 0.6)
    sine = float(mp.sin(mp.radians(traced(600, 30, "across")[1])))
    for direction, expected in (("across", (0.5 / sine, 0.6)), ("along", (0.5, 0.6 / sine))):
        view = orbit_view(altitude_km=600.0, look_angle_deg=30.0, direction=direction)
        assert view.ground_gsd(0.5, 0.6) == pytest.approx(expected, rel=1e-12)
    assert view.ground_gsd(None, None) == (None, None)
