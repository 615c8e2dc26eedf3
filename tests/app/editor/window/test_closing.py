"""Closing the window: it ends, or it asks and stays as alive as before."""

import json

import pytest
from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QFileDialog,
    QLineEdit,
    QMessageBox,
    QPushButton,
)

from app.editor.recovery_files import recoverable
from core.editing.operations import set_parameter
from window_hands import CTRL, KEY, SHIFT, add, answer, give_focus

_BUTTON = QMessageBox.StandardButton


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
    assert window.status.error == ""


# --- unmodified --------------------------------------------------------------------------------


def test_the_keys_to_quit_close_an_unmodified_network(window, hand, qtbot, idle):
    window.files.open_now("first_steps")
    idle(window)
    hand.focus()
    hand.key(KEY.Key_Q, CTRL)
    qtbot.waitUntil(lambda: not window.isVisible())


def test_an_accepted_close_shuts_down_once(window, tmp_path):
    add(window, "test_scene")
    window.session.save(tmp_path / "mine.json")
    assert window.close()
    window.close_for_good()
    window.stop()
    assert recoverable(tmp_path / "recovery") == ()


# --- modified ----------------------------------------------------------------------------------


def test_cancel_leaves_a_window_that_computes_and_keeps_work(window, qtbot, tmp_path):
    add(window, "init_trans")
    assert not window.close()
    answer(qtbot, window, _BUTTON.Cancel)
    assert window.isVisible()
    assert_alive(window, qtbot, tmp_path / "recovery")
    assert not window.close()
    (box,) = questions(window)  # it asks again
    QTest.keyClick(box, KEY.Key_Escape)
    qtbot.waitUntil(lambda: not questions(window))
    assert window.isVisible()


def test_closing_again_and_again_asks_once(window, qtbot, tmp_path):
    add(window, "test_scene")
    for _ in range(3):
        assert not window.close()
    assert len(questions(window)) == 1
    answer(qtbot, window, _BUTTON.Discard)
    qtbot.waitUntil(lambda: not window.isVisible())
    assert not questions(window)
    assert recoverable(tmp_path / "recovery") == ()


def test_a_close_that_comes_with_the_question_of_another_closes(window, qtbot):
    add(window, "test_scene")
    window.actions_by_name["new"].trigger()
    assert not window.close()
    assert len(questions(window)) == 1
    answer(qtbot, window, _BUTTON.Discard)
    qtbot.waitUntil(lambda: not window.isVisible())


def test_what_is_being_typed_counts_as_work(window, hand, qtbot, idle):
    """Quitting in the middle of a number asks for it: it has not been entered yet."""
    name = add(window, "jitter_mtf")
    window.session.save(window.settings.path.parent.parent / "mine.json")
    window.session.select([name])
    idle(window)
    type_sigma(window, name, "0.75")
    assert not window.close()
    assert len(questions(window)) == 1


def test_a_title_that_is_being_typed_counts_as_work(titling, qtbot, tmp_path):
    assert not titling.close()
    assert len(questions(titling)) == 1
    answer(qtbot, titling, _BUTTON.Save)
    qtbot.waitUntil(lambda: not titling.isVisible())
    assert title_in(tmp_path / "mine.json") == "Front"


def test_a_title_that_is_being_typed_is_saved(titling, hand, tmp_path):
    QTest.keyClick(titling.canvas.title_editor, KEY.Key_S, CTRL)
    assert title_in(tmp_path / "mine.json") == "Front"
    assert not titling.isWindowModified()


@pytest.fixture
def titling(window, hand, tmp_path):
    """A saved network of one backdrop, whose title is typed and not entered yet."""
    window.session.select([add(window, "test_scene")])
    window.edits.backdrop()
    hand.key(KEY.Key_Escape)  # its title is not typed yet
    window.session.save(tmp_path / "mine.json")
    hand.key(KEY.Key_Up, CTRL)  # from the node to the backdrop's title
    hand.key(KEY.Key_Return)
    title = window.canvas.title_editor
    assert title.isVisible()
    give_focus(title)
    title.selectAll()
    QTest.keyClicks(title, "Front")
    return window


def title_in(path):
    (ground,) = json.loads(path.read_text())["backdrops"]
    return ground["title"]


def type_sigma(window, name, text):
    """Type in a panel, without Enter."""
    edit = window.panels.panels[name].body.sections.field("sigma_mrad").edit
    give_focus(edit)
    edit.selectAll()
    QTest.keyClicks(edit, text)


# --- with a dialog open ------------------------------------------------------------------------

DIALOGS = {
    "open": ("open", "file_dialog"),
    "save as": ("save_as", "file_dialog"),
    "shortcuts": ("shortcuts", "shortcuts"),
    "about": ("about", "message"),
    "add run": ("add_run", "add_run"),
}


# In every run: each dialog, unmodified or modified.
@pytest.mark.thorough(
    always=("unmodified-open", "unmodified-shortcuts", "modified-save as", "modified-add run")
)
@pytest.mark.parametrize(("action", "name"), DIALOGS.values(), ids=DIALOGS)
@pytest.mark.parametrize("modified", [False, True], ids=["unmodified", "modified"])
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
        answer(qtbot, window, _BUTTON.Discard)
    qtbot.waitUntil(lambda: not window.isVisible())
    assert not dialogs(window)


@pytest.mark.thorough(but=2)
@pytest.mark.parametrize(("action", "name"), DIALOGS.values(), ids=DIALOGS)
def test_the_keys_to_quit_work_in_a_dialog(window, hand, qtbot, tmp_path, action, name):
    window.session.select([add(window, "test_scene")])
    window.session.save(tmp_path / "mine.json")
    window.actions_by_name[action].trigger()
    (dialog,) = dialogs(window)
    dialog.activateWindow()
    qtbot.waitUntil(dialog.isActiveWindow)
    QTest.keyClick(dialog.focusWidget() or dialog, KEY.Key_Q, CTRL)
    qtbot.waitUntil(lambda: not window.isVisible())


def test_the_keys_to_quit_work_while_a_module_is_searched(window, hand, qtbot):
    hand.key(KEY.Key_Tab)
    popup = window.canvas.findChild(object, "canvas.popup")
    assert popup.is_open
    hand.key(KEY.Key_Q, CTRL)
    qtbot.waitUntil(lambda: not window.isVisible())


def test_the_keys_to_quit_work_with_a_menu_open(window, hand, qtbot):
    menu = window.menus["&File"]
    menu.popup(window.mapToGlobal(window.rect().center()))
    qtbot.waitUntil(menu.isVisible)
    QTest.keyClick(menu, KEY.Key_Q, CTRL)
    qtbot.waitUntil(lambda: not window.isVisible())


def test_one_dialog_of_a_kind_at_a_time(window, hand, qtbot):
    for action in ("open", "save_as", "save_as", "shortcuts", "shortcuts", "about", "about"):
        window.actions_by_name[action].trigger()
    QApplication.processEvents()
    names = sorted(each.objectName() for each in dialogs(window))
    assert names == ["file_dialog", "message", "shortcuts"]


def test_a_dialog_to_save_goes_with_its_document(window, hand, qtbot, tmp_path):
    """It would otherwise give the name meant for one network to the next."""
    add(window, "test_scene")
    window.session.save(tmp_path / "one.json")
    hand.focus()
    hand.key(KEY.Key_S, CTRL | SHIFT)
    window.files.open_now("first_steps")
    assert not [each for each in dialogs(window) if isinstance(each, QFileDialog)]


def test_saving_as_asked_at_the_close_ends_the_window(window, qtbot, tmp_path):
    add(window, "test_scene")
    window.close()
    answer(qtbot, window, _BUTTON.Save)
    qtbot.waitUntil(lambda: bool(dialogs(window)))
    (dialog,) = (each for each in dialogs(window) if isinstance(each, QFileDialog))
    dialog.fileSelected.emit(str(tmp_path / "mine.json"))
    qtbot.waitUntil(lambda: not window.isVisible())
    assert b"test_scene" in (tmp_path / "mine.json").read_bytes()


# --- over a file that is there -----------------------------------------------------------------


@pytest.fixture
def replacing(window, hand, qtbot, tmp_path):
    """Save As, with the name of a file that is there; gives what to call to enter it, and more."""
    other = tmp_path / "other.json"
    other.write_text("mine")

    def begin(action="save_as"):
        window.actions_by_name[action].trigger()
        (dialog,) = (each for each in dialogs(window) if isinstance(each, QFileDialog))
        dialog.setDirectory(str(tmp_path))
        dialog.selectFile(str(other))
        dialog.accept()
        (box,) = window.findChildren(QMessageBox, "replace_file")
        assert box.isVisible()
        return dialog, box, other

    return begin


def test_the_question_to_replace_a_file_is_not_in_the_way(window, replacing, qtbot):
    window.session.select([add(window, "test_scene")])
    _, _, other = replacing()
    assert QApplication.activeModalWidget() is None
    assert not window.close()
    answer(qtbot, window, _BUTTON.Discard)
    qtbot.waitUntil(lambda: not window.isVisible())
    assert not dialogs(window)
    assert other.read_text() == "mine"


def keep_the_file(box):
    """Press Escape at the question to replace it, where a person does."""
    give_focus(box.findChild(QPushButton, "cancel"))
    QTest.keyClick(box, KEY.Key_Escape)
    assert not box.isVisible()


def test_a_file_is_replaced_only_once_that_is_agreed(window, replacing, qtbot):
    add(window, "test_scene")
    dialog, box, other = replacing()
    keep_the_file(box)
    assert dialog.isVisible()
    assert other.read_text() == "mine"
    dialog.accept()  # asks anew
    box = next(each for each in window.findChildren(QMessageBox) if each.isVisible())
    box.findChild(QPushButton, "replace").click()
    assert not dialog.isVisible()
    assert "test_scene" in other.read_text()


@pytest.mark.parametrize("way", ["another name", "cancel"])
def test_a_file_that_is_not_replaced_leaves_a_dialog_that_works(window, replacing, way):
    add(window, "test_scene")
    dialog, box, other = replacing()
    keep_the_file(box)
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)  # as Qt's loop does
    edit = dialog.findChild(QLineEdit, "fileNameEdit")
    give_focus(edit)
    if way == "another name":
        edit.setText(str(other.with_name("new.json")))
        QTest.keyClick(edit, KEY.Key_Return)
        assert "test_scene" in other.with_name("new.json").read_text()
    else:
        QTest.keyClick(edit, KEY.Key_Escape)
    assert not dialog.isVisible()
    assert other.read_text() == "mine"


def test_closing_while_the_name_is_asked_for_asks_anew(window, qtbot, tmp_path):
    add(window, "test_scene")
    window.close()
    answer(qtbot, window, _BUTTON.Save)
    qtbot.waitUntil(lambda: any(isinstance(each, QFileDialog) for each in dialogs(window)))
    assert not window.close()
    assert len(questions(window)) == 1
    answer(qtbot, window, _BUTTON.Discard)
    qtbot.waitUntil(lambda: not window.isVisible())


# --- told to end -------------------------------------------------------------------------------


def test_told_to_end_while_it_asks_keeps_the_work(window, qtbot, tmp_path):
    add(window, "test_scene")
    window.close()
    assert len(questions(window)) == 1
    window.stop()
    assert not window.isVisible()
    (left,) = (tmp_path / "recovery").glob("[!.]*.recovery")
    assert b"test_scene" in left.read_bytes()


def test_told_to_end_it_keeps_a_title_that_is_being_typed(titling, tmp_path):
    titling.stop()
    (left,) = (tmp_path / "recovery").glob("[!.]*.recovery")
    assert b"Front" in left.read_bytes()


def test_told_to_end_it_says_what_could_not_be_kept(make_window, tmp_path):
    (tmp_path / "file").write_text("")
    window = make_window(recovery=tmp_path / "file" / "below")
    add(window, "test_scene")
    assert "cannot write" in str(window.stop())
    assert not window.isVisible()


def test_a_floating_part_closes_along(window, hand, qtbot):
    window.panel_dock.setFloating(True)
    qtbot.waitUntil(window.panel_dock.isVisible)
    assert window.close()
    shown = [each for each in QApplication.topLevelWidgets() if each.isVisible()]
    assert not [each for each in shown if each is window or each.parent() is window]
