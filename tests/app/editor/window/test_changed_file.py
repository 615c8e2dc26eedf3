"""Two windows on one file: whoever saves second is asked."""

import json
import subprocess
import sys

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox, QPushButton

from app.run.open_marks import OpenMark
from app.run.shipped import environment, shipped_networks
from window_hands import KEY, add


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(shipped_networks()["first_steps"].read_text())
    return path


@pytest.fixture
def two(make_window, file):
    """Two windows on the file; the first has saved since, both have work of their own."""
    one, other = make_window(), make_window()
    for window in (one, other):
        assert window.files.open_now(str(file))
    add(one, "jitter_mtf")
    one.files.save()
    assert not one.isWindowModified()
    add(other, "test_scene")
    other.activateWindow()
    return one, other


def question(window):
    found = [box for box in window.findChildren(QMessageBox, "changed_file") if box.isVisible()]
    assert len(found) <= 1
    return found[0] if found else None


def click(qtbot, window, answer):
    box = question(window)
    box.findChild(QPushButton, answer).click()
    qtbot.waitUntil(lambda: question(window) is None)


def modules(path):
    return [node["module"] for node in json.loads(path.read_text())["nodes"].values()]


def test_the_second_to_save_is_asked_and_cancel_leaves_both_as_they_are(two, file, qtbot):
    _, other = two
    before = file.read_bytes()
    for _ in range(2):
        other.files.save()
        box = question(other)
        assert "Another program has changed mine.json" in box.text()
        texts = {button.text().replace("&", "") for button in box.findChildren(QPushButton)}
        assert texts == {"Reload", "Overwrite", "Save As…", "Cancel"}
        QTest.keyClick(box, KEY.Key_Escape)
        qtbot.waitUntil(lambda: question(other) is None)
        assert file.read_bytes() == before
        assert other.isWindowModified()


def test_overwrite_writes_asks_no_more_and_is_noticed_by_the_other(two, file, qtbot):
    one, other = two
    other.files.save()
    click(qtbot, other, "overwrite")
    assert "test_scene" in modules(file)
    assert "jitter_mtf" not in modules(file)
    assert not other.isWindowModified()
    add(other, "init_trans")
    other.files.save()
    assert question(other) is None
    assert not other.isWindowModified()
    add(one, "init_trans")
    one.files.save()
    assert question(one) is not None


def test_closing_saves_only_once_that_is_answered(two, file, qtbot):
    _, other = two
    before = file.read_bytes()
    for reply in ("cancel", "overwrite"):
        assert not other.close()
        box = next(b for b in other.findChildren(QMessageBox, "save_changes") if b.isVisible())
        box.button(QMessageBox.StandardButton.Save).click()
        qtbot.waitUntil(lambda: question(other) is not None)
        assert other.isVisible()
        assert file.read_bytes() == before
        click(qtbot, other, reply)
    qtbot.waitUntil(lambda: not other.isVisible())
    assert modules(file)[-1] == "test_scene"


def test_a_change_by_another_program_is_told_when_it_happens(make_window, file, qtbot):
    window = make_window()
    assert window.files.open_now(str(file))
    said = []
    window.session.message.connect(lambda kind, text: said.append((kind, text)))
    for content in (file.read_text() + "\n", file.read_text() + "\n\n"):
        new = file.with_name("new")
        new.write_text(content)
        new.replace(file)  # as most editors save
        qtbot.waitUntil(lambda: bool(said), timeout=60000)
        assert said == [("warning", "another program has changed mine.json: Save asks what to do")]
    window.files.save_to(file, over=True)
    said.clear()
    file.unlink()
    qtbot.waitUntil(lambda: bool(said), timeout=60000)
    assert said == [("warning", "another program has removed mine.json: Save asks what to do")]


SHARED = "another window has mine.json open too: save in one of them only"


def test_both_of_two_windows_on_one_file_say_so_and_save(make_window, file, qtbot):
    one, other = make_window(), make_window()
    assert one.files.open_now(str(file))
    qtbot.wait(400)
    assert one.status.warning == ""
    assert other.files.open_now(str(file))
    for window in (one, other):
        qtbot.waitUntil(lambda window=window: window.status.warning == SHARED)
    add(one, "jitter_mtf")
    one.files.save()
    assert not one.isWindowModified()
    assert "jitter_mtf" in modules(file)
    qtbot.waitUntil(lambda: "another program has changed" in other.status.warning)
    other.files.new()
    qtbot.waitUntil(lambda: one.status.warning == "")
    assert other.status.warning == ""


def test_a_window_that_crashed_has_the_file_open_no_longer(make_window, file, qtbot):
    code = (
        "import sys, time; from pathlib import Path; from app.run.open_marks import OpenMark\n"
        "mark = OpenMark(Path(sys.argv[1])); print('open', flush=True); time.sleep(600)\n"
    )
    words = [sys.executable, "-P", "-c", code, str(file)]
    window = make_window()
    assert window.files.open_now(str(file))
    with subprocess.Popen(words, env=environment(), stdout=subprocess.PIPE) as crashing:
        assert crashing.stdout.readline() == b"open\n"
        qtbot.waitUntil(lambda: window.status.warning == SHARED)
        crashing.kill()
    mark = OpenMark(file)
    assert len(list(mark.folder.glob("*.lock"))) == 3  # the dead one's is still there
    mark.let_go()
    qtbot.waitUntil(lambda: window.status.warning == "")
