"""Charge transfer, amplifier, post filters and periodic noise against independent truth."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from core.physics.detector.readout import (
    corner_in_cyc_per_mrad,
    dwell_time_s,
    lowpass_mtf,
    lowpass_ptf,
    mirror_scan_velocity_mrad_per_s,
    noise_bandwidth_hz,
    post_filter_mtf,
    post_filter_ptf,
)
from core.physics.noise.flicker_noise import periodic_pattern
from core.physics.sampling.detector_sampling import interval_mrad

_PHASES = np.array([-math.pi, -1.0, -1e-5, 0.0, 1e-200, 1e-8, 0.3, 0.99, 1.01, 2.0, math.pi])


@pytest.mark.parametrize("efficiency", ["0.99999", "0.999999999999", "0.5", "1e-12"])
@pytest.mark.parametrize("transfers", [1, 640, 10**6])
def test_exact_transfer_equals_the_product_of_its_transfers(
    efficiency: str, transfers: int
) -> None:
    given_ = {
        "phase_per_transfer": _PHASES,
        "transfers": transfers,
        "efficiency": float(efficiency),
    }
    mtf, ptf = charge_transfer_mtf(**given_), charge_transfer_ptf(**given_)
    with mpmath.workdps(50):
        eps = mpmath.mpf(efficiency)
        for w, modulus, phase in zip(_PHASES, mtf, ptf, strict=True):
            one = eps / (1 - (1 - eps) * mpmath.expj(-mpmath.mpf(float(w))))
            truth = mpmath.exp(transfers * mpmath.log(abs(one)))
            assert modulus == pytest.approx(float(truth), rel=1e-11, abs=1e-300)
            truth_phase = float(transfers * mpmath.arg(one))
            assert phase == pytest.approx(truth_phase, rel=1e-13, abs=1e-300)


def test_published_and_leading_phases_keep_their_digits() -> None:
    for w in _PHASES:
        with mpmath.workdps(40):
            lost = mpmath.mpf("0.00001") * 640
            published = -lost * (mpmath.mpf(w) - mpmath.sin(mpmath.mpf(w)))
            leading = -lost * mpmath.sin(mpmath.mpf(w))
            modulus = mpmath.exp(-lost * (1 - mpmath.cos(mpmath.mpf(w))))
        given_ = {"phase_per_transfer": w, "transfers": 640, "efficiency": 0.99999}
        for model, truth in (("published", published), ("leading", leading)):
            ptf = charge_transfer_ptf(**given_, model=model)
            assert ptf == pytest.approx(float(truth), rel=1e-14, abs=1e-300)
            mtf = charge_transfer_mtf(**given_, model=model)
            assert mtf == pytest.approx(float(modulus), rel=1e-15)


@pytest.mark.parametrize("poles", [1, 2, 5])
def test_lowpass_equals_its_complex_form(poles: int) -> None:
    frequency = np.array([-3.0, -0.2, 0.0, 0.48892, 7.0])
    given_ = {"scan_velocity_mrad_per_s": 1000.0, "time_constant_s": 1e-4, "poles": poles}
    truth = (1.0 + 2j * np.pi * 0.1 * frequency) ** -poles
    mtf = lowpass_mtf(frequency=frequency, **given_)
    ptf = lowpass_ptf(frequency=frequency, **given_)
    np.testing.assert_allclose(mtf * np.exp(1j * ptf), truth, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize(
    ("fov", "samples", "rate", "bandwidth"),
    [(30.0, 512, 16.0, 49152.0), (25.0, 1024, 40.0, 294912.0)],
)
def test_published_bandwidths(fov: float, samples: int, rate: float, bandwidth: float) -> None:
    time = dwell_time_s(
        interval_mrad=interval_mrad(fov_deg=fov, samples=samples),
        scan_velocity_mrad_per_s=mirror_scan_velocity_mrad_per_s(scan_mirror_rate_Hz=rate),
    )
    assert noise_bandwidth_hz(time_constant_s=time) == pytest.approx(bandwidth, rel=1e-15)


def test_half_the_power_passes_at_the_corner() -> None:
    corner = 1 / (2 * np.pi * 2e-5)
    xi = corner_in_cyc_per_mrad(corner_Hz=corner, scan_velocity_mrad_per_s=500.0)
    mtf = lowpass_mtf(frequency=xi, scan_velocity_mrad_per_s=500.0, time_constant_s=2e-5)
    assert mtf**2 == pytest.approx(0.5, rel=1e-14)


@pytest.mark.parametrize("poles", [1, 3])
def test_post_filters_equal_their_complex_forms(poles: int) -> None:
    frequency = np.array([-3.0, -0.2, 0.0, 0.48892, 7.0])
    u = 1j * frequency / 0.5
    truth = {
        "none": 1.0 + 0.0 * u,
        "lowpass": (1 + u) ** -poles,
        "highpass": (u / (1 + u)) ** poles,
    }
    for kind, expected in truth.items():
        given_ = {"frequency": frequency, "kind": kind, "corner_cyc_per_mrad": 0.5, "poles": poles}
        otf = post_filter_mtf(**given_) * np.exp(1j * post_filter_ptf(**given_))
        np.testing.assert_allclose(otf, expected, rtol=0.0, atol=2e-15)


def test_boost_rises_to_its_gain_and_stays() -> None:
    mtf = post_filter_mtf(
        frequency=[0.0, 0.25, -0.25, 0.5, 9.0], kind="boost", corner_cyc_per_mrad=0.5, max_gain=3.0
    )
    np.testing.assert_allclose(mtf, [1.0, 2.0, 2.0, 3.0, 3.0], rtol=1e-15)


def test_periodic_pattern_equals_its_formula() -> None:
    x, y = np.linspace(-9.0, 9.0, 23), np.linspace(0.0, 5.0, 17)[:, np.newaxis]
    got = periodic_pattern(
        x_mrad=x,
        y_mrad=y,
        amplitude=2.0,
        xi=0.31,
        eta=-0.12,
        phase_rad=0.4,
        modulation=0.6,
        modulation_xi=0.02,
        modulation_eta=0.05,
        modulation_phase_rad=-1.0,
    )
    envelope = 1.0 + 0.6 * np.sin(2 * np.pi * (0.02 * x + 0.05 * y) - 1.0)
    truth = 2.0 * envelope * np.sin(2 * np.pi * (0.31 * x - 0.12 * y) + 0.4)
    np.testing.assert_allclose(got, truth, rtol=0.0, atol=2e-14)
