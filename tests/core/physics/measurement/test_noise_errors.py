"""Errors of the noise from one picture, against what many pictures scatter by."""

import math

import numpy as np
import pytest
from scipy import special

from core.physics.measurement.flat_blocks import variance_line
from core.physics.measurement.picture_noise import noise_of_picture
from noisy_scenes import Sensor, blurred, polygons


def pulls_of(pictures, truth):
    """Departures of sigma from the truth over its errors."""
    noises = [noise_of_picture(picture=picture) for picture in pictures]
    return np.array([(noise.sigma - truth) / noise.sigma_error for noise in noises])


@pytest.mark.parametrize("levels", [(4000, 1000, 9000, 2500)])
def test_sigma_has_no_bias_and_errors_that_hold(levels):
    clean = polygons(136, 176, levels, seed=3)
    scene = blurred(np.asarray(clean, float), sigma=0.5)
    sensor = Sensor(gain=4.0, read_e=40.0)
    pictures = (sensor.picture(scene, seed=seed) for seed in range(40))
    pulls = pulls_of(pictures, sensor.sigma(scene.mean()))
    # Standard errors of the mean and of the root mean square are 0.16 and 0.11.
    assert abs(pulls.mean()) < 0.4
    assert 0.7 < math.sqrt((pulls**2).mean()) < 1.3


def variance_of_rounded(level, sigma):
    """Variance of a normal deviate rounded to whole numbers, by a sum over them."""
    whole = np.arange(math.floor(level - 12), math.ceil(level + 12))
    ends = special.ndtr((np.append(whole, whole[-1] + 1) - 0.5 - level) / sigma)
    share = np.diff(ends)
    mean = share @ whole
    return share @ (whole - mean) ** 2


@pytest.mark.parametrize("sigma", [0.5, 0.6])
def test_error_by_rounding_beyond_a_twelfth(sigma):
    phases = np.arange(50) / 50
    beyond = [variance_of_rounded(10 + phase, sigma) - sigma**2 - 1 / 12 for phase in phases]
    expected = math.sqrt(np.mean(np.square(beyond)))
    level = np.repeat([10.0, 30.0], 50)
    variance = np.full(100, sigma**2 + 1 / 12)
    line = variance_line(level=level, variance=variance).rounded(level=level, step=1.0)
    assert line.middle_error == pytest.approx(expected, rel=0.05)
    assert line.slope_error == pytest.approx(expected / 10.0, rel=0.05)
    twice = variance_line(level=2 * level, variance=4 * variance)
    assert twice.rounded(level=2 * level, step=2.0).middle_error == pytest.approx(
        4 * expected, rel=0.05
    )


def test_what_is_not_known_well_is_withheld_with_its_value():
    sensor = Sensor(gain=4.0, read_e=40.0)
    few = blurred(polygons(64, 72, (4000, 8000), seed=3), sigma=0.5)
    noise = noise_of_picture(picture=sensor.picture(few, seed=1))
    assert noise.sigma is None
    assert "at 95 % confidence; allowed: at most 3%" in noise.sigma_reason
    more = blurred(polygons(240, 320, (4000, 6000), seed=3), sigma=0.5)
    noise = noise_of_picture(picture=sensor.picture(more, seed=1))
    assert noise.sigma is not None
    assert noise.gain_e_per_dn is None
    assert "at 99 % confidence; allowed: at most 5%" in noise.gain_reason
