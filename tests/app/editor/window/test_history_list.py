"""The list of the history by mouse and keys, and what the status says meanwhile."""

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel

from core.editing.operations import set_parameter
from window_hands import CTRL, KEY, add, give_focus

LEFT = Qt.MouseButton.LeftButton
ROLE = Qt.ItemDataRole


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


def test_the_history_is_listed_and_gone_through(window, hand, tmp_path, idle):
    """A node, and its parameter set three times."""
    name = add(window, "jitter_mtf")
    for value in (0.1, 0.2, 0.3):
        window.session.do(set_parameter(name, "sigma_mrad", value))
    hand.focus()
    hand.key(KEY.Key_H, CTRL)
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
    # A click goes back several steps at once, and forth again.
    calls = []
    window.session.changed.connect(lambda *_: calls.append(1))
    click(window, 2)
    assert sigma(window, name) == 0.1
    assert len(calls) == 1
    assert [font.italic() for font in looks(window, ROLE.FontRole)] == [False] * 3 + [True] * 2
    assert looks(window, ROLE.FontRole)[2].bold()
    click(window, 4)
    assert sigma(window, name) == 0.3
    assert len(calls) == 2
    # Arrows and Enter do without the mouse.
    for _ in range(4):
        hand.key(KEY.Key_Up)
    assert sigma(window, name) == 0.3, "to look is not to go"
    hand.key(KEY.Key_Return)
    assert not window.session.network.nodes
    assert not window.isWindowModified()
    hand.key(KEY.Key_End)
    hand.key(KEY.Key_Return)
    assert sigma(window, name) == 0.3
    # The saved position is marked.
    window.session.save(tmp_path / "mine.json")
    assert [row.endswith("(saved)") for row in rows(window)] == [False] * 4 + [True]
    click(window, 1)
    assert rows(window)[4].endswith("(saved)")
    assert window.isWindowModified()
    click(window, 4)
    # What is being typed is taken before a click goes back.
    window.session.select([name])
    idle(window)
    field = window.panels.panels[name].body.sections.field("sigma_mrad")
    field.edit.setFocus()
    field.edit.selectAll()
    QTest.keyClicks(field.edit, "0.75")
    click(window, 3)
    assert rows(window)[-1] == "Set jitter_mtf.sigma_mrad: 0.3 → 0.75"
    assert sigma(window, name) == 0.2
    give_focus(window.history)
    hand.key(KEY.Key_H, CTRL)
    assert not window.history.isVisible()
    assert not window.actions_by_name["history"].isChecked()


def test_what_is_said_holds(window, hand, tmp_path):
    hint = window.findChild(QLabel, "canvas.empty_hint")
    assert hint.isVisible()
    for words in ("Tab", "double-click", "library", "file"):
        assert words in hint.text()
    add(window, "test_scene")
    assert not hint.isVisible()
    hand.key(KEY.Key_Z, CTRL)
    assert hint.isVisible()
    window.session.redo()
    # That it was saved is gone with the next edit.
    assert window.session.save(tmp_path / "mine.json")
    window.files.save()
    assert "saved" in window.status.said("information")
    hand.click(hand.middle("test_scene"))
    assert "saved" in window.status.said("information")  # it still is
    hand.key(KEY.Key_D)
    assert window.status.said("information") == ""
