"""Edges that are found in a picture, and those that are refused with a reason."""

from __future__ import annotations

import numpy as np
import pytest

from core.physics.measurement.edges.edge_mtf import measure_edge
from core.physics.measurement.edges.edge_pooling import pooled_mtf
from core.physics.measurement.edges.edge_samples import edge_samples
from core.physics.measurement.edges.edge_search import find_edges
from edge_pictures import edge_mtf, edge_picture

FREQUENCY = np.linspace(0.0, 0.5, 26)


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


def test_mtf_of_the_edge_found():
    (edge,) = [edge for edge in find_edges(picture=noisy_edge()) if edge.used]
    measured = measure_edge(picture=noisy_edge(), edge=edge, frequency=FREQUENCY)
    truth = edge_mtf(FREQUENCY, 5.0, 0.6)
    assert np.max(np.abs(measured.mtf - truth)) < 0.02
    assert np.all(np.abs(measured.mtf - truth)[1:] < 4.0 * measured.sigma[1:])
    assert measured.mtf50 == pytest.approx(np.interp(-0.5, -truth, FREQUENCY), abs=0.005)
    across = pooled_mtf(edges=[measured], axis="x")
    assert across is not None
    assert across.edges == 1
    assert pooled_mtf(edges=[measured], axis="y") is None


def test_no_edge_in_noise_or_in_nothing():
    noise = np.random.default_rng(3).normal(50.0, 1.0, (120, 160))
    assert not [edge for edge in find_edges(picture=noise) if edge.used]
    assert find_edges(picture=np.full((64, 64), 7.0)) == ()
