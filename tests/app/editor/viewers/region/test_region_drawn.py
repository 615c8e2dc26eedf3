"""The region of a module dragged, drawn and moved by keys on the picture, with real events."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.editor.viewers.plot.plot_viewer import PlotViewer
from core.editing.operations import set_parameter
from core.network.linked_values import expression
from region_hands import framed, stored, undo_steps

NETWORK = "measured_mtf"
KEY = Qt.Key
SHIFT, CTRL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier
AS_SHIPPED = (96, 32, 64, 192)  # of a picture of 256 × 256


def test_dragging_moves_it_by_whole_samples_in_one_undo_step(bench, viewer, hand):
    hand.drag((128, 128), (118.3, 139.6))
    assert stored(bench) == (86, 44, 64, 192)
    assert framed(viewer) == (86, 44, 64, 192)
    assert undo_steps(bench) == 1
    assert "region" in bench.session.document.history.undo_text
    bench.session.undo()
    assert framed(viewer) == AS_SHIPPED
    bench.session.redo()
    assert framed(viewer) == (86, 44, 64, 192)


@pytest.mark.parametrize(
    ("grip", "to", "wanted"),
    [
        ((160, 128), (180, 20), (96, 32, 84, 192)),
        ((96, 32), (90, 30), (90, 30, 70, 194)),
        ((96, 128), (999, 0), (159, 32, 1, 192)),  # a sample is left
    ],
)
def test_handles_resize_it(bench, viewer, hand, grip, to, wanted):
    hand.drag(grip, to)
    assert stored(bench) == wanted
    assert framed(viewer) == wanted
    assert undo_steps(bench) == 1


def test_a_new_one_is_drawn_by_key_and_by_button(bench, viewer, hand):
    viewer.canvas.setFocus()
    hand.key(KEY.Key_R)
    assert viewer.bar.region.isChecked()
    hand.drag((200.1, 150.1), (120.1, 89.9))
    assert stored(bench) == (120, 90, 80, 60)
    assert undo_steps(bench) == 1
    assert not viewer.bar.region.isChecked()
    QTest.mouseClick(viewer.bar.region, Qt.MouseButton.LeftButton)
    hand.drag((10, 20), (400, 400))
    assert stored(bench) == (10, 20, 246, 236)
    assert undo_steps(bench) == 2


def test_escape_gives_a_drag_up_and_leaves_no_step(bench, viewer, hand):
    hand.press((128, 128))
    hand.move((150, 128))
    assert framed(viewer) == (118, 32, 64, 192)
    hand.key(KEY.Key_Escape)
    assert framed(viewer) == AS_SHIPPED
    hand.move((170, 128))
    hand.release((170, 128))
    assert stored(bench) == AS_SHIPPED
    assert undo_steps(bench) == 0
    assert not bench.session.document.modified


def test_arrow_keys_move_it_once_it_is_held(bench, viewer, hand):
    viewer.canvas.setFocus()
    hand.key(KEY.Key_Right)  # moves the probe
    assert stored(bench) == AS_SHIPPED
    hand.drag((128, 128), (129, 128))
    hand.key(KEY.Key_Right)
    hand.key(KEY.Key_Down, SHIFT)
    assert stored(bench) == (98, 42, 64, 192)
    hand.key(KEY.Key_Left, CTRL)
    hand.key(KEY.Key_Up, CTRL | SHIFT)
    assert stored(bench) == (98, 42, 63, 182)
    assert undo_steps(bench) == 5
    hand.key(KEY.Key_Escape)
    hand.key(KEY.Key_Left)
    assert stored(bench) == (98, 42, 63, 182)


def test_the_curve_follows_while_it_is_dragged(bench, viewer, hand):
    plot = PlotViewer(bench.session, bench.evaluator)
    plot.look_at("measured.curve")
    bench.show(plot)
    before = plot.data.series[0].y
    hand.press((128, 128))
    hand.move((128, 118))
    bench.settle()  # the button is still down
    during = plot.data.series[0].y
    assert not np.array_equal(before, during)
    hand.release((128, 118))
    bench.settle()
    assert stored(bench) == (96, 22, 64, 192)
    assert np.array_equal(plot.data.series[0].y, during)


def test_a_linked_region_is_left_alone_and_the_reason_given(bench, viewer, hand):
    raw = expression("measured.region_height / 3")
    bench.session.do(set_parameter("measured", "region_width", raw))
    before, said = bench.session.network, []
    assert framed(viewer) == AS_SHIPPED  # 192 / 3
    bench.session.message.connect(lambda kind, text: said.append((kind, text)))
    hand.drag((128, 128), (118.3, 139.6))
    assert bench.session.network is before
    assert (
        "error",
        "measured.region_width follows measured.region_height / 3: unlink it in its panel first",
    ) in said
