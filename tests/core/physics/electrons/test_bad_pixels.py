"""Maps of bad pixels: their number, kinds and clusters."""

import numpy as np
import pytest
from scipy import ndimage

from core.physics.detector.focal_plane_array import DEAD, HOT, bad_pixel_places


def made(rows, columns, percent, seed=1):
    """A map: 0 where a pixel is good."""
    generator = np.random.default_rng(seed)
    places, kinds = bad_pixel_places(
        rows=rows, columns=columns, percent=percent, generator=generator
    )
    assert len(np.unique(places)) == len(places) == len(kinds)
    drawn = np.zeros(rows * columns, np.uint8)
    drawn[places] = kinds
    return drawn.reshape(rows, columns)


@pytest.mark.parametrize(
    ("rows", "columns", "percent"),
    [
        (100, 120, 0.5), (64, 64, 10), (1, 7, 50), (1, 1, 100), (30, 20, 24.9), (8, 8, 0.0),
        (9, 9, 100),
    ],
)  # fmt: skip
def test_their_number_is_exact(rows, columns, percent):
    kinds = made(rows, columns, percent)
    assert kinds.shape == (rows, columns)
    assert np.count_nonzero(kinds) == round(percent / 100 * rows * columns)


def test_dead_and_hot_come_alike_and_some_in_clusters():
    kinds = made(512, 512, 0.4)
    dead, hot = np.count_nonzero(kinds == DEAD), np.count_nonzero(kinds == HOT)
    assert 0.35 < dead / (dead + hot) < 0.65
    labels, count = ndimage.label(kinds > 0)
    sizes = np.bincount(labels.ravel())[1:]
    assert 0.5 < np.count_nonzero(sizes == 1) / count < 0.85
    assert (sizes > 2).any()


def test_the_same_generator_gives_the_same_map():
    np.testing.assert_array_equal(made(50, 60, 2.0), made(50, 60, 2.0))
    assert (made(50, 60, 2.0) != made(50, 60, 2.0, seed=2)).any()
