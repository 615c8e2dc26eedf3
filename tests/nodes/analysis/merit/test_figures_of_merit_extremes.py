"""Figures of Merit at the ends of all ranges: numbers, or one line that says what is wrong."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from core.errors import DataError
from merit_sensor import FOV, sensor

MERIT = [
    {"frame_rate_Hz": None},
    {"eye_integration_s": 10.0, "frame_rate_Hz": 1e6},
    {"background_K": 2.0},
    {"background_K": 10.0},
    {"background_K": 20.0},
    {"background_K": 1e6},
    {"cut_on_um": 0.4, "cut_off_um": 0.5},
    {"target_delta_K": -2.0},
    {"target_delta_K": 0.0},
    {"target_delta_K": 1e4, "extinction_per_km": 0.0},
    {"target_size_m": 1e6},
    {"target_size_m": 1e-9},
    {"extinction_per_km": 1e6},
    {"range_max_km": 1e-12},
    {"range_max_km": 1e6},
    {"range_max_km": 0.0},
    {"eye_limit_mrad": 1e-9},
    {"mdtd_window": "image"},
    {"magnification": 1e6},
    {"magnification": 1e-6},
    {"display_cd_m2": 1e-300},
    {"scene_contrast_K": 1e-300},
    {"v50": 1e-300},
    {"n50_detection": 1e-300},
    {"snr_threshold": 1e-300},
]
BOOST = {
    "post_filter": "boost", "post_corner_Hz": 60.0, "post_gain": 30.0, "scan_mirror_rate_Hz": 0.02,
}  # fmt: skip
SENSORS = [
    {"noisy": False},
    {"noise": {"gain_percent": 1e5}},
    {"noise": {"amplifier_snr": None, "bits": 4, "d_star": 1e30}},
    {"noise": {**BOOST, "bandwidth_Hz": 3e5}},
    {"noise": {**BOOST, "post_filter": "highpass"}},
    {"scene": {"height": 24, "fov_y_deg": 3.0}},
    {"scene": {"width": 3, "height": 3, "fov_x_deg": 3 * FOV / 80, "fov_y_deg": 3 * FOV / 80}},
    {"scene": {"height": 1, "fov_y_deg": FOV / 80}},
    {"scene": {"temperature_K": 30.0}},
    {"init": {"detector_x_um": 400.0}},
    {"init": {"detector_x_um": 40000.0, "detector_y_um": 40000.0}},
    {"init": {"detector_x_um": 4e6}},
    {"init": {"platform": "line"}, "noise": {"gain_percent": 3.0}},
    {"init": {"platform": "push"}, "noise": {"gain_percent": 3.0}},
]
REFUSED = [
    ({"background_K": 2.0}, {}),  # emits nothing
    ({"background_K": 10.0}, {}),  # next to nothing
    ({}, {"scene": {"height": 1, "fov_y_deg": FOV / 80}}),  # no rows to compare
    # A high pass leaves no mean to be the radiance of a background.
    ({}, {"noise": {**BOOST, "post_filter": "highpass"}}),
]


@pytest.mark.thorough(but=39)
@pytest.mark.parametrize("model", ["flir92", "ratches_1976"])
@pytest.mark.parametrize(
    ("merit", "given"), [*((each, {}) for each in MERIT), *(({}, each) for each in SENSORS)]
)
def test_numbers_or_one_line(model, merit, given):
    engine, plan, work = sensor({**merit, "model": model}, **given)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if (merit, given) in REFUSED:
            with pytest.raises(DataError) as caught:
                engine.value(plan, "merit.table", work)
            assert "\n" not in str(caught.value)
            return
        table = engine.value(plan, "merit.table", work).as_dict()
        curves = [
            engine.value(plan, f"merit.{port}", work) for port in ("mrtd", "mdtd", "probability")
        ]
    assert all(value is None or np.isfinite(value) for value in table.values())
    for curve in curves:
        for series in curve.series:
            assert np.isfinite(series.x).all()
            assert np.isfinite(series.y).all()
            assert (np.diff(series.x) > 0).all(), series.label
    for series in curves[2].series:
        assert ((series.y >= 0) & (series.y <= 1)).all()
        assert (np.diff(series.y) <= 1e-12).all()
