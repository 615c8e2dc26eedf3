"""The page of shortcuts: searched by words and by keys, without the mouse."""

import pytest

from app.editor.window.help import OR, ShortcutList, shortcuts_of
from window_hands import CTRL, KEY, WindowHands


@pytest.fixture
def hand(window):
    made = WindowHands(window)
    made.begin()
    return made


@pytest.fixture
def page(window, hand, qtbot):
    hand.key(KEY.Key_Question)
    made = window.findChild(ShortcutList, "shortcuts")
    qtbot.waitUntil(made.search.hasFocus)
    return made


def actions(page):
    table = page.table
    rows = [row for row in range(table.rowCount()) if not table.isRowHidden(row)]
    return [table.item(row, 1).text() for row in rows]


def test_every_action_is_found_by_its_words_and_by_its_keys(page, window):
    for _, action, keys, _ in shortcuts_of(window.actions_by_name):
        for text in (action, *filter(None, keys.split(OR))):
            page.search.setText(text)
            assert action in actions(page), text


def test_a_word_that_is_nowhere_leaves_no_line_and_escape_closes(hand, page):
    hand.type("espresso")
    assert actions(page) == []
    hand.key(KEY.Key_A, CTRL)
    hand.key(KEY.Key_Delete)
    assert len(actions(page)) > 40
    hand.key(KEY.Key_Escape)
    assert not page.isVisible()
