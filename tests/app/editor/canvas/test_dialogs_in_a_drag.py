"""A dialog opened by a key while a button is held: the release behind it never arrives."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox

from canvas_networks import chain_and_free_blur
from core.editing.document import Document


@pytest.fixture
def four(session, canvas, library):
    """A short chain, and a blur that lies free."""
    session.open(Document(chain_and_free_blur(), library=library))
    return session


def answer_a_question(qtbot, parent):
    """Open a modal question over the window, and leave it by Esc."""
    box = QMessageBox(parent.window())
    box.open()
    qtbot.waitExposed(box)
    QApplication.processEvents()
    QTest.keyClick(box, Qt.Key.Key_Escape)
    qtbot.waitUntil(lambda: not box.isVisible())
    box.deleteLater()


def test_a_dragged_node_goes_back_and_follows_no_more(qtbot, four, canvas, hand):
    before = four.network
    start = hand.head("init")
    hand.press(start)
    hand.move(start, start + QPoint(40, 80))
    assert canvas.content.nodes["init"].y() == 80.0
    answer_a_question(qtbot, canvas)
    assert canvas.content.nodes["init"].y() == 0.0
    hand.move(start, start + QPoint(60, 120))
    assert canvas.content.nodes["init"].y() == 0.0
    hand.release(start + QPoint(60, 120))
    assert four.network is before
