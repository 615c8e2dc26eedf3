"""The list of the history, by mouse and keys in the window."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from core.editing.operations import set_parameter
from window_hands import CTRL, KEY, add

LEFT = Qt.MouseButton.LeftButton
ROLE = Qt.ItemDataRole


@pytest.fixture
def steps(window, hand):
    """A node, and its parameter set three times; the list is open."""
    name = add(window, "jitter_mtf")
    for value in (0.1, 0.2, 0.3):
        window.session.do(set_parameter(name, "sigma_mrad", value))
    hand.focus()
    hand.key(KEY.Key_H, CTRL)
    return name


def rows(window):
    model = window.history.model()
    return [model.index(row).data() for row in range(model.rowCount())]


def looks(window, role):
    model = window.history.model()
    return [model.index(row).data(role) for row in range(model.rowCount())]


def click(window, row):
    view = window.history
    spot = view.visualRect(view.model().index(row)).center()
    QTest.mouseClick(view.viewport(), LEFT, pos=spot)


def sigma(window, name):
    return window.session.network.nodes[name].params.get("sigma_mrad")


def test_ctrl_h_lists_the_steps_with_the_focus_and_puts_them_away(window, hand, steps):
    assert window.history.isVisible()
    assert window.history.hasFocus()
    assert window.actions_by_name["history"].isChecked()
    assert rows(window) == [
        "Start",
        "Add jitter_mtf",
        "Set jitter_mtf.sigma_mrad: default → 0.1",
        "Set jitter_mtf.sigma_mrad: 0.1 → 0.2",
        "Set jitter_mtf.sigma_mrad: 0.2 → 0.3",
    ]
    assert [font.bold() for font in looks(window, ROLE.FontRole)] == [False] * 4 + [True]
    hand.key(KEY.Key_H, CTRL)
    assert not window.history.isVisible()
    assert not window.actions_by_name["history"].isChecked()


def test_a_click_goes_back_several_steps_at_once_and_forth_again(window, steps):
    calls = []
    window.session.changed.connect(lambda *_: calls.append(1))
    click(window, 2)
    assert sigma(window, steps) == 0.1
    assert len(calls) == 1
    assert [font.italic() for font in looks(window, ROLE.FontRole)] == [False] * 3 + [True] * 2
    assert looks(window, ROLE.FontRole)[2].bold()
    click(window, 4)
    assert sigma(window, steps) == 0.3
    assert len(calls) == 2


def test_arrows_and_enter_go_without_the_mouse(window, hand, steps):
    for _ in range(4):
        hand.key(KEY.Key_Up)
    assert sigma(window, steps) == 0.3, "to look is not to go"
    hand.key(KEY.Key_Return)
    assert not window.session.network.nodes
    assert not window.isWindowModified()
    hand.key(KEY.Key_End)
    hand.key(KEY.Key_Return)
    assert sigma(window, steps) == 0.3


def test_the_saved_position_is_marked(window, steps, tmp_path):
    window.session.save(tmp_path / "mine.json")
    assert [row.endswith("(saved)") for row in rows(window)] == [False] * 4 + [True]
    click(window, 1)
    assert rows(window)[4].endswith("(saved)")
    assert window.isWindowModified()


def test_what_is_being_typed_is_taken_before_the_click_goes_back(window, hand, steps, idle):
    window.session.select([steps])
    idle(window)
    field = window.panels.panels[steps].body.sections.field("sigma_mrad")
    field.edit.setFocus()
    field.edit.selectAll()
    QTest.keyClicks(field.edit, "0.75")
    click(window, 3)
    assert rows(window)[-1] == "Set jitter_mtf.sigma_mrad: 0.3 → 0.75"
    assert sigma(window, steps) == 0.2
