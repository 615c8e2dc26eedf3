"""A line scanner's geometry by hand, and the blend of scales on polynomials."""

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.numerics import sinc
from core.physics.sampling.platform_motion import (
    WAVES,
    MotionSpectrum,
    between_exposures_mrad,
    exposure_mtf,
    line_intervals_mrad,
    motion_waves,
    scale_nodes_mrad,
    scale_weights,
    vibration_mtf,
    vibration_otf,
    view_angles_rad,
    within_exposure,
)

IN_FLIGHT = np.array([0.5, 0.6, 0.8, 1.0, 0.9, 0.7, 0.4])


def test_view_angles_are_equal_steps_about_nadir():
    found = view_angles_rad(columns=4, interval_mrad=200.0)
    np.testing.assert_allclose(found, [-0.3, -0.1, 0.1, 0.3], rtol=0, atol=1e-16)
    assert view_angles_rad(columns=1, interval_mrad=5e3) == [0.0]


def test_lines_close_up_with_the_range():
    """At 60° the ground is twice as far as at nadir: 3 m are 3 mrad and 1.5 mrad at 1000 m."""
    found = line_intervals_mrad(
        line_spacing_m=3.0, altitude_m=1000.0, view_angle_rad=[0.0, math.pi / 3, -math.pi / 3]
    )
    np.testing.assert_allclose(found, [3.0, 1.5, 1.5], rtol=1e-15)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_weights_are_exact_for_polynomials_of_the_scale(count):
    nodes = scale_nodes_mrad(intervals_mrad=IN_FLIGHT, count=count)
    assert len(set(nodes)) == count
    assert IN_FLIGHT.min() <= nodes.min() <= nodes.max() <= IN_FLIGHT.max()
    weights = scale_weights(nodes_mrad=nodes, intervals_mrad=IN_FLIGHT)
    for power in range(count):
        np.testing.assert_allclose(
            nodes**-power @ weights, IN_FLIGHT**-power, rtol=1e-12, err_msg=str(power)
        )


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: view_angles_rad(columns=4, interval_mrad=-1.0), "interval_mrad"),
        (lambda: view_angles_rad(columns=3, interval_mrad=1571.0), "interval_mrad"),
        (
            lambda: line_intervals_mrad(line_spacing_m=1, altitude_m=1, view_angle_rad=1.6),
            "view_angle_rad",
        ),
        (
            lambda: line_intervals_mrad(line_spacing_m=0, altitude_m=1, view_angle_rad=0),
            "line_spacing_m",
        ),
        (
            lambda: view_angles_rad(columns=3, interval_mrad=500.0, look_angle_rad=1.1),
            "look_angle_rad",
        ),
    ],
)
def test_bad_geometry_is_refused(call, told):
    with pytest.raises(ParameterError, match=told):
        call()


# Motion by its spectrum: against closed forms of a Gauss-Markov motion and moving points.


def markov(rms, corner, exposure, place):
    """Closed forms of covariance rms²·exp(−2π·corner·|τ|): Var of the mean, and about it.

    `place` is the time from the start of the exposure over its length.
    """
    with mpmath.workdps(40):
        a = 2 * mpmath.pi * mpmath.mpf(corner) * mpmath.mpf(exposure)
        mean = 2 * (a - 1 + mpmath.exp(-a)) / a**2
        both = (2 - mpmath.exp(-a * place) - mpmath.exp(-a * (1 - place))) / a
        return float(rms**2 * mean), float(rms**2 * (1 + mean - 2 * both))


@pytest.mark.parametrize("corner", [0.001, 0.3, 5.0, 80.0, 3000.0])
def test_variances_are_those_of_the_gauss_markov_motion(corner):
    spectrum, exposure = MotionSpectrum(0.2, corner), 0.02
    nodes, _ = np.polynomial.legendre.leggauss(24)
    found, weights = within_exposure(spectrum=spectrum, exposure_s=exposure)
    for node, variance in zip(nodes, found, strict=True):
        _, expected = markov(0.2, corner, exposure, 0.5 + 0.25 * (1 + node))
        assert variance == pytest.approx(expected, rel=2e-3, abs=1e-6 * 0.2**2)
    mean, _ = markov(0.2, corner, exposure, 0.5)
    between = between_exposures_mrad(spectrum=spectrum, exposure_s=exposure)
    assert between**2 == pytest.approx(mean, rel=1e-4)
    assert between**2 + np.dot(found, weights) == pytest.approx(0.2**2, rel=1e-3)
    assert math.fsum(weights) == pytest.approx(1.0)


@pytest.mark.parametrize("corner", [60.0])
def test_the_mtf_is_the_time_average_of_a_moving_point(corner):
    """A motion drawn step by step: the mean of exp(−2πi·ξ·(θ − centroid)) over many exposures."""
    rng, steps, exposures, length, rms = np.random.default_rng(4), 400, 6000, 0.02, 0.3
    keep = math.exp(-2 * math.pi * corner * length / steps)
    position = rms * rng.standard_normal(exposures)
    path = np.empty((steps + 1, exposures))
    path[0] = position
    for step in range(1, steps + 1):
        path[step] = keep * path[step - 1] + rms * math.sqrt(1 - keep**2) * rng.standard_normal(
            exposures
        )
    share = np.full(steps + 1, 1.0 / steps)
    share[[0, -1]] /= 2
    path -= share @ path
    variances, weights = within_exposure(spectrum=MotionSpectrum(rms, corner), exposure_s=length)
    for frequency in (0.3, 1.0, 2.5):
        seen = share @ np.exp(-2j * np.pi * frequency * path)
        expected = float(exposure_mtf(frequency=frequency, variances=variances, weights=weights))
        error = seen.real.std() / math.sqrt(exposures)
        assert seen.real.mean() == pytest.approx(expected, abs=4 * error + 1e-3)


def test_shifts_have_the_covariance_of_the_spectrum():
    """Over many draws: the variance at any time, and what two frames have in common."""
    spectrum, exposure, rms, corner = MotionSpectrum(0.4, 3.0), 0.01, 0.4, 3.0
    rng, draws = np.random.default_rng(8), 1500
    shifts = np.empty((draws, 3))
    for draw in range(draws):
        centroid = motion_waves(
            spectrum=spectrum, exposure_s=exposure, uniform=rng.random((3, WAVES))
        )
        shifts[draw] = [centroid(t) for t in (0.0, 0.03, 1e6 + 0.03)]
    mean, _ = markov(rms, corner, exposure, 0.5)
    a = 2 * math.pi * corner
    # The mean of the covariance over both exposures, which do not overlap.
    common = rms**2 * math.exp(-a * 0.03) * (math.sinh(a * exposure / 2) / (a * exposure / 2)) ** 2
    scatter = 4.0 / math.sqrt(draws)
    assert np.var(shifts[:, 0]) == pytest.approx(mean, rel=scatter * math.sqrt(2))
    assert np.var(shifts[:, 2]) == pytest.approx(mean, rel=scatter * math.sqrt(2))
    assert np.mean(shifts[:, 0] * shifts[:, 1]) == pytest.approx(common, abs=scatter * mean)
    assert abs(np.mean(shifts[:, 0] * shifts[:, 2])) < scatter * mean


def test_points_are_a_power_of_the_frequency_between_them():
    """S = f^-2 from 1 to 100 Hz and f^-1 up to 1000: its integral is 0.99 + 0.01·ln 10."""
    points = ((1.0, 1.0), (100.0, 1e-4), (1000.0, 1e-5))
    spectrum = MotionSpectrum(points=points)
    total = between_exposures_mrad(spectrum=spectrum, exposure_s=0.0) ** 2
    assert total == pytest.approx(0.99 + 0.01 * math.log(10), rel=1e-9)
    variances, weights = within_exposure(spectrum=spectrum, exposure_s=0.05)
    between = between_exposures_mrad(spectrum=spectrum, exposure_s=0.05)
    assert np.dot(variances, weights) + between**2 == pytest.approx(total, rel=1e-4)


# Gaussian, detector, motion and vibration transfer functions against independent truth.


def test_sinc_keeps_relative_accuracy_next_to_its_zeros():
    for x in (1e-9, 0.3, 0.999999999, 1.000000001, -2.0000001, 7.5, 12345.000001):
        with mpmath.workdps(40):
            truth = float(mpmath.sincpi(mpmath.mpf(x)))
        assert sinc(x) == pytest.approx(truth, rel=1e-14, abs=0.0)


def test_sinc_is_exact_at_integers_and_infinity():
    assert sinc(0.0) == 1.0
    np.testing.assert_array_equal(sinc([1.0, -2.0, 3e5, 1e20, np.inf, -np.inf]), 0.0)


def _vibration_truth(size, periods):
    """Mean over the exposure by direct quadrature, a panel for each radian of phase."""
    panels = max(2, math.ceil(4.0 * periods * (1.0 + size)))
    edges = [2.0 * math.pi * periods * k / panels for k in range(panels + 1)]
    with mpmath.workdps(20):
        total = mpmath.quad(lambda t: mpmath.expj(-size * mpmath.sin(t)), edges, maxdegree=5)
        return complex(total / edges[-1])


@pytest.mark.parametrize("periods", [1e-9, 0.2501, 0.5, 1.3, 2.75])
@pytest.mark.parametrize("size", [0.3, 33.0])
def test_vibration_equals_its_time_average(size, periods):
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
def test_whole_periods_give_the_signed_bessel_function(rate, time):
    mtf = vibration_mtf(
        frequency=[2.0], amplitude_mrad=0.2, vibration_frequency_Hz=rate, integration_time_s=time
    )
    assert mtf[0] == pytest.approx(float(mpmath.besselj(0, 0.8 * mpmath.pi)), rel=1e-13)
