"""Nodes selected, moved and put into wires, with the mouse and with the keys."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

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


def test_a_drag_is_one_step(four, canvas, hand):
    start = hand.head("blur")
    hand.drag(start, start + QPoint(50, 30))
    assert four.network.layout["blur"] == (290.0, 290.0)
    assert position(four) == 1
    four.undo()
    assert four.network.layout["blur"] == (240.0, 260.0)
    assert canvas.content.nodes["blur"].y() == 260.0


def test_the_document_stays_as_it_is_while_the_mouse_drags(four, canvas, hand):
    before = four.network
    start = hand.head("init")
    hand.press(start)
    hand.move(start, start + QPoint(0, 80))
    assert four.network is before
    assert canvas.content.nodes["init"].y() == 80.0
    wire = canvas.content.wires[Link.between("scene.image", "init.image")]
    assert wire.path().pointAtPercent(1) == wire.input_port.scenePos()
    hand.release(start + QPoint(0, 80))
    assert four.network is not before


def test_escape_puts_a_dragged_node_back(four, canvas, hand):
    before = four.network
    start = hand.head("init")
    hand.press(start)
    hand.move(start, start + QPoint(40, 80))
    hand.key(Qt.Key.Key_Escape)
    assert canvas.content.nodes["init"].y() == 0.0
    hand.release(start + QPoint(40, 80))
    assert four.network is before


def test_selected_nodes_are_dragged_together(four, hand):
    four.select(["scene", "blur"])
    start = hand.head("scene")
    hand.drag(start, start + QPoint(-30, 60))
    assert four.network.layout["scene"] == (-30.0, 60.0)
    assert four.network.layout["blur"] == (210.0, 320.0)
    assert four.network.layout["init"] == (240.0, 0.0)
    assert four.selection == ("scene", "blur")
    assert position(four) == 1


def test_a_trembling_click_moves_nothing(four, hand):
    before = four.network
    start = hand.head("scene")
    hand.drag(start, start + QPoint(1, 1))
    assert four.network is before
    assert four.selection == ("scene",)


def test_clicks_select_and_shift_adds_and_takes_away(four, canvas, hand):
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


def test_a_frame_selects_what_it_meets(four, hand):
    hand.drag(hand.at(-30, -40), hand.at(300, 60))
    assert four.selection == ("scene", "init")
    hand.drag(hand.at(200, 220), hand.at(500, 350), SHIFT)
    assert four.selection == ("scene", "init", "blur")
    hand.drag(hand.at(-30, 350), hand.at(100, 380))
    assert four.selection == ()


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


def test_a_wire_of_another_type_takes_no_node(four, hand):
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


def test_arrows_with_ctrl_go_from_node_to_node(four, hand):
    four.select(["scene"])
    hand.key(Qt.Key.Key_Right, CTRL)
    assert four.selection == ("init",)
    hand.key(Qt.Key.Key_Down, CTRL)
    assert four.selection == ("blur",)
    hand.key(Qt.Key.Key_Up, CTRL)
    hand.key(Qt.Key.Key_Right, CTRL | SHIFT)
    assert four.selection == ("init", "back")
