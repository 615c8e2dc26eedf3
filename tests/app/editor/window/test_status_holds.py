"""The status bar shows nothing that no longer holds, and the empty canvas what to do first."""

from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QWidget

from core.editing.operations import set_parameter
from core.network.network import Link
from region_hands import PictureHand
from window_hands import CTRL, KEY, add, give_focus


def test_that_it_was_saved_is_gone_with_the_next_edit(window, hand, tmp_path):
    add(window, "test_scene")
    assert window.session.save(tmp_path / "mine.json")
    window.files.save()
    assert "saved" in window.status.note
    hand.click(hand.middle("test_scene"))
    assert "saved" in window.status.note  # it still is
    hand.key(KEY.Key_D)
    assert window.status.note == ""


def test_what_to_select_is_gone_once_something_is_selected(window, hand):
    add(window, "test_scene")
    window.session.select([])
    hand.key(KEY.Key_F1)
    assert "select a node" in window.status.note
    hand.click(hand.middle("test_scene"))
    assert window.status.note == ""


def test_that_a_node_shows_nothing_is_gone_with_its_wire(window, hand, idle):
    add(window, "test_scene", (0.0, 0.0))
    add(window, "write_image", (300.0, 0.0))
    hand.click(hand.middle("write_image"))
    hand.key(KEY.Key_1)
    assert "it has no input" in window.status.note
    hand.drag(
        hand.port("test_scene", "image", "output"), hand.port("write_image", "image", "input")
    )
    assert Link("test_scene", "image", "write_image", "image") in window.session.network.links
    assert window.status.note == ""


def test_that_work_was_left_behind_is_gone_where_it_is_offered(window):
    window.session.message.emit("error", "unsaved work was left behind: see File > New from…")
    window.actions_by_name["welcome"].trigger()
    assert window.status.error == ""


def test_what_a_region_takes_is_said_after_it_was_drawn(window, idle, qtbot):
    """The note comes after the changes of the drag, and holds."""
    window.files.open_now("measured_mtf")
    idle(window)
    viewer = window.viewers.images[1]
    hands = PictureHand(viewer)
    give_focus(viewer.canvas)
    hands.key(Qt.Key.Key_R)
    hands.drag((30, 40), (70, 90))
    idle(window)
    assert "Arrow keys" in window.status.note
    window.session.do(set_parameter("measured", "samples", 65))
    assert window.status.note == ""


# --- an empty canvas -----------------------------------------------------------------------------


def hint_of(window):
    return window.findChild(QLabel, "canvas.empty_hint")


def test_an_empty_canvas_says_what_to_do_until_there_is_a_node(window, hand):
    hint = hint_of(window)
    assert hint.isVisible()
    for words in ("Tab", "double-click", "library", "file"):
        assert words in hint.text()
    add(window, "test_scene")
    assert not hint.isVisible()
    hand.key(KEY.Key_Z, CTRL)
    assert hint.isVisible()
    window.files.open_now("first_steps")
    assert not hint.isVisible()


def test_the_hint_is_in_the_middle_at_any_size_and_lets_the_mouse_through(window, hand, qtbot):
    hint = hint_of(window)
    for size in ((1000, 700), (1700, 1000)):
        window.resize(*size)
        qtbot.wait(50)
        ground = window.canvas.view.viewport()
        middle = hint.mapTo(ground, hint.rect().center())
        assert abs(middle.x() - ground.rect().center().x()) <= 2
        assert abs(middle.y() - ground.rect().center().y()) <= 2
    hand.double_click(QPoint(*ground.rect().center().toTuple()))
    assert window.canvas.popup.is_open
    QTest.keyClick(window.canvas.popup.findChild(QWidget), Qt.Key.Key_Escape)
