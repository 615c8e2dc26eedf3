"""Motion by its spectrum: against closed forms of a Gauss-Markov motion and moving points."""

import math

import mpmath
import numpy as np
import pytest

from core.physics.sampling.platform_motion import (
    WAVES,
    MotionSpectrum,
    between_exposures_mrad,
    exposure_mtf,
    motion_waves,
    within_exposure,
)


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
        waves = motion_waves(spectrum=spectrum, exposure_s=exposure, uniform=rng.random((3, WAVES)))
        shifts[draw] = [waves.centroid_mrad(time_s=t) for t in (0.0, 0.03, 1e6 + 0.03)]
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
