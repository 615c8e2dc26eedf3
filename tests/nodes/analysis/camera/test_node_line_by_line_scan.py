"""Where a scan looks, how far apart its lines are, and what makes no scan."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import DataError, ParameterError
from core.network.network import Link, Network, Node
from delivered_chains import LIBRARY, scene
from scan_chains import network, values
from scan_truth import ACROSS, ALONG

SCANS = ["x", "y"]


class TestGeometry:
    """Intervals and places by hand: 12 × 9 samples, 90 mrad apart along the scan."""

    def told(self, folder, **settings):
        (table,) = values(folder, scene(12, 9), ("blur",), ("table",), **settings)
        return table.as_dict()

    def test_lines_at_nadir_as_far_apart_as_the_frames(self, tmp_path):
        told = self.told(tmp_path)
        assert told["interval_nadir_mrad"] == pytest.approx(ALONG, rel=1e-12)
        assert told["interval_edge_mrad"] == pytest.approx(ALONG * math.cos(0.36), rel=1e-12)
        assert told["view_first_deg"] == pytest.approx(-math.degrees(0.36), rel=1e-12)
        assert told["view_last_deg"] == pytest.approx(math.degrees(0.36), rel=1e-12)

    def test_scan_down_the_frame(self, tmp_path):
        told = self.told(tmp_path, scan="y")
        assert told["interval_nadir_mrad"] == pytest.approx(ACROSS * math.cos(0.035), rel=1e-12)
        assert told["interval_edge_mrad"] == pytest.approx(ACROSS * math.cos(0.385), rel=1e-12)

    def test_spacing_of_the_flight(self, tmp_path):
        """60 m/s and 10 turns a second: 6 m, at 100 m 60 mrad."""
        flight = {"velocity_m_per_s": -60.0, "scan_velocity_mrad_per_s": 20000 * math.pi}
        told = self.told(tmp_path, spacing="flight", init=flight)
        assert told["interval_nadir_mrad"] == pytest.approx(60.0, rel=1e-12)

    @pytest.mark.parametrize("scan", SCANS)
    def test_where_and_how_large(self, tmp_path, scan):
        found, whole, gap, table, curve = values(
            tmp_path, scene(12, 9), ("blur",), ("image", "whole", "difference", "table", "curve"),
            scan=scan, look_angle_deg=20.0,
        )  # fmt: skip
        expected = found - whole
        np.testing.assert_array_equal(gap, expected)
        share = 100 / np.ptp(whole)
        told = table.as_dict()
        assert told["max_percent"] == pytest.approx(np.abs(expected).max() * share, rel=1e-12)
        assert told["rms_percent"] == pytest.approx(expected.std() * share, rel=1e-3)
        place = np.unravel_index(np.argmax(np.abs(expected)), expected.shape)[scan == "x"]
        count, interval = (9, ACROSS) if scan == "x" else (12, ALONG)
        angle = 20.0 + math.degrees((place - (count - 1) / 2) * interval / 1000)
        assert told["max_view_deg"] == pytest.approx(angle, rel=1e-12)
        largest, rms = curve.series
        axis = 0 if scan == "x" else 1
        np.testing.assert_allclose(largest.y, np.abs(expected).max(axis=axis) * share, rtol=1e-12)
        power = np.sqrt(np.mean(expected**2, axis=axis)) * share
        np.testing.assert_allclose(rms.y, power, rtol=1e-12)
        assert largest.x[place] == pytest.approx(angle, rel=1e-12)


@pytest.mark.parametrize(
    ("params", "init", "told"),
    [
        ({"look_angle_deg": 70.0}, {}, "look_angle_deg.*horizon"),
        ({"nadir_column": 40.0}, {}, "nadir_column.*horizon"),
        ({"nadir_column": 4.0, "look_angle_deg": 1.0}, {}, "nadir_column"),
        ({"spacing": "typed"}, {}, "line_spacing_m"),
        ({"spacing": "typed", "line_spacing_m": 7.0}, {"range_m": None}, "range_m"),
        ({"spacing": "flight"}, {}, "velocity_m_per_s"),
        ({"spacing": "flight"}, {"velocity_m_per_s": 3.0}, "scan_velocity_mrad_per_s"),
    ],
)
def test_what_makes_no_scan_is_refused(tmp_path, params, init, told):
    np.save(tmp_path / "in.npy", scene(12, 9))
    document = network(("blur",), (12, 9), init=init, **params)
    error = Engine(LIBRARY).plan(document, folder=tmp_path).nodes["lines"].error
    assert isinstance(error, ParameterError)
    assert re.search(told, str(error))


def test_two_images_and_no_image_are_refused(tmp_path):
    for name, seed in (("in", 5), ("other", 6)):
        np.save(tmp_path / f"{name}.npy", scene(12, 9, seed=seed))
    document = network(("blur",), (12, 9))
    fields = document.nodes["init"].params
    nodes = {
        **document.nodes,
        "file2": Node("file2", "read_image", {"path": "other.npy"}),
        "init2": Node("init2", "init_trans", fields),
    }
    links = tuple(k for k in document.links if (k.target, k.input) != ("lines", "phase"))
    links += (Link("file2", "image", "init2", "image"), Link("init2", "phase", "lines", "phase"))
    plan = Engine(LIBRARY).plan(Network(nodes=nodes, links=links), folder=tmp_path)
    assert isinstance(plan.nodes["lines"].error, DataError)
    assert "Back Transform" in str(plan.nodes["lines"].error)
    alone = document.with_parameter("blur", "apply", "filter_only")
    error = Engine(LIBRARY).plan(alone, folder=tmp_path).nodes["lines"].error
    assert isinstance(error, DataError)
    assert "multiply" in str(error)
    links = tuple(k for k in document.links if (k.target, k.input) != ("lines", "context"))
    links += (
        Link("file2", "image", "init2", "image"),
        Link("init2", "context", "lines", "context"),
    )
    other = Network(nodes=nodes, links=links).with_parameter("init2", "fov_x_deg", 7.0)
    error = Engine(LIBRARY).plan(other, folder=tmp_path).nodes["lines"].error
    assert isinstance(error, DataError)
    assert "context" in str(error)
