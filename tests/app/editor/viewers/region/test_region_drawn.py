"""The region of a module dragged, drawn and moved by keys on the picture, with real events."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

from app.editor.viewers.plot.plot_viewer import PlotViewer
from core.editing.operations import Remove, Rename, set_parameter
from core.network.linked_values import expression
from region_hands import PictureHand, framed, stored, undo_steps

NETWORK, INPUT = "measured_mtf", "electronics.image"
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


def test_it_stays_in_the_picture(bench, viewer, hand):
    hand.drag((128, 128), (-200, 400))
    assert stored(bench) == (0, 64, 64, 192)
    hand.drag((32, 128), (400, -400))
    assert stored(bench) == (192, 0, 64, 192)


@pytest.mark.parametrize(
    ("grip", "to", "wanted"),
    [
        ((160, 128), (180, 20), (96, 32, 84, 192)),
        ((96, 32), (90, 30), (90, 30, 70, 194)),
        ((128, 224), (0, 999), (96, 32, 64, 224)),
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


def test_escape_leaves_drawing(bench, viewer, hand):
    viewer.canvas.setFocus()
    hand.key(KEY.Key_R)
    hand.key(KEY.Key_Escape)
    assert not viewer.bar.region.isChecked()
    hand.drag((128, 128), (130, 128))
    assert stored(bench) == (98, 32, 64, 192)


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


def test_a_key_that_is_held_down_is_one_step(bench, viewer, hand):
    viewer.canvas.setFocus()
    hand.key(KEY.Key_R)
    for _ in range(5):
        QTest.keyPress(viewer.canvas, KEY.Key_Left)
    QTest.keyRelease(viewer.canvas, KEY.Key_Left)
    assert stored(bench) == (91, 32, 64, 192)
    assert undo_steps(bench) == 1


def test_a_click_beside_it_gives_the_arrow_keys_back(bench, viewer, hand):
    hand.drag((128, 128), (129, 128))
    QTest.mouseClick(
        viewer.canvas.viewport(),
        Qt.MouseButton.LeftButton,
        Qt.KeyboardModifier.NoModifier,
        hand.at(220, 100),
    )
    hand.key(KEY.Key_Right)
    assert stored(bench) == (97, 32, 64, 192)


def test_whole_picture_by_the_menu(bench, viewer, hand, qtbot):
    viewer.canvas.region.menu_wanted.emit(QPoint(10, 10))
    menu = viewer.findChild(QMenu, "region.menu")
    next(each for each in menu.actions() if each.objectName() == "region.whole").trigger()
    menu.close()
    assert stored(bench) == (None, None, None, None)
    assert framed(viewer) == (0, 0, 256, 256)
    assert undo_steps(bench) == 1
    hand.drag((128, 128), (140, 140))  # there is nowhere to move it to: the picture is moved
    assert stored(bench) == (None, None, None, None)
    viewer.fit()
    hand.drag((256, 128), (100, 128))
    assert stored(bench) == (0, 0, 100, 256)


def test_a_right_click_opens_the_menu(viewer, hand):
    at = hand.at(128, 128)
    event = QContextMenuEvent(
        QContextMenuEvent.Reason.Mouse, at, viewer.canvas.viewport().mapToGlobal(at)
    )
    QApplication.sendEvent(viewer.canvas.viewport(), event)
    menu = viewer.findChild(QMenu, "region.menu")
    assert menu is not None
    menu.close()


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


def test_a_key_switches_to_the_picture_that_is_measured(bench, viewer, hand):
    viewer.look_at("detector.magnitude")
    bench.settle()
    viewer.canvas.setFocus()
    hand.key(KEY.Key_R)
    bench.settle()
    assert viewer.choices.port == INPUT
    hand.drag((20, 30), (60, 90))
    assert stored(bench) == (20, 30, 40, 60)


def test_the_button_takes_the_only_module_there_is(bench, viewer):
    assert viewer.bar.region.isEnabled()
    QTest.mouseClick(viewer.bar.region, Qt.MouseButton.LeftButton)
    assert bench.session.selection == ("measured",)
    PictureHand(viewer).drag((20, 30), (60, 90))
    assert stored(bench) == (20, 30, 40, 60)


def test_a_node_that_vanishes_under_a_drag(bench, viewer, hand):
    hand.press((128, 128))
    hand.move((150, 128))
    bench.do(Remove(("measured",)))
    hand.move((160, 128))
    hand.release((160, 128))
    assert framed(viewer) is None


def test_a_drag_goes_on_under_another_name(bench, viewer, hand):
    bench.do(Rename("measured", "mtf"))
    hand.drag((128, 128), (129, 128))
    assert stored(bench, "mtf") == (97, 32, 64, 192)


def test_it_says_what_to_do(bench, viewer, hand):
    told = []
    bench.session.message.connect(lambda kind, text: told.append((kind, text)))
    hand.key(Qt.Key.Key_R)
    assert told == [("note", told[0][1])]
    assert "Drag a rectangle" in told[0][1]
    assert "Esc" in told[0][1]
    hand.drag((30, 40), (70, 90))
    bench.settle()
    assert "Arrow keys" in told[-1][1]
    assert len(told) == 2


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
