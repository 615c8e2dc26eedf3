"""Image Quality of a visible camera behind a Gaussian blur: every figure by hand."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from core.errors import ImagechainError
from node_bench import NodeBench
from reference_cases import CAMERA as CAMERA_VALUES
from reference_cases import reference_cases

SIZE, FOV_DEG, RANGE_M = 40, 0.02, 600e3
SAMPLE_MRAD = math.radians(FOV_DEG) * 1000 / SIZE  # small angles: as Init & Trans to 1e-8
SIGMA_X, SIGMA_Y = 0.45, 0.6  # of the blur, in samples
SCENE = {
    "kind": "uniform", "width": SIZE, "height": SIZE, "fov_x_deg": FOV_DEG, "fov_y_deg": FOV_DEG,
    "temperature_K": 1250.0, "cut_on_um": 0.5, "cut_off_um": 0.8,
}  # fmt: skip
INIT = {
    "detector_x_um": 8, "detector_y_um": 8, "focal_length_mm": 900, "f_number": 8,
    "platform": "array", "range_m": RANGE_M,
}  # fmt: skip
CAMERA = {"integration_time_s": 0.5, "read_noise_e": 20, "photon_weighting": "source"}


def bench_of(folder, quality=None, *, scene=None, camera=None, init=None, blur=None, orbit=None):
    gauss = {"sigma_x_mrad": SIGMA_X * SAMPLE_MRAD, "sigma_y_mrad": SIGMA_Y * SAMPLE_MRAD}
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "satellite": ("camera", orbit or {}),
        "init": ("init_trans", {**INIT, **(init or {})}),
        "blur": blur or ("gaussian_mtf", gauss),
        "back": ("back_transform", {}),
        "fpa": ("focal_plane", {**CAMERA, **(camera or {})}),
        "merit": ("image_quality", quality or {}),
    }
    return NodeBench(folder, nodes)


def rer(sigma):
    return 2 * ndtr(0.5 / sigma) - 1


def test_figures_of_the_chain(tmp_path):
    bench = bench_of(tmp_path)
    found, camera = bench.readouts("merit"), bench.readouts("fpa")
    table = bench.value("merit.table").as_dict()
    gsd = SAMPLE_MRAD * RANGE_M / 1000
    edge = math.sqrt(rer(SIGMA_X) * rer(SIGMA_Y))
    height = math.sqrt(ndtr(1.25 / SIGMA_X) * ndtr(1.25 / SIGMA_Y))
    assert found["gsd_m"] == pytest.approx(gsd, rel=1e-7)
    assert (table["rer_x"], table["rer_y"]) == pytest.approx((rer(SIGMA_X), rer(SIGMA_Y)))
    assert found["rer"] == pytest.approx(edge, rel=1e-7)
    assert found["overshoot"] == pytest.approx(height, rel=1e-7)
    # a radiance counts as that of 15 % reflectance, and the contrast to 7 % is 8/15 of it
    assert found["snr"] == pytest.approx(camera["snr"] * 8 / 15, rel=1e-6)
    whole = bench_of(tmp_path, {"snr_of": "mean"}).readouts("merit")
    assert whole["snr"] == pytest.approx(camera["snr"], rel=1e-6)
    snr, inch, log = camera["snr"] * 8 / 15, gsd / 0.0254, math.log10(edge)
    worse = math.log10(rer(SIGMA_X) * rer(SIGMA_Y) ** 2) / 3
    fifth = 9.57 - 3.32 * math.log10(inch) + 3.32 * (1 - math.exp(-1.9 / snr)) * worse
    assert found["giqe5"] == pytest.approx(fifth - 2 * worse**4 - 1.8 / snr, rel=1e-6)
    fourth = 10.251 - 3.16 * math.log10(inch) + 2.817 * log - 0.656 * height - 0.344 / snr
    assert found["giqe4"] == pytest.approx(fourth, rel=1e-6)
    third = 11.81 + 3.32 * (log - math.log10(inch)) - 1.48 * height - 1 / snr
    assert found["giqe3"] == pytest.approx(third, rel=1e-6)
    curve = bench.value("merit.edge")
    for series, sigma in zip(curve.series, (SIGMA_X, SIGMA_Y), strict=True):
        np.testing.assert_allclose(series.y, ndtr(series.x / sigma), atol=1e-7)


def test_what_is_typed_counts(tmp_path):
    typed = {"range_m": 300e3, "off_nadir_deg": 60.0, "snr": 50.0, "overshoot": 1.2,
             "noise_gain": 4.0}  # fmt: skip
    found = bench_of(tmp_path, typed).readouts("merit")
    gsd = SAMPLE_MRAD * 300 * math.sqrt(2)  # on the ground, 30° above the horizon
    assert found["gsd_m"] == pytest.approx(SAMPLE_MRAD * 300, rel=1e-7)
    assert found["gsd_ground_m"] == pytest.approx(gsd, rel=1e-7)
    assert (found["snr"], found["overshoot"]) == (50.0, 1.2)
    log = math.log10(math.sqrt(rer(SIGMA_X) * rer(SIGMA_Y)))
    fourth = 10.251 - 3.16 * math.log10(gsd / 0.0254) + 2.817 * log - 0.656 * 1.2
    assert found["giqe4"] == pytest.approx(fourth - 0.344 * 4 / 50, rel=1e-6)


def test_the_elevation_is_that_of_the_orbit(tmp_path):
    """600 km, 30° off nadir: cos e = sin 30°·(R + h)/R; what is typed counts, and is warned of."""
    elevation = math.degrees(math.acos(0.5 * 6978.137 / 6378.137))
    orbit = {"altitude_km": 600, "look_angle_deg": 30}
    found = bench_of(tmp_path, init={"range_m": None}, orbit=orbit).readouts("merit")
    ground = found["gsd_m"] / math.sqrt(math.sin(math.radians(elevation)))
    assert found["gsd_ground_m"] == pytest.approx(ground, rel=1e-12)
    for typed, words in (
        ({"elevation_deg": 60.0}, "elevation_deg = 60 deg here but 56.84 deg from Camera's orbit"),
        ({"off_nadir_deg": 30.0}, "elevation_deg = 60 deg here but 56.84 deg from Camera's orbit"),
        ({"range_m": 6e5}, "range_m = 6e+05 m here but 7.04e+05 m on Init & Trans"),
    ):
        bench = bench_of(tmp_path, typed, init={"range_m": None}, orbit=orbit)
        (said,) = cautions(bench, "view")
        assert words in said
        if "range_m" not in typed:
            assert bench.readouts("merit")["gsd_ground_m"] == pytest.approx(
                found["gsd_m"] / math.sqrt(math.sin(math.radians(60)))
            )


def test_a_warning_names_what_lies_beyond_the_limits(tmp_path):
    """A camera of high SNR, as many satellites have; one within them is silent."""
    bench = bench_of(tmp_path, {"snr": 279.0, "range_m": 1000.0})
    (caution,) = [one for one in bench.warnings() if one.node == "merit"]
    assert caution.check == "limits"
    assert "snr = 279 (2 to 130)" in caution.text
    assert "gsd_inch = 0.3436 (3 to 80)" in caution.text  # 8.727 mm
    within = bench_of(tmp_path, {"snr": 50.0, "range_m": 40e3})
    told = [one for one in within.warnings() if one.node == "merit"]
    assert told == []


def test_without_a_range_it_says_so(tmp_path):
    bench = bench_of(tmp_path, init={"range_m": 0})
    assert str(bench.error("merit")).startswith("merit: range_m is empty")


def test_an_edge_that_is_no_edge_any_more_is_refused(tmp_path):
    smear = {"dwell_time_s": 1.39, "scan_velocity_mrad_per_s": 7.64e4 * SAMPLE_MRAD}
    bench = bench_of(tmp_path, blur=("crosstrack_mtf", smear))
    with pytest.raises(ImagechainError, match=r"edge response is -\d.* both must be above zero"):
        bench.value("merit.table")


@pytest.mark.parametrize("case", reference_cases("giqe_oblique", file=CAMERA_VALUES))
def test_a_view_at_an_angle_of_the_reference(case, tmp_path):
    given = {name: float(value) for name, value in case["inputs"].items()}
    pixel = given.pop("pitch_um") / given.pop("focal_length_mm")  # mrad
    given["range_m"] = given.pop("slant_range_m")
    fov = math.degrees(pixel * SIZE / 1000)
    bench = bench_of(tmp_path, given, scene={"fov_x_deg": fov, "fov_y_deg": fov})
    found = bench.readouts("merit") | bench.value("merit.table").as_dict()
    for name, value in case["expected"].items():
        assert found[name.replace("normal_", "")] == pytest.approx(float(value), rel=1e-9), name


def cautions(bench, check):
    told = bench.warnings()
    return [one.text for one in told if (one.node, one.check) == ("merit", check)]


@pytest.mark.parametrize(("unit", "mean"), [("1", 0.4), ("%", 40.0)])
@pytest.mark.parametrize("bands", [1, 3])
def test_the_contrast_of_a_scene_in_reflectance(tmp_path, unit, mean, bands):
    """15 % less 7 % under its own light: 0.08/0.4 of the electrons of a scene of 40 %."""
    np.save(tmp_path / "ground.npy", np.full((SIZE, SIZE), mean))
    nodes = {
        "scene": ("read_image", {"path": "ground.npy", "unit": unit, "fov_x_deg": FOV_DEG,
                                 "fov_y_deg": FOV_DEG}),
        "light": ("reflected_light", {"cut_on_um": 0.5, "cut_off_um": 0.8, "bands": bands}),
        "air": ("atmospheric_path", {"model": "transmission", "transmission": 0.7}),
        "init": ("init_trans", INIT),
        "fpa": ("focal_plane", {**CAMERA, "integration_time_s": 1e-3}),
        "merit": ("image_quality", {}),
    }  # fmt: skip
    bench = NodeBench(tmp_path, nodes)
    camera = bench.readouts("fpa")
    expected = 0.08 / 0.4 * camera["signal_e"] / camera["temporal_noise_e"]
    assert bench.readouts("merit")["snr"] == pytest.approx(expected, rel=1e-6)
    assert not cautions(bench, "contrast")
