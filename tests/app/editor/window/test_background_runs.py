"""Reports and queued runs in the window as it is: real keys, and a real process for each run."""

import os
import re
import signal
from pathlib import Path

import pytest
from PySide6.QtCore import QObject, Qt, QUrl, Slot
from PySide6.QtGui import QDesktopServices
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit, QMessageBox, QPushButton

from app.editor.window.background_runs import AddRun
from command_line import run_here
from core.editing.document import Document
from core.editing.operations import set_parameter
from core.network.file import parse_network
from core.network.network import Network
from window_hands import CTRL, KEY, SHIFT, give_focus

_BUTTON, LEFT = QMessageBox.StandardButton, Qt.MouseButton.LeftButton
LONG = 100_000  # frames
TIMES = re.compile(r"\d{4}-\d\d-\d\d \d\d:\d\d [+-]\d{4}|\b\d+\.\d+ m?s\b")


class Browser(QObject):
    """What is opened outside of the window."""

    def __init__(self):
        super().__init__()
        self.opened = []

    @Slot(QUrl)
    def open(self, url):
        self.opened.append(url.toLocalFile())


@pytest.fixture
def browser(qtbot):
    made = Browser()
    QDesktopServices.setUrlHandler("file", made, "open")
    yield made
    QDesktopServices.unsetUrlHandler("file")


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
    qtbot.waitUntil(lambda: run.step.doing.startswith("frames"))
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
    folder = tmp_path / "mine-sweep"
    runs = [f"blur.sigma_x_mrad={value}" for value in (0.1, 0.3)]
    assert names(folder) == [*runs, "tradeoff.csv", "tradeoff.html"]
    done = run_here(
        *("run", "mine.json", "--set", runs[0], "--output-dir", "theirs"), folder=tmp_path
    )
    assert done.returncode == 0, done.stderr
    theirs = (tmp_path / "theirs" / "final.png").read_bytes()
    assert (folder / runs[0] / "final.png").read_bytes() == theirs
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


def test_a_run_is_of_the_network_as_it_stands_with_what_is_typed(desk, qtbot):
    """Unsaved changes too, also of a value that is not entered yet."""
    desk.session.select(["blur"])
    edit = desk.panels.panels["blur"].body.sections.field("sigma_x_mrad").edit
    give_focus(edit)
    edit.selectAll()
    QTest.keyClicks(edit, "0.75")
    desk.actions_by_name["add_run"].trigger()
    (dialog,) = (each for each in desk.findChildren(AddRun) if each.isVisible())
    dialog.kinds.setCurrentIndex(3)
    give_focus(dialog.folder)
    press(desk, KEY.Key_Return)
    (entry,) = desk.runs.queue.runs
    assert '"sigma_x_mrad": 0.75' in entry.job.network
    over(qtbot, entry)
    assert entry.state == "done", entry.text


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("values", "", "no values: FROM:TO:COUNT"),
        ("values", "0:1", "blur.sigma_x_mrad=0:1: write FROM:TO:COUNT"),
        ("values", "-1, 2", "-1 mrad is not allowed: a number of at least 0"),
        ("folder", "", "give a folder"),
    ],
)
def test_bad_input_is_said_and_its_field_has_the_focus(desk, qtbot, name, text, said):
    dialog = dialog_of(desk, qtbot)
    dialog.parameter.take("blur.sigma_x_mrad")
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


def test_one_is_cancelled_by_its_key_and_the_next_goes_on(desk, qtbot, tmp_path):
    before = names(tmp_path)
    long = add_frames(desk, qtbot)
    small = add_frames(desk, qtbot, 2)
    computing(qtbot, long)
    desk.runs.view.mark(long)
    give_focus(desk.runs.view.list)
    assert "%" in desk.runs.view.list.currentItem().text(1)
    press(desk, KEY.Key_Delete)
    assert over(qtbot, long).state == "cancelled"
    assert over(qtbot, small).state == "done"
    assert names(tmp_path) == sorted([*before, "mine-frames-2"])
    assert desk.status.error == ""


def test_a_failure_stands_in_the_list_in_one_line(desk, qtbot):
    """A network that does not hold together: its line is the command's."""
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


def test_the_end_of_a_run_is_said_where_the_list_is_hidden(desk, qtbot, tmp_path):
    entry = add_frames(desk, qtbot, 2)
    desk.runs.dock.hide()
    assert over(qtbot, entry).state == "done"
    assert desk.status.note == "mine: 2 frames: done"
    entry = add_frames(desk, qtbot)
    desk.runs.dock.hide()
    os.kill(computing(qtbot, entry), signal.SIGKILL)
    over(qtbot, entry)
    assert entry.text == "the system ended the process (signal 9): memory may have run out"
    assert desk.status.error == f"mine: {LONG} frames: failed: {entry.text}"


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


def test_the_report_is_the_commands_of_the_network_as_it_stands(desk, qtbot, browser, tmp_path):
    assert desk.session.do(set_parameter("blur", "sigma_x_mrad", 0.75))
    view = desk.runs.view
    write_report(desk, tmp_path / "report.html")
    (entry,) = desk.runs.queue.runs
    assert view.stop.isEnabled()
    over(qtbot, entry)
    assert not view.stop.isEnabled()
    QTest.mouseClick(view.page, LEFT)
    assert browser.opened == [str(tmp_path / "report.html")]
    (tmp_path / "as_it_stands.json").write_text(desk.session.document.text())
    words = ("run", "as_it_stands.json", "--report", "theirs.html")
    done = run_here(*words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    mine, theirs = (
        TIMES.sub("TIME", (tmp_path / name).read_text()) for name in ("report.html", "theirs.html")
    )
    assert mine == theirs
    assert desk.isWindowModified(), "nothing was saved for it"
    assert entry.job.network != (tmp_path / "mine.json").read_text()


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


def test_runs_that_are_done_are_not_asked_about(desk, qtbot):
    assert over(qtbot, add_frames(desk, qtbot, 2)).state == "done"
    assert desk.close()
