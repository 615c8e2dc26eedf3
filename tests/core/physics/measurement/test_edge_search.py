"""Edges that are found in a picture, and those that are refused with a reason."""

import math

import numpy as np
import pytest
from scipy.special import erf

from core.physics.measurement.edge_search import _medians, find_edges
from core.physics.measurement.found_edge import FoundEdge, edge_samples, without_those_at
from core.physics.measurement.ridges import spread_out
from edge_pictures import edge_picture
from edge_truth import gaussian_edge


def noisy_edge(angle=5.0, sigma=0.6, low=48.0, contrast=8.0, noise=0.05, size=(90, 90)):
    picture = low + contrast * edge_picture(angle, sigma, size)
    return picture + np.random.default_rng(17).normal(0.0, noise, size)


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_one_edge_in_each_direction(turns):
    """`edge_picture` has its normal 5° from the rows, to the right and upwards."""
    picture = np.rot90(noisy_edge(), -turns)
    (edge,) = [edge for edge in find_edges(picture=picture) if edge.used]
    assert abs((edge.angle_deg - (90.0 * turns - 5.0) + 180.0) % 360.0 - 180.0) < 0.1
    assert edge.length > 60.0
    assert (edge.low, edge.high) == pytest.approx((48.0, 56.0), abs=0.02)
    assert edge.noise_sigma == pytest.approx(0.05, rel=0.1)
    samples = edge_samples(picture=picture, edge=edge)
    bright = samples.distance > 3.0
    assert np.mean(samples.value[bright]) == pytest.approx(56.0, abs=0.02)
    assert np.max(np.abs(samples.distance)) <= edge.reach


def refused(picture, **settings):
    """Why the strongest candidate is not used; there must be none that is."""
    edges = find_edges(picture=picture, **settings)
    assert not [edge for edge in edges if edge.used]
    return edges[0].why_not


def test_clipped_edge():
    """Noise about a level that is the limit is cut off in half of the samples."""
    picture = noisy_edge()
    assert refused(picture.clip(48.0, 56.0)).startswith("clipped: ")
    assert refused(np.minimum(picture, 55.5)).startswith(
        "clipped: 100 % of the samples on one side"
    )
    both = noisy_edge(noise=0.1).clip(49.0, 55.0)  # no noise is left on either side
    assert refused(both).startswith("clipped: the samples beside the edge")
    assert find_edges(picture=noisy_edge(noise=0.0))[0].used
    assert refused(picture, clip_levels=(0.0, 56.0)).startswith("clipped: ")
    assert find_edges(picture=picture, clip_levels=(40.0, 60.0))[0].used


@pytest.mark.parametrize(("edges", "used"), [(6, 0), (7, 5)])
def test_a_limit_holds_for_others_where_three_of_ten_edges_that_reach_it_show_it(edges, used):
    picture = np.tile(np.repeat([0.0, 255.0], 10), (20, edges))
    clipped = ["clipped: noise"] * 2 + [""] * (edges - 2)
    found = [
        FoundEdge(20.0 * n + 9.5, 9.5, 0.0, 16.0, 8.0, 0.0, 255.0, 1.0, why)
        for n, why in enumerate(clipped)
    ]
    left = without_those_at(edges=found, picture=picture, extremes=(0.0, 255.0))
    assert sum(edge.used for edge in left) == used


def test_edge_along_the_columns_cannot_be_supersampled():
    picture = np.repeat(noisy_edge(angle=0.0)[:1], 90, axis=0)
    picture += np.random.default_rng(1).normal(0.0, 0.05, picture.shape)
    assert refused(picture).startswith("not slanted enough: ")


def test_neighbouring_edge():
    """A bar of 4 samples: no side is level between its edges."""
    bar = noisy_edge() - np.roll(noisy_edge(), 4, axis=1)
    assert refused(bar[:, 10:-10])


def test_disc():
    """Of radius 12: what bends so much within its reach is no straight edge."""
    y, x = np.mgrid[-40:41, -40:41]
    disc = 50.0 + 4.0 * np.clip(12.5 - np.hypot(x, y), 0.0, 1.0)
    disc += np.random.default_rng(2).normal(0.0, 0.02, disc.shape)
    assert not [edge for edge in find_edges(picture=disc) if edge.used]


def test_little_contrast():
    assert not [edge for edge in find_edges(picture=noisy_edge(noise=3.0)) if edge.used]


def test_a_side_that_falls_below_the_other_has_no_contrast_in_figures():
    """Without noise, how many times the noise it is would be a number without end."""
    y, x = np.mgrid[0:96, 0:96].astype(float)
    away = (x - 48.3) * math.cos(0.1) + (y - 48.0) * math.sin(0.1)
    beyond = np.clip(away, 0.0, None)
    picture = 125.0 + 25.0 * erf(away / 0.9) - 80.0 * (1.0 - np.exp(-beyond / 2.0))
    reasons = [edge.why_not for edge in find_edges(picture=picture)]
    assert any("no brighter than the dark side" in reason for reason in reasons)
    assert not any("e+" in reason for reason in reasons)


def test_soft_edge_beside_a_sharp_one():
    picture = np.vstack([noisy_edge(sigma=0.5), noisy_edge(sigma=3.0)])
    edges = find_edges(picture=picture)
    assert [edge.y < 90 for edge in edges if edge.used] == [True]
    assert [edge for edge in edges if edge.y > 90 and edge.why_not.startswith("soft in the scene")]


@pytest.mark.parametrize(
    ("contrast", "copies", "used"),
    [(1.0, 1, 0), (8.0, 1, 1), (1.0, 2, 2)],
    ids=["a faint one alone", "as strong", "two faint ones alike"],
)
def test_a_soft_edge_of_a_direction_of_its_own(contrast, copies, used):
    """Motion blurs one direction; a faint edge alone may as well be soft in the scene."""
    along = np.rot90(noisy_edge(sigma=1.6, contrast=contrast, low=48.0))
    picture = np.vstack([noisy_edge(sigma=0.5), *[along] * copies])
    found = [edge for edge in find_edges(picture=picture) if abs(abs(edge.angle_deg) - 90.0) < 20]
    assert sum(edge.used for edge in found) == used
    soft = [edge for edge in found if edge.why_not.startswith("soft in the scene")]
    assert bool(soft) == (used == 0)


def test_interlaced_picture():
    """Odd rows half a sample to the right."""
    picture = noisy_edge(noise=0.0)
    picture[1::2] = (picture[1::2] + np.roll(picture[1::2], 1, axis=1)) / 2.0
    picture = picture[:, 2:] + np.random.default_rng(1).normal(0.0, 0.05, picture[:, 2:].shape)
    reason = refused(picture)
    assert reason.startswith("interlaced: the odd rows are shifted by ")
    assert float(reason.split()[7]) == pytest.approx(0.5, abs=0.1)


def test_compressed_picture(tmp_path):
    from PIL import Image

    def saved(**settings):
        picture = np.rint(noisy_edge(low=60.0, contrast=120.0, noise=2.0, size=(120, 120)))
        Image.fromarray(picture.astype(np.uint8)).save(tmp_path / "edge.jpg", **settings)
        return np.asarray(Image.open(tmp_path / "edge.jpg"), np.float64)

    assert "JPEG" in refused(saved(quality=60))


@pytest.mark.parametrize("number", [0.0, -9999.0, 255.0])
@pytest.mark.parametrize("whole", [False, True])
def test_samples_without_data_judge_no_edge(number, whole):
    """A corner of one number, sharper than any blur: the edge is used as without it."""
    picture = noisy_edge(low=60.0, contrast=120.0, noise=2.0, size=(120, 160))
    y, x = np.mgrid[:120, :160]
    picture[x + 2 * y < 60] = number
    if whole:
        picture = np.rint(picture)
    limits = (0.0, 255.0) if whole else None
    edges = find_edges(picture=picture, clip_levels=limits)
    assert len([edge for edge in edges if edge.used]) == 1
    assert not [edge for edge in edges if edge.x + 2 * edge.y < 70]


def test_edges_of_which_none_can_be_used_are_not_enough():
    """A grid along the samples: of 400 that were looked at none is slanted."""
    y, x = np.mgrid[:360, :360]
    picture = 50.0 + 40.0 * (((x // 15) + (y // 15)) % 2)
    edges = find_edges(picture=picture + np.random.default_rng(3).normal(0.0, 0.5, picture.shape))
    assert not any(edge.used for edge in edges)
    assert [edge for edge in edges if "no stronger edge can be used" in edge.why_not]
    assert not [edge for edge in edges if "are enough" in edge.why_not]


def test_no_edge_in_noise_or_in_nothing():
    noise = np.random.default_rng(3).normal(50.0, 1.0, (120, 160))
    assert not [edge for edge in find_edges(picture=noise) if edge.used]
    assert find_edges(picture=np.full((64, 64), 7.0)) == ()


def test_enough_edges_of_a_chart_with_many():
    """A chart of 192 edges: 48 of them, of both directions, in all parts of the frame."""
    y, x = np.mgrid[0:270, 0:360]
    across, down = (math.cos(math.radians(6.0)) * a + b for a, b in ((x, 0.1 * y), (y, -0.1 * x)))
    waves = [18.0 * np.sin(np.pi * place / 27.0) for place in (across, down)]
    picture = 100.0 + 40.0 * np.tanh(waves[0]) * np.tanh(waves[1])
    looked_at = []
    edges = find_edges(
        picture=picture + np.random.default_rng(3).normal(0.0, 0.5, picture.shape),
        check=lambda: looked_at.append(1),
    )
    used = [edge for edge in edges if edge.used]
    assert len(used) == 48
    assert len(looked_at) < 80  # what is not examined takes no time
    assert {edge.why_not for edge in edges[48:] if "not examined" in edge.why_not} == {
        "not examined: 48 stronger or better separated edges are enough"
    }
    for axis in (0.0, 90.0):
        near = [e for e in used if abs((e.angle_deg - axis + 90.0) % 180.0 - 90.0) < 10.0]
        parts = {(e.x > 180.0, e.y > 135.0) for e in near}
        assert len(near) >= 16
        assert len(parts) == 4


def test_lines_in_turn():
    """The strongest first, one that is weak but alone before the third of a crowd."""
    order = spread_out(
        x=np.array([10.0, 11.0, 12.0, 90.0, 13.0]),
        y=np.full(5, 50.0),
        angle_deg=np.array([0.0, 5.0, 184.0, 0.0, 90.0]),
        merit=np.array([9.0, 10.0, 8.0, 4.0, 1.0]),
        shape=(100, 100),
    )
    assert order.tolist() == [1, 0, 3, 2, 4]


def test_a_soft_edge_without_noise_is_not_clipped_where_its_sides_are_level():
    """Its tail varies beside it, and beyond that every sample has the level's single number."""
    picture = gaussian_edge(angle_deg=5.0, sigma=(1.8, 1.8), shape=(128, 128), levels=(40.5, 47.3))
    (edge,) = find_edges(picture=picture.astype(np.float32).astype(float))
    assert (edge.used, edge.why_not) == (True, "")


@pytest.mark.parametrize("seed", range(4))
def test_medians_over_cells_of_the_means_at_each_distance(seed):
    """Against sums by hand; also of cells and distances without a sample, odd and even counts."""
    random, (cells, size) = np.random.default_rng(seed), (5 + seed, 7)
    cell, distance = random.integers(0, cells, 60), random.integers(0, size - 1, 60)
    value = random.normal(10.0, 1.0, 60)
    expected = []
    for place in range(size):
        own = [value[(cell == one) & (distance == place)] for one in range(cells)]
        known = [one.mean() for one in own if len(one)]
        expected.append(np.median(known) if known else np.median(value))
    found = _medians(cell * size + distance, value, cells, size)
    np.testing.assert_allclose(found, expected, rtol=1e-13)
