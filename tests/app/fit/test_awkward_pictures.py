"""Pictures without noise, given twice, or of two levels; and ranges whose end is no value."""

import json

import numpy as np
import pytest

from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import edges_in
from app.measure.measurement_files import measurement_json
from app.measure.measurement_text import remarks
from app.measure.measuring import MeasurePlan, measure_files
from core.network.parsing import parse_network
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


def test_a_picture_given_again_is_counted_once(tmp_path):
    picture = edge(20.0)
    np.save(tmp_path / "one.npy", picture)
    np.save(tmp_path / "three.npy", np.stack([picture] * 3))
    once = measure_files(MeasurePlan((tmp_path / "one.npy",)))
    again = measure_files(MeasurePlan((tmp_path / "one.npy", tmp_path / "three.npy")))
    # Copies say nothing more: the errors are those of one.
    assert once.x.mtf50_sigma == again.x.mtf50_sigma
    assert len(once.edges) == len(again.edges)
    assert once.noise == again.noise
    assert json.loads(measurement_json(again))["repeated"] == [1, 2, 3]
    assert any(line.startswith("warning: 3 pictures are the same") for line in remarks(again))
