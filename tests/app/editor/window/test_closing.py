"""Closing the window: it ends, or it asks and stays as alive as before."""

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QFileDialog, QMessageBox, QPushButton

from core.editing.document import Document
from core.editing.operations import set_parameter
from window_hands import CTRL, KEY, SHIFT, add, answer, give_focus


def questions(window):
    return [box for box in window.findChildren(QMessageBox, "save_changes") if box.isVisible()]


def dialogs(window):
    return [each for each in window.findChildren(QDialog) if each.isVisible()]


def kept(folder):
    """What the files of recovery hold, but for one that is being written: it goes any moment."""
    return [path.read_bytes() for path in folder.glob("[!.]*.recovery")]


def assert_alive(window, qtbot, folder):
    """Whatever is edited is computed and kept against a crash."""
    name = add(window, "test_scene")
    window.session.select([name])
    before = kept(folder)
    qtbot.waitUntil(lambda: kept(folder) not in ([], before))
    done = []
    window.evaluator.pass_done.connect(done.append)
    window.session.do(set_parameter(name, "width", 96))
    qtbot.waitUntil(lambda: bool(done) and window.evaluator.idle)
    assert window.status.said("error") == ""


# --- modified ----------------------------------------------------------------------------------


def test_a_window_may_go_before_its_docks_have_their_places(make_window, qtbot):
    window = make_window()
    window.files.new()
    assert window.layout_in_use.lacks_docks
    window.files.open_now("first_steps")  # they come back, and the canvas waits for their places
    window.close_for_good()
    window.canvas.view.deleteLater()
    qtbot.wait(100)  # an error on Qt's loop fails the test
    assert not window.isVisible()


def test_work_is_asked_for_until_it_is_saved(window, hand, qtbot, idle, tmp_path):
    """Quitting in the middle of a number asks for it: it has not been entered yet."""
    name = add(window, "jitter_mtf")
    window.session.open(Document(window.session.network, library=window.session.library))
    window.session.select([name])
    idle(window)
    edit = window.panels.panels[name].body.sections.field("sigma_mrad").edit
    give_focus(edit)
    edit.selectAll()
    QTest.keyClicks(edit, "0.75")
    assert not window.close()
    answer(qtbot, window, "cancel")
    assert window.isVisible()
    assert_alive(window, qtbot, tmp_path / "recovery")
    assert not window.close()
    (box,) = questions(window)  # it asks again
    QTest.keyClick(box, KEY.Key_Escape)
    qtbot.waitUntil(lambda: not questions(window))
    box.setObjectName("answered")
    assert window.isVisible()
    window.close()
    answer(qtbot, window, "save")
    qtbot.waitUntil(lambda: bool(dialogs(window)))
    (dialog,) = (each for each in dialogs(window) if isinstance(each, QFileDialog))
    dialog.fileSelected.emit(str(tmp_path / "mine.json"))
    qtbot.waitUntil(lambda: not window.isVisible())
    assert b"test_scene" in (tmp_path / "mine.json").read_bytes()


# --- with a dialog open ------------------------------------------------------------------------

DIALOGS = [("open", "file_dialog", False), ("add_run", "add_run", True)]


@pytest.mark.parametrize(("action", "name", "modified"), DIALOGS)
def test_no_dialog_is_in_the_way(window, hand, qtbot, tmp_path, action, name, modified):
    """The window takes a close as its manager sends it, which a modal dialog would swallow."""
    window.session.select([add(window, "test_scene")])
    if not modified:
        window.session.save(tmp_path / "mine.json")
    window.actions_by_name[action].trigger()
    assert [each.objectName() for each in dialogs(window)] == [name]
    assert QApplication.activeModalWidget() is None
    assert window.close() is not modified
    if modified:
        answer(qtbot, window, "discard")
    qtbot.waitUntil(lambda: not window.isVisible())
    assert not dialogs(window)


def test_the_keys_to_quit_work_with_a_menu_open(window, hand, qtbot):
    menu = window.menus["&File"]
    menu.popup(window.mapToGlobal(window.rect().center()))
    qtbot.waitUntil(menu.isVisible)
    QTest.keyClick(menu, KEY.Key_Q, CTRL)
    qtbot.waitUntil(lambda: not window.isVisible())


# --- over a file that is there -----------------------------------------------------------------


def test_a_file_is_replaced_only_once_that_is_agreed(window, hand, tmp_path):
    add(window, "test_scene")
    window.session.save(tmp_path / "one.json")
    other = tmp_path / "other.json"
    other.write_text("mine")
    hand.focus()
    hand.key(KEY.Key_S, CTRL | SHIFT)
    (dialog,) = (each for each in dialogs(window) if isinstance(each, QFileDialog))
    dialog.setDirectory(str(tmp_path))
    dialog.selectFile(str(other))
    for reply in ("cancel", "replace"):
        dialog.accept()
        box = next(each for each in window.findChildren(QMessageBox) if each.isVisible())
        assert box.objectName() == "replace_file"
        if reply == "cancel":  # by Escape
            give_focus(box.findChild(QPushButton, reply))
            QTest.keyClick(box, KEY.Key_Escape)
            assert not box.isVisible()
            assert dialog.isVisible()
            assert other.read_text() == "mine"
        else:
            box.findChild(QPushButton, reply).click()
    assert not dialog.isVisible()
    assert "test_scene" in other.read_text()
    # One that is open goes with its document: it would give the name to the next network.
    hand.focus()
    hand.key(KEY.Key_S, CTRL | SHIFT)
    assert dialogs(window)
    window.files.open_now("first_steps")
    assert not [each for each in dialogs(window) if isinstance(each, QFileDialog)]


# --- told to end -------------------------------------------------------------------------------


def test_told_to_end_it_says_what_could_not_be_kept(make_window, tmp_path):
    (tmp_path / "file").write_text("")
    window = make_window(recovery=tmp_path / "file" / "below")
    add(window, "test_scene")
    assert "cannot write" in str(window.stop())
    assert not window.isVisible()
