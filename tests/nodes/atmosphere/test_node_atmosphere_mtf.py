"""Atmosphere MTF in a chain: what of the air blurs, and which way one looks through it."""

import math

import mpmath
import numpy as np
import pytest

from node_bench import NodeBench

SCENE = {
    "kind": "uniform", "width": 16, "height": 12, "fov_x_deg": 1.0, "fov_y_deg": 0.75,
    "cut_on_um": 8.0, "cut_off_um": 12.0,
}  # fmt: skip
SCATTERING = {"turbidity": "custom", "scattering_per_km": 0.7}


def run(params, range_m=1000.0):
    """MTF and read-outs."""
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", {"range_m": range_m}),
        "air": ("atmosphere_mtf", params),
    }
    bench = NodeBench(None, nodes)
    return bench.value("air.mtf"), bench.readouts("air")


@pytest.mark.parametrize("view", ["horizontal", "vertical", "up"])
def test_absorption_does_not_blur(view):
    mtf, told = run({"turbidity": "custom", "absorption_per_km": 1.0, "view": view})
    np.testing.assert_array_equal(mtf, 1.0)
    assert told["optical_depth"] == 0.0


@pytest.mark.parametrize("view", ["vertical", "up"])
def test_depth_of_a_column(view):
    _, told = run({**SCATTERING, "scale_height_km": 1.2, "view": view}, 3000.0)
    truth = mpmath.quad(lambda h: 0.7 * mpmath.exp(-h / mpmath.mpf("1.2")), [0, 3])
    assert told["optical_depth"] == pytest.approx(float(truth), rel=1e-14)


def test_r0_looking_up_weighs_the_air_at_the_ground():
    """(0.423·k²·∫Cn²(h)·(z/L)^(5/3) dz)^(−3/5), z from the target, at the height h = L − z."""
    length, ground = 3000.0, 1e-13
    params = {"turbulence": "long_exposure", "wavelength_um": 10.0, "cn2": ground}

    def cn2(h):
        high = 0.00594 * (21 / 27) ** 2 * (h * 1e-5) ** 10 * mpmath.exp(-h / 1000)
        return high + 2.7e-16 * mpmath.exp(-h / 1500) + ground * mpmath.exp(-h / 100)

    found = {}
    for view, height in (("up", lambda z: length - z), ("vertical", lambda z: z)):
        with mpmath.workdps(20):
            weighted = mpmath.quad(
                lambda z, height=height: (
                    1e18 * cn2(height(z)) * (z / length) ** (mpmath.mpf(5) / 3)
                ),
                [0, 100, 300, 1000, 2000, 2700, 2900, 3000],
            )
            k = 2 * mpmath.pi / mpmath.mpf("1e-5")
            truth = (mpmath.mpf("0.423") * k**2 * weighted / 10**18) ** (mpmath.mpf(-3) / 5)
        found[view] = run({**params, "view": view}, length)[1]["r0_m"]
        assert found[view] == pytest.approx(float(truth), rel=1e-10)
    assert found["up"] < found["vertical"] / 2


def test_the_cutoff_of_particles_is_their_radius_over_the_wavelength():
    """At 10 µm, of 20 mm wide ones: 2 cycles/mrad; the middle of the band if none is typed."""
    custom = {"turbidity": "custom", "scatter_depth": 0.9, "turbulence": "none"}
    for typed in ({"wavelength_um": 10.0}, {}):
        by_radius, _ = run({**custom, "particle_radius_um": 20000.0, **typed})
        by_cutoff, _ = run({**custom, "turbidity_cutoff_cyc_per_mrad": 2.0})
        np.testing.assert_allclose(by_radius, by_cutoff, rtol=1e-13)
    wider, _ = run({**custom, "particle_radius_um": 20000.0, "wavelength_um": 5.0})
    fifth = 5000 / (math.radians(1.0) * 1e6)  # cycles/mrad: five over a field of a degree
    assert wider[0, 5] == pytest.approx(math.exp(-0.9 * (fifth / 4.0) ** 2), rel=1e-12)


def cautions(params, path, *, range_m=1000.0):
    nodes = {
        "scene": ("test_scene", SCENE),
        "path": ("atmospheric_path", {"range_m": range_m, "air_K": 300.0, **path}),
        "init": ("init_trans", {"range_m": range_m}),
        "air": ("atmosphere_mtf", params),
    }
    plan = NodeBench(None, nodes).plan
    assert plan.errors() == []
    return [str(one) for one in plan.warnings() if one.node == "air"]


def test_air_that_scatters_more_than_it_dims_is_a_warning():
    path = {"model": "extinction_per_km", "extinction_per_km": 0.5}
    assert cautions({**SCATTERING, "scattering_per_km": 0.3, "absorption_per_km": 0.2}, path) == []
    (warned,) = cautions({**SCATTERING, "scattering_per_km": 0.3, "absorption_per_km": 0.3}, path)
    assert "0.6 1/km, but the extinction of Atmospheric Path is 0.5 1/km" in warned


def test_a_cutoff_beside_particles_is_a_warning():
    both = {"turbidity": "high", "particle_radius_um": 5, "turbidity_cutoff_cyc_per_mrad": 0.01}
    (warned,) = cautions(both, {})
    assert "turbidity_cutoff_cyc_per_mrad = 0.01 is not used" in warned
