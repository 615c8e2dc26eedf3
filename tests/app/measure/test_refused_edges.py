"""Reasons why edges are not used, in words that the handbook has too."""

import numpy as np
import pytest

from app.handbook.example_figures import PAGES
from app.measure.measurement_text import refused_lines
from app.measure.measuring import Source, measure_pictures
from app.measure.picture_measurement import MeasuredFile
from core.physics.measurement.edge_search import find_edges
from edge_truth import gaussian_edge

SIZE = (96, 96)


def edge(angle_deg=6.0, **how):
    how = {"sigma": (0.6, 0.6), "shape": SIZE, "levels": (50.0, 200.0), "noise": 1.0, **how}
    return gaussian_edge(angle_deg=angle_deg, seed=3, **how)


def two_edges():
    """A dark bar, seven samples wide."""
    left, right = (edge(middle=(48.0 + away, 48.0), noise=0.0) for away in (-3.5, 3.5))
    return 200.0 - left + right + np.random.default_rng(2).standard_normal(SIZE)


def interlaced():
    picture = edge()
    picture[1::2] = np.roll(picture[1::2], 2, axis=1)
    return picture[:, 4:]


def uneven():
    """One side is striped, by half of the contrast."""
    stripes = 37.0 * np.sin(np.arange(SIZE[0]) / 3.0)[:, np.newaxis]
    return edge() + stripes * (edge(noise=0.0) - 50.0) / 150.0


@pytest.mark.parametrize(
    ("picture", "words"),
    [
        (np.clip(edge(), 60.0, 190.0), "clipped"),
        (edge(levels=(50.0, 62.0), noise=3.0, shape=(24, 96)), "too little contrast"),
        (edge(0.0), "not slanted enough"),
        (edge(0.5, middle=(92.5, 48.0)), "too close to the frame's border"),
        (two_edges(), "another edge too close"),
        (interlaced(), "interlaced"),
        (uneven(), "brightness or contrast varies along the edge"),
        (edge(sigma=(5.0, 5.0)), "the edge spread is wider than the clear area around the edge"),
    ],
)
def test_the_clearest_edge_is_refused(picture, words):
    seen = find_edges(picture=picture)
    assert seen
    assert not seen[0].used
    assert seen[0].why_not.partition(":")[0] == words
    assert words in (PAGES / "edge_pictures.md").read_text(encoding="utf-8")


def test_what_helps_is_named_where_no_edge_is_used():
    def lines(picture):
        file = MeasuredFile("p.npy", 1, "")
        return refused_lines(measure_pictures(Source((file,), [picture], *picture.shape)))

    told = ["1 not used: not slanted enough", "for advice, run imagechain handbook edge_pictures"]
    assert lines(edge(0.0)) == told
    both = np.concatenate([edge(0.0), edge()], axis=1)
    assert lines(both)
    assert told[1] not in lines(both)
