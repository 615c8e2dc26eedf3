"""Focal Plane: noises and clipping."""

import math

import pytest

from focal_plane_bench import CAMERA_SHEET, cautions, focal_plane_bench
from node_bench import NodeBench
from nodes.analysis.lineage import NoiseOf

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
    return NodeBench(folder, nodes)


@pytest.mark.parametrize("units", ["dn", "electrons", "radiance"])
def test_figures_of_merit_and_noise_budget_are_those_of_the_focal_plane(tmp_path, units):
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
    if units == "dn":
        shares, gain = bench.readouts("budget"), own["gain_e_per_dn"]
        assert shares["sigma_temporal"] == pytest.approx(own["temporal_noise_e"] / gain, rel=1e-6)
        assert shares["sigma_fixed"] == pytest.approx(own["fixed_pattern_e"] / gain, rel=1e-3)
        names = {bar.split(" (")[0] for bar in bench.value("budget.noise").bars}
        assert names == {"Shot", "PRNU", "DSNU", "Read", "Quantization"}


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


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ({"integration_time_s": 0.1}, "% of the full well and is clipped"),
        ({"integration_time_s": 0.1, "bits": 0, "units": "radiance"}, "% of the full well"),
        ({"gain_e_per_dn": 10.0}, "above the converter's maximum of 16383 DN, and is clipped"),
        ({"offset_dn": -2000.0}, "below the converter's minimum of 0 DN, and is clipped"),
        (
            {"integration_time_s": 0.2, "nonlinearity_percent": 25.0},
            "reaches 100 % of the full well",
        ),
    ],
    ids=["well", "well without bits", "converter", "below the converter", "bent flat"],
)
def test_a_mean_that_is_clipped_has_no_netd_and_no_snr(tmp_path, params, said):
    """The clipped picture does not change with the scene: any noise over that is no figure."""
    sheet = {**CAMERA_SHEET, **params}
    behind = ("figures_of_merit", "image_quality")
    init = {"range_m": 1000}
    bench = focal_plane_bench(tmp_path, sheet, size=(16, 16), init=init, behind=behind)
    found = bench.readouts("it")
    for name in ("netd_K", "snr", "responsivity_e_per_K", "nei_photons_per_cm2"):
        assert found[name] is None, name
        assert said in bench.engine.why_none(bench.plan, "it", bench.work, name)
    assert found["signal_e"] > 0
    for node, names in (
        ("figures_of_merit", ("snr", "netd_K", "ner", "mrtd_x_K", "ttp_range_km")),
        ("image_quality", ("giqe5", "giqe4", "giqe3", "snr")),
    ):
        figures = bench.readouts(node)
        for name in names:
            assert figures[name] is None, name
            why = bench.engine.why_none(bench.plan, node, bench.work, name)
            assert said in why
            assert "\n" not in why
    assert bench.readouts("image_quality")["rer"] > 0  # is none of the noise
    for curve in ("mrtd", "mdtd", "probability"):
        assert bench.value(f"figures_of_merit.{curve}").series == ()


def test_dark_electrons_that_fill_the_well_leave_no_dynamic_range(tmp_path):
    dark = {**CAMERA_SHEET, "dark_current_e_per_s": 7e6 / 0.004}
    bench = focal_plane_bench(tmp_path, dark, size=(8, 8))
    assert bench.readouts("it")["dynamic_range_dB"] is None
    why = bench.engine.why_none(bench.plan, "it", bench.work, "dynamic_range_dB")
    assert why == "7e+06 dark electrons reach saturation at 7e+06 e-"


def test_the_noise_of_what_is_not_clipped_stays_in_the_budget(tmp_path):
    """Beside a mean that is clipped there may be samples that are not."""
    over = {**CAMERA_SHEET, "integration_time_s": 0.1}
    bench = focal_plane_bench(tmp_path, over, size=(8, 8))
    noises = bench.work.value(NoiseOf(bench.port("it.image"))).terms
    shot = next(noise for noise in noises if noise.name == "shot")
    found = bench.readouts("it")
    expected = (found["shot_noise_e"] / found["gain_e_per_dn"]) ** 2
    assert shot.variances.total == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("params", "saturation"),
    [
        ({}, 7e6),
        ({"gain_e_per_dn": 100.0}, 16383 * 100.0),
        ({"gain_e_per_dn": 100.0, "offset_dn": 383.0}, 16000 * 100.0),
        ({"gain_e_per_dn": 1000.0}, 7e6),
        ({"gain_e_per_dn": 100.0, "full_well_e": None}, 16383 * 100.0),
    ],
    ids=["well is the last number", "converter", "with offset", "well", "no well"],
)
def test_the_dynamic_range_ends_where_the_picture_is_clipped(tmp_path, params, saturation):
    """EMVA 1288: the saturation of the camera, whichever of well and converter comes first."""
    found = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 8)).readouts("it")
    dark = math.sqrt(400**2 + params.get("gain_e_per_dn", 7e6 / 16383) ** 2 / 12)
    assert found["dynamic_range_dB"] == pytest.approx(20 * math.log10(saturation / dark), rel=1e-9)


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ({"integration_time_s": 0.1}, ("% of the full well", "tdi_stages", "full_well_e")),
        ({"gain_e_per_dn": 10.0}, ("16383", "gain_e_per_dn", "offset_dn")),
        ({"offset_dn": -2000.0}, ("mean gives -", "minimum of 0", "Raise offset_dn")),
        ({}, ()),
    ],
    ids=["well", "converter", "below the converter", "neither"],
)
def test_a_mean_that_is_clipped_is_warned_of(tmp_path, params, said):
    """25 times the exposure of the reference fills its well to 1.6; 4.5e5 electrons are 45,000."""
    bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 8))
    found = cautions(bench, "overflow")
    assert len(found) == bool(said)
    for words in said:
        assert words in found[0].text


@pytest.mark.parametrize(("warmer", "clipped"), [(20.0, False), (30.0, True)])
def test_a_brightest_that_is_clipped_is_warned_of(tmp_path, warmer, clipped):
    """Half of the picture at 300 K, half warmer; the well holds 2.5 times what 300 K give.

    By Planck's law 320 K give 2.0 times as many photons from 3.7 to 4.8 µm, and 330 K 2.7 times.
    """
    scene = {"kind": "two_panel", "temperature_K": 300.0, "delta_K": warmer}
    cold = focal_plane_bench(tmp_path, CAMERA_SHEET, size=(8, 8)).readouts("it")["signal_e"]
    sheet = {**CAMERA_SHEET, "full_well_e": 2.5 * cold, "read_noise_e": 0}
    bench = focal_plane_bench(tmp_path, sheet, size=(8, 8), scene=scene)
    assert bench.readouts("it")["well_fill_percent"] < 100
    assert (bench.readouts("it")["saturated_pixels"] > 0) == clipped
    found = cautions(bench, "overflow")
    assert len(found) == clipped
    if clipped:
        assert "the brightest pixels saturate" in found[0].text
