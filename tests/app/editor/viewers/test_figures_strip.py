"""The row of figures: the electronics' read-outs, and the run time."""

import pytest

from app.editor.evaluation.queries import PassDone, Passing
from app.editor.viewers.plot.figures_strip import FiguresQuery, FiguresStrip, figure_text
from app.run.evaluation import ELECTRONICS_FIGURES
from core.editing.operations import add_nodes, remove_nodes, set_node_field, set_parameter
from core.network.network import Link, Node
from viewer_bench import ViewerBench

NETWORK = "inframetrics"

NAMES = [name for name, _ in ELECTRONICS_FIGURES]


@pytest.fixture
def strip(bench):
    return bench.show(FiguresStrip(bench.session, bench.evaluator), 820, 40)


def figures(bench, preferred=None):
    engine, plan, work = bench.truth()
    return FiguresQuery(preferred).answer(Passing(engine, plan, work))


def test_the_published_figures_stand_there_in_full(bench, strip):
    """Tantalo 1996, table 5.2: G# 5.207, bandwidth 49152 Hz."""
    assert strip.text("g_number") == "5.207 1/sr"
    assert strip.text("bandwidth_Hz") == "49.15 kHz"
    assert strip.text("run_time").endswith("s")
    assert "NETD" in strip.label("netd_system_K").toolTip()
    narrow = bench.show(FiguresStrip(bench.session, bench.evaluator), 300, 40)
    last = narrow.label("run_time").parentWidget()
    assert narrow.height() > last.geometry().bottom() > 2 * last.height()


def test_figures_as_text():
    for value, unit, text in (
        (None, "K", "—"),
        (0.0040711, "K", "4.071 mK"),
        (999.96, "Hz", "1 kHz"),
        (2e-15, "s", "2e−06 ns"),
        (-0.002, "W/m²/sr", "−2 mW/m²/sr"),
    ):
        assert figure_text(value, unit) == text


def test_follows_edits_and_where_there_are_no_figures_dashes_say_why(bench, strip):
    before = strip.text("snr")
    bench.do(set_parameter("electronics", "amplifier_snr", 40.0))
    assert strip.text("snr") != before
    engine, plan, work = bench.truth()
    truth = engine.readouts(plan, "electronics", work)
    assert strip.text("snr") == f"{truth['snr']:.4g}"
    for edit, why in (
        (remove_nodes(("electronics",)), "Electronics & Noise"),
        (set_node_field("electronics", "disabled", True), ""),
        (set_parameter("electronics", "material", "manual"), "d_star"),
    ):
        bench.do(edit)
        assert {strip.text(name) for name in NAMES} == {"—"}
        assert why in strip.label("snr").toolTip()
        bench.session.undo()
    # The run time is that of the last pass after a change.
    bench.settle()
    bench.evaluator.pass_done.emit(PassDone(99, 0.0123, after_edit=True))
    assert strip.text("run_time") == "12.3 ms"
    bench.evaluator.pass_done.emit(PassDone(100, 5.0, cancelled=True, after_edit=True))
    bench.evaluator.pass_done.emit(PassDone(101, 0.0012))  # for a panel opened meanwhile
    assert strip.text("run_time") == "12.3 ms"


def test_of_several_that_of_the_final_picture_or_the_selected_one(bench, strip):
    node = Node("more", "electronics_noise", bench.session.network.nodes["electronics"].params)
    inputs = Link("pixels", "image", "more", "image"), Link("init", "context", "more", "context")
    bench.do(add_nodes(((node, None),), inputs))
    bench.do(set_parameter("more", "amplifier_snr", 100.0))
    assert figures(bench).node == "electronics"  # more leads to nothing
    before = strip.text("snr")
    bench.session.select(["more"])
    bench.settle()
    assert strip.text("snr") == figures(bench, "more").figures["snr"][0]
    assert strip.text("snr") != before
    bench.session.select(["scene"])
    bench.settle()
    assert strip.text("snr") == before


def test_a_camera_of_today_shows_its_own_figures(qtbot, opened):
    node, captions = "bolometer", ("NETD", "1/f noise", "Lag")
    bench = ViewerBench(qtbot, opened("microbolometer"))
    strip = bench.show(FiguresStrip(bench.session, bench.evaluator), 900, 40)
    engine, plan, work = bench.truth()
    truth = engine.readouts(plan, node, work)
    heads = [head.text() for head, _ in strip._slots]
    assert set(captions) <= set(heads)
    assert heads[0] == "Output"
    assert heads[-1] == "Run time"
    units = {each.name: each.unit for each in plan.node(node).declaration.readouts}
    for name in strip._names:
        assert strip.text(name) == figure_text(truth[name], units[name])
    assert node in strip.label("snr").toolTip()
    bench.close()
