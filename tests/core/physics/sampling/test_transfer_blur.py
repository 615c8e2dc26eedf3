"""Gaussian, detector, motion and vibration transfer functions against independent truth."""

import math

import mpmath
import numpy as np
import pytest

from core.physics.numerics import sinc
from core.physics.optics.veiling_glare import fwhm_to_sigma_mrad, gaussian_mtf
from core.physics.sampling.detector_sampling import (
    interval_mrad,
    nyquist_cyc_per_mrad,
)
from core.physics.sampling.platform_motion import (
    blur_mrad,
    line_motion_mtf,
    scan_blur_mrad,
    vibration_mtf,
    vibration_otf,
)


def test_sinc_keeps_relative_accuracy_next_to_its_zeros() -> None:
    for x in (1e-9, 0.3, 0.999999999, 1.000000001, -2.0000001, 7.5, 12345.000001):
        with mpmath.workdps(40):
            truth = float(mpmath.sincpi(mpmath.mpf(x)))
        assert sinc(x) == pytest.approx(truth, rel=1e-14, abs=0.0)


def test_sinc_is_exact_at_integers_and_infinity() -> None:
    assert sinc(0.0) == 1.0
    np.testing.assert_array_equal(sinc([1.0, -2.0, 3e5, 1e20, np.inf, -np.inf]), 0.0)


def test_smear_equals_the_mean_of_displaced_points() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(60)
    bx, by, xi, eta = 0.8, -1.7, 2.3, 1.1
    phase = 2.0 * np.pi * 0.5 * nodes * (bx * xi + by * eta)
    truth = 0.5 * np.sum(weights * np.cos(phase))
    got = line_motion_mtf(xi=xi, eta=eta, blur_x_mrad=bx, blur_y_mrad=by)
    assert got == pytest.approx(truth, abs=1e-14)


def test_half_maximum_lies_at_half_the_full_width() -> None:
    sigma = fwhm_to_sigma_mrad(fwhm_mrad=0.3)
    assert math.exp(-0.5 * (0.15 / sigma) ** 2) == pytest.approx(0.5, rel=1e-15)


def test_gaussian_equals_the_transform_of_its_spread() -> None:
    x = np.linspace(-6.0, 6.0, 4001)  # trapezoid on a Gaussian converges beyond rounding
    spread = np.exp(-0.5 * (x / 0.5) ** 2)
    for frequency in (0.1, 0.48892, 1.3):
        truth = np.sum(spread * np.cos(2 * np.pi * frequency * x)) / np.sum(spread)
        got = gaussian_mtf(frequency=frequency, sigma_mrad=0.5)
        assert got == pytest.approx(truth, abs=2e-15)


def _vibration_truth(size: float, periods: float) -> complex:
    """Mean over the exposure by direct quadrature, a panel for each radian of phase."""
    panels = max(2, math.ceil(4.0 * periods * (1.0 + size)))
    edges = [2.0 * math.pi * periods * k / panels for k in range(panels + 1)]
    with mpmath.workdps(20):
        total = mpmath.quad(lambda t: mpmath.expj(-size * mpmath.sin(t)), edges, maxdegree=5)
        return complex(total / edges[-1])


@pytest.mark.parametrize("periods", [1e-9, 0.2501, 0.5, 1.3, 2.75])
@pytest.mark.parametrize("size", [0.3, 33.0])
def test_vibration_equals_its_time_average(size: float, periods: float) -> None:
    given_ = {
        "frequency": np.array([1.0, -1.0]),
        "amplitude_mrad": size / (2.0 * math.pi),
        "vibration_frequency_Hz": 100.0 * periods,
        "integration_time_s": 0.01,
    }
    truth = _vibration_truth(size, periods)
    otf = vibration_otf(**given_)
    assert abs(otf[0] - truth) < 2e-14
    assert otf[1] == otf[0].conjugate()
    np.testing.assert_allclose(vibration_mtf(**given_), abs(truth), rtol=0.0, atol=2e-14)


@pytest.mark.parametrize(("rate", "time"), [(30.0, 0.1), (100.0, 0.29), (7.0, 1.0), (1e17, 0.3)])
def test_whole_periods_give_the_signed_bessel_function(rate: float, time: float) -> None:
    mtf = vibration_mtf(
        frequency=[2.0], amplitude_mrad=0.2, vibration_frequency_Hz=rate, integration_time_s=time
    )
    assert mtf[0] == pytest.approx(float(mpmath.besselj(0, 0.8 * mpmath.pi)), rel=1e-13)


def test_motion_widths() -> None:
    assert blur_mrad(velocity_m_per_s=-4.0, time_s=0.5, range_m=1000.0) == -2.0
    assert scan_blur_mrad(scan_velocity_mrad_per_s=500.0, dwell_time_s=0.002) == 1.0


def test_sampling_of_a_detector() -> None:
    interval = interval_mrad(fov_deg=30.0, samples=512)
    assert nyquist_cyc_per_mrad(interval_mrad=interval) == pytest.approx(0.488924, abs=1e-6)
    assert interval_mrad(fov_deg=1e-6, samples=512) > 0.0
