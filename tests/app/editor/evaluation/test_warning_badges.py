"""Warnings in the window: a badge of their own on the node, and the text in its panel."""

import numpy as np
import pytest

from app.editor.evaluation.queries import STALE, Badge, badges
from core.chain.engine import Engine
from core.editing.operations import add_nodes, set_parameter
from core.errors import DataError
from core.network.network import Node
from editor_queries import Samples
from viewer_bench import ViewerBench


@pytest.fixture
def bench(qtbot, opened):
    made = ViewerBench(qtbot, opened("measured_mtf"))
    yield made
    made.close()


def shown(bench):
    bench.settle()
    return bench.evaluator.badges


def test_a_warning_comes_and_goes_with_what_brings_it_about(bench, canvas):
    bench.evaluator.badges_changed.connect(canvas.set_badges)
    assert "electronics" not in shown(bench)
    bench.do(set_parameter("electronics", "cut_on_um", 3.0))
    bench.do(set_parameter("electronics", "cut_off_um", 5.0))
    badge = shown(bench)["electronics"]
    assert badge.kind == "warning"
    assert "8 to 12 µm" in badge.text
    assert "3 to 5 µm" in badge.text
    assert canvas.content.nodes["electronics"].badge == badge
    bench.session.undo()
    bench.session.undo()
    assert "electronics" not in shown(bench)


def test_samples_that_look_like_kelvin_are_warned_of_once_they_are_seen(bench, tmp_path):
    np.save(tmp_path / "t.npy", np.full((32, 32), 290.0, np.float32))
    node = Node("read", "read_image", {"path": str(tmp_path / "t.npy")})
    bench.do(add_nodes(((node, None),)))
    assert "read" not in shown(bench)
    bench.evaluator.ask("test", [Samples("read.image")])
    badge = shown(bench)["read"]
    assert badge.kind == "warning"
    assert "look like temperatures in kelvin" in badge.text
    bench.do(set_parameter("read", "unit", "K"))
    assert "read" not in shown(bench)
    bench.session.undo()
    assert shown(bench)["read"] == badge


def planned(session, library):
    return Engine(library).plan(session.network)


def test_what_else_there_is_to_say_stands_beside_it(opened, library):
    plan = planned(opened("inframetrics"), library)
    warned = plan.nodes["optics"].warnings[0].text
    assert badges(plan, library)["optics"] == Badge("warning", warned)
    found = badges(plan, library, skipped={"optics": "left out: below the budget"})
    assert found["optics"] == Badge("warning", f"{warned}\nleft out: below the budget")
    assert badges(plan, library, stale=["optics"])["optics"] == Badge("stale", f"{STALE}\n{warned}")
    met = DataError("no such number", node="optics")
    assert badges(plan, library, met=[met])["optics"] == Badge("error", "no such number")
