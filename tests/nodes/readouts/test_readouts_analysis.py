"""Every read-out of the modules of analysis, with unlike axes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from edge_pictures import edge_mtf, edge_picture
from node_bench import NodeBench
from readout_bench import (
    COLUMNS,
    DY,
    F_NUMBER,
    FILL_X,
    FILL_Y,
    FOCAL_LENGTH_MM,
    LIBRARY,
    NYQUIST_X,
    NYQUIST_Y,
    PITCH_X_UM,
    PITCH_Y_UM,
    bench_of,
    gaussian,
)

BLUR = {"sigma_x_mrad": 0.4, "sigma_y_mrad": 1.3}
D_STAR, BANDWIDTH_HZ, GAIN = 1e9, 3e4, 0.02


def test_slices_at_both_nyquist_frequencies(tmp_path):
    bench = bench_of(tmp_path, "mtf_slices", {}, more={"blur": ("gaussian_mtf", BLUR)})
    assert bench.readouts("it") == pytest.approx(
        {
            "at_nyquist_x": gaussian(0.4, NYQUIST_X),
            "at_nyquist_y": gaussian(1.3, NYQUIST_Y),
            "at_pixel_nyquist_x": gaussian(0.4, 0.5 * FOCAL_LENGTH_MM / PITCH_X_UM),
            "at_pixel_nyquist_y": gaussian(1.3, 0.5 * FOCAL_LENGTH_MM / PITCH_Y_UM),
        },
        rel=1e-12,
    )


def noisy(folder, key, params, platform="array"):
    """A blurred level through detectors with noise and errors of gain."""
    noise = {
        "material": "manual", "d_star": D_STAR, "bandwidth_Hz": BANDWIDTH_HZ,
        "gain_percent": 100 * GAIN, "background_K": 290.0,
    }  # fmt: skip
    return bench_of(
        folder, key, params, scene={"kind": "uniform"}, init={"platform": platform},
        more={
            "blur": ("gaussian_mtf", BLUR),
            "back": ("back_transform", {}),
            "noise": ("electronics_noise", noise),
        },
    )  # fmt: skip


def detector_sigma():
    """√(A·Δf)/D*·(1 + 4F²)/π/A, per m²."""
    area_cm2 = PITCH_X_UM * FILL_X * PITCH_Y_UM * FILL_Y * 1e-8
    g_number = (1 + 4 * F_NUMBER**2) / math.pi
    return 1e4 * math.sqrt(area_cm2 * BANDWIDTH_HZ) / D_STAR * g_number / area_cm2


def test_readouts_of_the_noise_budget(tmp_path):
    bench = noisy(tmp_path, "noise_budget", {"frequency": 0.4})
    level = float(bench.value("scene.image").mean())
    one, two = detector_sigma(), GAIN * level
    assert 0.05 < one / two < 20  # neither hides the other
    found = bench.readouts("it")
    assert found == pytest.approx(
        {
            "sigma": math.hypot(one, two),
            "sigma_temporal": one,
            "sigma_fixed": two,
            "mtf_x": gaussian(0.4, 0.4 * NYQUIST_X),
            "mtf_y": gaussian(1.3, 0.4 * NYQUIST_Y),
            "xi": 0.4 * NYQUIST_X,
            "eta": 0.4 * NYQUIST_Y,
        },
        rel=1e-3,
    )


def test_readouts_of_spatial_blur(tmp_path):
    """Two passes of 7 taps; the table's bound is tested beside the module."""
    more = {"blur": ("gaussian_mtf", BLUR)}
    bench = bench_of(tmp_path, "spatial_blur", {"half_width_px": 3}, more=more)
    found = bench.readouts("it")
    assert found["taps"] == 14
    assert found["error_bound"] == bench.value("it.table").as_dict()["error_bound"] > 0


def test_readouts_of_lines(tmp_path):
    bench = bench_of(
        tmp_path, "line_by_line", {}, more={"blur": ("gaussian_mtf", BLUR)},
        scene={"fov_x_deg": 60.0}, init={"platform": "line"},
    )  # fmt: skip
    dx = math.radians(60.0) * 1000 / COLUMNS
    image, whole = bench.value("it.image"), bench.value("it.whole")
    gap = np.abs(image - whole)
    span = whole.max() - whole.min()
    worst = int(gap.max(axis=0).argmax())
    found = bench.readouts("it")
    assert found == pytest.approx(
        {
            "rms_percent": 100 * math.sqrt(float((gap**2).mean())) / span,
            "max_percent": 100 * gap.max() / span,
            "max_view_deg": math.degrees((worst - (COLUMNS - 1) / 2) * dx / 1000),
            "interval_nadir_mrad": DY * math.cos(dx / 2 / 1000),
            "interval_edge_mrad": DY * math.cos((COLUMNS - 1) / 2 * dx / 1000),
            "scale_nodes": 0,
            "error_percent": 0,
        },
        rel=1e-9,
    )


def test_readouts_of_a_pushbroom(tmp_path):
    """1000 m up; 20 and 30 µm at 40 mm are 0.5 and 0.75 m, out to the ends of a line."""
    params = {
        "kind": "pushbroom", "altitude_m": 1000.0, "ground_interval_m": 1.0, "columns": 20,
        "rows": 12, "fov_x_deg": None, "pitch_x_um": 20.0, "pitch_y_um": 30.0,
        "focal_length_mm": 40.0,
    }  # fmt: skip
    found = bench_of(tmp_path, "camera_geometry", params).readouts("it")
    assert found == pytest.approx(
        {
            "swath_m": 10.0,
            "gsd_x_m": 0.5,
            "gsd_y_m": 0.75,
            "gsd_edge_x_m": 0.5,
            "gsd_edge_y_m": 0.75,
            "panoramic_factor": 1.0,
            "interval_x_mrad": 0.5,
            "interval_y_mrad": 0.75,
            "line_spacing_m": 0.75,
            "lines": 12,
            "footprint_error": 0.0,
        },
        rel=1e-9,
    )


def test_readouts_of_a_measured_edge(tmp_path):
    """An edge at 8°, of a blur of 0.6 px; pixels of 0.218 and 0.273 mrad."""
    np.save(tmp_path / "edge.npy", 270 + 30 * edge_picture(8, 0.6, (96, 80)))
    fov = {"fov_x_deg": 1.0, "fov_y_deg": 1.5}
    bench = NodeBench(
        LIBRARY,
        tmp_path,
        {"file": ("read_image", {"path": "edge.npy", **fov}), "it": ("measured_mtf", {})},
    )
    x, y = math.radians(1.0) * 1000 / 80, math.radians(1.5) * 1000 / 96
    per_mrad = math.hypot(math.cos(math.radians(8)) / x, math.sin(math.radians(8)) / y)
    fine = np.linspace(0, 1, 10001)
    curve = edge_mtf(fine, 8, 0.6)
    half, tenth = (float(fine[np.argmax(curve < level)]) for level in (0.5, 0.1))
    found = bench.readouts("it")
    assert found["mtf50"] == pytest.approx(half * per_mrad, rel=0.004)
    assert found["mtf50_per_pixel"] == pytest.approx(half, rel=0.004)
    assert found["mtf10"] == pytest.approx(tenth * per_mrad, rel=0.02)
    assert found["mtf10_per_pixel"] == pytest.approx(tenth, rel=0.02)
    assert found["at_nyquist"] == pytest.approx(float(edge_mtf(0.5, 8, 0.6)), abs=0.002)
    assert found["edge_angle_deg"] == pytest.approx(-8, abs=0.01)
    table = bench.value("it.table").as_dict()
    for name in ("mtf50_error", "at_nyquist_error"):
        assert found[name] == table[name]
    assert table["mtf50_error"] != table["at_nyquist_error"]
    for name in ("expected_mtf50", "expected_at_nyquist", "largest_difference"):
        assert found[name] is None  # no chain is known behind a file
