"""Backdrops stand behind nodes, take them along, and are resized and titled in their place."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QStyleOptionGraphicsItem

from canvas_networks import chain_and_free_blur
from core.editing.backdrops import around, backdrops_of
from core.editing.document import Document

SHIFT = Qt.KeyboardModifier.ShiftModifier
CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def grounded(session, canvas, library):
    """A backdrop behind the first two nodes."""
    session.open(Document(chain_and_free_blur(), library=library))
    session.do(around(session.network, ["scene", "init"], canvas.sizes(), "Front end"))
    return session


def position(session):
    return session.document.history.position


def test_a_backdrop_stands_behind_its_nodes(grounded, canvas):
    (item,) = canvas.content.backdrops
    assert item.title == "Front end"
    for name in ("scene", "init"):
        assert item.frame().contains(canvas.content.nodes[name].frame())
        assert item.zValue() < canvas.content.nodes[name].zValue()
    grounded.undo()
    assert not canvas.content.backdrops


def test_a_backdrop_takes_its_nodes_along_in_one_step(grounded, canvas, hand):
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


def test_a_backdrops_corner_resizes_it(grounded, canvas, hand):
    (before,) = backdrops_of(grounded.network)
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


def test_a_title_is_edited_in_its_place(grounded, canvas, hand):
    (before,) = backdrops_of(grounded.network)
    hand.double_click(hand.at(before.x + 60, before.y + 10))
    assert canvas.title_editor.isVisible()
    assert canvas.title_editor.text() == "Front end"
    hand.key(Qt.Key.Key_A, CTRL)
    hand.type("Source")
    hand.key(Qt.Key.Key_Return)
    assert not canvas.title_editor.isVisible()
    assert backdrops_of(grounded.network)[0].title == "Source"
    assert canvas.content.backdrops[0].title == "Source"


@pytest.mark.parametrize("zoom", [0.2, 0.4, 2.0])
def test_a_title_is_drawn_where_it_is_dragged_by(grounded, canvas, zoom):
    """Far away it stands above the ground, in letters that can still be read."""
    (item,) = canvas.content.backdrops
    drawn = {}
    for title in ("Front end", ""):
        item.show_backdrop(replace(item.shown, title=title))
        image = QImage(900, 400, QImage.Format.Format_ARGB32)
        image.fill(Qt.GlobalColor.white)
        painter = QPainter(image)
        painter.translate(20, 200)
        painter.scale(zoom, zoom)
        item.paint(painter, QStyleOptionGraphicsItem())
        painter.end()
        flat = np.frombuffer(image.constBits(), np.uint32).reshape(400, 900)
        drawn[title] = flat.copy()
    rows = np.flatnonzero((drawn["Front end"] != drawn[""]).any(axis=1)) - 200
    head = item.head(zoom).translated(-item.pos())
    assert zoom * head.top() <= rows.min() <= rows.max() <= zoom * head.bottom()
    assert bool(rows.max() < 0) is (zoom < 0.5)
    assert np.ptp(rows) >= 6


def test_escape_leaves_the_title(grounded, canvas, hand):
    (before,) = backdrops_of(grounded.network)
    hand.double_click(hand.at(before.x + 60, before.y + 10))
    hand.type("Other")
    hand.key(Qt.Key.Key_Escape)
    assert not canvas.title_editor.isVisible()
    assert backdrops_of(grounded.network) == (before,)


def test_a_backdrop_is_deleted_and_its_nodes_stay(grounded, canvas, hand):
    (ground,) = backdrops_of(grounded.network)
    hand.click(hand.at(ground.x + 60, ground.y + 10))
    canvas.menus.delete_backdrop()
    assert not backdrops_of(grounded.network)
    assert set(grounded.network.nodes) == {"scene", "init", "back", "blur"}
    canvas.menus.delete_backdrop()


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
