"""The curves of the trade-off dock follow the network, and leave it and the store alone."""

import math

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.editor.docks.tradeoff_plots import Span
from app.editor.docks.tradeoff_view import TradeOffView
from app.editor.evaluation import runner
from child_process import PATIENCE_S
from core.chain.engine import Engine
from core.editing.operations import Remove, Rename, set_node_field, set_parameter
from core.evaluation.policy import Policy
from core.network.linked_values import expression
from tradeoff_network import mtf
from viewer_bench import ViewerBench, is_freed

MTF = "total.mtf_nyquist_x"


def test_the_curves_follow_an_edit(opened_window, dock, idle, graph):
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


def test_moving_the_parameter_itself_moves_the_mark_alone(opened_window, dock, idle):
    points = dict(dock.points)
    opened_window.session.do(set_parameter("blur", "sigma_x_mrad", 0.25))
    idle(opened_window)
    assert dock.plots.mark == 0.25
    assert all(dock.points[value] is point for value, point in points.items())


def test_what_the_figures_do_not_hang_on_leaves_them_alone(opened_window, dock, idle):
    dock.show_figure(MTF, False)
    dock.show_figure("electronics.snr", False)
    dock.show_figure("electronics.netd_system_K", False)
    dock.show_figure("blur.mtf_at_nyquist_x", True)
    idle(opened_window)
    points = dict(dock.points)
    opened_window.session.do(set_parameter("electronics", "d_star", 3e9))
    idle(opened_window)
    assert all(dock.points[value] is point for value, point in points.items())


def test_a_figure_of_a_node_is_what_the_engine_tells(opened_window, dock, idle, graph):
    dock.show_figure("electronics.snr", True)
    idle(opened_window)
    network = opened_window.session.network
    told = graph("electronics.snr")
    for index in (0, 11, len(told.x) - 1):
        engine = Engine(opened_window.session.library)
        plan = engine.plan(network.with_parameter("blur", "sigma_x_mrad", float(told.x[index])))
        found = engine.readouts(plan, "electronics", engine.work(Policy()))
        assert told.y[index] == found["snr"]


def test_values_that_fail_are_gaps_and_told(opened_window, dock, idle, graph):
    dock.set_span(Span(-1.0, 1.0, count=5))
    idle(opened_window)
    assert np.isnan(graph(MTF).y).tolist() == [True, True, False, False, False]
    told = dock.status.title.text()
    assert told.startswith("2 of 5 values have gaps: blur: sigma_x_mrad = -1.0 mrad is not allowed")
    assert opened_window.evaluator.badges == {}  # no node of the network itself has failed


def test_it_follows_renamed_and_removed_nodes(opened_window, dock, idle):
    opened_window.session.do(Rename("blur", "lens"))
    idle(opened_window)
    assert dock.bar.parameter.currentText() == "σ x of lens (mrad)"
    assert len(dock.points) == dock.span.count
    opened_window.session.do(Remove(("lens",)))
    idle(opened_window)
    assert dock.span is None
    assert dock.plots.graphs == ()


def test_nodes_held_back_count_as_generated(opened_window, dock, idle, graph):
    opened_window.session.do(set_node_field("electronics", "auto", False))
    opened_window.session.do(set_parameter("electronics", "d_star", 1e9))
    idle(opened_window)
    engine = Engine(opened_window.session.library)
    network = opened_window.session.network.with_parameter("blur", "sigma_x_mrad", 1.0)
    found = engine.readouts(engine.plan(network), "electronics", engine.work(Policy()))
    assert graph("electronics.snr").y[-1] == found["snr"]


def test_another_document_begins_with_nothing_varied(opened_window, dock, idle):
    opened_window.files.open_now("first_steps")
    idle(opened_window)
    assert dock.span is None
    assert not dock.points
    assert not dock.bar.low.isEnabled()


def test_hidden_it_asks_nothing(opened_window, dock, idle):
    opened_window.viewers.tradeoff_dock.hide()
    answers = []
    opened_window.evaluator.answered.connect(lambda answer: answers.append(answer.owner))
    opened_window.session.do(set_parameter("jitter", "sigma_mrad", 0.01))
    idle(opened_window)
    assert "tradeoff" not in answers


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
    assert parts[0] == (0.0, 0.25, 0.5, 0.75, 1.0)
    assert shown[0] == 5  # none of the network as it was
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


def test_nothing_is_left_of_a_closed_dock(opened, qtbot):
    bench = ViewerBench(qtbot, opened("first_steps"))

    def used():
        view = TradeOffView(bench.session, bench.evaluator)
        view.plots.setObjectName("used")
        view.show()
        view.trade_off("blur", "sigma_x_mrad")
        bench.settle()
        assert view.points
        view.plots.moved.emit(0.2)
        view.plots.released.emit()
        bench.settle()
        return view

    assert is_freed(used)
    bench.close()


def test_a_linked_parameter_is_not_moved_by_its_mark(opened_window, dock, idle):
    """Its value would take the place of the expression by a mere drag."""
    raw = expression("jitter.sigma_mrad * 2")
    opened_window.session.do(set_parameter("blur", "sigma_x_mrad", raw))
    idle(opened_window)
    sigma_mrad = opened_window.session.network.nodes["jitter"].params["sigma_mrad"]
    assert dock.plots.mark == 2 * sigma_mrad
    before = opened_window.session.network
    dock.plots.setFocus()
    QTest.keyClick(dock.plots, Qt.Key.Key_Right)
    assert opened_window.session.network is before
    dock.varied.move(0.125)
    assert opened_window.session.network is before
