"""Focal Plane: its figures and pictures, against reference values, statistics and by hand."""

import math

import numpy as np
import pytest
from scipy import stats

from core.chain.frame_sequence import at_frame
from core.errors import ParameterError
from core.evaluation.region import Region
from core.physics.radiometry.planck import band_radiance
from node_bench import NodeBench
from nodes.library import standard_library
from reference_cases import CAMERA, reference_cases

LIBRARY = standard_library()
CONVERTED = {  # of the reference: what Init & Trans is given
    "pitch_um": ("detector_x_um", "detector_y_um"),
    "f_number": ("f_number",),
    "fill": ("fill_x",),
}
SENSOR = {
    "detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.95, "fill_y": 0.95, "platform": "array",
}  # fmt: skip
MWIR = {"cut_on_um": 3.7, "cut_off_um": 4.8}
CAMERA_SHEET = {
    "integration_time_s": 0.004, "optics_transmission": 0.765, "quantum_efficiency": 0.7,
    "read_noise_e": 400, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip


def bench_of(folder, params, *, size=(64, 48), init=None, scene=None, precision="double"):
    seen = {
        "kind": "uniform", "width": size[0], "height": size[1], "fov_x_deg": 1.0,
        "fov_y_deg": 1.0, "temperature_K": 300.0, **MWIR, **(scene or {}),
    }  # fmt: skip
    nodes = {
        "scene": ("test_scene", seen),
        "init": ("init_trans", {**SENSOR, **(init or {})}),
        "it": ("focal_plane", params),
    }
    links = [
        ("scene.image", "init.image"), ("scene.image", "it.image"), ("init.context", "it.context"),
    ]  # fmt: skip
    return NodeBench(LIBRARY, folder, nodes, links, precision=precision)


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
    bench = bench_of(tmp_path, given, init={**init, "fill_y": 1.0}, scene=scene, size=(4, 3))
    found = bench.readouts("it")
    for name, value in case["expected"].items():
        assert found[name] == pytest.approx(float(value), rel=1e-9, abs=0.0), name
    assert found["snr"] == pytest.approx(found["signal_e"] / found["temporal_noise_e"])


def test_the_mean_number_of_a_noisy_picture_is_that_of_the_figures(tmp_path):
    bench = bench_of(tmp_path, CAMERA_SHEET, size=(256, 200))
    image, found = bench.value("it.image"), bench.readouts("it")
    sigma_dn = found["temporal_noise_e"] / found["gain_e_per_dn"]
    assert image.mean() == pytest.approx(found["mean_dn"], abs=4 * sigma_dn / 226)
    assert image.std() == pytest.approx(sigma_dn, rel=0.02)
    assert (image == np.rint(image)).all()
    assert found["saturated_pixels"] == 0


def test_electrons_are_poisson_distributed_pixel_by_pixel(tmp_path):
    dim = {"integration_time_s": 6e-8, "units": "electrons"}
    bench = bench_of(tmp_path, dim, size=(300, 300), scene={"kind": "two_panel", "delta_K": 40})
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
    bench = bench_of(tmp_path, quiet, scene=scene)
    image = bench.value("it.image")
    assert bench.port("it.image").unit == "W/m²/sr"
    np.testing.assert_allclose(image, bench.value("scene.image"), rtol=2e-3)  # shot noise
    assert bench.port("it.electrons").unit == "e-"


def test_the_order_is_pattern_then_read_noise_then_well_then_numbers(tmp_path):
    """Fixed patterns multiply and add what was collected; the well cuts what was read."""
    params = {**CAMERA_SHEET, "prnu_percent": 2.0, "dsnu_e": 5000.0, "offset_dn": 100.0}
    one = bench_of(tmp_path, params, size=(200, 200))
    electrons = one.value("it.electrons")
    found = one.readouts("it")
    total = found["signal_e"]
    assert found["fixed_pattern_e"] == pytest.approx(math.hypot(0.02 * total, 5000.0))
    spread = math.hypot(found["fixed_pattern_e"], found["shot_noise_e"], 400.0)
    assert electrons.std() == pytest.approx(spread, rel=0.02)
    image = one.value("it.image")
    gain = found["gain_e_per_dn"]
    np.testing.assert_array_equal(image, np.clip(np.rint(electrons / gain + 100.0), 0, 16383))
    full = bench_of(tmp_path, {**params, "full_well_e": total})
    assert full.value("it.electrons").max() == total
    assert full.value("it.image").max() == np.rint(16383 + 100.0) - 100  # the last number
    marked = full.value("it.saturated")
    np.testing.assert_array_equal(
        marked == 1.0,
        np.rint(full.value("it.electrons") / full.readouts("it")["gain_e_per_dn"] + 100) > 16383,
    )
    assert full.readouts("it")["saturated_pixels"] == np.count_nonzero(marked)
    assert 0.4 < marked.mean() < 0.7


def test_the_noise_is_what_differs_from_the_expected_electrons(tmp_path):
    bench = bench_of(tmp_path, {**CAMERA_SHEET, "nonlinearity_percent": 5.0})
    noise, electrons = bench.value("it.noise"), bench.value("it.electrons")
    total = bench.readouts("it")["signal_e"]
    expected = total * (1 - 0.05 * total / 7e6)
    np.testing.assert_allclose(electrons - noise, expected, rtol=1e-12)
    assert bench.readouts("it")["mean_dn"] == pytest.approx(expected * 16383 / 7e6)


def test_frames_averaged_lower_shot_and_read_noise_by_their_root(tmp_path):
    one, many = (
        bench_of(tmp_path, {**CAMERA_SHEET, "bits": 0, "frames_averaged": n}, size=(200, 200))
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
    bench = bench_of(tmp_path, params, size=(80, 60))
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
        bench_of(tmp_path, params, scene=scene, size=(97, 61), precision=precision)
        for _ in range(2)
    ]
    whole = benches[0].value(f"it.{port}")
    region = Region(13, 29, 21, 40)
    part = benches[1].work.part(benches[1].port(f"it.{port}").recipe, region)
    np.testing.assert_array_equal(part, whole[region.slices])


def test_a_typed_seed_gives_the_same_noise_under_any_name_and_another_one_other_noise(tmp_path):
    typed = {**CAMERA_SHEET, "seed_mode": "typed", "seed": 4}
    one, two = (bench_of(tmp_path, typed).value("it.image") for _ in range(2))
    np.testing.assert_array_equal(one, two)
    assert (bench_of(tmp_path, {**typed, "seed": 5}).value("it.image") != one).any()


def test_an_edit_of_the_read_noise_draws_nothing_again(tmp_path):
    quiet, loud = (
        bench_of(tmp_path, {**CAMERA_SHEET, "bits": 0, "read_noise_e": sigma})
        for sigma in (100.0, 300.0)
    )
    clean = bench_of(tmp_path, {**CAMERA_SHEET, "bits": 0, "read_noise_e": 0.0})
    base = clean.value("it.electrons")
    np.testing.assert_allclose(
        loud.value("it.electrons") - base, 3 * (quiet.value("it.electrons") - base), atol=1e-6
    )


def test_twenty_four_bits_are_whole_numbers_in_single_precision(tmp_path):
    params = {**CAMERA_SHEET, "bits": 24, "offset_dn": 3.0}
    bench = bench_of(tmp_path, params, precision="single")
    image, electrons = bench.value("it.image"), bench.value("it.electrons")
    assert image.dtype == np.float32
    exact = np.rint(electrons.astype(float) / (7e6 / (2**24 - 1)) + 3.0)
    np.testing.assert_array_equal(image, exact)


def test_a_response_file_takes_the_place_of_the_number(tmp_path):
    (tmp_path / "qe.csv").write_text("um,QE\n3.0,0.7\n5.2,0.7\n")
    number = bench_of(tmp_path, CAMERA_SHEET).readouts("it")
    params = {**CAMERA_SHEET, "response": "qe.csv", "quantum_efficiency": 0.1}
    for name, value in bench_of(tmp_path, params).readouts("it").items():
        if name == "photon_weighting":
            continue
        assert value == pytest.approx(number[name], rel=1e-11), name
    (tmp_path / "qe.csv").write_text("# none beyond 4 µm\n3.0;0.7\n4.0;0.7\n")
    short = bench_of(tmp_path, params).readouts("it")
    narrow = bench_of(tmp_path, {**CAMERA_SHEET, "cut_off_um": 4.0}).readouts("it")
    assert short["signal_e"] == pytest.approx(narrow["signal_e"], rel=1e-11)


def test_rule_07_and_the_typed_current(tmp_path):
    rule = {"rule_07": True, "detector_K": 120.0, "material_cutoff_um": 5.0}
    dark = bench_of(tmp_path, {**CAMERA_SHEET, **rule}).readouts("it")["dark_e"]
    # 6.5408535053481733711e-9 A/cm² of the reference on 225 µm² in 4 ms
    assert dark == pytest.approx(6.5408535053481733711e-9 * 225e-8 / 1.602176634e-19 * 0.004)
    typed = {**CAMERA_SHEET, "dark_current_e_per_s": dark / 0.004}
    assert bench_of(tmp_path, typed).readouts("it")["dark_e"] == pytest.approx(dark, rel=1e-12)


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
    found = bench_of(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 8)).readouts("it")
    dark = math.sqrt(400**2 + params.get("gain_e_per_dn", 7e6 / 16383) ** 2 / 12)
    assert found["dynamic_range_dB"] == pytest.approx(20 * math.log10(saturation / dark), rel=1e-9)


@pytest.mark.parametrize(
    ("params", "warned"),
    [
        ({"material_cutoff_um": 4.5}, True),
        ({"material_cutoff_um": 4.5, "cut_off_um": 4.5}, False),
        ({"material_cutoff_um": 4.5, "response": "qe.csv"}, False),
        ({"material_cutoff_um": 5.3}, False),
        ({}, False),
    ],
)
def test_photons_beyond_the_cutoff_of_the_material_are_warned_of(tmp_path, params, warned):
    (tmp_path / "qe.csv").write_text("3.0,0.7\n4.4,0.7\n4.6,0\n5.0,0\n")
    bench = bench_of(tmp_path, {**CAMERA_SHEET, "detector_K": 90, "rule_07": bool(
        params.get("material_cutoff_um")), **params}, size=(8, 8))  # fmt: skip
    found = [c for c in bench.engine.warnings(bench.plan, bench.work) if c.check == "material"]
    assert len(found) == warned
    if warned:
        assert "3.7 to 4.8 µm" in found[0].text
        assert "material_cutoff_um = 4.5 µm" in found[0].text


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ({"detector_K": 150, "material_cutoff_um": 5.2}, "rule_07 is off"),
        ({"detector_K": 150, "material_cutoff_um": 5.2, "rule_07": True}, None),
        ({"detector_K": 150, "material_cutoff_um": 5.2, "rule_07": True,
          "dark_current_e_per_s": 2e5}, "dark_current_e_per_s = 200000 e-/s is not used"),
        ({"detector_K": 150, "material_cutoff_um": 5.2, "dark_current_e_per_s": 2e5}, None),
        ({}, None),
    ],
)  # fmt: skip
def test_a_dark_current_that_does_nothing_is_warned_of(tmp_path, params, said):
    bench = bench_of(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 8))
    found = [c for c in bench.engine.warnings(bench.plan, bench.work) if c.check == "dark_current"]
    assert len(found) == (said is not None)
    assert said is None or said in found[0].text


@pytest.mark.parametrize(
    ("optics", "params", "warned"),
    [
        ({}, {"cut_on_um": 7.7, "cut_off_um": 9.3}, True),
        ({"cut_on_um": 7.7, "cut_off_um": 9.3}, {"cut_on_um": 7.7, "cut_off_um": 9.3}, False),
        ({}, {"cut_on_um": 7.9, "cut_off_um": 12.0}, False),
        ({}, {}, False),
        ({"cut_on_um": 7.5, "cut_off_um": 8.0}, {}, True),
    ],
)
def test_optics_of_another_band_than_the_cold_filter_are_warned_of(
    tmp_path, optics, params, warned
):
    """At F/2 and 100 mm, 7.5 to 12 µm end at 5.1 cyc/mrad and 7.7 to 9.3 µm at 5.9."""
    seen = {
        "kind": "uniform", "width": 16, "height": 12, "fov_x_deg": 0.1, "fov_y_deg": 0.1,
        "temperature_K": 300.0, "cut_on_um": 7.5, "cut_off_um": 12.0,
    }  # fmt: skip
    nodes = {
        "scene": ("test_scene", seen),
        "init": ("init_trans", {**SENSOR, "f_number": 2}),
        "lens": ("diffraction_mtf", optics),
        "back": ("back_transform", {}),
        "pixels": ("sample_pixels", {}),
        "it": ("focal_plane", {**CAMERA_SHEET, **params}),
    }
    links = [
        ("scene.image", "init.image"), ("init.context", "lens.context"),
        ("init.magnitude", "lens.magnitude"), ("init.phase", "lens.phase"),
        ("lens.magnitude", "back.magnitude"), ("lens.phase", "back.phase"),
        ("back.image", "pixels.image"), ("pixels.image", "it.image"),
        ("init.context", "it.context"),
    ]  # fmt: skip
    bench = NodeBench(LIBRARY, tmp_path, nodes, links)
    found = [c for c in bench.engine.warnings(bench.plan, bench.work) if c.check == "optics"]
    assert len(found) == warned
    if warned and params:
        for words in ("(lens)", "7.5 to 12 µm", "7.7 to 9.3 µm", "cut_on_um = 7.7"):
            assert words in found[0].text


def test_reflected_light_has_no_netd(tmp_path):
    scene = {"cut_on_um": 0.5, "cut_off_um": 0.9, "temperature_K": 1500.0}
    for weighting in ("source", "scene"):
        params = {**CAMERA_SHEET, "photon_weighting": weighting, "full_well_e": 1e9}
        found = bench_of(tmp_path, params, scene=scene).readouts("it")
        assert found["netd_K"] is None
        assert found["responsivity_e_per_K"] is None
    table = bench_of(tmp_path, {**CAMERA_SHEET, "photon_weighting": "source"}, scene=scene)
    rows = table.value("it.table").as_dict()
    assert rows["photon_weighting"] == "source"
    assert rows["signal_by_scene_e"] is None
    assert rows["signal_by_source_e"] == rows["signal_e"]
    assert rows["signal_by_middle_e"] == pytest.approx(rows["signal_e"], rel=0.05)


def test_what_the_weighting_is_worth(tmp_path):
    rows = bench_of(tmp_path, CAMERA_SHEET).value("it.table").as_dict()
    radiance = band_radiance(temperature_K=300.0, **MWIR)
    h_c = 6.62607015e-34 * 299792458.0
    k = math.pi / 65 * 0.765 * 0.7 * 0.004 * (15e-6 * 0.95) ** 2
    assert rows["signal_by_middle_e"] == pytest.approx(k * radiance * 4.25e-6 / h_c, rel=1e-12)
    assert rows["signal_by_scene_e"] == pytest.approx(rows["signal_e"], rel=1e-13)
    assert rows["signal_by_source_e"] < rows["signal_by_middle_e"] < rows["signal_e"]
    worth = (rows["signal_e"] - rows["signal_by_source_e"]) / rows["signal_e"]
    assert rows["weighting_worth_percent"] == pytest.approx(100 * worth, rel=1e-12)
    assert bench_of(tmp_path, CAMERA_SHEET).readouts("it")["photon_weighting"] == "scene"


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
    error = bench_of(tmp_path, params).error("it")
    assert isinstance(error, ParameterError)
    assert line in str(error)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("3.0,0.7\n", "1 points; at least 2"),
        ("3.0,0.7\n2.0,0.7\n", "line 2, '2.0,0.7': must be a wavelength above the one before, 3"),
        ("3.0,0.7\n4.0,1.7\n", "quantum efficiency from 0 to 1"),
        ("3.0,0.7\nfour,0.5\n", "line 2, 'four,0.5': must be two numbers"),
        ("3.0,O.7\n4.0,0.7\n5.0,0.7\n", "line 1, '3.0,O.7': must be two numbers"),
        ("3;0,7\n4;0\n5;1\n", "line 1, '3;0,7': must be two numbers"),
        ('3,0.5\n4,"' + "9" * 200_000 + '"\n', "line 2, "),
        ("6,0.5\n7,0.5\n", "points that overlap the band, 3.7 to 4.8 µm"),
    ],
)
def test_a_response_that_is_none_is_refused(tmp_path, text, line):
    (tmp_path / "qe.csv").write_text(text)
    error = bench_of(tmp_path, {"response": "qe.csv"}).error("it")
    assert line in str(error)
    assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ({"integration_time_s": 0.1}, ("% of the full well", "tdi_stages", "full_well_e")),
        ({"gain_e_per_dn": 10.0}, ("16383", "gain_e_per_dn", "offset_dn")),
        ({"offset_dn": -2000.0}, ("number -", "first, 0", "offset_dn larger")),
        ({}, ()),
    ],
    ids=["well", "converter", "below the converter", "neither"],
)
def test_a_mean_that_is_clipped_is_warned_of(tmp_path, params, said):
    """25 times the exposure of the reference fills its well to 1.6; 4.5e5 electrons are 45,000."""
    bench = bench_of(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 8))
    found = [c for c in bench.engine.warnings(bench.plan, bench.work) if c.check == "overflow"]
    assert len(found) == bool(said)
    for words in said:
        assert words in found[0].text


@pytest.mark.parametrize(("warmer", "clipped"), [(20.0, False), (30.0, True)])
def test_a_brightest_that_is_clipped_is_warned_of(tmp_path, warmer, clipped):
    """Half of the picture at 300 K, half warmer; the well holds 2.5 times what 300 K give.

    By Planck's law 320 K give 2.0 times as many photons from 3.7 to 4.8 µm, and 330 K 2.7 times.
    """
    scene = {"kind": "two_panel", "temperature_K": 300.0, "delta_K": warmer}
    cold = bench_of(tmp_path, CAMERA_SHEET, size=(8, 8)).readouts("it")["signal_e"]
    sheet = {**CAMERA_SHEET, "full_well_e": 2.5 * cold, "read_noise_e": 0}
    bench = bench_of(tmp_path, sheet, size=(8, 8), scene=scene)
    assert bench.readouts("it")["well_fill_percent"] < 100
    assert (bench.readouts("it")["saturated_pixels"] > 0) == clipped
    found = [c for c in bench.engine.warnings(bench.plan, bench.work) if c.check == "overflow"]
    assert len(found) == clipped
    if clipped:
        assert "the picture's brightest gives" in found[0].text


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("3,0.5\n4.2,0.6\n", ("ends at 4.2 µm with 0.6", "3.7 to 4.8 µm")),
        ("4,0.5\n5,0.6\n", ("begins at 4 µm with 0.5",)),
        ("4,0\n4.1,0.5\n4.2,0\n", ()),
        ("3.7,0.5\n4.8,0.6\n", ()),
    ],
    ids=["ends", "begins", "closed", "whole"],
)
def test_a_response_that_breaks_off_within_the_band_is_warned_of(tmp_path, text, said):
    (tmp_path / "qe.csv").write_text(text)
    bench = bench_of(tmp_path, {**CAMERA_SHEET, "response": "qe.csv"}, size=(8, 8))
    found = [c for c in bench.engine.warnings(bench.plan, bench.work) if c.check == "response_ends"]
    assert len(found) == bool(said)
    for words in said:
        assert words in found[0].text
