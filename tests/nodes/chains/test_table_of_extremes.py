"""Extremes, one row each: the right number against independent truth, or one clear error.

Every row runs in single and in double precision. Further out, and in every combination that chance
brings, nothing is NaN: `test_extreme_parameters` takes every parameter to the ends of its range,
`test_random_chains` draws chains and pictures; near the ends of the formulas themselves,
`tests/core/physics` compares with 30 to 60 digits.
"""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import ImagechainError
from delivered_chains import MTF_ERROR, PRECISIONS
from extreme_rows import ROWS, charge, optics
from node_bench import NodeBench
from noise_bench import BOUND
from planck_truth import band_radiance
from short_chain import LIBRARY, short_chain
from spatial_truth import blurred, left_behind

EDGES = ["reflect", "periodic"]
SIGMA, TRANSFERS, EFFICIENCY = 2.7, 3, 0.8
INTERVAL = 0.5  # mrad: 4097 of them are less than 180°
BLUR = {"sigma_x_mrad": SIGMA * INTERVAL, "sigma_y_mrad": SIGMA * INTERVAL}
CHAIN = (
    ("gaussian_mtf", BLUR),
    ("charge_eff_mtf", {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY}),
    ("charge_eff_phase", {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY}),
)


def drawn(rows, columns, seed=9):
    """Samples that are the same in single precision."""
    values = np.random.default_rng(seed).uniform(20, 60, (rows, columns))
    return values.astype(np.float32).astype(float)


def assert_near(found, expected, precision, scale):
    assert np.isfinite(found).all()
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= MTF_ERROR[precision] * scale


# ---------------------------------------------------------------- pictures through one chain


def logarithmic(shape):
    """A dynamic range of 1e12."""
    values = 10 ** np.random.default_rng(3).uniform(-6, 6, shape)
    values.flat[:2] = 1e-6, 1e6
    return values.astype(np.float32).astype(float)


FRAMES = {
    "1 × 1": drawn(1, 1),
    "1 × 2": drawn(1, 2),
    "1 × N": drawn(1, 40),
    "N × 1": drawn(29, 1),
    "primes": drawn(31, 37),
    "4097 × 3": drawn(4097, 3),
    "3 × 4097": drawn(3, 4097),
    "all zero": np.zeros((12, 17)),
    "constant": np.full((12, 17), 37.25),
    "radiance of 1e30": 1e30 * drawn(12, 17),
    "radiance of 1e-30": 1e-30 * drawn(12, 17),
    "dynamic range of 1e12": logarithmic((24, 31)),
    "negative radiance": -drawn(12, 17),
    "of either sign": drawn(12, 17) - 40,
}


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("name", FRAMES)
def test_frame_is_the_spatial_sum(tmp_path, name, edges, precision):
    picture = FRAMES[name]
    bench, last = short_chain(
        tmp_path, picture, CHAIN, interval_mrad=INTERVAL, init={"edges": edges}, precision=precision
    )
    expected = left_behind(blurred(picture, SIGMA, edges), TRANSFERS, EFFICIENCY, edges)
    assert_near(bench.value(last), expected, precision, np.abs(picture).max())


# ---------------------------------------------------------------- modules at their extremes


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("name", ROWS)
def test_module_at_an_extreme(tmp_path, name, edges, precision):
    row, picture = ROWS[name], drawn(12, 13)
    init = {"edges": edges, **row.init}
    bench, last = short_chain(
        tmp_path, picture, row.modules, interval_mrad=row.interval_mrad, init=init,
        precision=precision,
    )  # fmt: skip
    found, expected = bench.value(last), row.expected(picture, edges)
    assert_near(found, expected, precision, 60)
    if row.exact:
        nothing, last = short_chain(tmp_path, picture, (), init=init, precision=precision)
        assert np.array_equal(found, nothing.value(last))


# ---------------------------------------------------------------- what is refused, and how

REFUSED = {
    "fields of view of 0 and below": (
        (), {"fov_x_deg": -1.0}, "fov_x_deg = -1.0 deg is not allowed",
    ),
    "a field of view of 180 degrees": (
        (), {"fov_x_deg": 180.0},
        "fov_x_deg = 180.0 deg is not allowed: a number from 0 below 180",
    ),
    "an obscuration of 1": (
        optics(2.56, shape="cassegrain", obscuration_radius=24.0), {},
        "obscuration_radius = 24.0 samples is not allowed: below the radius",
    ),
    "an efficiency above 1": (charge(efficiency=1.0000001), {}, "from 0 to 1"),
    "an efficiency below 0": (charge(efficiency=-1e-9), {}, "from 0 to 1"),
    "a range of nothing": (
        (("alongtrack_mtf", {"velocity_m_per_s": 1.0, "integration_time_s": 1.0}),), {},
        "range_m is empty: give it here or on Init & Trans",
    ),
    "numbers that are none": (
        (("gaussian_mtf", {"sigma_x_mrad": float("nan")}),), {}, "sigma_x_mrad = nan",
    ),
    "numbers without end": (
        (("gaussian_mtf", {"sigma_x_mrad": float("inf")}),), {}, "sigma_x_mrad = inf",
    ),
}  # fmt: skip


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_one_line(tmp_path, name, precision):
    modules, init, words = REFUSED[name]
    bench, last = short_chain(tmp_path, drawn(4, 5), modules, init=init, precision=precision)
    with pytest.raises(ImagechainError) as caught:
        bench.value(last)
    assert words in str(caught.value)
    assert caught.value.exit_code == 2
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_samples_that_are_no_numbers_are_counted_and_placed(tmp_path, bad, precision):
    picture = drawn(5, 7)
    picture[1, 3] = picture[1, 6] = picture[4, 0] = bad
    bench, last = short_chain(tmp_path, picture, CHAIN, interval_mrad=INTERVAL, precision=precision)
    with pytest.raises(ImagechainError, match=r"3 .*not finite.*row 1, column 3") as caught:
        bench.value(last)
    assert caught.value.exit_code == 2
    assert caught.value.node == "file"


def test_radiance_beyond_single_precision_is_refused_there_only(tmp_path):
    picture = 1e38 * drawn(5, 7)
    bench, last = short_chain(tmp_path, picture, CHAIN, interval_mrad=INTERVAL, precision="double")
    expected = left_behind(blurred(picture, SIGMA, "reflect"), TRANSFERS, EFFICIENCY, "reflect")
    assert_near(bench.value(last), expected, "double", 6e39)
    bench, last = short_chain(tmp_path, picture, CHAIN, interval_mrad=INTERVAL, precision="single")
    with pytest.raises(ImagechainError, match="single precision") as caught:
        bench.value(last)
    assert caught.value.exit_code == 2


# ---------------------------------------------------------------- noise

SENSOR = {"f_number": 2.0, "detector_x_um": 30.0, "detector_y_um": 30.0, "focal_length_mm": 50.0}
QUIET = {"cut_on_um": 8.0, "cut_off_um": 12.0, "bandwidth_Hz": 1e4, "d_star": 1e40,
         "background_K": 300.0}  # fmt: skip


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("snr", [0.01, 1e9])
def test_signal_to_noise_ratio(tmp_path, snr, precision):
    picture = np.full((90, 80), 40.0)
    reader = (("electronics_noise", {**QUIET, "amplifier_snr": snr}),)
    bench, last = short_chain(tmp_path, picture, reader, init=SENSOR, precision=precision)
    error = bench.value(last).astype(float) - picture
    assert np.isfinite(error).all()
    if precision == "single" and snr > 1e7:
        assert np.abs(error).max() <= 2e-6 * 40
        return
    sigma = 40 / snr
    rounding = np.finfo(bench.work.policy.dtype).eps * 40
    assert abs(error.std() - sigma) <= BOUND * sigma / np.sqrt(2 * error.size) + rounding
    assert abs(error.mean()) <= BOUND * sigma / np.sqrt(error.size) + rounding


@pytest.mark.parametrize("precision", PRECISIONS)
def test_negative_radiance_after_noise(tmp_path, precision):
    """Filtered, combined and quantized like any other; photons and temperatures refuse it."""
    picture = np.full((40, 36), 5.0)
    noisy = ("electronics_noise", {**QUIET, "amplifier_snr": 0.5, "bits": 12})
    bench, last = short_chain(
        tmp_path, picture, (noisy, ("combine_pixels", {"factor_x": 3, "factor_y": 4})),
        init=SENSOR, precision=precision,
    )  # fmt: skip
    fine = bench.value("electronics_noise.image").astype(float)
    assert fine.min() < 0 < fine.max()
    expected = fine.reshape(10, 4, 12, 3).mean(axis=(1, 3))
    assert_near(bench.value(last), expected, precision, np.abs(fine).max())
    photons = ("poisson_noise", {"mode": "photon", "photons_per_unit": 10.0})
    bench, last = short_chain(tmp_path, picture, (noisy, photons), init=SENSOR, precision=precision)
    with pytest.raises(ImagechainError, match="below 0") as caught:
        bench.value(last)
    assert caught.value.node == "poisson_noise"
    dark = {**QUIET, "background_K": None}
    bench, last = short_chain(
        tmp_path, -picture, (("electronics_noise", dark),), init=SENSOR, precision=precision
    )
    with pytest.raises(ImagechainError, match="give background_K"):
        bench.value(last)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_background_near_absolute_zero_has_no_slope(tmp_path, precision):
    cold = (("electronics_noise", {**QUIET, "background_K": 1e-3}),)
    bench, last = short_chain(tmp_path, drawn(4, 5), cold, init=SENSOR, precision=precision)
    with pytest.raises(ImagechainError, match=r"background_K = 0\.001 K .*too cold") as caught:
        bench.value(last)
    assert caught.value.node == "electronics_noise"


# ---------------------------------------------------------------- radiance


@pytest.mark.thorough(but=11)
@pytest.mark.parametrize(("precision", "tolerance"), [("double", 1e-12), ("single", 1e-7)])
@pytest.mark.parametrize("wavelength_times_temperature", [10.0**n for n in range(2, 13)])
def test_ten_decades_of_wavelength_times_temperature(
    tmp_path, wavelength_times_temperature, precision, tolerance
):
    band = (10.0, 12.0)
    temperature = wavelength_times_temperature / 10
    scene = {
        "kind": "uniform", "width": 2, "height": 1, "cut_on_um": band[0], "cut_off_um": band[1],
        "temperature_K": temperature, "delta_K": 0.0,
    }  # fmt: skip
    bench = NodeBench(LIBRARY, tmp_path, {"scene": ("test_scene", scene)}, precision=precision)
    found, expected = bench.value("scene.image"), band_radiance(*band, temperature)
    # A radiance below the least number of single precision is none.
    assert np.abs(found - expected).max() <= tolerance * expected + np.finfo(found.dtype).tiny


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("temperature", [5e-324, 1e-9, 1.0])
def test_next_to_absolute_zero_there_is_no_radiance(tmp_path, temperature, precision):
    scene = {"kind": "uniform", "width": 2, "height": 1, "temperature_K": temperature,
             "delta_K": 0.0}  # fmt: skip
    bench = NodeBench(LIBRARY, tmp_path, {"scene": ("test_scene", scene)}, precision=precision)
    assert np.array_equal(bench.value("scene.image"), np.zeros((1, 2)))
