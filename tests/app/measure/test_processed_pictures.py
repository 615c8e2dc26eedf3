"""Pictures that were filtered after they were taken: what is said of them."""

import json

import numpy as np
import pytest
from scipy import ndimage

from app.measure.measurement_page import measurement_json, measurement_page
from app.measure.measurement_text import remarks, with_error
from app.measure.measuring import Source, measure_pictures
from app.measure.picture_measurement import MeasuredFile
from camera_scenes import box, turned
from core.physics.measurement.edge_search import find_edges
from oversampled_camera import Camera, half_plane, take
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


@pytest.mark.parametrize("amount", [0.4, 2.0])
def test_noise_of_a_sharpened_picture_is_withheld(taken, amount):
    picture = taken + amount * (taken - ndimage.gaussian_filter(taken, 1.0))
    sharpened = measured(picture)
    assert sharpened.noise is None
    assert "sharpened" in sharpened.noise_reason


def test_an_mtf_above_one_is_called_that_of_a_sharpened_picture(taken):
    picture = taken + 2.0 * (taken - ndimage.gaussian_filter(taken, 1.0))
    lines = remarks(measured(picture))
    assert any(
        line.startswith("warning: the horizontal MTF exceeds 1: the picture was") for line in lines
    )


@pytest.mark.parametrize("colour", ["green", "red"])
def test_a_mosaic_of_filters_that_was_filled_in_is_measured_with_a_warning(taken, colour):
    kept, weights = np.zeros_like(taken), [[1, 2, 1], [2, 4, 2], [1, 2, 1]]
    kept[::2, ::2] = 1.0
    if colour == "green":
        kept[1::2, 1::2], weights = 1.0, [[0, 1, 0], [1, 4, 1], [0, 1, 0]]
    filled = ndimage.convolve(taken * kept, np.array(weights) / 4.0)
    result = measured(filled)
    assert 0.1 < result.x.mtf50 < measured(taken).x.mtf50
    assert result.noise is None
    assert "interpolated" in result.noise_reason
    assert any(line.startswith("warning: one: interpolated: ") for line in remarks(result))
    # A fit of the camera's own blur is not for such a picture.
    seen = find_edges(picture=filled)
    assert not any(edge.used for edge in seen)
    assert any(edge.why_not.startswith("interpolated: ") for edge in seen)


def test_one_edge_has_one_error():
    camera = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=50, read_e=30)
    picture = take(half_plane(9.0, (60, 50), 3000, 9000), camera, rows=100, columns=120).picture
    result = measured(picture)
    (edge,) = [edge for edge in result.edges if edge.used]
    assert edge.mtf50_sigma == pytest.approx(result.x.mtf50_sigma, rel=1e-9)
    text = with_error(result.x.mtf50, result.x.mtf50_sigma)
    assert measurement_page(result).count(text) == 2
    (written,) = [one for one in json.loads(measurement_json(result))["edges"] if one["used"]]
    assert written["sigma"] == pytest.approx(result.x.mtf50_sigma, rel=1e-9)
