"""Backdrops stand behind nodes, take them along, and are resized and titled in their place."""

import pytest
from PySide6.QtCore import QPoint, Qt

from canvas_networks import chain_and_free_blur
from core.editing.backdrops import around, backdrops_of
from core.editing.document import Document

SHIFT = Qt.KeyboardModifier.ShiftModifier
CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def grounded(session, canvas, library):
    """A backdrop behind the first two nodes."""
    session.open(Document(chain_and_free_blur(), library=library))
    session.do(around(session.network, ["scene", "init"], canvas.content.sizes(), "Front end"))
    return session


def position(session):
    return session.document.position


def test_a_backdrop_takes_its_nodes_along_is_resized_and_titled(grounded, canvas, hand):
    (before,) = backdrops_of(grounded.network)
    start = hand.at(before.x + 60, before.y + 10)
    hand.drag(start, start + QPoint(20, -40))
    (after,) = backdrops_of(grounded.network)
    assert (after.x - before.x, after.y - before.y) == (20, -40)
    assert grounded.network.layout["scene"] == (20.0, -40.0)
    assert grounded.network.layout["init"] == (260.0, -40.0)
    assert grounded.network.layout["back"] == (720.0, 0.0)
    assert position(grounded) == 2
    grounded.undo()
    assert backdrops_of(grounded.network) == (before,)
    assert grounded.network.layout["scene"] == (0.0, 0.0)
    assert canvas.content.backdrops[0].frame().x() == before.x
    corner = hand.at(before.x + before.width - 5, before.y + before.height - 5)
    hand.drag(corner, corner + QPoint(60, 35))
    (after,) = backdrops_of(grounded.network)
    assert (after.width - before.width, after.height - before.height) == (60, 35)
    assert (after.x, after.y) == (before.x, before.y)
    assert canvas.content.backdrops[0].frame().width() == after.width
    hand.drag(corner + QPoint(60, 35), corner + QPoint(-900, -900))
    (least,) = backdrops_of(grounded.network)
    assert least.width > 0
    assert least.height > 0
    grounded.undo()
    # Its title is edited in its place.
    hand.double_click(hand.at(before.x + 60, before.y + 10))
    assert canvas.title_editor.isVisible()
    assert canvas.title_editor.text() == "Front end"
    hand.key(Qt.Key.Key_A, CTRL)
    hand.type("Source")
    hand.key(Qt.Key.Key_Return)
    assert not canvas.title_editor.isVisible()
    assert backdrops_of(grounded.network)[0].title == "Source"
    assert canvas.content.backdrops[0].title == "Source"


def test_the_keys_reach_a_backdrop(grounded, canvas, hand):
    (before,) = backdrops_of(grounded.network)
    grounded.select(["init"])
    hand.key(Qt.Key.Key_Up, CTRL)
    assert canvas.marks.backdrop is canvas.content.backdrops[0]
    hand.key(Qt.Key.Key_Left)
    (moved,) = backdrops_of(grounded.network)
    assert moved.x < before.x
    assert grounded.network.layout["scene"][0] == moved.x - before.x
    hand.key(Qt.Key.Key_Down, SHIFT)
    (grown,) = backdrops_of(grounded.network)
    assert grown.height > before.height
    hand.key(Qt.Key.Key_Return)
    hand.type("S")
    hand.key(Qt.Key.Key_Return)
    assert backdrops_of(grounded.network)[0].title == "S"
