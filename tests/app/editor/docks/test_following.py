"""The curves of the trade-off dock follow the network, and leave it and the store alone."""

import math

import numpy as np
import pytest

from app.editor.docks.tradeoff_plots import Span
from app.editor.evaluation import runner
from child_process import PATIENCE_S
from core.chain.engine import Engine
from core.editing.operations import set_parameter
from core.evaluation.work import Policy
from tradeoff_network import mtf

MTF = "total.mtf_nyquist_x"


def test_the_curves_follow_an_edit_and_figures_are_what_the_engine_tells(
    opened_window, dock, idle, graph
):
    before = graph(MTF).y
    opened_window.session.do(set_parameter("jitter", "sigma_mrad", 0.0))
    idle(opened_window)
    x, y = graph(MTF).x, graph(MTF).y
    variance = x**2
    nyquist = math.sqrt(-math.log(mtf(0.0)) / (2 * math.pi**2 * 0.2**2))
    assert y == pytest.approx(np.exp(-2 * math.pi**2 * variance * nyquist**2), rel=1e-9)
    assert (y >= before).all()
    opened_window.session.undo()
    idle(opened_window)
    assert (graph(MTF).y == before).all()
    # Moving the parameter itself moves the mark alone.
    points = dict(dock.points)
    opened_window.session.do(set_parameter("blur", "sigma_x_mrad", 0.25))
    idle(opened_window)
    assert dock.plots.mark == 0.25
    assert all(dock.points[value] is point for value, point in points.items())
    opened_window.session.undo()
    # A figure of a node is what the engine tells.
    dock.show_figure("electronics.snr", True)
    idle(opened_window)
    network = opened_window.session.network
    told = graph("electronics.snr")
    for index in (0, len(told.x) - 1):
        engine = Engine(opened_window.session.library)
        plan = engine.plan(network.with_parameter("blur", "sigma_x_mrad", float(told.x[index])))
        found = engine.readouts(plan, "electronics", engine.work(Policy()))
        assert told.y[index] == found["snr"]
    # Values that fail are gaps and told.
    dock.set_span(Span(-1.0, 1.0, count=5))
    idle(opened_window)
    assert np.isnan(graph(MTF).y).tolist() == [True, True, False, False, False]
    told = dock.status.title.text()
    assert told.startswith(
        "figures are missing at 2 of 5 values: blur: sigma_x_mrad = -1.0 mrad is not allowed"
    )
    assert opened_window.evaluator.badges == {}  # no node of the network itself has failed
    # The range that is shown can be typed again.
    span, points = dock.span, dict(dock.points)
    assert points
    dock.set_span(span)
    idle(opened_window)
    assert dock.points.keys() == points.keys()


def test_while_edits_come_nothing_is_computed_then_the_coarse_points_first(
    opened_window, dock, idle, qtbot, monkeypatch
):
    answers, shown = [], []

    def note(answer):
        if answer.owner == "tradeoff":
            answers.append(answer)
            shown.append(len(dock.points))

    opened_window.evaluator.answered.connect(note)
    with monkeypatch.context() as patched:
        # However long a busy machine takes from one edit to the next, it is no pause.
        patched.setattr(runner, "PAUSE_S", PATIENCE_S)
        for number in range(10):
            step = set_parameter("jitter", "sigma_mrad", 0.1 + 0.01 * number)
            opened_window.session.do(step, gesture="drag")
            qtbot.wait(20)
        assert not answers
    opened_window.session.do(set_parameter("jitter", "sigma_mrad", 0.7), gesture="drag")
    opened_window.session.end_gesture()
    idle(opened_window)
    parts = [answer.query.values for answer in answers]
    assert parts[0] == pytest.approx(
        [4 * number / 24 for number in (0, 1, 2, 3, 4, 5, 6)] + [2 / 24]
    )
    assert shown[0] == 8  # none of the network as it was
    assert shown == np.cumsum([len(part) for part in parts]).tolist()
    assert sorted(value for part in parts for value in part) == sorted(dock.span.values())


def test_it_leaves_no_pictures_in_the_store(opened_window, dock, idle, graph):
    store = opened_window.evaluator._runner._engine.store
    opened_window.viewers.tradeoff_dock.hide()
    idle(opened_window)
    before = store.used_bytes
    opened_window.viewers.trade_off("scene", "temperature_K")
    idle(opened_window)
    snr = graph("electronics.snr").y
    assert len(set(snr.tolist())) == dock.span.count  # a picture was made for each
    assert store.used_bytes == before
