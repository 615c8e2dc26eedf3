"""Figures of Merit: extremes, and ranges through air."""

import math
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


PATH = {
    "model": "visibility_km", "visibility_km": 4.0, "angstrom_q": 1.1, "range_m": 300.0,
    "air_K": 300.0,
}  # fmt: skip
TASKS = {"detection": 0.75, "recognition": 3.0, "identification": 6.0}
RANGES = [*(f"{task}_range_km" for task in TASKS), "ttp_range_km"]


def evaluated(merit=None, air=(), **changes):
    engine, plan, work = sensor(merit, air=air, **changes)
    assert plan.errors() == []
    curves = {one.label: one for one in engine.value(plan, "merit.mrtd", work).series}
    table = engine.value(plan, "merit.table", work).as_dict()
    return table, curves, [str(one) for one in plan.warnings() if one.node == "merit"]


def left_of_difference(km, background_K, visibility_km=4.0, q=1.1):
    """∫τ(λ, R)·dL/dT dλ over ∫dL/dT dλ from 3 to 5 µm, as a sum of 20 000 midpoints."""
    um = 3 + 2 * (np.arange(20000) + 0.5) / 20000
    x = 14387.768775039338 / (um * background_K)
    slope = um**-6 * np.exp(x) / np.expm1(x) ** 2
    passed = np.exp(-3.912 / visibility_km * (0.55 / um) ** q * km)
    return float((passed * slope).sum() / slope.sum())


def bisected_km(curve, delta_K, cycles, left, size_m=2.3):
    """Where the apparent difference is the MRTD at the frequency of that many cycles."""
    near, far = 1e-3, 1e3
    for _ in range(80):
        middle = math.sqrt(near * far)
        frequency = cycles / (size_m / middle)  # a metre at a km is a mrad
        beyond = frequency > curve.x[-1]
        needed = np.exp(np.interp(np.log(frequency), np.log(curve.x), np.log(curve.y)))
        near, far = (near, middle) if beyond or left(middle) * delta_K < needed else (middle, far)
    return near


def test_johnson_ranges_by_bisection():
    table, curves, _ = evaluated({"target_delta_K": 0.1}, air=[PATH])
    background = table["background_K"]
    assert background == pytest.approx(300.0, abs=0.01)  # through air as warm as the scene
    for task, cycles in TASKS.items():
        expected = bisected_km(
            curves["2-D"], 0.1, cycles, lambda km: left_of_difference(km, background)
        )
        assert table[f"{task}_range_km"] == pytest.approx(expected, rel=1e-7)
    clear, _, _ = evaluated({"target_delta_K": 0.1, "extinction_per_km": 0.0})
    assert table["detection_range_km"] < 0.9 * clear["detection_range_km"]


@pytest.mark.parametrize("form", ["mrtd", "system_contrast_threshold"])
def test_the_ttp_range_is_that_of_the_extinction_there(form):
    """At its own range a haze has an extinction −ln τ(R)/R, which typed in gives the same range."""
    merit = {"ttp_threshold": form, "target_delta_K": 0.1, "v50": 8.0}
    table, _, _ = evaluated(merit, air=[PATH])
    km = table["ttp_range_km"]
    extinction = -math.log(left_of_difference(km, table["background_K"])) / km
    typed, _, _ = evaluated({**merit, "extinction_per_km": extinction})
    assert typed["ttp_range_km"] == pytest.approx(km, rel=1e-5)
    assert km < 0.99 * evaluated({**merit, "extinction_per_km": 0.0})[0]["ttp_range_km"]


@pytest.mark.parametrize(
    "air",
    [
        [{"model": "extinction_per_km", "extinction_per_km": 0.6, "range_m": 250.0}],
        [{"transmission": math.exp(-0.15), "range_m": 250.0}],
        [{"transmission": math.exp(-0.24)}],  # of the 400 m on Init & Trans
        [
            {"model": "extinction_per_km", "extinction_per_km": 0.4, "range_m": 250.0},
            {"transmission": math.exp(-0.05), "range_m": 250.0},
        ],
    ],
)
def test_grey_air_is_an_extinction(air):
    """The range sought counts, not that of the picture; two paths are two constituents."""
    air = [{**one, "air_K": 300.0} for one in air]
    through, _, warned = evaluated({"target_delta_K": 0.5}, air=air)
    typed, _, _ = evaluated({"target_delta_K": 0.5, "extinction_per_km": 0.6})
    for name in RANGES:
        assert through[name] == pytest.approx(typed[name], rel=1e-9)
    assert warned == []


def test_an_extinction_beside_a_path_is_a_warning():
    grey = {"model": "extinction_per_km", "extinction_per_km": 0.6, "range_m": 250, "air_K": 300}
    _, _, warned = evaluated({"extinction_per_km": 0.5}, air=[grey])
    assert len(warned) == 1
    assert "extinction_per_km = 0.5 1/km is not used" in warned[0]
    assert evaluated({"extinction_per_km": 0.6}, air=[grey])[2] == []
    assert len(evaluated({"extinction_per_km": 0.6}, air=[PATH])[2]) == 1
    assert evaluated({"extinction_per_km": 0.6})[2] == []
