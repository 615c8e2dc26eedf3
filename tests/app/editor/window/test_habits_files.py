"""What a person expects of files, in the window as it is: real keys, dialogs and drops."""

import json
import os
import stat

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit, QPushButton

from app.editor.recovery_files import Autosave
from app.run.shipped import shipped_networks
from core.editing.document import Document
from window_hands import CTRL, KEY, SHIFT, WindowHands, add, answer, drag_event, give_focus


def dialog_of(window):
    found = [each for each in window.findChildren(QFileDialog, "file_dialog") if each.isVisible()]
    assert len(found) == 1
    return found[0]


def type_name(window, path):
    """Type a file's name in the dialog that is open, and press Enter."""
    edit = dialog_of(window).findChild(QLineEdit, "fileNameEdit")
    give_focus(edit)
    edit.setText(str(path))
    QTest.keyClick(edit, KEY.Key_Return)
    QApplication.processEvents()


@pytest.fixture
def files(tmp_path):
    """A picture and a network in a folder."""
    np.save(tmp_path / "scene.npy", np.ones((4, 6)))
    text = shipped_networks()["first_steps"].read_text()
    (tmp_path / "mine.json").write_text(text)
    return tmp_path


# --- keys --------------------------------------------------------------------------------------


def test_ctrl_s_asks_once_for_a_file_and_then_no_more(window, hand, tmp_path):
    add(window, "test_scene")
    assert window.windowTitle().startswith("untitled[*]")
    hand.key(KEY.Key_S, CTRL)
    type_name(window, tmp_path / "mine.json")
    assert not window.isWindowModified()
    add(window, "init_trans")
    assert window.isWindowModified()
    hand.focus()
    hand.key(KEY.Key_S, CTRL)
    assert not window.isWindowModified()
    stored = json.loads((tmp_path / "mine.json").read_text())
    assert list(stored["nodes"]) == ["test_scene", "init_trans"]


def test_ctrl_shift_s_saves_to_another_file(window, hand, files):
    window.files.open_now(str(files / "mine.json"))
    add(window, "test_scene")
    before = (files / "mine.json").read_bytes()
    hand.key(KEY.Key_S, CTRL | SHIFT)
    type_name(window, files / "other")
    assert (files / "mine.json").read_bytes() == before
    assert window.session.document.path == files / "other.json"
    assert "other.json" in window.windowTitle()


def test_ctrl_n_asks_for_unsaved_work_and_begins_anew(window, hand, qtbot):
    add(window, "test_scene")
    hand.key(KEY.Key_N, CTRL)
    answer(qtbot, window, "cancel")
    assert window.session.network.nodes
    hand.focus()
    hand.key(KEY.Key_N, CTRL)
    answer(qtbot, window, "discard")
    qtbot.waitUntil(lambda: not window.session.network.nodes)


# --- drops -------------------------------------------------------------------------------------


def test_a_picture_dropped_on_the_canvas_becomes_read_image_there(window, hand, files):
    viewport = window.canvas.view.viewport()
    assert hand.drop_files(viewport, hand.at(60, 40), [files / "scene.npy"])
    (node,) = window.session.network.nodes.values()
    assert node.module == "read_image"
    assert window.session.network.layout[node.id] == (60.0, 40.0)


def test_a_picture_dropped_on_the_welcome_page_begins_a_network(window, files):
    hand = WindowHands(window)
    spot = window.welcome.viewport().rect().center()
    assert hand.drop_files(window.welcome.viewport(), spot, [files / "scene.npy"])
    assert [node.module for node in window.session.network.nodes.values()] == ["read_image"]
    assert window.canvas.isVisible()


@pytest.mark.parametrize("part", ["panels", "viewer"])
def test_a_network_dropped_anywhere_in_the_window_is_opened(window, hand, files, part):
    where = window.viewers.images[1] if part == "viewer" else getattr(window, part)
    assert hand.drop_files(where, where.rect().center(), [files / "mine.json"])
    assert window.session.document.path == files / "mine.json"


@pytest.mark.parametrize("part", ["canvas", "window"])
def test_a_file_is_not_taken_from_where_it_lies(window, hand, files, part):
    """A file manager proposes a move within a disk, as Shift does, and deletes what was moved."""
    widget = window.canvas.view.viewport() if part == "canvas" else window
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(files / "scene.npy"))])
    copy, move = Qt.DropAction.CopyAction, Qt.DropAction.MoveAction
    left, shift = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier
    for kind in (QDragEnterEvent, QDragMoveEvent, QDropEvent):
        event = drag_event(kind, QPoint(50, 50), copy | move, data, left, shift)
        assert event.proposedAction() == move
        QApplication.sendEvent(widget, event)
        assert event.isAccepted()
        assert event.dropAction() == copy
    assert [node.module for node in window.session.network.nodes.values()] == ["read_image"]


# --- saving that fails -------------------------------------------------------------------------


@pytest.mark.skipif(os.access("/etc/shadow", os.W_OK), reason="root may write every file")
def test_a_file_that_may_only_be_read_is_not_written_over(window, hand, files):
    """Its owner has said so; the name is not to be taken by another file either."""
    path = files / "mine.json"
    path.chmod(0o444)
    before = path.read_bytes()
    window.files.open_now(str(path))
    add(window, "test_scene")
    hand.focus()
    hand.key(KEY.Key_S, CTRL)
    assert path.read_bytes() == before
    assert stat.S_IMODE(path.stat().st_mode) == 0o444
    assert "not saved" in window.status.said("error")
    assert window.isWindowModified()


# --- what a crash leaves -----------------------------------------------------------------------


@pytest.fixture
def left_behind(make_window, tmp_path):
    """The recovery file of a process that is no more."""
    window = make_window()
    add(window, "test_scene")
    library = window.session.library
    document = Document(window.session.network, library=library, saved=False)
    autosave = Autosave(document, tmp_path / "recovery")
    autosave.write_if_changed()
    autosave._let_go()  # its process is dead
    return autosave.path


def test_recovered_work_is_offered_opened_and_modified(left_behind, make_window, qtbot):
    again = make_window()
    button = again.findChild(QPushButton, "welcome.recover")
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert list(again.session.network.nodes) == ["test_scene"]
    assert again.isWindowModified()
    qtbot.waitUntil(lambda: not left_behind.exists())


# --- the layout --------------------------------------------------------------------------------


def test_a_part_that_was_closed_can_be_shown_again_from_the_menu(window, hand, idle):
    window.files.open_now("first_steps")
    idle(window)
    parts = [window.library_dock, window.panel_dock, window.viewers.plot_dock]
    parts += window.viewers.docks.values()
    for dock in parts:
        dock.close()
        action = dock.toggleViewAction()
        assert action in window.menus["&View"].actions(), dock.windowTitle()
        action.trigger()
        assert dock.isVisible()
