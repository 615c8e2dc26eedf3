"""Measured MTF on files with edges of known blur."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.errors import DataError, ImagechainError, ParameterError
from edge_pictures import edge_mtf, edge_picture
from node_bench import NodeBench
from nodes.analysis.measured_mtf import MeasuredMTF
from nodes.input_output.read_image import ReadImage
from small_library import library_of

LIBRARY = library_of([ReadImage, MeasuredMTF])
ERRORS = ("mtf50_error", "at_nyquist_error")
FOV = {"fov_x_deg": 1.0, "fov_y_deg": 1.5}


def measured(folder, picture, fov=FOV, precision="double", **params):
    np.save(folder / "a.npy", picture)
    nodes = {"a": ("read_image", {"path": "a.npy", **fov}), "out": ("measured_mtf", params)}
    bench = NodeBench(LIBRARY, folder, nodes, precision=precision)
    return bench.engine, bench.plan, bench.work


def intervals(picture):
    return [
        math.radians(fov) * 1000 / size
        for fov, size in zip((1.0, 1.5), picture.shape[::-1], strict=True)
    ]


@pytest.mark.parametrize("across", ["horizontal", "vertical"])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_frequencies_are_angular_along_the_normal_of_oblong_pixels(tmp_path, across, precision):
    """The picture is 80 wide and 96 high: pixels of 0.218 and 0.273 mrad."""
    upright = across == "horizontal"
    picture = edge_picture(8, 0.6, (96, 80) if upright else (80, 96))
    picture = 270 + 30 * (picture if upright else picture.T)
    x, y = intervals(picture)
    engine, plan, work = measured(tmp_path, picture, precision=precision)
    curve = engine.value(plan, "out.curve", work)
    assert curve.x_label == "frequency (cyc/mrad)"
    # The normal in mrad, for one in pixels of (cos 8°, ∓sin 8°): lines stretch, normals shrink.
    angle = math.radians(8)
    over, down = (x, y) if upright else (y, x)
    per_mrad = math.hypot(math.cos(angle) / over, math.sin(angle) / down)
    cycles = curve.series[0].x / per_mrad
    below = cycles <= 0.5
    truth = edge_mtf(cycles, 8, 0.6)
    assert np.max(np.abs(curve.series[0].y - truth)[below]) < 0.002
    found = engine.readouts(plan, "out", work)
    fine = np.linspace(0, 1, 10001)
    half, tenth = (fine[np.argmax(edge_mtf(fine, 8, 0.6) < level)] for level in (0.5, 0.1))
    assert found["mtf50_per_pixel"] == pytest.approx(half, abs=0.001)
    assert found["mtf50"] == pytest.approx(half * per_mrad, rel=0.004)
    assert found["mtf10_per_pixel"] == pytest.approx(tenth, rel=0.02)
    assert found["mtf10"] == pytest.approx(tenth * per_mrad, rel=0.02)
    assert found["at_nyquist"] == pytest.approx(edge_mtf(0.5, 8, 0.6), abs=0.002)
    for name in ("expected_mtf50", "expected_at_nyquist", "largest_difference"):
        assert found[name] is None  # no chain is known behind a file
    table = engine.value(plan, "out.table", work).as_dict()
    assert table["direction"] == across
    assert table["contrast"] == pytest.approx(30, rel=1e-3)
    assert table["nyquist"] == pytest.approx(0.5 * per_mrad)
    assert [found[name] for name in ERRORS] == [table[name] for name in ERRORS]
    assert table["mtf50_error"] != table["at_nyquist_error"]


def test_direction_of_the_normal(tmp_path):
    """From +x towards +y, as a test scene's angle; the normal of the picture points to −8°."""
    for picture, normal in ((edge_picture(8, 1), -8), (edge_picture(8, 1).T, 98)):
        engine, plan, work = measured(tmp_path, picture, {})
        assert engine.readouts(plan, "out", work)["edge_angle_deg"] == pytest.approx(
            normal, abs=0.01
        )


def test_only_the_region_counts(tmp_path):
    whole = np.random.default_rng(1).uniform(0, 9, (100, 120))
    whole[10:80, 30:100] = edge_picture(4, 1, (70, 70))
    region = {"region_x": 30, "region_y": 10, "region_width": 70, "region_height": 70}
    engine, plan, work = measured(tmp_path, whole, axis="cyc_per_pixel", **region)
    series = engine.value(plan, "out.curve", work).series[0]
    np.testing.assert_allclose(series.y, edge_mtf(series.x, 4, 1), atol=0.002)


def test_row_average_reads_low_by_the_differences(tmp_path):
    picture = edge_picture(0, 1.2, (40, 64)).T
    engine, plan, work = measured(
        tmp_path, picture, method="row_average", axis="cyc_per_pixel", direction="vertical"
    )
    series = engine.value(plan, "out.curve", work).series[0]
    truth = edge_mtf(series.x, 0, 1.2) * np.sinc(series.x)
    np.testing.assert_allclose(series.y, truth, atol=0.004)


@pytest.mark.parametrize(
    ("params", "named"),
    [
        ({"region_x": 64}, "region_x"),
        ({"region_y": 99}, "region_y"),
        ({"region_x": 10, "region_width": 60}, "region_width"),
        ({"region_height": 65}, "region_height"),
    ],
)
def test_region_outside_the_picture_is_refused(tmp_path, params, named):
    _, plan, _ = measured(tmp_path, edge_picture(5, 1), **params)
    error = plan.nodes["out"].error
    assert isinstance(error, ParameterError)
    assert error.parameter == named


@pytest.mark.parametrize("method", ["slanted_edge", "row_average"])
@pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1), (7, 5), (64, 64)])
def test_pictures_without_an_edge_are_refused_in_one_line(tmp_path, method, size):
    for picture in (np.zeros(size), np.random.default_rng(2).normal(size=size)):
        engine, plan, work = measured(tmp_path, picture, method=method)
        with pytest.raises(DataError) as caught:
            engine.value(plan, "out.curve", work)
        assert isinstance(caught.value, ImagechainError)
        assert caught.value.node == "out"
        assert "\n" not in str(caught.value)
