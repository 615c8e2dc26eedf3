"""Two windows on one file say so at once; whoever saves second is asked."""

import json

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox, QPushButton

from app.run.shipped import shipped_networks
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


def test_the_second_to_save_is_asked_and_nothing_is_written_before_the_answer(two, file, qtbot):
    one, other = two
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
    other.files.save()
    click(qtbot, other, "overwrite")
    assert "test_scene" in modules(file)
    assert "jitter_mtf" not in modules(file)
    assert not other.isWindowModified()
    add(other, "init_trans")
    other.files.save()  # asks no more
    assert question(other) is None
    assert not other.isWindowModified()
    # The other notices; closing it saves only once that is answered.
    add(one, "vibration_mtf")
    before = file.read_bytes()
    for reply in ("cancel", "overwrite"):
        assert not one.close()
        box = next(b for b in one.findChildren(QMessageBox, "save_changes") if b.isVisible())
        box.findChild(QPushButton, "save").click()
        qtbot.waitUntil(lambda: question(one) is not None)
        assert one.isVisible()
        assert file.read_bytes() == before
        click(qtbot, one, reply)
    qtbot.waitUntil(lambda: not one.isVisible())
    assert modules(file)[-1] == "vibration_mtf"


def test_both_windows_say_so_and_a_change_from_outside_is_said_by_itself(two, file, qtbot):
    one, other = two
    qtbot.waitUntil(lambda: "mine.json is also open" in one.status.said("warning"))
    qtbot.waitUntil(
        lambda: "has changed mine.json" in other.status.said("warning")
    )  # by the first one
    assert "changed" not in one.status.said("warning")
    for how in (write_in_place, replace):
        one.files.save_to(file, over=True)
        qtbot.waitUntil(lambda: "changed" not in one.status.said("warning"))
        assert f"saved {file}" in one.status.said("information")
        how(file)
        qtbot.waitUntil(
            lambda: "another program has changed mine.json" in one.status.said("warning")
        )
    file.unlink()
    qtbot.waitUntil(lambda: "has removed mine.json" in one.status.said("warning"))
    other.close_for_good()
    one.files.save_to(file, over=True)
    assert one.files.open_now(str(file))
    qtbot.wait(500)
    assert one.status.said("warning") == ""


def write_in_place(file):
    file.write_text(file.read_text() + "\n")


def replace(file):
    new = file.with_name("new")
    new.write_text(file.read_text() + " ")
    new.replace(file)
