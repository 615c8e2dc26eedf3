"""Microbolometer: NETD measured in simulated frames, lag over frames and along a scan."""

import math

import mpmath
import numpy as np
import pytest

from core.chain.random_fields import at_frame
from core.physics.radiometry.planck import band_radiance, band_radiance_derivative
from focal_plane_bench import cautions
from node_bench import NodeBench

SCENE = {"kind": "uniform", "width": 64, "height": 48, "fov_x_deg": 2.0, "fov_y_deg": 1.5,
         "temperature_K": 285.0, "cut_on_um": 8.0, "cut_off_um": 14.0}  # fmt: skip
INIT = {"detector_x_um": 17, "detector_y_um": 17, "focal_length_mm": 25, "f_number": 1.4,
        "platform": "array", "edges": "periodic"}  # fmt: skip
FRAMES = 16


def bench_of(folder, params, *, scene=None, init=None, before=None, nuc=None):
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "init": ("init_trans", {**INIT, **(init or {})}),
        **({"before": before} if before else {}),
        "bolo": ("microbolometer", params),
        "merit": ("figures_of_merit", {"frame_rate_Hz": None}),
        **({} if nuc is None else {"nuc": ("nuc", nuc)}),
        "cube": ("noise_3d", {"frames": FRAMES}),
    }
    return NodeBench(folder, nodes)


def slope(kelvin):
    return float(band_radiance_derivative(cut_on_um=8.0, cut_off_um=14.0, temperature_K=kelvin))


def frame(bench, number, port="bolo.image"):
    return bench.work.value(at_frame(bench.port(port).recipe, number))


def test_netd_elsewhere_and_measured_in_frames(tmp_path):
    params = {"netd_mK": 60, "optics_transmission": 0.9, "integration_time_s": 2e-5,
              "reference_integration_time_s": 5e-5}  # fmt: skip
    bench = bench_of(tmp_path, params)
    expected = 0.06 * (4 * 1.4**2 + 1) / 5 / 0.9 * math.sqrt(2.5) * slope(300.0) / slope(285.0)
    found = bench.readouts("bolo")
    assert found["netd_K"] == pytest.approx(expected, rel=1e-6)
    assert found["scene_K"] == pytest.approx(285.0, rel=1e-9)
    table = bench.value("cube.table").as_dict()
    error = 4 / math.sqrt(2 * 64 * 48 * FRAMES)
    assert table["temporal_measured"] / slope(285.0) == pytest.approx(expected, rel=error)
    assert bench.readouts("merit")["netd_K"] == pytest.approx(expected, rel=1e-6)


def test_one_over_f_adds_its_share(tmp_path):
    params = {"corner_Hz": 3.0, "frame_rate_Hz": 60.0, "longest_period_s": 20.0}
    found = bench_of(tmp_path, params).readouts("bolo")
    # Densities meet at the corner: σ²·3/30·ln(30·20).
    ratio = math.sqrt(3.0 / 30.0 * math.log(30.0 * 20.0))
    assert found["flicker_K"] == pytest.approx(ratio * found["white_netd_K"], rel=1e-9)
    whole = math.hypot(found["flicker_K"], found["white_netd_K"])
    assert found["netd_K"] == pytest.approx(whole, rel=1e-12)


def test_lag_over_frames_of_other_pictures(tmp_path):
    """Frames that differ, by noise before, against a recursion from long ago."""
    params = {"netd_mK": 0, "time_constant_s": 0.02, "frame_rate_Hz": 40.0}
    before = ("noise_3d_source", {"sigma_tvh": 1.0, "sigma_vh": 0.5})
    bench = bench_of(tmp_path, params, before=before)
    kept = math.exp(-1 / 0.8)
    state = frame(bench, -30, "before.image")
    for number in range(-29, 4):
        state = kept * state + (1 - kept) * frame(bench, number, "before.image")
        if number >= 0:
            np.testing.assert_allclose(frame(bench, number), state, atol=1e-5)
    table = bench.value("cube.table").as_dict()
    averaged = math.sqrt((1 - kept) / (1 + kept))
    assert table["sigma_tvh"] == pytest.approx(averaged, rel=1e-5)
    assert table["sigma_vh"] == pytest.approx(0.5, rel=1e-9)
    assert table["fixed"] == pytest.approx(table["fixed_measured"], rel=0.2)
    assert bench.readouts("bolo")["lag_percent"] == pytest.approx(100 * kept)


def test_lag_along_a_scan(tmp_path):
    """1/(1 + 2πi·τ·v·ξ) on every line, by numpy."""
    params = {"netd_mK": 0, "time_constant_s": 0.004}
    bench = bench_of(tmp_path, params, scene={"kind": "siemens_star"},
                     init={"scan_velocity_mrad_per_s": 300.0})  # fmt: skip
    frequency = np.fft.rfftfreq(64, np.radians(2.0) * 1000 / 64)
    response = 1 / (1 + 2j * np.pi * 0.004 * 300.0 * frequency)
    response[-1] = response[-1].real  # of Nyquist's wave
    spectrum = np.fft.rfft(bench.value("scene.image"), axis=1) * response
    expected = np.fft.irfft(spectrum, 64, axis=1)
    np.testing.assert_allclose(bench.value("bolo.image"), expected, rtol=1e-9)


def test_patterns_of_pixels_and_their_correction(tmp_path):
    params = {"netd_mK": 20, "response_percent": 3.0, "offset_mK": 2000}
    raw = bench_of(tmp_path, params)
    table = raw.value("cube.table").as_dict()
    assert table["fixed"] == pytest.approx(table["fixed_measured"], rel=0.05)
    assert table["fixed"] / slope(285.0) == pytest.approx(
        raw.readouts("bolo")["fixed_pattern_K"], rel=0.01
    )
    nuc = {"low_K": 275, "high_K": 305, "reference_frames": 16}
    corrected = bench_of(tmp_path, params, nuc=nuc).value("cube.table").as_dict()
    assert corrected["fixed_measured"] < 0.5 * corrected["temporal_measured"]
    assert corrected["fixed"] == pytest.approx(corrected["fixed_measured"], rel=0.15)


SLOW = {"corner_Hz": 5.0, "frame_rate_Hz": 60.0, "longest_period_s": 20.0, "time_constant_s": 0.0}


def test_a_temporal_filter_is_a_recursion_over_the_frames(tmp_path):
    """y = a·y₋₁ + (1 − a)·x of the camera's own frames without it, a = (4 − 1)/(4 + 1)."""
    before = ("noise_3d_source", {"sigma_tvh": 0.1})
    params = {**SLOW, "response_percent": 2.0, "time_constant_s": 0.01}
    plain = bench_of(tmp_path, params, before=before)
    made = bench_of(tmp_path, {**params, "filter_frames": 4.0}, before=before)
    state = frame(plain, -40)
    for number in range(-39, 3):
        state = 0.6 * state + 0.4 * frame(plain, number)
        if number >= 0:
            np.testing.assert_allclose(frame(made, number), state, atol=2e-6)


def test_noise_behind_a_temporal_filter(tmp_path):
    """White noise falls to a third; 1/f noise by the filter's response, integrated by mpmath."""
    plain = bench_of(tmp_path, SLOW).readouts("bolo")
    bench = bench_of(tmp_path, {**SLOW, "filter_frames": 9.0})
    found = bench.readouts("bolo")
    assert found["white_netd_K"] == pytest.approx(plain["white_netd_K"] / 3, rel=1e-12)
    a = mpmath.mpf(8) / 10
    power = mpmath.quad(
        lambda f: (1 - a) ** 2 / (1 - 2 * a * mpmath.cos(mpmath.pi * f / 30) + a**2) / f,
        mpmath.linspace(mpmath.mpf(1) / 20, 30, 40),
    )
    ratio = float(mpmath.sqrt(power / mpmath.log(600)))
    assert found["flicker_K"] == pytest.approx(ratio * plain["flicker_K"], rel=1e-12)
    assert bench.readouts("merit")["netd_K"] == pytest.approx(found["netd_K"], rel=1e-6)
    # Independent pixels of one frame have all that noise.
    spread = frame(bench, 0).std() / slope(285.0)
    assert spread == pytest.approx(found["netd_K"], rel=4 / math.sqrt(2 * 64 * 48))


def test_bits_and_range_of_the_output(tmp_path):
    """8 bits from 250 to 330 K: levels of L(250 K) + k·q, clipped beyond them."""
    params = {"bits": 8, "range_low_K": 250.0, "range_high_K": 330.0, "netd_mK": 400.0}
    bench = bench_of(tmp_path, params)
    low, high = (
        float(band_radiance(cut_on_um=8.0, cut_off_um=14.0, temperature_K=kelvin))
        for kelvin in (250.0, 330.0)
    )
    step = (high - low) / 255
    number = (bench.value("bolo.image") - low) / step
    np.testing.assert_allclose(number, np.rint(number), atol=1e-4)
    found = bench.readouts("bolo")
    rounding = step / math.sqrt(12) / slope(285.0)
    assert found["quantization_K"] == pytest.approx(rounding, rel=1e-9)
    assert found["netd_K"] == pytest.approx(math.hypot(found["white_netd_K"], rounding), rel=1e-9)
    assert bench.readouts("merit")["netd_K"] == pytest.approx(found["netd_K"], rel=1e-6)
    assert not cautions(bench, "clipped")
    hot = bench_of(tmp_path, params, scene={"kind": "two_panel", "delta_K": 120})
    assert hot.value("bolo.image").max() == pytest.approx(high, rel=1e-6)
    (told,) = cautions(hot, "clipped")
    assert "outside 250 to 330 K" in told.text


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"integration_time_s": 1e-4}, "reference_integration_time_s"),
        ({"reference_integration_time_s": 1e-4}, "integration_time_s"),
        ({"corner_Hz": 1.0, "longest_period_s": 0.01}, "longest_period_s"),
        ({"optics_transmission": 0.0}, "optics_transmission"),
        ({"bits": 8, "range_low_K": 250.0}, "range_high_K"),
        ({"range_low_K": 250.0, "range_high_K": 300.0}, "bits"),
        ({"bits": 8, "range_low_K": 300.0, "range_high_K": 280.0}, "above range_low_K = 300"),
    ],
)
def test_faults(tmp_path, params, words):
    error = str(bench_of(tmp_path, params).error("bolo"))
    assert words in error
    assert "\n" not in error
