"""A warm window by Atmospheric Path, and the same window as the optics of Focal Plane."""

import numpy as np
import pytest
from scipy.integrate import quad

from node_bench import NodeBench
from nodes.library import standard_library

TAU, WINDOW_K, SCENE_K = 0.8, 330.0, 290.0
BAND = (3.7, 4.8)
C1, C2 = 1.1910429723971884e8, 1.4387768775039337e4  # W µm⁴/m²/sr and µm K


def planck(kelvin):
    """Radiance of the band, W/m²/sr."""
    return quad(lambda x: C1 / x**5 / np.expm1(C2 / x / kelvin), *BAND, epsrel=1e-12)[0]


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    scene = {"kind": "uniform", "width": 16, "height": 12, "fov_x_deg": 1, "fov_y_deg": 1,
             "temperature_K": SCENE_K, "cut_on_um": BAND[0], "cut_off_um": BAND[1]}  # fmt: skip
    fpa = {"integration_time_s": 1e-3, "full_well_e": 1e9, "units": "electrons"}
    nodes = {
        "scene": ("test_scene", scene),
        "window": ("atmospheric_path", {"transmission": TAU, "air_K": WINDOW_K}),
        "init": ("init_trans", {"detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 50,
                                "f_number": 2}),
        "in_front": ("focal_plane", fpa),
        "inside": ("focal_plane", {**fpa, "optics_transmission": TAU, "optics_K": WINDOW_K}),
    }  # fmt: skip
    links = [("scene.image", "window.image"), ("scene.image", "init.image"),
             ("window.image", "in_front.image"), ("scene.image", "inside.image"),
             ("init.context", "in_front.context"), ("init.context", "inside.context")]  # fmt: skip
    return NodeBench(standard_library(), tmp_path_factory.mktemp("window"), nodes, links)


def test_radiance_behind_it_has_its_own_emission(bench):
    before = bench.value("scene.image")
    found = bench.value("window.image")
    np.testing.assert_allclose(found, TAU * before + (1 - TAU) * planck(WINDOW_K), rtol=1e-9)


def test_in_front_and_inside_give_the_same_electrons(bench):
    """But for the scene's spectrum, which the sum in one band takes for that of one black body."""
    both = bench.readouts("in_front"), bench.readouts("inside")
    front, inside = (one["signal_e"] + (one["optics_e"] or 0.0) for one in both)
    assert front == pytest.approx(inside, rel=2e-3)
    assert both[1]["optics_e"] > 0.2 * both[1]["signal_e"]
