"""The row of figures: the electronics' read-outs, and the run time."""

import pytest
from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QFontMetricsF

from app.editor.evaluation.queries import PassDone, Passing
from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.figures_strip import FiguresQuery, FiguresStrip, figure_text
from app.editor.widgets import ElidedLabel
from app.run.figures import ELECTRONICS_FIGURES
from core.editing.operations import Add, Placed, Remove, set_node_field, set_parameter
from core.network.network import Link, Node
from editor_queries import Asking, Gate
from viewer_bench import ViewerBench, is_freed

NETWORK = "inframetrics"
NAMES = [name for name, _ in ELECTRONICS_FIGURES]


@pytest.fixture
def strip(bench):
    return bench.show(FiguresStrip(bench.session, bench.evaluator), 820, 40)


def figures(bench, preferred=None):
    engine, plan, work = bench.truth()
    return FiguresQuery(preferred).answer(Passing(engine, plan, work))


def test_figures_are_the_read_outs(bench):
    engine, plan, work = bench.truth()
    truth = engine.readouts(plan, "electronics", work)
    found = figures(bench)
    assert found.node == "electronics"
    assert {each.name: each.value for each in found.figures} == {n: truth[n] for n in NAMES}
    declared = {each.name: each for each in plan.node("electronics").declaration.readouts}
    for each in found.figures:
        assert (each.unit, each.meaning) == (declared[each.name].unit, declared[each.name].meaning)


def test_the_published_figures_stand_there(strip):
    """Tantalo 1996, table 5.2: G# 5.207, bandwidth 49152 Hz."""
    assert strip.text("g_number") == "5.207 1/sr"
    assert strip.text("bandwidth_Hz") == "49.15 kHz"
    assert strip.text("run_time").endswith("s")
    assert "NETD" in strip.label("netd_system_K").toolTip()


def test_figures_in_several_lines_are_not_cut_off(bench):
    strip = bench.show(FiguresStrip(bench.session, bench.evaluator), 300, 40)
    last = strip.label("run_time").parentWidget()
    assert strip.height() > last.geometry().bottom() > 2 * last.height()


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (None, "K", "—"),
        (0.0, "K", "0 K"),
        (0.0040711, "K", "4.071 mK"),
        (49152.0, "Hz", "49.15 kHz"),
        (1.19, "K", "1.19 K"),
        (999.96, "Hz", "1 kHz"),
        (46.4637, "", "46.46"),
        (2e-15, "s", "2e−06 ns"),
        (5.2069, "1/sr", "5.207 1/sr"),
        (float("inf"), "K", "inf K"),
        (-0.002, "W/m²/sr", "−2 mW/m²/sr"),
    ],
)
def test_figures_as_text(value, unit, text):
    assert figure_text(value, unit) == text


def test_follows_edits(bench, strip):
    before = strip.text("snr")
    bench.do(set_parameter("electronics", "amplifier_snr", 40.0))
    assert strip.text("snr") != before
    truth = {each.name: each.value for each in figures(bench).figures}
    assert strip.text("snr") == f"{truth['snr']:.4g}"


@pytest.mark.parametrize(
    ("edit", "why"),
    [
        (Remove(("electronics",)), "Electronics & Noise"),
        (set_node_field("electronics", "disabled", True), ""),
        (set_parameter("electronics", "material", "manual"), "d_star"),
    ],
)
def test_where_there_are_no_figures_dashes_say_why(bench, strip, edit, why):
    bench.do(edit)
    assert {strip.text(name) for name in NAMES} == {"—"}
    assert why in strip.label("snr").toolTip()


def second(bench):
    node = Node("more", "electronics_noise", bench.session.network.nodes["electronics"].params)
    links = (
        Link("pixels", "image", "more", "image"),
        Link("init", "context", "more", "context"),
    )
    bench.do(Add((Placed(node),), links))
    bench.do(set_parameter("more", "amplifier_snr", 100.0))


def test_of_several_that_of_the_final_picture_or_the_selected_one(bench, strip):
    second(bench)
    assert figures(bench).node == "electronics"  # more leads to nothing
    before = strip.text("snr")
    bench.session.select(["more"])
    bench.settle()
    other = {each.name: each.value for each in figures(bench, "more").figures}
    assert strip.text("snr") == f"{other['snr']:.4g}"
    assert strip.text("snr") != before
    bench.session.select(["scene"])
    bench.settle()
    assert strip.text("snr") == before


def test_the_key_tells_whether_figures_would_change(bench):
    engine, plan, _ = bench.truth()
    key = FiguresQuery().key(plan)
    network = bench.session.network
    changed = engine.plan(network.with_parameter("electronics", "amplifier_snr", 9.0))
    assert FiguresQuery().key(changed) != key
    same = engine.plan(network.with_parameter("frame_grabber", "width", 300))
    assert FiguresQuery().key(same) == key


def test_a_broken_network_still_has_its_figures(bench):
    engine, _, work = bench.truth()
    plan = engine.plan(bench.session.network.with_parameter("frame_grabber", "width", -3))
    found = FiguresQuery().answer(Passing(engine, plan, work))
    assert found.node == "electronics"
    assert all(each.value is not None for each in found.figures)


def test_run_time_of_the_last_pass_after_a_change(bench, strip):
    bench.evaluator.pass_done.emit(PassDone(99, 0.0123, after_edit=True))
    assert strip.text("run_time") == "12.3 ms"
    bench.evaluator.pass_done.emit(PassDone(100, 5.0, cancelled=True, after_edit=True))
    bench.evaluator.pass_done.emit(PassDone(101, 0.0012))  # for a panel opened meanwhile
    assert strip.text("run_time") == "12.3 ms"


def test_a_figure_of_like_length_lays_nothing_out_anew(bench, strip, qtbot):
    class Layouts(QObject):
        number = 0

        def eventFilter(self, _watched, event):  # noqa: N802
            self.number += event.type() == QEvent.Type.LayoutRequest
            return False

    def laid_out(seconds):
        counting.number = 0
        bench.evaluator.pass_done.emit(PassDone(99, seconds, after_edit=True))
        qtbot.wait(30)
        return counting.number

    counting = Layouts(strip)
    strip.installEventFilter(counting)
    label = strip.findChild(ElidedLabel, "figures_strip.run_time")
    label.show_text("—")
    laid_out(0.01233)
    qtbot.waitUntil(lambda: counting.number > 0)
    assert laid_out(0.01122) == 0
    assert strip.text("run_time") == "11.22 ms"
    assert laid_out(0.01) == 0
    needed = QFontMetricsF(label.font()).horizontalAdvance("12.33 ms")
    assert needed <= label.sizeHint().width() < needed + 2


def test_another_document(bench, strip, opened):
    opened("first_steps")
    bench.settle()
    assert {strip.text(name) for name in NAMES} == {"—"}


def test_captions_have_the_themes_colour(strip):
    strip.setPalette(LIGHT.palette())
    label = strip._slots[0][0]
    assert label.palette().color(label.foregroundRole()).name() == LIGHT.faint_text


def test_nothing_is_left_of_a_closed_strip(bench):
    def used():
        strip = FiguresStrip(bench.session, bench.evaluator)
        strip.show()
        bench.settle()
        return strip

    assert is_freed(used)


def test_figures_from_before_the_last_edit_are_faint(strip, bench, qtbot):
    """While something else takes the worker's time."""

    def ink():
        label = strip.label("snr")
        return label.palette().color(label.foregroundRole()).name()

    assert ink() == DARK.text
    before = strip.text("snr")
    gate = Gate()
    bench.evaluator.ask("panel", [Asking(gate, urgency=-1)])
    qtbot.waitUntil(gate.entered.is_set)
    bench.session.do(set_parameter("electronics", "amplifier_snr", 20.0))
    qtbot.waitUntil(lambda: ink() == DARK.faint_text)
    assert strip.text("snr") == before
    gate.opened.set()
    bench.evaluator.forget("panel")
    qtbot.waitUntil(lambda: ink() == DARK.text)
    assert strip.text("snr") != before


@pytest.mark.parametrize(
    ("network", "node", "captions"),
    [
        ("mwir_camera", "focal_plane", ("Well fill", "Signal", "NETD", "SNR")),
        ("microbolometer", "bolometer", ("NETD", "1/f noise", "Lag")),
        ("satellite_tdi", "focal_plane", ("Well fill", "Dynamic range")),
    ],
)
def test_a_camera_of_today_shows_its_own_figures(qtbot, opened, network, node, captions):
    bench = ViewerBench(qtbot, opened(network))
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


def test_a_figure_of_a_clipped_picture_is_a_dash_with_its_reason(qtbot, opened):
    made = ViewerBench(qtbot, opened("mwir_camera"))
    strip = made.show(FiguresStrip(made.session, made.evaluator), 820, 40)
    camera = next(n for n, node in made.session.network.nodes.items()
                  if node.module == "focal_plane")  # fmt: skip
    assert strip.text("netd_K").endswith("mK")
    made.do(set_parameter(camera, "integration_time_s", 10.0))
    assert (strip.text("netd_K"), strip.text("snr")) == ("—", "—")
    assert strip.text("well_fill_percent") != "—"
    tip = strip.label("netd_K").toolTip()
    assert "None: the picture's mean is " in tip
    assert "% of the full well and is clipped" in tip
    made.close()
