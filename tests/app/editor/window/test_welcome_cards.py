"""The first page: the network to begin with stands first, each with what it shows."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QWidget

from app.editor.window.main_window import MainWindow
from app.editor.window.welcome import NetworkCard
from app.run.shipped import shipped_networks


def cards(window):
    """The networks' buttons in reading order."""
    found = [window.findChild(QWidget, f"welcome.{name}") for name in shipped_networks()]

    def place(card):
        at = card.mapTo(window, QPoint())
        return at.y(), at.x()

    return sorted(found, key=place)


@pytest.mark.parametrize("size", [(1000, 700), (1366, 768), (2560, 1440)])
def test_first_steps_stand_first_with_every_description(window, qtbot, size):
    window.resize(*size)
    qtbot.wait(50)
    shown = cards(window)
    assert shown[0].objectName() == "welcome.first_steps"
    for card in shown:
        file = shipped_networks()[card.objectName().partition(".")[2]]
        document = json.loads(file.read_text())
        labels = {label.text(): label for label in card.findChildren(QLabel)}
        assert document["name"] in labels
        about = labels[document["description"]]
        assert about.isVisible()
        assert about.height() >= about.heightForWidth(about.width())  # nothing is cut
        assert card.rect().contains(about.geometry())
        assert card.accessibleDescription() == document["description"]


def test_it_is_opened_by_mouse_and_by_keys(make_window, qtbot, tmp_path):
    window = make_window()
    card = cards(window)[0]
    label = card.findChildren(QLabel)[-1]
    spot = label.mapTo(card, label.rect().center())
    under = window.childAt(card.mapTo(window, spot))
    QTest.mouseClick(
        under, Qt.MouseButton.LeftButton, pos=under.mapFrom(window, card.mapTo(window, spot))
    )
    assert window.session.network.name == "First steps"
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
