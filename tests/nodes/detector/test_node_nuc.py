"""Non-Uniformity Correction behind a focal plane, in simulated frames."""

import math

import numpy as np
import pytest

from core.chain.random_fields import at_frame
from node_bench import NodeBench

FPA = {
    "integration_time_s": 0.002, "prnu_percent": 2.0, "dsnu_e": 40000.0, "units": "electrons",
    "full_well_e": 1e8,
}  # fmt: skip
INIT = {"detector_x_um": 25, "detector_y_um": 25, "focal_length_mm": 100, "f_number": 2,
        "platform": "array"}  # fmt: skip
SCENE = {"kind": "uniform", "width": 80, "height": 64, "fov_x_deg": 1.1, "fov_y_deg": 0.9,
         "temperature_K": 305.0, "cut_on_um": 3.7, "cut_off_um": 4.8}  # fmt: skip
FRAMES = 12


def bench_of(folder, params, *, fpa=None, scene=None):
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "init": ("init_trans", INIT),
        "fpa": ("focal_plane", {**FPA, **(fpa or {})}),
        "raw": ("noise_3d", {"frames": FRAMES}),
        "nuc": ("nuc", params),
        "cube": ("noise_3d", {"frames": FRAMES}),
    }
    return NodeBench(folder, nodes)


def electrons(folder, kelvin):
    return bench_of(folder, {}, scene={"temperature_K": kelvin}).readouts("fpa")["signal_e"]


def tables(bench):
    return bench.value("cube.table").as_dict(), bench.value("raw.table").as_dict()


def test_two_points_leave_the_noise_of_the_references(tmp_path):
    params = {"low_K": 290, "high_K": 320, "reference_frames": 8}
    found, raw = tables(bench_of(tmp_path, params))
    signal, low, high = (electrons(tmp_path, kelvin) for kelvin in (305, 290, 320))
    share = (signal - low) / (high - low)
    # Shot noise is the root of the electrons: each reference has its own.
    expected = math.sqrt((low * (1 - share) ** 2 + high * share**2) / 8)
    assert raw["fixed_measured"] > 20 * found["fixed_measured"]
    assert found["sigma_vh_measured"] == pytest.approx(expected, rel=0.05)
    assert found["fixed"] == pytest.approx(found["fixed_measured"], rel=0.2)
    assert found["temporal"] == pytest.approx(found["temporal_measured"], rel=0.02)
    assert found["temporal"] == pytest.approx(raw["temporal"], rel=1e-3)


def test_one_point_leaves_the_gains_times_the_distance(tmp_path):
    params = {"method": "one_point", "low_K": 295, "high_K": 320, "reference_frames": 16}
    found, _ = tables(bench_of(tmp_path, params))
    signal, low = electrons(tmp_path, 305), electrons(tmp_path, 295)
    expected = math.hypot(0.02 * (signal - low), math.sqrt(low / 16))
    assert found["sigma_vh_measured"] == pytest.approx(expected, rel=0.05)
    assert found["sigma_vh"] == pytest.approx(expected, rel=0.05)


def test_drift_is_that_many_kelvins_among_pixels(tmp_path):
    params = {"low_K": 290, "high_K": 320, "reference_frames": 8, "drift_K": 0.5}
    bench = bench_of(tmp_path, params)
    found, _ = tables(bench)
    slope = (electrons(tmp_path, 320) - electrons(tmp_path, 290)) / 30
    own = bench.readouts("nuc")
    assert own["response_per_kelvin"] == pytest.approx(slope, rel=1e-2)
    assert found["sigma_vh_measured"] == pytest.approx(0.5 * slope, rel=0.05)
    assert found["sigma_vh"] == pytest.approx(0.5 * slope, rel=0.02)


def test_the_references_are_seen_once_for_all_frames(tmp_path):
    bench = bench_of(tmp_path, {"reference_frames": 2})
    for port in ("nuc.gain", "nuc.offset"):
        recipe = bench.port(port).recipe
        assert at_frame(recipe, 5).key == recipe.key
    later = bench.work.value(at_frame(bench.port("nuc.image").recipe, 5))
    assert not np.array_equal(later, bench.value("nuc.image"))


def test_dead_pixels_are_counted(tmp_path):
    bench = bench_of(tmp_path, {"reference_frames": 2}, fpa={"bad_pixel_percent": 1.0})
    assert bench.readouts("nuc")["weak_pixels"] == round(0.01 * 80 * 64)


def test_without_references_nothing_changes(tmp_path):
    bench = bench_of(tmp_path, {"method": "none"})
    assert bench.port("nuc.image").key == bench.port("fpa.image").key
    assert bench.readouts("nuc")["pattern_low"] is None


def test_references_of_one_temperature_are_refused(tmp_path):
    error = bench_of(tmp_path, {"low_K": 310, "high_K": 310}).error("nuc")
    assert "high_K" in str(error)
