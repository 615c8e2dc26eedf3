"""The noises of a focal plane in noise budget, 3-D noise and figures of merit."""

import math

import numpy as np
import pytest

from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()
PARAMS = {
    "integration_time_s": 0.004, "optics_transmission": 0.765, "quantum_efficiency": 0.7,
    "read_noise_e": 400, "full_well_e": 7e6, "bits": 14, "optics_K": 290, "prnu_percent": 0.1,
    "dsnu_e": 300.0,
}  # fmt: skip
INIT = {
    "detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.95, "fill_y": 0.95, "platform": "array", "range_m": 1000,
}  # fmt: skip
SCENE = {
    "kind": "uniform", "width": 96, "height": 80, "fov_x_deg": 0.8250592, "fov_y_deg": 0.6875493,
    "temperature_K": 300.0, "cut_on_um": 3.7, "cut_off_um": 4.8,
}  # fmt: skip
FRAMES = 24


def bench_of(folder, params=None, *, scene=None, before=None):
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "init": ("init_trans", INIT),
        "fpa": ("focal_plane", {**PARAMS, **(params or {})}),
        "budget": ("noise_budget", {}),
        "cube": ("noise_3d", {"frames": FRAMES}),
        "merit": ("figures_of_merit", {"frame_rate_Hz": None}),
    }
    links = [
        ("scene.image", "init.image"), ("init.context", "fpa.context"),
        ("fpa.image", "budget.image"), ("fpa.image", "cube.image"),
        ("init.context", "merit.context"), ("fpa.image", "merit.image"),
    ]  # fmt: skip
    if before:
        nodes["before"] = before
        links += [("scene.image", "before.image"), ("before.image", "fpa.image")]
    else:
        links.append(("scene.image", "fpa.image"))
    return NodeBench(LIBRARY, folder, nodes, links)


@pytest.mark.parametrize("units", ["dn", "electrons", "radiance"])
def test_netd_and_snr_of_figures_of_merit_are_those_of_the_focal_plane(tmp_path, units):
    bench = bench_of(tmp_path, {"units": units, "offset_dn": 50.0})
    own, merit = bench.readouts("fpa"), bench.readouts("merit")
    # The rounding of a uniform picture is stirred by its noise: that is what both count.
    assert merit["netd_K"] == pytest.approx(own["netd_K"], rel=1e-6)
    assert merit["snr"] == pytest.approx(own["snr"], rel=1e-6)
    table = bench.value("merit.table").as_dict()
    assert table["background_K"] == pytest.approx(300.0, rel=1e-9)
    fixed = own["fixed_pattern_e"] / own["responsivity_e_per_K"]
    assert table["sigma_vh_K"] == pytest.approx(fixed, rel=1e-3)
    assert not [caution for caution in bench.plan.checks() if caution.node == "merit"]


def test_a_bent_response_lowers_the_slope_that_noise_is_divided_by(tmp_path):
    straight = bench_of(tmp_path, {"bits": 0})
    bent = bench_of(tmp_path, {"bits": 0, "nonlinearity_percent": 10.0})
    own = straight.readouts("fpa")
    total = own["signal_e"] + own["optics_e"]
    slope = 1 - 2 * 0.1 * total / 7e6
    read = math.hypot(own["shot_noise_e"], 400.0 / slope) / own["responsivity_e_per_K"]
    assert bent.readouts("merit")["netd_K"] == pytest.approx(read, rel=1e-9)


def test_shares_of_the_noise_budget(tmp_path):
    bench = bench_of(tmp_path)
    own = bench.readouts("fpa")
    found = bench.readouts("budget")
    gain = own["gain_e_per_dn"]
    assert found["sigma_temporal"] == pytest.approx(own["temporal_noise_e"] / gain, rel=1e-6)
    assert found["sigma_fixed"] == pytest.approx(own["fixed_pattern_e"] / gain, rel=1e-3)
    bars = bench.value("budget.noise").bars
    assert {"Shot", "PRNU", "DSNU", "Read", "Quantization"} == {bar.split(" (")[0] for bar in bars}


@pytest.mark.parametrize(
    ("params", "scene"),
    [({}, {}), ({"bad_pixel_percent": 0.5}, {}), ({"frames_averaged": 4}, {"kind": "dormitory"})],
)
def test_frames_have_the_noise_that_is_predicted(tmp_path, params, scene):
    bench = bench_of(tmp_path, params, scene=scene)
    table = bench.value("cube.table").as_dict()
    samples = 96 * 80
    for name, spread in (("temporal", 1 / math.sqrt(2 * samples * FRAMES)),
                         ("fixed", 1 / math.sqrt(2 * samples))):  # fmt: skip
        assert table[f"{name}_measured"] == pytest.approx(table[name], rel=6 * spread), name


def test_noise_before_the_focal_plane_arrives_in_its_numbers(tmp_path):
    before = ("poisson_noise", {"mode": "photon", "photons_per_unit": 1e4})
    bench = bench_of(tmp_path, {"read_noise_e": 0, "integration_time_s": 0.02}, before=before)
    image = bench.value("fpa.image")
    budget = bench.readouts("budget")
    total = math.hypot(budget["sigma_temporal"], budget["sigma_fixed"])
    assert np.std(image) == pytest.approx(total, rel=0.03)
    quiet = bench_of(tmp_path, {"read_noise_e": 0, "integration_time_s": 0.02})
    assert budget["sigma_temporal"] > 5 * quiet.readouts("budget")["sigma_temporal"]


def test_pixels_of_a_sum_before_keep_the_background(tmp_path):
    """The scene's temperature is that of the scene, whatever was summed on the way."""
    before = ("combine_pixels", {"factor_x": 2, "factor_y": 2, "mode": "sum"})
    bench = bench_of(tmp_path, {"full_well_e": 7e7, "bits": 0}, before=before)
    table = bench.value("merit.table").as_dict()
    assert table["background_K"] == pytest.approx(300.0, rel=1e-9)
