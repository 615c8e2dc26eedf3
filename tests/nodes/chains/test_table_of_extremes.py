"""Extremes, one row each: the right number against independent truth, or one clear error.

Every row runs in single and in double precision. Further out, and in every combination that chance
brings, nothing is NaN: `test_extreme_parameters` takes every parameter to the ends of its range,
`test_random_networks` draws chains and pictures; near the ends of the formulas themselves,
`tests/core/physics` compares with 30 to 60 digits.
"""

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from core.errors import ImagechainError
from delivered_chains import MTF_ERROR, PRECISIONS
from short_chain import short_chain
from slow_reference.filtering import filtered
from slow_reference.transfer import box
from spatial_truth import blurred, left_behind


@dataclass(frozen=True)
class Row:
    """A module, and what it makes of a picture: of (picture, edges)."""

    modules: tuple
    expected: Any
    interval_mrad: float = 1.0
    init: dict[str, Any] = field(default_factory=dict)
    exact: bool = False


def unchanged(picture, edges):
    return picture


def mean_of_all(picture, edges):
    return np.full(picture.shape, picture.mean())


def mean_of_lines(picture, edges):
    return np.repeat(picture.mean(axis=1, keepdims=True), picture.shape[1], axis=1)


def charge(**params):
    return (("charge_eff_mtf", params), ("charge_eff_phase", params))


def averaged(width_samples):
    """What a detector of that width makes of it, for a frame of `interval` mrad."""

    def expected(picture, edges):
        one = np.longdouble(1)
        law = box(width_samples, width_samples)
        return filtered(picture.astype(np.longdouble), law, (one, one), edges)

    return expected


def detector(interval_mrad, width_samples):
    """A pitch of so many samples over 100 mm."""
    pitch_um = 100 * interval_mrad * width_samples
    return (("detector_mtf", {"detector_x_um": pitch_um, "detector_y_um": pitch_um,
                              "focal_length_mm": 100.0}),)  # fmt: skip


def optics(size_cm, **pupil):
    pupil = {"size_x": 64, "size_y": 64, "radius": 24.0, **pupil}
    band = {"cut_on_um": 10.0, "cut_off_um": 10.0, "size_x_cm": size_cm, "size_y_cm": size_cm}
    return (("exit_pupil", pupil), ("exit_pupil_mtf", band))


STILL = {"integration_time_s": 1.0, "range_m": 100.0}
ROWS = {
    "zero blur": Row((("gaussian_mtf", {"sigma_x_mrad": 0.0}),), unchanged, exact=True),
    "enormous blur": Row(
        (("gaussian_mtf", {"sigma_x_mrad": 1e9, "sigma_y_mrad": 1e9}),), mean_of_all
    ),
    "efficiency of 0": Row(charge(efficiency=0.0, detectors_per_line=1), mean_of_lines),
    "1e6 transfers": Row(
        charge(efficiency=0.99999, detectors_per_line=10**6),
        lambda picture, edges: left_behind(picture, 10**6, 0.99999, edges),
    ),
    "zero velocity": Row(
        (
            ("alongtrack_mtf", {"velocity_m_per_s": 0.0, **STILL}),
            ("crosstrack_mtf", {"scan_velocity_mrad_per_s": 0.0, "dwell_time_s": 1.0}),
            ("relative_motion_mtf", {"image_velocity_x": 7.0, "platform_velocity_x": 7.0, **STILL}),
        ),
        unchanged,
        exact=True,
    ),
    # 0.15 mm over 10 µm are 0.015 cycles/mrad, the mirrored frame's first frequency is 1/26.
    "cutoff below the first frequency interval": Row(optics(0.02), mean_of_all),
    "no cutoff in sight": Row(optics(1e18), unchanged),
    "field of view of 1e-6 degrees": Row(
        detector(np.pi / 180e-3 * 1e-6 / 13, 2.3), averaged(2.3),
        interval_mrad=np.pi / 180e-3 * 1e-6 / 13,
    ),
    "field of view of 170 degrees": Row(
        detector(np.pi / 180e-3 * 170 / 13, 2.3), averaged(2.3),
        interval_mrad=np.pi / 180e-3 * 170 / 13,
    ),
}  # fmt: skip


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
    "1 × N": drawn(1, 40),
    "primes": drawn(31, 37),
    "4097 × 3": drawn(4097, 3),
    "constant": np.full((12, 17), 37.25),
    "radiance of 1e30": 1e30 * drawn(12, 17),
    "radiance of 1e-30": 1e-30 * drawn(12, 17),
    "dynamic range of 1e12": logarithmic((24, 31)),
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


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_samples_that_are_no_numbers_are_counted_and_placed(tmp_path, bad, precision):
    picture = drawn(5, 7)
    picture[1, 3] = picture[1, 6] = picture[4, 0] = bad
    bench, last = short_chain(tmp_path, picture, CHAIN, interval_mrad=INTERVAL, precision=precision)
    assert re.search(r"3 .*not finite.*row 1, column 3", bench.refusal(last, "file"))


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
    assert "below 0" in bench.refusal(last, "poisson_noise")
    dark = {**QUIET, "background_K": None}
    bench, last = short_chain(
        tmp_path, -picture, (("electronics_noise", dark),), init=SENSOR, precision=precision
    )
    with pytest.raises(ImagechainError, match="give background_K"):
        bench.value(last)


# ---------------------------------------------------------------- radiance
