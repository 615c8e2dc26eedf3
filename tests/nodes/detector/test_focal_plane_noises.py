"""The noises of a focal plane in noise budget, 3-D noise and figures of merit."""

import math

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
        **({"before": before} if before else {}),
        "fpa": ("focal_plane", {**PARAMS, **(params or {})}),
        "budget": ("noise_budget", {}),
        "cube": ("noise_3d", {"frames": FRAMES}),
        "merit": ("figures_of_merit", {"frame_rate_Hz": None}),
    }
    return NodeBench(LIBRARY, folder, nodes)


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
