"""The page of shortcuts: searched by words and by keys, without the mouse."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from shiboken6 import isValid

from app.editor.window.help import OR, ShortcutList, shortcuts_of
from app.editor.window.recent_files import Settings
from window_hands import CTRL, KEY, SHIFT, WindowHands

ALT = Qt.KeyboardModifier.AltModifier


@pytest.fixture
def hand(window, qtbot):
    made = WindowHands(window)
    made.begin()
    made.wait_until = qtbot.waitUntil
    return made


@pytest.fixture
def page(window, hand, qtbot):
    hand.key(KEY.Key_Question)
    made = window.findChild(ShortcutList, "shortcuts")
    qtbot.waitUntil(made.search.hasFocus)
    yield made
    if isValid(made):  # else a test has closed it
        made.reject()


def actions(page):
    table = page.table
    return [table.item(row, 1).text() for row in range(table.rowCount())]


def press(hand, page, key, keys=Qt.KeyboardModifier.NoModifier):
    """Press a key in the mode, begun by its letter; a button is down for a moment first."""
    hand.key(KEY.Key_K, ALT)
    hand.wait_until(page.catcher.isChecked)
    hand.key(key, keys)


def test_every_action_is_found_by_its_words_and_by_its_keys(page, window):
    for row in shortcuts_of(window.actions_by_name):
        action = row.action
        for text in (action, *filter(None, row.keys.split(OR))):
            page.search.clear()
            QTest.keyClicks(page.search, text)
            assert action in actions(page), text
            if text != action:
                assert actions(page)[0] == action, text


def test_what_is_not_there_is_one_line(hand, page):
    hand.type("espresso")
    assert page.none.isVisible()
    assert page.none.text() == "No shortcut has “espresso”"
    assert not page.table.isVisible()
    hand.key(KEY.Key_A, CTRL)
    hand.key(KEY.Key_Delete)
    assert page.table.isVisible()
    assert len(actions(page)) > 40


@pytest.mark.parametrize(
    ("key", "keys", "action"),
    [
        (KEY.Key_Escape, None, "Cancel"),
        (KEY.Key_Q, CTRL, "Quit"),
        (KEY.Key_Plus, CTRL | SHIFT, "Zoom In"),
    ],
)
def test_pressed_keys_find_their_action_and_do_nothing_else(window, hand, page, key, keys, action):
    before = window.session.network
    press(hand, page, key, keys or Qt.KeyboardModifier.NoModifier)
    assert actions(page) == [action]
    assert not page.catcher.isChecked()
    assert page.search.hasFocus()
    assert page.isVisible()
    assert window.isVisible()
    assert window.session.network is before


def test_arrows_go_into_the_list_and_escape_closes(hand, page, qtbot):
    hand.type("align")
    hand.key(KEY.Key_Down)
    assert page.table.hasFocus()
    assert page.table.currentRow() == 0
    hand.key(KEY.Key_Down)
    assert page.table.currentRow() == 1
    hand.key(KEY.Key_Escape)
    assert not page.isVisible()


def change(hand, page, word, key, keys=Qt.KeyboardModifier.NoModifier):
    page.search.setFocus()
    page.search.selectAll()
    hand.type(word)
    hand.key(KEY.Key_Down)
    hand.key(KEY.Key_C, ALT)
    hand.wait_until(page.changer.isChecked)
    hand.key(key, keys)


def test_keys_are_changed_kept_and_put_back(hand, page, window, settings, make_window):
    change(hand, page, "lay out", KEY.Key_J, CTRL)
    action = window.actions_by_name["arrange"]
    assert [key.toString() for key in action.shortcuts()] == ["Ctrl+J"]
    assert page.table.item(page.table.currentRow(), 2).text() == "Ctrl+J"
    hand.key(KEY.Key_R, ALT)
    hand.wait_until(lambda: not action.shortcuts())
    hand.key(KEY.Key_D, ALT)
    hand.wait_until(lambda: [key.toString() for key in action.shortcuts()] == ["L"])
    assert Settings(settings.path).keys == {}
    change(hand, page, "lay out", KEY.Key_J, CTRL)
    again = make_window(settings=Settings(settings.path)).actions_by_name
    assert again["arrange"].shortcut().toString() == "Ctrl+J"
