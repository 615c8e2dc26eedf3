"""Reports and queued runs in the window as it is: real keys, and a real process for each run."""

import os
import signal
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit, QMessageBox, QPushButton

from app.editor.window.background_runs import AddRun
from core.editing.document import Document
from core.network.file import parse_network
from core.network.network import Network
from window_hands import CTRL, KEY, SHIFT, give_focus

LEFT = Qt.MouseButton.LeftButton
LONG = 100_000  # frames


@pytest.fixture
def desk(window, small, write, library, tmp_path, idle):
    """A window with the small network, saved in a file."""
    path = tmp_path / write(small, "mine.json")
    network = parse_network(path.read_text(), library=library)
    window.session.open(Document(network, library=library, path=path))
    window.show_canvas()
    idle(window)
    return window


def press(window, key, *modifiers):
    """Where the focus is, as a person does."""
    keys = Qt.KeyboardModifier.NoModifier
    for modifier in modifiers:
        keys |= modifier
    QTest.keyClick(QApplication.focusWidget() or window, key, keys)


def show_runs(window):
    give_focus(window.canvas.view)
    press(window, KEY.Key_T, CTRL, SHIFT)


def dialog_of(window, qtbot):
    """The dialog that adds a run, by the keys."""
    show_runs(window) if not window.runs.view.isVisible() else None
    give_focus(window.runs.view.add)
    press(window, KEY.Key_Space)
    qtbot.waitUntil(lambda: any(each.isVisible() for each in window.findChildren(AddRun)))
    (dialog,) = (each for each in window.findChildren(AddRun) if each.isVisible())
    dialog.activateWindow()
    qtbot.waitUntil(dialog.kinds.hasFocus)
    return dialog


def add_frames(window, qtbot, count=LONG):
    """Queue frames, which take long."""
    dialog = dialog_of(window, qtbot)
    press(window, KEY.Key_Down)  # from the sweep to frames
    give_focus(dialog.frames)
    dialog.frames.selectAll()
    QTest.keyClicks(dialog.frames, str(count))
    press(window, KEY.Key_Return)
    assert not dialog.isVisible()
    return window.runs.queue.runs[-1]


def computing(qtbot, run):
    qtbot.waitUntil(lambda: run.doing.startswith("frames"))
    return run.pid


def over(qtbot, run):
    qtbot.waitUntil(lambda: run.is_over)
    return run


def questions(window):
    return [box for box in window.findChildren(QMessageBox, "runs_go_on") if box.isVisible()]


def reply(window, qtbot, name):
    (box,) = questions(window)
    QTest.mouseClick(box.findChild(QPushButton, name), LEFT)
    qtbot.waitUntil(lambda: not questions(window))


def is_running(pid):
    return Path(f"/proc/{pid}").exists()


def names(folder):
    """What is in a folder, hidden leftovers too."""
    return sorted(path.name for path in folder.iterdir())


# --- the queue ---------------------------------------------------------------------------------


def test_a_sweep_by_the_keyboard_alone(desk, qtbot, browser, tmp_path):
    dialog = dialog_of(desk, qtbot)
    combo = dialog.parameter
    give_focus(combo)
    for _ in range(combo.findText("σ x of blur (mrad)")):
        if combo.currentText() != "σ x of blur (mrad)":
            press(desk, KEY.Key_Down)
    assert dialog.values.text() == "0:1:5"  # around the present 0.5
    give_focus(dialog.values)
    dialog.values.selectAll()
    QTest.keyClicks(dialog.values, "0.1, 0.3")
    press(desk, KEY.Key_Return)
    assert not dialog.isVisible()
    (entry,) = desk.runs.queue.runs
    assert entry.title == "mine: σ x of blur, 2 values"
    assert entry.job.values == (0.1, 0.3)
    qtbot.waitUntil(desk.runs.view.list.hasFocus)
    over(qtbot, entry)
    assert entry.state == "done", entry.text
    assert "done" not in desk.status.said("information"), "the list is seen, and says so itself"
    folder = tmp_path / "mine-sweep"
    runs = [f"blur.sigma_x_mrad={value}" for value in (0.1, 0.3)]
    assert names(folder) == [*runs, "tradeoff.csv", "tradeoff.html"]
    previews = desk.runs.view.previews
    assert previews.isVisible()
    assert [previews.item(row).text() for row in range(previews.count())] == ["0.1", "0.3"]
    press(desk, KEY.Key_Return)
    assert browser.opened == [str(folder / "tradeoff.html")]
    QTest.mouseClick(desk.runs.view.folder, LEFT)
    assert browser.opened[1:] == [str(folder)]
    give_focus(desk.runs.view.list)
    QTest.mouseClick(desk.runs.view.clear, LEFT)  # off the list; its files stay
    assert desk.runs.queue.runs == []
    assert folder.is_dir()


def test_what_cannot_be_run_is_said_at_its_field_or_in_its_line(desk, qtbot):
    dialog = dialog_of(desk, qtbot)
    dialog.parameter.take("blur.sigma_x_mrad")
    for name, text, said in (
        ("values", "", "no values: FROM:TO:COUNT"),
        ("values", "0:1", "blur.sigma_x_mrad=0:1: write FROM:TO:COUNT"),
        ("values", "-1, 2", "-1 mrad is not allowed: must be a number of at least 0"),
        ("folder", "", "give a folder"),
    ):
        dialog.values.setText("0.1, 0.3")
        field = getattr(dialog, name)
        give_focus(field)
        field.selectAll()
        press(desk, KEY.Key_Delete)
        QTest.keyClicks(field, text)
        press(desk, KEY.Key_Return)
        assert dialog.isVisible()
        assert desk.runs.queue.runs == []
        assert dialog.error.isVisible()
        assert said in dialog.error.text()
        assert field.hasFocus()
        assert field.accessibleDescription() == dialog.error.text()
    dialog.reject()
    # A network that does not hold together: its line is the command's.
    nodes = {name: node for name, node in desk.session.network.nodes.items() if name != "scene"}
    links = [link for link in desk.session.network.links if link.source != "scene"]
    broken = Network(nodes=nodes, links=tuple(links))
    desk.session.open(Document(broken, library=desk.session.library))
    entry = over(qtbot, add_frames(desk, qtbot, 2))
    assert entry.state == "failed"
    assert entry.text.startswith("init: ")
    view = desk.runs.view
    assert view.list.topLevelItem(0).text(1) == f"failed: {entry.text}"
    assert not view.folder.isEnabled()


def test_runs_are_cancelled_killed_and_done_and_the_window_says_so(desk, qtbot, tmp_path):
    before = names(tmp_path)
    long = add_frames(desk, qtbot)
    small = add_frames(desk, qtbot, 2)
    computing(qtbot, long)
    desk.runs.view.mark(long)
    give_focus(desk.runs.view.list)
    assert "%" in desk.runs.view.list.currentItem().text(1)
    press(desk, KEY.Key_Delete)
    assert over(qtbot, long).state == "cancelled"
    desk.runs.dock.hide()  # where the list is not seen, the end of a run is said
    assert over(qtbot, small).state == "done"
    assert names(tmp_path) == sorted([*before, "mine-frames-2"])
    assert desk.status.said("error") == ""
    assert desk.status.said("information") == "mine: 2 frames: done"
    entry = add_frames(desk, qtbot)
    desk.runs.dock.hide()
    os.kill(computing(qtbot, entry), signal.SIGKILL)
    over(qtbot, entry)
    assert entry.text == "the system ended the process (signal 9): memory may have run out"
    assert desk.status.said("error") == f"mine: {LONG} frames: failed: {entry.text}"
    desk.close()  # of runs that are over nothing is asked
    assert not desk.isVisible()


# --- the report --------------------------------------------------------------------------------


def write_report(window, file):
    """By the keys, and a name that is typed."""
    give_focus(window.canvas.view)
    press(window, KEY.Key_R, CTRL, SHIFT)
    (dialog,) = (each for each in window.findChildren(QFileDialog) if each.isVisible())
    assert dialog.objectName() == "report_dialog"
    edit = dialog.findChild(QLineEdit, "fileNameEdit")
    give_focus(edit)
    edit.selectAll()
    QTest.keyClicks(edit, str(file))
    QTest.keyClick(edit, KEY.Key_Return)
    assert not dialog.isVisible()


def test_a_report_is_of_the_network_as_it_stands_with_what_is_typed(desk, qtbot, browser, tmp_path):
    """Unsaved changes too, also of a value that is not entered yet."""
    desk.session.select(["blur"])
    edit = desk.panels.panels["blur"].body.sections.field("sigma_x_mrad").edit
    give_focus(edit)
    edit.selectAll()
    QTest.keyClicks(edit, "0.75")
    view = desk.runs.view
    write_report(desk, tmp_path / "report.html")
    (entry,) = desk.runs.queue.runs
    assert '"sigma_x_mrad": 0.75' in entry.job.network
    assert entry.job.network == desk.session.document.text()
    assert view.stop.isEnabled()
    over(qtbot, entry)
    assert entry.state == "done", entry.text
    assert not view.stop.isEnabled()
    QTest.mouseClick(view.page, LEFT)
    assert browser.opened == [str(tmp_path / "report.html")]
    assert (tmp_path / "report.html").is_file()
    assert desk.isWindowModified(), "nothing was saved for it"


# --- the end -----------------------------------------------------------------------------------


def test_quitting_while_a_run_goes_on_asks(desk, qtbot, tmp_path):
    run = add_frames(desk, qtbot)
    pid = computing(qtbot, run)
    for _ in range(2):
        assert not desk.close()
    assert len(questions(desk)) == 1
    (box,) = questions(desk)
    assert "100000 frames" in box.text()
    QTest.keyClick(box, KEY.Key_Escape)
    qtbot.waitUntil(lambda: not questions(desk))
    assert desk.isVisible()
    assert run.state == "running"
    give_focus(desk.canvas.view)
    press(desk, KEY.Key_Q, CTRL)
    reply(desk, qtbot, "stop")
    qtbot.waitUntil(lambda: not desk.isVisible())
    assert not is_running(pid)
    assert not [name for name in names(tmp_path) if name.startswith((".imagechain", "mine-"))]


def test_told_to_end_it_ends_its_run_too(desk, qtbot, tmp_path):
    pid = computing(qtbot, add_frames(desk, qtbot))
    assert desk.stop() is None
    assert not is_running(pid)
    assert not [name for name in names(tmp_path) if name.startswith((".imagechain", "mine-"))]
