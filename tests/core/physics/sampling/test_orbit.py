"""A circular orbit's view of the ground, against traced rays and motion."""

import mpmath as mp
import pytest

from core.physics.sampling.ground_geometry import orbit_view

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
