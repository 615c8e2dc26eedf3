"""The first page: networks by what one wants to do, each with what is special of it."""

import json

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget

from app.editor.window.main_window import MainWindow
from app.editor.window.welcome import GROUPS, NetworkCard, SpecialDrawing, read_data
from app.run.shipped import shipped_networks
from gallery_curves import CUBE, FILE, SOURCES, curves_of

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
    names = [name for group in read_data(GROUPS).values() for name in group]
    assert [card.name for card in cards(window)] == names
    assert set(names) == set(shipped_networks())
    assert sorted(names[-4:]) == sorted(f"{one}{year}" for one in SENSORS for year in ("", "_1996"))
    for card in cards(window):
        document = json.loads(shipped_networks()[card.name].read_text())
        assert card.title.text() == document["name"]
        assert card.accessibleDescription() == document["description"]
        for label in (card.title, card.line):
            assert label.isVisible()
            assert label.height() >= label.heightForWidth(label.width())  # nothing is cut
            assert card.rect().contains(label.geometry())


def test_no_two_cards_show_the_same(window):
    seen = {}
    for drawing in window.findChildren(SpecialDrawing):
        seen.setdefault(bytes(drawing.grab().toImage().constBits()), []).append(drawing)
    assert len(seen) == len(shipped_networks())


def test_curves_of_the_cards_are_those_that_the_networks_give():
    stored = json.loads(FILE.read_text())
    assert set(stored) == {*SOURCES, CUBE}
    for name in ("measured_mtf", CUBE):
        for (colour, line), (wanted, points) in zip(stored[name], curves_of(name), strict=True):
            assert colour == wanted
            assert np.allclose(line, points, atol=5)  # thousandths of the drawing


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


def test_it_is_opened_by_mouse_and_by_keys(make_window, qtbot, tmp_path):
    window = make_window()
    card = cards(window)[0]
    label = card.findChildren(QLabel)[-1]
    spot = label.mapTo(card, label.rect().center())
    under = window.childAt(card.mapTo(window, spot))
    QTest.mouseClick(
        under, Qt.MouseButton.LeftButton, pos=under.mapFrom(window, card.mapTo(window, spot))
    )
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
    assert window.findChildren(NetworkCard) == []
    window.show_welcome()
    assert len(cards(window)) == len(shipped_networks())
    assert all(card.isVisible() for card in cards(window))
    window.close_for_good()
