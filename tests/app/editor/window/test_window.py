"""The window as a whole: files, questions, themes, keys, and that nothing is lost."""

import json
import stat
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import (
    QAbstractScrollArea,
    QApplication,
    QDialog,
    QLineEdit,
    QPushButton,
    QTableWidget,
    QWidget,
)

from app.editor.recovery_files import DELAY_MS
from app.editor.theme import DARK, LIGHT
from app.editor.window.actions import ACTIONS
from app.editor.window.help import OR, shortcuts_of
from app.editor.window.recent_files import Settings
from app.editor.window.start import built, show_painted
from window_hands import CTRL, KEY, add, show_small

# --- beginning, opening ------------------------------------------------------------------------


def test_what_is_dropped_replaces_the_scene_in_one_step_and_faults_change_nothing(window, tmp_path):
    window.files.open_now("first_steps")
    before = window.session.network
    (tmp_path / "broken.json").write_text("{")
    assert not window.files.open_now(str(tmp_path / "broken.json"))
    assert window.session.network is before
    assert "broken.json" in window.status.said("error")
    np.save(tmp_path / "own.npy", np.arange(48.0).reshape(6, 8))
    middle = window.canvas.content.nodes["scene"].frame().center()
    window.canvas.surface.files_dropped.emit([str(tmp_path / "own.npy")], middle)
    after = window.session.network
    assert after.nodes["scene"].module == "read_image"
    assert Path(after.nodes["scene"].params["path"]) == tmp_path / "own.npy"
    assert (after.links, after.layout) == (before.links, before.layout)
    assert after.nodes["scene"].params["fov_x_deg"] == pytest.approx(10.0)
    assert window.session.selection == ("scene",)
    note = window.status.said("information")
    assert note.startswith("own.npy, 8 × 6 samples, replaces Test Scene; samples 0…47 scaled to ")
    assert "(" not in note  # no names of options, which a drop has not
    window.session.undo()
    assert window.session.network == before
    window.canvas.surface.files_dropped.emit([str(tmp_path / "none.npy")], middle)
    assert window.session.network == before
    assert "none.npy: no such file" in window.status.said("error")


# --- saving ------------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full disk to offer")
def test_work_is_soon_on_the_disk_and_survives_a_full_one(window, qtbot, tmp_path, monkeypatch):
    """Every write to the temporary file goes to a device that is full."""
    import core.atomic

    assert DELAY_MS < 2000  # and the writing takes milliseconds
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deep").mkdir()
    np.save(tmp_path / "scene.npy", np.ones((8, 8)))
    window.drops.files([str(tmp_path / "scene.npy")], QPointF(0, 0))
    (name,) = window.session.network.nodes
    assert window.session.network.nodes[name].params["path"] == "scene.npy"
    folder = tmp_path / "recovery"

    def kept():
        try:
            return any(b"read_image" in each.read_bytes() for each in folder.glob("[!.]*.recovery"))
        except FileNotFoundError:  # taken away between being listed and being read
            return False

    qtbot.waitUntil(kept)
    assert stat.S_IMODE(folder.stat().st_mode) & 0o077 == 0, "others could read it"
    # Files named in a network are found after saving elsewhere.
    path = tmp_path / "deep" / "mine.json"
    window.files.save_to(path)
    assert json.loads(path.read_text())["nodes"][name]["params"]["path"] == "../scene.npy"
    qtbot.waitUntil(lambda: not kept())
    before = path.read_bytes()
    add(window, "test_scene")
    create = core.atomic._create_beside

    def on_a_full_disk(target):
        temporary = create(target)
        temporary.unlink()
        temporary.symlink_to("/dev/full")
        return temporary

    monkeypatch.setattr(core.atomic, "_create_beside", on_a_full_disk)
    assert not window.session.save()
    assert "No space left" in window.status.said("error")
    assert path.read_bytes() == before
    assert window.session.document.modified


# --- looks, keys -------------------------------------------------------------------------------


def test_look_size_and_docks_are_remembered(make_window):
    window = make_window()
    assert window.theme is DARK
    window.actions_by_name["light"].trigger()
    assert window.theme is LIGHT
    assert QApplication.palette().window().color().name() == LIGHT.window
    window.resize(780, 640)
    window.library_dock.hide()
    window.close_for_good()
    again = make_window()
    assert again.theme is LIGHT
    assert (again.width(), again.height()) == (780, 640)
    assert not again.library_dock.isVisible()


HABITS = {
    "Tab": "Add Module",
    "Del": "Delete",
    "Ctrl+C": "Copy",
    "Ctrl+X": "Cut",
    "Ctrl+V": "Paste",
    "Ctrl+D": "Duplicate",
    "Ctrl+Z": "Undo",
    "Ctrl+Shift+Z": "Redo",
    "Ctrl+S": "Save",
    "Ctrl+Shift+S": "Save As",
    "Ctrl+O": "Open",
    "Ctrl+N": "New",
    "F": "Frame",
    "L": "Lay Out",
    "D": "Disable",
    **{str(number): f"Show in Viewer {number}" for number in range(1, 10)},
    "Ctrl+Return": "Generate Image",
    "Esc": "Cancel",
    "?": "Shortcuts",
}


def test_every_action_has_its_keys_a_menu_and_a_tip_and_every_control_a_name(window, idle):
    listed = shortcuts_of(window.actions_by_name)
    rows = {key: action for _, action, keys, _ in listed for key in keys.split(OR)}
    assert {keys: rows.get(keys) for keys in HABITS} == HABITS
    actions = window.actions_by_name.values()
    given = [key.toString() for action in actions for key in action.shortcuts()]
    assert len(given) == len(set(given)), "keys are given twice"
    in_menus = {action for menu in window.menus.values() for action in menu.actions()}
    for spec in ACTIONS:
        action = window.actions_by_name[spec.name]
        assert action in in_menus
        assert action.toolTip()
    show_small(window, "kodak_kir310")
    window.session.select(["electronics"])
    idle(window)
    nameless = [
        widget
        for widget in window.findChildren(QWidget)
        if widget.isVisible()
        and widget.focusPolicy() & Qt.FocusPolicy.TabFocus
        and not widget.accessibleName()
        and not (isinstance(widget, QPushButton) and widget.text())
        and not widget.objectName().startswith("qt_")
        and not isinstance(widget.parent(), QAbstractScrollArea)  # a viewport: its owner has one
    ]
    assert not nameless, [(type(w).__name__, w.objectName(), w.parent()) for w in nameless]


def test_the_very_first_start_opens_a_network_whatever_the_settings_hold(
    qtbot, tmp_path, monkeypatch
):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    for first in (True, False):
        window = built(Settings(tmp_path / "editor.ini"))
        qtbot.addWidget(window)
        assert bool(window.session.network.nodes) is first
        assert window.isMaximized()  # the second time because it was left so
        window.setWindowState(Qt.WindowState.WindowMaximized)
        window.close_for_good()
    damaged = b"[%General\nlook=\xff\xfe@ByteArray(\ngeometry=3\nrecent=@Invalid()\n"
    (tmp_path / "editor.ini").write_bytes(damaged)  # counts as none
    sized = built(Settings(tmp_path / "editor.ini"), size=(900, 600))
    qtbot.addWidget(sized)
    assert sized.theme is DARK
    assert not sized.isMaximized()
    assert sized.size().toTuple() == (900, 600)
    painted = []
    monkeypatch.setattr(sized, "setWindowOpacity", lambda share: painted.append((share, shown())))

    def shown():
        return sized.windowHandle() is not None and sized.windowHandle().isExposed()

    show_painted(sized)  # a compositor draws it black until it is painted
    assert painted == [(0.0, False), (1.0, True)]
    sized.close_for_good()


def actions(page):
    table = page.findChild(QTableWidget, "shortcuts.table")
    rows = [row for row in range(table.rowCount()) if not table.isRowHidden(row)]
    return [table.item(row, 1).text() for row in rows]


def test_every_action_is_found_by_its_words_and_by_its_keys(window, hand, qtbot):
    hand.key(KEY.Key_Question)
    page = window.findChild(QDialog, "shortcuts")
    search = page.findChild(QLineEdit, "shortcuts.search")
    qtbot.waitUntil(search.hasFocus)
    for _, action, keys, _ in shortcuts_of(window.actions_by_name):
        for text in (action, *filter(None, keys.split(OR))):
            search.setText(text)
            assert action in actions(page), text
    search.clear()
    hand.type("espresso")
    assert actions(page) == []
    hand.key(KEY.Key_A, CTRL)
    hand.key(KEY.Key_Delete)
    assert len(actions(page)) > 40
    hand.key(KEY.Key_Escape)
    assert not page.isVisible()
