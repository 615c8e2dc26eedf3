"""Errors of the noise from one picture, against what many pictures scatter by."""

import math

import numpy as np
import pytest

from core.physics.measurement.noise.picture_noise import noise_of_picture
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


def test_what_is_not_known_well_is_withheld_with_its_value():
    sensor = Sensor(gain=4.0, read_e=40.0)
    few = blurred(polygons(64, 72, (4000, 8000), seed=3), sigma=0.5)
    noise = noise_of_picture(picture=sensor.picture(few, seed=1))
    assert noise.sigma is None
    assert "at a confidence of 95 %; allowed: at most 3%" in noise.sigma_reason
    more = blurred(polygons(240, 320, (4000, 6000), seed=3), sigma=0.5)
    noise = noise_of_picture(picture=sensor.picture(more, seed=1))
    assert noise.sigma is not None
    assert noise.gain_e_per_dn is None
    assert "at a confidence of 99 %; allowed: at most 5%" in noise.gain_reason
