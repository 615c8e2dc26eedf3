"""Pictures that were filtered after they were taken: what is said of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage

from app.measure.measurement_text import remarks
from app.measure.measuring import Source, measure_pictures
from app.measure.picture_measurement import MeasuredFile
from camera_scenes import box, turned
from oversampled_camera import Camera, take
from oversampled_scene import Scene, Shape

SCENE = Scene(
    background=3000,
    shapes=tuple(
        Shape(turned(box(46, 46), angle, middle), level)
        for angle, middle, level in ((11, (40, 42), 9000), (27, (140, 140), 7000))
    ),
)


@pytest.fixture(scope="module")
def taken():
    camera = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=50, read_e=30)
    return take(SCENE, camera, rows=192, columns=200, seed=1).picture


def measured(picture):
    return measure_pictures(Source((MeasuredFile("one", 1, ""),), [picture], *picture.shape))


def test_a_picture_as_it_is_has_nothing_against_it(taken):
    plain = measured(taken)
    assert plain.x is not None
    # Of the mean level's electrons, and the read noise.
    assert plain.noise.sigma == pytest.approx(np.sqrt(50 * taken.mean() + 30**2) / 50, rel=0.03)
    assert not any("sharpened" in line for line in remarks(plain))


@pytest.mark.parametrize("amount", [0.4, 1.0, 2.0])
def test_noise_of_a_sharpened_picture_is_withheld(taken, amount):
    picture = taken + amount * (taken - ndimage.gaussian_filter(taken, 1.0))
    sharpened = measured(picture)
    assert sharpened.noise is None
    assert "sharpened" in sharpened.noise_reason


def test_an_mtf_above_one_is_called_that_of_a_sharpened_picture(taken):
    picture = taken + 2.0 * (taken - ndimage.gaussian_filter(taken, 1.0))
    lines = remarks(measured(picture))
    assert any(line.startswith("the MTF across exceeds 1: the picture was") for line in lines)


@pytest.mark.parametrize("colour", ["green", "red"])
def test_a_mosaic_of_filters_that_was_filled_in_is_refused(taken, colour):
    kept, weights = np.zeros_like(taken), [[1, 2, 1], [2, 4, 2], [1, 2, 1]]
    kept[::2, ::2] = 1.0
    if colour == "green":
        kept[1::2, 1::2], weights = 1.0, [[0, 1, 0], [1, 4, 1], [0, 1, 0]]
    filled = ndimage.convolve(taken * kept, np.array(weights) / 4.0)
    result = measured(filled)
    assert result.x is None
    assert "interpolated (" in result.reason_x


def test_two_amplifiers_in_turn_are_no_mosaic(taken):
    """Noise that differs from column to column is the camera's own."""
    random = np.random.default_rng(2)
    picture = taken.copy()
    picture[:, ::2] += 2.0 * random.standard_normal(picture[:, ::2].shape)
    assert measured(picture).x is not None
