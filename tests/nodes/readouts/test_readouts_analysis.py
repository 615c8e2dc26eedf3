"""Every read-out of the modules of analysis, with unlike axes."""

from __future__ import annotations

import math

import pytest

from readout_bench import (
    F_NUMBER,
    FILL_X,
    FILL_Y,
    FOCAL_LENGTH_MM,
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
