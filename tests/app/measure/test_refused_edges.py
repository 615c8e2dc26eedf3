"""Reasons why edges are not used: each kind in words, with what helps against it."""

import numpy as np
import pytest

from app.handbook.module_examples import PAGES
from app.measure.measurement_text import REFUSALS, refusal_of, refused_lines
from app.measure.measuring import Source, measure_pictures
from app.measure.picture_measurement import MeasuredFile
from core.physics.measurement.edges.edge_search import find_edges
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
    ("picture", "words", "helps"),
    [
        (np.clip(edge(), 60.0, 190.0), "clipped at black or white", "exposure"),
        (edge(levels=(50.0, 62.0), noise=3.0, shape=(24, 96)), "too little contrast", "light"),
        (edge(0.0), "not slanted enough", "5°"),
        (edge(0.5, middle=(92.5, 48.0)), "too close to the edge of the frame", "inside"),
        (two_edges(), "another edge too close", "larger areas"),
        (interlaced(), "interlaced", "rows alone"),
        (uneven(), "its brightness or contrast varies along its length", "even light"),
        (edge(sigma=(5.0, 5.0)), "the edge spread is wider", "larger areas"),
    ],
)
def test_the_clearest_edge_is_refused_with_what_helps(picture, words, helps):
    seen = find_edges(picture=picture)
    assert seen
    assert not seen[0].used
    refusal = refusal_of(seen[0].why_not)
    assert refusal.words.startswith(words)
    assert helps in refusal.helps


def test_what_helps_is_told_where_no_edge_is_used():
    def lines(picture):
        file = MeasuredFile("p.npy", 1, "")
        return refused_lines(measure_pictures(Source((file,), [picture], *picture.shape)))

    assert "1 not used: not slanted enough; what helps: an edge tilted" in lines(edge(0.0))[0]
    both = np.concatenate([edge(0.0), edge()], axis=1)
    assert lines(both)
    assert not [line for line in lines(both) if "what helps" in line]


def test_the_handbook_names_every_kind():
    page = (PAGES / "edge_pictures.md").read_text(encoding="utf-8")
    assert not [one.words for one in REFUSALS if one.words not in page]
