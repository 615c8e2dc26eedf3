"""The editor's help opens the page of the handbook, and says what it cannot open."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.handbook.written_pages import MARK, content_mark
from nodes.library import standard_library
from window_hands import add


@pytest.fixture
def written(tmp_path, monkeypatch):
    """A handbook that is there already, as far as its mark says."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = tmp_path / "imagechain" / f"handbook-{content_mark(standard_library())}"
    folder.mkdir(parents=True)
    (folder / MARK).write_text("{}")
    return folder


@pytest.fixture
def lines(window):
    """What the status bar is given to say."""
    said = []
    window.session.message.connect(lambda kind, text: said.append((kind, text)))
    return said


def test_help_is_about_the_selected_module(window, monkeypatch):
    asked = []
    monkeypatch.setattr(window.help, "open_handbook", asked.append)
    window.session.select([add(window, "jitter_mtf")])
    window.actions_by_name["module_help"].trigger()
    assert asked == ["jitter_mtf"]


@pytest.mark.thorough  # it writes the whole handbook
def test_help_leads_to_the_page_of_the_module(window, browser, written, lines, qtbot):
    window.session.select([add(window, "jitter_mtf")])
    page = str(written / "modules" / "jitter_mtf.html")
    window.actions_by_name["module_help"].trigger()
    qtbot.waitUntil(lambda: browser.opened == [page])
    assert ("note", f"the handbook was opened in the browser: {page}") in lines
    head = window.panels.panels["jitter_mtf"].head
    QTest.mouseClick(head.help, Qt.MouseButton.LeftButton)
    assert head.more.isVisible()
    head.more.linkActivated.emit("handbook")
    qtbot.waitUntil(lambda: browser.opened == [page, page])


def test_a_handbook_that_cannot_be_opened_is_a_line(
    window, browser, lines, qtbot, tmp_path, monkeypatch
):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    window.actions_by_name["handbook"].trigger()
    qtbot.waitUntil(lambda: [kind for kind, _ in lines][-1:] == ["error"])
    assert lines[-1][1].startswith("the handbook could not be opened: cannot make the folder")
    assert browser.opened == []
