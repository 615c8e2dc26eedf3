"""The window as a whole: files, questions, themes, keys, and that nothing is lost."""

import json
import stat
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import QAbstractScrollArea, QApplication, QPushButton, QWidget

from app.editor.recovery_files import DELAY_MS
from app.editor.theme import DARK, LIGHT
from app.editor.window.actions import ACTIONS
from app.editor.window.help import OR, shortcuts_of
from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.editor.window.start import built, show_painted
from window_hands import add

# --- beginning, opening ------------------------------------------------------------------------


def test_a_broken_file_leaves_the_open_network_as_it_is(window, tmp_path):
    window.files.open_now("first_steps")
    before = window.session.network
    broken = tmp_path / "broken.json"
    broken.write_text("{")
    assert not window.files.open_now(str(broken))
    assert window.session.network is before
    assert "broken.json" in window.status.error


def test_a_picture_dropped_on_the_scene_replaces_it_in_one_step(window, tmp_path):
    window.files.open_now("first_steps")
    before = window.session.network
    np.save(tmp_path / "own.npy", np.arange(48.0).reshape(6, 8))
    middle = window.canvas.content.nodes["scene"].frame().center()
    window.canvas.surface.files_dropped.emit([str(tmp_path / "own.npy")], middle)
    after = window.session.network
    assert after.nodes["scene"].module == "read_image"
    assert Path(after.nodes["scene"].params["path"]) == tmp_path / "own.npy"
    assert (after.links, after.layout) == (before.links, before.layout)
    assert after.nodes["scene"].params["fov_x_deg"] == pytest.approx(10.0)
    assert window.session.selection == ("scene",)
    note = window.status.note
    assert note.startswith("own.npy, 8 × 6 samples, replaces Test Scene; samples 0…47 scaled to ")
    assert "(" not in note  # no names of options, which a drop has not
    window.session.undo()
    assert window.session.network == before
    window.canvas.surface.files_dropped.emit([str(tmp_path / "none.npy")], middle)
    assert window.session.network == before
    assert "none.npy: no such file" in window.status.error


# --- saving ------------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full disk to offer")
def test_a_full_disk_is_said_and_the_old_file_stays(window, tmp_path, monkeypatch):
    """Every write to the temporary file goes to a device that is full."""
    import core.atomic

    path = tmp_path / "mine.json"
    window.session.save(path)
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
    assert "No space left" in window.status.error
    assert path.read_bytes() == before
    assert window.session.document.modified


def test_files_named_in_a_network_are_found_after_saving_elsewhere(window, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deep").mkdir()
    np.save(tmp_path / "scene.npy", np.ones((8, 8)))
    window.drops.files([str(tmp_path / "scene.npy")], QPointF(0, 0))
    (name,) = window.session.network.nodes
    assert window.session.network.nodes[name].params["path"] == "scene.npy"
    window.files.save_to(tmp_path / "deep" / "mine.json")
    stored = json.loads((tmp_path / "deep" / "mine.json").read_text())
    assert stored["nodes"][name]["params"]["path"] == "../scene.npy"


# --- work that is not saved --------------------------------------------------------------------


def test_unsaved_work_is_soon_on_the_disk(window, qtbot, tmp_path):
    assert DELAY_MS < 2000  # and the writing takes milliseconds
    add(window, "test_scene")
    folder = tmp_path / "recovery"

    def kept():
        try:
            return any(b"test_scene" in each.read_bytes() for each in folder.glob("[!.]*.recovery"))
        except FileNotFoundError:  # taken away between being listed and being read
            return False

    qtbot.waitUntil(kept)
    assert stat.S_IMODE(folder.stat().st_mode) & 0o077 == 0, "others could read it"
    window.session.save(tmp_path / "mine.json")
    qtbot.waitUntil(lambda: not kept())


# --- looks, keys -------------------------------------------------------------------------------


def test_light_and_dark_are_remembered(make_window, settings):
    window = make_window()
    assert window.theme is DARK
    window.actions_by_name["light"].trigger()
    assert window.theme is LIGHT
    assert QApplication.palette().window().color().name() == LIGHT.window
    assert make_window().theme is LIGHT


def test_size_and_docks_are_remembered(make_window):
    window = make_window()
    window.resize(780, 640)
    window.library_dock.hide()
    window.close_for_good()
    again = make_window()
    assert (again.width(), again.height()) == (780, 640)
    assert not again.library_dock.isVisible()


def test_damaged_settings_count_as_none(qtbot, library, tmp_path):
    path = tmp_path / "editor.ini"
    path.write_bytes(b"[%General\nlook=\xff\xfe@ByteArray(\ngeometry=3\nrecent=@Invalid()\n")
    settings = Settings(path)
    window = MainWindow(library=library, settings=settings, recovery=tmp_path / "recovery")
    assert window.theme is DARK
    window.close_for_good()
    window.deleteLater()


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


def test_every_habit_has_its_keys_in_the_list(window):
    listed = shortcuts_of(window.actions_by_name)
    rows = {key: action for _, action, keys, _ in listed for key in keys.split(OR)}
    assert {keys: rows.get(keys) for keys in HABITS} == HABITS


def test_no_keys_are_given_twice(window):
    actions = window.actions_by_name.values()
    keys = [key.toString() for action in actions for key in action.shortcuts()]
    assert len(keys) == len(set(keys))


def test_every_action_is_in_a_menu_with_a_tip(window):
    in_menus = {action for menu in window.menus.values() for action in menu.actions()}
    for spec in ACTIONS:
        action = window.actions_by_name[spec.name]
        assert action in in_menus
        assert action.toolTip()


def test_every_control_has_an_accessible_name(window, idle):
    window.files.open_now("kodak_kir310")
    idle(window)
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


def test_the_very_first_start_opens_a_network(qtbot, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    for first in (True, False):
        window = built(Settings(tmp_path / "editor.ini"))
        qtbot.addWidget(window)
        assert bool(window.session.network.nodes) is first
        assert window.isMaximized()  # the second time because it was left so
        window.setWindowState(Qt.WindowState.WindowMaximized)
        window.close_for_good()
    sized = built(Settings(tmp_path / "editor.ini"), size=(900, 600))
    qtbot.addWidget(sized)
    assert not sized.isMaximized()
    assert sized.size().toTuple() == (900, 600)
    sized.close_for_good()


def test_a_window_is_seen_once_it_is_painted(qtbot, tmp_path, monkeypatch):
    """A compositor draws it black until then."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    window = built(Settings(tmp_path / "editor.ini"), size=(900, 600))
    qtbot.addWidget(window)
    painted = []
    monkeypatch.setattr(window, "setWindowOpacity", lambda share: painted.append((share, shown())))

    def shown():
        return window.windowHandle() is not None and window.windowHandle().isExposed()

    show_painted(window)
    assert painted == [(0.0, False), (1.0, True)]
    window.close_for_good()
