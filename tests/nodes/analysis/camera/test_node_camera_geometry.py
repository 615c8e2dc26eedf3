"""Camera Geometry in a network: figures, what is refused, and what an edit computes anew."""

import math

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import DataError, ParameterError
from core.evaluation.work import Policy
from linked_network import linked_network
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()
WIDE = {
    "kind": "line", "ground_interval_m": 1.0, "fov_x_deg": 90.0, "columns": 100, "rows": 60,
    "altitude_m": 50.0,
}  # fmt: skip


def planned(folder, picture, engine=None, **params):
    if not (folder / "in.npy").exists():  # a file written again is another file
        np.save(folder / "in.npy", picture)
    nodes = {
        "scene": ("read_image", {"path": "in.npy", "unit": "W/m²/sr"}),
        "camera": ("camera_geometry", params),
    }
    network = linked_network(nodes)
    engine = engine or Engine(LIBRARY)
    return engine, engine.plan(network, folder=folder)


def value(folder, picture, port="image", precision="double", **params):
    engine, plan = planned(folder, picture, **params)
    assert plan.errors() == []
    return engine.value(plan, f"camera.{port}", engine.work(Policy(precision)))


def refused(folder, shape=(100, 120), **params):
    _, plan = planned(folder, np.ones(shape), **params)
    return plan.nodes["camera"].error


def scene(rows=100, columns=120):
    return np.random.default_rng(3).random((rows, columns)) + 4.0


def test_figures_of_a_wide_scan(tmp_path):
    """50 m up, ±45°: ±50 m of ground. The outermost sample reaches from 44.1° to 45°."""
    engine, plan = planned(tmp_path, scene(), **WIDE)
    found = engine.readouts(plan, "camera", engine.work(Policy()))
    step = math.pi / 2 / 100
    assert found["swath_m"] == pytest.approx(100.0, rel=1e-12)
    assert found["interval_x_mrad"] == pytest.approx(1000 * step, rel=1e-14)
    assert found["interval_y_mrad"] == pytest.approx(1000 * step, rel=1e-14)
    assert found["line_spacing_m"] == pytest.approx(50 * step, rel=1e-14)
    assert found["lines"] == 60
    middle = 50 * 2 * math.tan(step / 2)
    edge = 50 * (1 - math.tan(math.pi / 4 - step))
    assert found["gsd_x_m"] == pytest.approx(middle, rel=1e-12)
    assert found["gsd_edge_x_m"] == pytest.approx(edge, rel=1e-12)
    assert found["panoramic_factor"] == pytest.approx(edge / middle, rel=1e-12)
    assert found["gsd_edge_y_m"] == pytest.approx(
        50 * step / math.cos(math.pi / 4 - step / 2), rel=1e-12
    )
    assert found["footprint_error"] == 0


def test_the_picture_knows_its_sampling(tmp_path):
    pitch = {"fov_x_deg": None, "pitch_x_um": 20.0, "pitch_y_um": 30.0, "focal_length_mm": 40.0}
    given = {**WIDE, **pitch, "velocity_m_per_s": 60.0, "line_rate_Hz": 80.0}
    _, plan = planned(tmp_path, scene(), **given)
    image = plan.output("camera.image")
    assert image.shape == (60, 100)
    assert image.interval_x_mrad == 0.5
    assert image.interval_y_mrad == pytest.approx(1000 * 0.75 / 50)  # 60/80 m at 50 m
    assert image.unit == "W/m²/sr"
    assert image.header.focal_length_mm == 40.0
    framing = plan.nodes["camera"].module.camera(plan.output("scene.image"))
    assert framing.step_y_mrad == 0.75
    _, plan = planned(tmp_path, scene(), **{**given, "kind": "framing"})
    assert plan.output("camera.image").interval_y_mrad == 0.75


def test_the_scenes_own_sampling_at_nadir(tmp_path):
    nodes = {
        "scene": ("test_scene", {"width": 64, "height": 48, "fov_x_deg": 8, "fov_y_deg": 5}),
        "camera": ("camera_geometry", {"fov_x_deg": 3.0}),
    }
    plan = NodeBench(tmp_path, nodes).plan
    x, y = plan.nodes["camera"].module.intervals_m(plan.output("scene.image"))
    assert x == pytest.approx(1000 * math.radians(8) / 64)
    assert y == pytest.approx(1000 * math.radians(5) / 48)


def test_each_sample_is_the_mean_of_its_rectangle(tmp_path):
    """A direct sum over the scene's samples, weighted with what a rectangle holds of each."""
    picture = scene()
    found = value(tmp_path, picture, **WIDE)

    def held(low, high, count):
        edges = np.arange(count + 1.0) - count / 2
        return np.clip(np.minimum(high, edges[1:]) - np.maximum(low, edges[:-1]), 0, None)

    step = math.pi / 200
    for row, column in ((0, 0), (59, 99), (30, 49), (12, 80)):
        left, right = (50 * math.tan((column + k - 50) * step) for k in (0, 1))
        line = (row + 0.5 - 30) * 50 * step
        reach = 25 * step / math.cos((column + 0.5 - 50) * step)
        weight = np.outer(held(line - reach, line + reach, 100), held(left, right, 120))
        expected = np.sum(weight * picture) / np.sum(weight)
        assert found[row, column] == pytest.approx(expected, rel=1e-12)


def test_all_of_the_scene_is_covered_or_the_fill_is_seen(tmp_path):
    picture = scene()
    assert (value(tmp_path, picture, port="coverage", **WIDE) == 1.0).all()
    wider = {**WIDE, "altitude_m": 80.0, "outside": "fill", "fill_value": -2.0}
    share = value(tmp_path, picture, port="coverage", **wider)
    found = value(tmp_path, picture, **wider)
    assert (share[:, 0] == 0.0).all()
    assert (found[:, 0] == -2.0).all()
    assert share[30, 50] == 1.0
    partly = (share > 0) & (share < 1)
    assert partly.any()
    low, high = -2.0 + share * (picture.min() + 2), -2.0 + share * (picture.max() + 2)
    assert ((found >= low - 1e-12) & (found <= high + 1e-12)).all()


def test_what_leaves_the_scene_is_refused_with_how_far(tmp_path):
    error = refused(tmp_path, **{**WIDE, "altitude_m": 80.0, "offset_x_m": 5.0, "rows": 5})
    assert isinstance(error, DataError)
    # 80 m up ±80 m are seen about x = 5 m, of ±60 m.
    assert "15 m past the left edge, 25 m past the right edge;" in str(error)
    assert "altitude_m" in str(error)
    error = refused(tmp_path, **{**WIDE, "rows": 200})
    assert "past the top" in str(error)
    assert "past the left" not in str(error)
    assert refused(tmp_path, **WIDE) is None


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"ground_interval_m": None}, "ground_interval_m"),
        ({"fov_x_deg": None}, "fov_x_deg"),
        ({"fov_x_deg": None, "pitch_x_um": 20.0}, "fov_x_deg"),
        ({"pitch_y_um": 20.0}, "focal_length_mm"),
        ({"pitch_x_um": 20.0, "focal_length_mm": 10.0}, "fov_x_deg"),
        ({"velocity_m_per_s": 60.0}, "line_rate_Hz"),
        ({"line_rate_Hz": 60.0}, "velocity_m_per_s"),
        ({"roll_deg": 46.0}, "roll_deg"),
    ],
)
def test_what_does_not_follow_is_refused_by_name(tmp_path, changes, name):
    error = refused(tmp_path, **{**WIDE, **changes})
    assert isinstance(error, ParameterError)
    assert error.parameter == name
    assert "\n" not in str(error)


def test_an_edit_computes_what_it_moves(tmp_path):
    """Another value for the scene leaves the footprints; another fill leaves their share."""
    picture = scene()
    engine, first = planned(tmp_path, picture, **WIDE, outside="fill")
    work = engine.work(Policy())
    engine.value(first, "camera.image", work)
    _, second = planned(tmp_path, picture, engine, **WIDE, outside="fill", fill_value=3.0)
    before = set(work.log.computed)
    engine.value(second, "camera.image", work)
    assert len(work.log.computed - before) == 1
    _, third = planned(tmp_path, picture, engine, **{**WIDE, "altitude_m": 48.0}, outside="fill")
    before = set(work.log.computed)
    engine.value(third, "camera.image", work)
    assert len(work.log.computed - before) == 3  # footprints, their share, the picture
