"""Nodes selected, moved and put into wires, with the mouse and with the keys."""

import pytest
from PySide6.QtCore import QEvent, QObject, QPoint, Qt
from PySide6.QtGui import QRegion
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from canvas_networks import chain_and_free_blur
from core.editing.document import Document
from core.editing.operations import Move
from core.network.network import Link

SHIFT = Qt.KeyboardModifier.ShiftModifier
CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def four(session, canvas, library):
    """A short chain, and a blur that lies free."""
    session.open(Document(chain_and_free_blur(), library=library))
    return session


def position(session):
    return session.document.history.position


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


def test_a_node_is_not_left_drawn_where_it_was_when_a_part_is_painted_first(four, canvas, qtbot):
    """As where the map opens in the corner while nodes make way for what is dropped."""
    viewport = canvas.view.viewport()
    qtbot.wait(100)
    item = canvas.content.nodes["blur"]
    before = canvas.view.mapFromScene(item.frame()).boundingRect()
    painted = PaintedRegion()
    viewport.installEventFilter(painted)
    four.do(Move({"blur": (240.0, 60.0)}))
    after = canvas.view.mapFromScene(item.frame()).boundingRect()
    assert not after.intersects(before)
    viewport.repaint(after)
    whole = QRegion(before).united(QRegion(after))
    QApplication.processEvents()
    assert whole.subtracted(painted.region).isEmpty()


class PaintedRegion(QObject):
    """All that is painted of a widget."""

    def __init__(self):
        super().__init__()
        self.region = QRegion()

    def eventFilter(self, _watched, event):  # noqa: N802 - Qt's name
        if event.type() == QEvent.Type.Paint:
            self.region = self.region.united(event.region())
        return False


def test_a_move_draws_only_what_it_changes_anew(four, canvas, qtbot):
    """Else a large network is painted whole at every step of a drag."""
    four.do(Move({"blur": (900.0, 900.0)}))
    far = canvas.content.wires[Link.between("scene.image", "init.image")]
    QApplication.processEvents()
    drawn = []
    canvas.view.scene().changed.connect(drawn.extend)
    four.do(Move({"blur": (930.0, 900.0)}))
    qtbot.waitUntil(lambda: bool(drawn))
    QApplication.processEvents()
    assert any(area.intersects(canvas.content.nodes["blur"].frame()) for area in drawn)
    assert not any(area.intersects(far.sceneBoundingRect()) for area in drawn)


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


def test_a_click_on_one_of_several_selected_leaves_that_one(four, hand):
    four.select(["scene", "init", "blur"])
    hand.click(hand.head("init"))
    assert four.selection == ("init",)


def test_the_canvas_shows_what_is_selected_elsewhere(four, canvas):
    four.select(["back"])
    assert canvas.content.nodes["back"].selected
    wires = canvas.content.wires
    assert wires[Link.between("init.phase", "back.phase")].lit
    assert not wires[Link.between("scene.image", "init.image")].lit
    four.select([])
    assert not canvas.content.nodes["back"].selected


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


def test_the_wire_that_takes_the_node_is_marked(four, canvas, hand):
    link = Link.between("init.magnitude", "back.magnitude")
    start, end = hand.head("blur"), hand.wire(link)
    hand.press(start)
    hand.move(start, end)
    assert canvas.content.wires[link].target
    hand.move(end, start)
    assert not canvas.content.wires[link].target
    hand.release(start)
    assert link in four.network.links


def test_a_wire_of_another_type_takes_no_node(four, hand):
    link = Link.between("scene.image", "init.image")
    hand.drag(hand.head("blur"), hand.wire(link))
    assert link in four.network.links
    assert not four.network.links_into("blur")


def test_a_double_click_tells_the_window(four, canvas, hand, qtbot):
    with qtbot.waitSignal(canvas.surface.activated) as told:
        hand.double_click(hand.head("init"))
    assert told.args == ["init"]


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


def test_an_arrow_selects_where_nothing_is(four, hand):
    hand.key(Qt.Key.Key_Right)
    assert len(four.selection) == 1
    assert position(four) == 0


def test_enter_opens_the_selected_node(four, canvas, hand, qtbot):
    four.select(["back"])
    with qtbot.waitSignal(canvas.surface.activated) as told:
        hand.key(Qt.Key.Key_Return)
    assert told.args == ["back"]
