"""Focal Plane: its figures and pictures, against reference values, statistics and by hand."""

import math

import numpy as np
import pytest
from scipy import stats

from core.chain.frame_sequence import at_frame
from core.errors import ParameterError
from core.evaluation.recipes import Region
from core.physics.radiometry.planck import band_radiance
from focal_plane_bench import CAMERA_SHEET, MWIR, focal_plane_bench
from reference_cases import CAMERA, reference_cases

CONVERTED = {  # of the reference: what Init & Trans is given
    "pitch_um": ("detector_x_um", "detector_y_um"),
    "f_number": ("f_number",),
    "fill": ("fill_x",),
}


@pytest.mark.parametrize("case", reference_cases("focal_plane", file=CAMERA))
def test_the_readouts_of_a_focal_plane_of_the_reference(case, tmp_path):
    given = {name: float(value) for name, value in case["inputs"].items()}
    init = {}
    for name, places in CONVERTED.items():
        value = given.pop(name)
        init |= dict.fromkeys(places, value)
    scene = {"temperature_K": given.pop("scene_K")}
    scene |= {name: given[name] for name in ("cut_on_um", "cut_off_um")}
    for name in ("bits", "tdi_stages"):
        if name in given:
            given[name] = int(given[name])
    bench = focal_plane_bench(
        tmp_path, given, init={**init, "fill_y": 1.0}, scene=scene, size=(4, 3)
    )
    found = bench.readouts("it")
    for name, value in case["expected"].items():
        assert found[name] == pytest.approx(float(value), rel=1e-9, abs=0.0), name
    assert found["snr"] == pytest.approx(found["signal_e"] / found["temporal_noise_e"])


def test_electrons_are_poisson_distributed_pixel_by_pixel(tmp_path):
    dim = {"integration_time_s": 6e-8, "units": "electrons"}
    bench = focal_plane_bench(
        tmp_path, dim, size=(300, 300), scene={"kind": "two_panel", "delta_K": 40}
    )
    electrons = bench.value("it.electrons")
    expected = bench.readouts("it")["signal_e"]
    assert 5 < expected < 60
    for half in (electrons[:, :150], electrons[:, 150:]):
        assert half.var() == pytest.approx(half.mean(), rel=0.03)
        assert stats.skew(half.ravel()) == pytest.approx(1 / math.sqrt(half.mean()), rel=0.15)
    np.testing.assert_array_equal(bench.value("it.image"), electrons)


def test_the_picture_in_radiance_is_the_scene(tmp_path):
    quiet = {"integration_time_s": 1.0, "units": "radiance", "optics_K": 290,
             "optics_transmission": 0.8}  # fmt: skip
    scene = {"kind": "two_panel", "delta_K": 60}
    bench = focal_plane_bench(tmp_path, quiet, scene=scene)
    image = bench.value("it.image")
    assert bench.port("it.image").unit == "W/m²/sr"
    np.testing.assert_allclose(image, bench.value("scene.image"), rtol=2e-3)  # shot noise
    assert bench.port("it.electrons").unit == "e-"


def test_the_order_is_pattern_then_read_noise_then_well_then_numbers(tmp_path):
    """Fixed patterns multiply and add what was collected; the well cuts what was read."""
    params = {**CAMERA_SHEET, "prnu_percent": 2.0, "dsnu_e": 5000.0, "offset_dn": 100.0}
    one = focal_plane_bench(tmp_path, params, size=(200, 200))
    electrons = one.value("it.electrons")
    found = one.readouts("it")
    total = found["signal_e"]
    assert found["fixed_pattern_e"] == pytest.approx(math.hypot(0.02 * total, 5000.0))
    spread = math.hypot(found["fixed_pattern_e"], found["shot_noise_e"], 400.0)
    assert electrons.std() == pytest.approx(spread, rel=0.02)
    image = one.value("it.image")
    gain = found["gain_e_per_dn"]
    np.testing.assert_array_equal(image, np.clip(np.rint(electrons / gain + 100.0), 0, 16383))
    full = focal_plane_bench(tmp_path, {**params, "full_well_e": total})
    assert full.value("it.electrons").max() == total
    assert full.value("it.image").max() == np.rint(16383 + 100.0) - 100  # the last number
    marked = full.value("it.saturated")
    np.testing.assert_array_equal(
        marked == 1.0,
        np.rint(full.value("it.electrons") / full.readouts("it")["gain_e_per_dn"] + 100) > 16383,
    )
    assert full.readouts("it")["saturated_pixels"] == np.count_nonzero(marked)
    assert 0.4 < marked.mean() < 0.7


def test_noise_and_responsivity_are_those_behind_the_nonlinearity(tmp_path):
    """At 70 % of the well, bent by 10 %: measured in a picture, and between two scenes."""
    params = {**CAMERA_SHEET, "nonlinearity_percent": 10.0, "prnu_percent": 0.1, "bits": 0}
    params["integration_time_s"] = 0.7 * 7e6 / (584765.21021844287024 / 0.004)
    bench = focal_plane_bench(tmp_path, params, size=(256, 256))
    found, electrons = bench.readouts("it"), bench.value("it.electrons")
    slope = 1 - 2 * 0.1 * found["well_fill_percent"] / 100
    assert found["shot_noise_e"] == pytest.approx(slope * math.sqrt(found["signal_e"]), rel=1e-12)
    spread = math.hypot(found["temporal_noise_e"], found["fixed_pattern_e"])
    assert electrons.std() == pytest.approx(spread, rel=0.01)
    warmer = focal_plane_bench(tmp_path, params, size=(256, 256), scene={"temperature_K": 300.2})
    rise = (warmer.value("it.electrons").mean() - electrons.mean()) / 0.2
    assert found["responsivity_e_per_K"] == pytest.approx(rise, rel=0.01)
    assert found["netd_K"] == pytest.approx(
        found["temporal_noise_e"] / found["responsivity_e_per_K"], rel=1e-12
    )


def test_frames_averaged_lower_shot_and_read_noise_by_their_root(tmp_path):
    one, many = (
        focal_plane_bench(
            tmp_path, {**CAMERA_SHEET, "bits": 0, "frames_averaged": n}, size=(200, 200)
        )
        for n in (1, 16)
    )
    assert many.value("it.electrons").std() == pytest.approx(
        one.value("it.electrons").std() / 4, rel=0.02
    )
    ratio = one.readouts("it")["netd_K"] / many.readouts("it")["netd_K"]
    assert ratio == pytest.approx(4.0, rel=1e-12)
    assert many.value("it.electrons").mean() == pytest.approx(
        one.value("it.electrons").mean(), rel=1e-4
    )


def test_patterns_and_bad_pixels_stay_from_frame_to_frame_and_noise_does_not(tmp_path):
    params = {**CAMERA_SHEET, "bits": 0, "bad_pixel_percent": 1.0, "prnu_percent": 3.0}
    bench = focal_plane_bench(tmp_path, params, size=(80, 60))
    first = bench.value("it.electrons")
    second = bench.work.value(at_frame(bench.port("it.electrons").recipe, 1))
    bad = (first == 0.0) | (first == 7e6)
    assert np.count_nonzero(bad) == 48
    np.testing.assert_array_equal(bad, (second == 0.0) | (second == 7e6))
    assert (first[bad] == second[bad]).all()
    assert (first[~bad] != second[~bad]).mean() > 0.99
    both = np.corrcoef(first[~bad], second[~bad])[0, 1]
    total = bench.readouts("it")["signal_e"]
    pattern, temporal = (0.03 * total) ** 2, total + 400.0**2
    assert both == pytest.approx(pattern / (pattern + temporal), abs=0.02)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("port", ["image", "electrons", "noise", "saturated"])
def test_a_region_has_the_bits_of_the_whole(tmp_path, precision, port):
    params = {
        **CAMERA_SHEET, "integration_time_s": 2e-5, "prnu_percent": 1, "dsnu_e": 10,
        "bad_pixel_percent": 5, "nonlinearity_percent": 2, "full_well_e": 1e4,
    }  # fmt: skip
    scene = {"kind": "dormitory"}
    benches = [
        focal_plane_bench(tmp_path, params, scene=scene, size=(97, 61), precision=precision)
        for _ in range(2)
    ]
    whole = benches[0].value(f"it.{port}")
    region = Region(13, 29, 21, 40)
    part = benches[1].work.part(benches[1].port(f"it.{port}").recipe, region)
    np.testing.assert_array_equal(part, whole[region.slices])


def test_a_response_file_takes_the_place_of_the_number(tmp_path):
    (tmp_path / "qe.csv").write_text("um,QE\n3.0,0.7\n5.2,0.7\n")
    sheet = {**CAMERA_SHEET, "reference_radiance": 2.0}
    number = focal_plane_bench(tmp_path, sheet).readouts("it")
    params = {**sheet, "response": "qe.csv", "quantum_efficiency": 0.1}
    for name, value in focal_plane_bench(tmp_path, params).readouts("it").items():
        if name == "photon_weighting":
            continue
        assert value == pytest.approx(number[name], rel=1e-11), name
    (tmp_path / "qe.csv").write_text("# none beyond 4 µm\n3.0;0.7\n4.0;0.7\n")
    short = focal_plane_bench(tmp_path, params).readouts("it")
    narrow = focal_plane_bench(tmp_path, {**CAMERA_SHEET, "cut_off_um": 4.0}).readouts("it")
    assert short["signal_e"] == pytest.approx(narrow["signal_e"], rel=1e-11)


def test_reflected_light_has_no_netd(tmp_path):
    scene = {"cut_on_um": 0.5, "cut_off_um": 0.9, "temperature_K": 1500.0}
    for weighting in ("source", "scene"):
        params = {**CAMERA_SHEET, "photon_weighting": weighting, "full_well_e": 1e9}
        found = focal_plane_bench(tmp_path, params, scene=scene).readouts("it")
        assert found["netd_K"] is None
        assert found["responsivity_e_per_K"] is None
    table = focal_plane_bench(tmp_path, {**CAMERA_SHEET, "photon_weighting": "source"}, scene=scene)
    rows = table.value("it.table").as_dict()
    assert rows["photon_weighting"] == "source"
    assert rows["signal_by_scene_e"] is None
    assert rows["signal_by_source_e"] == rows["signal_e"]
    assert rows["signal_by_middle_e"] == pytest.approx(rows["signal_e"], rel=0.05)


def test_what_the_weighting_is_worth(tmp_path):
    rows = focal_plane_bench(tmp_path, CAMERA_SHEET).value("it.table").as_dict()
    radiance = band_radiance(temperature_K=300.0, **MWIR)
    h_c = 6.62607015e-34 * 299792458.0
    k = math.pi / 65 * 0.765 * 0.7 * 0.004 * (15e-6 * 0.95) ** 2
    assert rows["signal_by_middle_e"] == pytest.approx(k * radiance * 4.25e-6 / h_c, rel=1e-12)
    assert rows["signal_by_scene_e"] == pytest.approx(rows["signal_e"], rel=1e-13)
    assert rows["signal_by_source_e"] < rows["signal_by_middle_e"] < rows["signal_e"]
    worth = (rows["signal_e"] - rows["signal_by_source_e"]) / rows["signal_e"]
    assert rows["weighting_worth_percent"] == pytest.approx(100 * worth, rel=1e-12)
    assert focal_plane_bench(tmp_path, CAMERA_SHEET).readouts("it")["photon_weighting"] == "scene"


@pytest.mark.parametrize(
    ("params", "line"),
    [
        ({"bits": 12}, "gain_e_per_dn"),
        ({"nonlinearity_percent": 1}, "full_well_e"),
        ({"cold_shield_efficiency": 0.9}, "housing_K"),
        ({"rule_07": True, "detector_K": 77}, "material_cutoff_um"),
        ({"cut_on_um": 5.0, "cut_off_um": 4.0}, "cut_off_um"),
        ({"bits": 25, "full_well_e": 1e6}, "bits = 25 bit is not allowed: a whole number from 0"),
    ],
)  # fmt: skip
def test_what_lacks_a_value_is_refused_in_one_line(tmp_path, params, line):
    error = focal_plane_bench(tmp_path, params).error("it")
    assert isinstance(error, ParameterError)
    assert line in str(error)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("3.0,0.7\n", "1 points; a curve needs at least 2"),
        ("3.0,0.7\n2.0,0.7\n", "line 2: must be a wavelength above the previous one, 3"),
        ("3.0,0.7\n4.0,1.7\n", "quantum efficiency from 0 to 1"),
        ("3.0,0.7\nfour,0.5\n", "line 2: must be two numbers"),
        ("3.0,O.7\n4.0,0.7\n5.0,0.7\n", "line 1: must be two numbers"),
        ("3;0,7\n4;0\n5;1\n", "line 1: must be two numbers"),
        ('3,0.5\n4,"' + "9" * 200_000 + '"\n', "line 2: "),
        ("6,0.5\n7,0.5\n", "points that overlap the band, 3.7 to 4.8 µm"),
    ],
)
def test_a_response_that_is_none_is_refused(tmp_path, text, line):
    (tmp_path / "qe.csv").write_text(text)
    error = focal_plane_bench(tmp_path, {"response": "qe.csv"}).error("it")
    assert line in str(error)
    assert "\n" not in str(error)
