"""Nodes selected, moved and put into wires, with the mouse and with the keys."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox

from canvas_networks import chain_and_free_blur
from core.editing.document import Document
from core.network.network import Link

SHIFT = Qt.KeyboardModifier.ShiftModifier
CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def four(session, canvas, library):
    """A short chain, and a blur that lies free."""
    session.open(Document(chain_and_free_blur(), library=library))
    return session


def position(session):
    return session.document.position


def test_a_drag_is_one_step_that_escape_or_a_question_gives_up(four, canvas, hand, qtbot):
    before = four.network
    start = hand.head("blur")
    hand.drag(start, start + QPoint(50, 30))
    assert four.network.layout["blur"] == (290.0, 290.0)
    assert position(four) == 1
    four.undo()
    assert four.network.layout["blur"] == (240.0, 260.0)
    assert canvas.content.nodes["blur"].y() == 260.0
    hand.drag(start, start + QPoint(1, 1))  # a trembling click moves nothing
    assert four.network == before
    assert four.selection == ("blur",)
    # The document stays as it is while the mouse drags.
    before = four.network
    start = hand.head("init")
    wire = canvas.content.wires[Link.between("scene.image", "init.image")]
    for give_up in (lambda: hand.key(Qt.Key.Key_Escape), lambda: answer_a_question(qtbot, canvas)):
        hand.press(start)
        hand.move(start, start + QPoint(0, 80))
        assert four.network is before
        assert canvas.content.nodes["init"].y() == 80.0
        assert wire.path().pointAtPercent(1) == wire.input_port.scenePos()
        give_up()
        assert canvas.content.nodes["init"].y() == 0.0
        hand.move(start, start + QPoint(60, 120))  # it follows no more
        assert canvas.content.nodes["init"].y() == 0.0
        hand.release(start + QPoint(60, 120))
        assert four.network is before
    # Selected nodes are dragged together.
    four.select(["scene", "blur"])
    start = hand.head("scene")
    hand.drag(start, start + QPoint(-30, 60))
    assert four.network.layout["scene"] == (-30.0, 60.0)
    assert four.network.layout["blur"] == (210.0, 320.0)
    assert four.network.layout["init"] == (240.0, 0.0)
    assert four.selection == ("scene", "blur")
    assert position(four) == 1


def answer_a_question(qtbot, parent):
    """Open a modal question over the window, and leave it by Esc.

    The release behind it never arrives.
    """
    box = QMessageBox(parent.window())
    box.open()
    qtbot.waitExposed(box)
    QApplication.processEvents()
    QTest.keyClick(box, Qt.Key.Key_Escape)
    qtbot.waitUntil(lambda: not box.isVisible())
    box.deleteLater()


def test_clicks_frames_and_keys_select(four, canvas, hand):
    hand.click(hand.head("scene"))
    hand.click(hand.head("blur"), SHIFT)
    assert four.selection == ("scene", "blur")
    assert [name for name, item in canvas.content.nodes.items() if item.selected] == [
        "scene",
        "blur",
    ]
    hand.click(hand.head("scene"), SHIFT)
    assert four.selection == ("blur",)
    hand.click(hand.head("init"))
    assert four.selection == ("init",)
    hand.click(hand.at(100, 350))
    assert four.selection == ()
    hand.drag(hand.at(-30, -40), hand.at(300, 60))
    assert four.selection == ("scene", "init")
    hand.drag(hand.at(200, 220), hand.at(500, 350), SHIFT)
    assert four.selection == ("scene", "init", "blur")
    hand.drag(hand.at(-30, 350), hand.at(100, 380))
    assert four.selection == ()
    four.select(["scene"])
    hand.key(Qt.Key.Key_Right, CTRL)
    assert four.selection == ("init",)
    hand.key(Qt.Key.Key_Down, CTRL)
    assert four.selection == ("blur",)
    hand.key(Qt.Key.Key_Up, CTRL)
    hand.key(Qt.Key.Key_Right, CTRL | SHIFT)
    assert four.selection == ("init", "back")


def test_a_node_dropped_on_a_wire_is_put_into_it(four, canvas, hand):
    link = Link.between("init.magnitude", "back.magnitude")
    hand.drag(hand.head("blur"), hand.wire(link))
    assert set(four.network.links_into("blur")) == {
        Link.between("init.magnitude", "blur.magnitude"),
        Link.between("init.context", "blur.context"),
    }
    assert Link.between("blur.magnitude", "back.magnitude") in four.network.links
    assert link not in four.network.links
    assert four.network.layout["blur"][1] < 100
    assert position(four) == 1
    four.undo()
    assert link in four.network.links
    assert four.network.layout["blur"] == (240.0, 260.0)
    # A wire of another type takes no node.
    link = Link.between("scene.image", "init.image")
    hand.drag(hand.head("blur"), hand.wire(link))
    assert link in four.network.links
    assert not four.network.links_into("blur")


# --- the keys -----------------------------------------------------------------------------------


def test_arrows_move_what_is_selected_one_step_for_each_hold(four, canvas):
    four.select(["blur"])
    view = canvas.view
    for _ in range(3):
        QTest.keyPress(view, Qt.Key.Key_Right)
    QTest.keyRelease(view, Qt.Key.Key_Right)
    x, y = four.network.layout["blur"]
    assert x > 240.0
    assert y == 260.0
    assert position(four) == 1
    QTest.keyClick(view, Qt.Key.Key_Up, SHIFT)
    assert four.network.layout["blur"] == (x, 259.0)
    assert position(four) == 2
    four.undo()
    four.undo()
    assert four.network.layout["blur"] == (240.0, 260.0)
