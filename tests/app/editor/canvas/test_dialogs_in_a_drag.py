"""A dialog opened by a key while a button is held: the release behind it never arrives."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QMessageBox

from app.editor.canvas.wires import LiveWire
from canvas_networks import chain_and_free_blur
from core.editing.document import Document
from panel_hands import drop, field_of, panel_area

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def four(session, canvas, library):
    """A short chain, and a blur that lies free."""
    session.open(Document(chain_and_free_blur(), library=library))
    return session


def live_wire(canvas):
    """The wire that the mouse draws."""
    (live,) = (item for item in canvas.view.scene().items() if isinstance(item, LiveWire))
    return live


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


def test_a_dragged_wire_is_dropped(qtbot, four, canvas, hand):
    before = four.network
    start, end = hand.port("scene", "image", "output"), hand.at(200, 200)
    hand.press(start)
    hand.move(start, end)
    assert live_wire(canvas).isVisible()
    answer_a_question(qtbot, canvas)
    assert not live_wire(canvas).isVisible()
    hand.release(end)
    assert four.network is before


def test_a_slider_follows_the_document_again(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "gaussian_mtf")
    field = field_of(area, session, "sigma_x_mrad")
    slider, before = field.slider, field.slider.value()
    handle = QPoint(slider.height() // 2, slider.height() // 2)
    QTest.mousePress(slider, LEFT, pos=handle)
    QTest.mouseMove(slider, handle + QPoint(slider.width() // 2, 0))
    assert slider.isSliderDown()
    assert slider.value() != before
    answer_a_question(qtbot, area)
    session.undo()
    assert slider.value() == before
    QTest.mouseRelease(slider, LEFT, pos=handle)  # Qt's own note of pressed buttons outlives tests


def test_a_dragged_label_ends_its_step(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "gaussian_mtf")
    field = field_of(area, session, "sigma_x_mrad")
    position = session.document.history.position
    middle = field.label.rect().center()
    for _ in range(2):
        QTest.mousePress(field.label, LEFT, pos=middle)
        QTest.mouseMove(field.label, middle + QPoint(20, 0))
        answer_a_question(qtbot, area)
    assert session.document.history.position == position + 2
    elsewhere = QLineEdit()  # the label takes no release of a press that it has given up
    qtbot.addWidget(elsewhere)
    elsewhere.show()
    QTest.mouseRelease(elsewhere, LEFT)
