"""Errors of the noise from one picture, against what many pictures scatter by."""

import math

import numpy as np
import pytest
from scipy import special

from core.physics.measurement.noise.flat_blocks import flat_blocks, picture_blocks
from core.physics.measurement.noise.picture_noise import noise_of_picture
from core.physics.measurement.noise.variance_line import variance_line
from noisy_scenes import Sensor, blurred, polygons


def pulls_of(pictures, truth):
    """Departures of sigma from the truth over its errors."""
    noises = [noise_of_picture(picture=picture) for picture in pictures]
    return np.array([(noise.sigma - truth) / noise.sigma_error for noise in noises])


@pytest.mark.parametrize("levels", [(4000,), (4000, 1000, 9000, 2500)])
def test_sigma_has_no_bias_and_errors_that_hold(levels):
    clean = polygons(136, 176, levels, seed=3)
    scene = blurred(np.asarray(clean, float), sigma=0.5)
    sensor = Sensor(gain=4.0, read_e=40.0)
    pictures = (sensor.picture(scene, seed=seed) for seed in range(40))
    pulls = pulls_of(pictures, sensor.sigma(scene.mean()))
    # Standard errors of the mean and of the root mean square are 0.16 and 0.11.
    assert abs(pulls.mean()) < 0.4
    assert 0.7 < math.sqrt((pulls**2).mean()) < 1.3


def test_errors_hold_where_the_noise_differs_from_place_to_place():
    place = np.where(np.arange(240) < 120, 2.0, 5.0)
    random = np.random.default_rng(20)
    pictures = (300 + place * random.standard_normal((160, 240)) for _ in range(30))
    pulls = pulls_of(pictures, math.sqrt((4.0 + 25.0) / 2.0))
    assert abs(pulls.mean()) < 0.5
    assert 0.7 < math.sqrt((pulls**2).mean()) < 1.3


def test_levels_at_which_nearly_all_has_structure_do_not_count():
    random = np.random.default_rng(21)
    down = across = 20
    level = random.uniform(3000, 5000, (down, across))
    strength = 20 * 10 ** random.uniform(-0.3, 1.0, (down, across))
    ripple = np.cos(np.pi * 2 * (np.arange(8) + 0.5) / 8)
    # A fifth of these ripples is lost in the noise.
    clutter = np.kron(level, np.ones((8, 8))) + np.kron(strength, np.outer(ripple, ripple))
    scene = np.hstack([np.full((8 * down, 8 * across), 1000.0), clutter])
    picture = scene + 20 * random.standard_normal(scene.shape)
    flat = flat_blocks(blocks=picture_blocks(picture=picture), at=1000.0)
    chosen = flat.chosen.reshape(down, 2 * across)
    assert chosen[:, :across].mean() > 0.95
    assert chosen[:, across:].mean() < 0.06


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
    assert "at a confidence of 95 %; allowed: at most 3%" in noise.sigma_reason
    more = blurred(polygons(240, 320, (4000, 6000), seed=3), sigma=0.5)
    noise = noise_of_picture(picture=sensor.picture(more, seed=1))
    assert noise.sigma is not None
    assert noise.gain_e_per_dn is None
    assert "at a confidence of 99 %; allowed: at most 5%" in noise.gain_reason
