"""Pictures without noise, and ranges whose end is no value."""

import json

import pytest

from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import edges_in
from core.network.file import parse_network
from edge_truth import blur_network, gaussian_edge
from nodes.library import standard_library


def edge(noise, seed=1):
    return gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), points=6, noise=noise, seed=seed
    )


def test_an_edge_without_noise_is_fitted_as_one_with_little():
    (patch,) = edges_in(pictures=[edge(0.0)]).patches
    (other,) = edges_in(pictures=[edge(1e-3)]).patches
    assert len(patch.value) == len(other.value)
    assert patch.edge.angle_deg == pytest.approx(other.edge.angle_deg, abs=1e-3)


def test_zero_that_stands_for_an_empty_parameter_is_not_in_its_range():
    library = standard_library()
    network = parse_network(json.dumps(blur_network()), library=library)
    (free,) = free_parameters(["detector.fill_x=0:1"], network, library)
    assert 0.0 < free.low < 1e-9
    assert free.high == 1.0
