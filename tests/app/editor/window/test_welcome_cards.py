"""The first page: networks by what one wants to do, each with what is special of it."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QFont
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget

from app.editor.window.main_window import MainWindow
from app.editor.window.welcome import Card, gallery
from app.run.shipped import shipped_networks

SENSORS = ("inframetrics", "kodak_kir310")


def cards(window):
    """The networks' buttons in reading order."""
    found = [window.findChild(QWidget, f"welcome.{name}") for name in shipped_networks()]

    def place(card):
        at = card.mapTo(window, QPoint())
        return at.y(), at.x()

    return sorted(found, key=place)


@pytest.mark.parametrize("size", [(704, 463), (1366, 768)])
def test_cards_stand_in_groups_with_their_lines_and_the_sensors_of_1996_last(window, qtbot, size):
    window.resize(*size)
    qtbot.wait(50)
    names = [name for group in gallery().values() for name in group]
    assert [card.objectName().removeprefix("welcome.") for card in cards(window)] == names
    assert set(names) == set(shipped_networks())
    assert sorted(names[-4:]) == sorted(f"{one}{year}" for one in SENSORS for year in ("", "_1996"))
    for name, card in zip(names, cards(window), strict=True):
        document = json.loads(shipped_networks()[name].read_text())
        assert card.accessibleName() == document["name"]
        assert card.accessibleDescription() == document["description"]
        assert any(not label.pixmap().isNull() for label in card.findChildren(QLabel))
        assert card.width() >= card.minimumSizeHint().width()  # nothing is cut
        assert card.height() >= card.layout().heightForWidth(card.width())


def test_cards_are_written_in_the_fonts_of_the_window(make_window):
    before = QApplication.font()
    large = QFont(before)
    large.setPointSizeF(1.6 * before.pointSizeF())
    QApplication.setFont(large)
    try:
        window = make_window()
        sizes = {label.font().pointSizeF() for label in cards(window)[0].findChildren(QLabel)}
        assert sizes == {large.pointSizeF()}
    finally:
        QApplication.setFont(before)


def test_one_key_shows_them_and_leads_back(make_window, qtbot):
    window = make_window()
    action = window.actions_by_name["welcome"]
    assert action.shortcut() == "Ctrl+Shift+N"
    assert action in window.menus["&File"].actions()
    assert not window.welcome.back.isVisible()
    window.files.open_now("first_steps")
    window.activateWindow()
    qtbot.waitUntil(window.canvas.view.hasFocus)
    for shown in (True, False):
        with_both = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
        QTest.keyClick(QApplication.focusWidget() or window, Qt.Key.Key_N, with_both)
        qtbot.waitUntil(lambda shown=shown: window.pages.at_first == shown)
    action.trigger()
    assert window.welcome.back.text() == "Back to First steps"
    window.welcome.back.click()
    assert not window.pages.at_first
    window.files.new()
    for shown in (True, False):  # an empty network is one to return to as well
        action.trigger()
        assert window.pages.at_first == shown


def test_it_is_opened_by_mouse_and_by_keys(make_window, qtbot, tmp_path):
    window = make_window()
    card = cards(window)[0]
    QTest.mouseClick(card, Qt.MouseButton.LeftButton)
    assert window.session.network.name == "Cooled MWIR camera"
    window.show_welcome()
    other = cards(window)[1]
    other.setFocus()
    qtbot.waitUntil(other.hasFocus)
    QTest.keyClick(other, Qt.Key.Key_Space)
    assert window.session.network.name == other.accessibleName()


def test_opening_a_network_at_the_start_builds_no_card(library, settings, tmp_path, qtbot):
    """Their networks load nearly every module."""
    window = MainWindow(library=library, settings=settings, recovery=tmp_path)
    qtbot.addWidget(window)
    window.open_first("first_steps")
    window.show()
    qtbot.waitExposed(window)
    assert window.findChildren(Card) == []
    window.show_welcome()
    assert len(cards(window)) == len(shipped_networks())
    assert all(card.isVisible() for card in cards(window))
    window.close_for_good()
