"""File > Open Recent, by keys and mouse."""

from pathlib import Path

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget

from app.editor.window.recent_files import Settings, folder_text
from app.run.shipped import shipped_networks
from window_hands import KEY


@pytest.fixture
def saved(tmp_path):
    """Save networks of these names; the first is the last one opened."""

    def save(settings, *names):
        text = shipped_networks()["first_steps"].read_text()
        paths = [tmp_path / name for name in names]
        for path in reversed(paths):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            settings.add_recent(path)
        return paths

    return save


def entries(window):
    """The texts of the menu, opened as by the mouse, without the letters that are underlined."""
    window.recent_menu.aboutToShow.emit()
    return [action.text().replace("&", "") for action in window.recent_menu.actions()]


def test_ten_are_listed_newest_first_and_numbered(window, settings, saved):
    names = [f"net_{number}.json" for number in range(12)]
    paths = saved(settings, *names)
    shown = entries(window)
    assert [text.split("\t")[0].split() for text in shown[:10]] == [
        [str(number), name] for number, name in enumerate(names[:10], start=1)
    ]
    assert shown[10:] == ["", "Clear List"]
    assert window.recent_menu.actions()[3].toolTip() == str(paths[3])


def test_keys_alone_open_the_second(window, settings, saved):
    paths = saved(settings, "first.json", "second.json")
    window.activateWindow()
    menu = window.menus["&File"]
    texts = [action.text() for action in menu.actions()]
    assert texts[texts.index("&Open…") + 1] == "Open &Recent"
    menu.popup(window.mapToGlobal(window.rect().center()))
    QTest.keyClick(menu, KEY.Key_R)
    assert window.recent_menu.isVisible()
    QTest.keyClick(window.recent_menu, KEY.Key_2)
    assert window.session.document.path == paths[1]
    assert entries(window)[0].startswith("1  second.json")


def test_a_file_that_goes_while_the_menu_is_open_is_named(window, settings, saved):
    (path,) = saved(settings, "here & there/a & b.json")
    entries(window)
    text = window.recent_menu.actions()[0].text()
    assert "a && b.json" in text
    assert "here && there" in text
    path.unlink()
    window.recent_menu.actions()[0].trigger()
    assert "a & b.json" in window.status.error
    assert window.session.document.path is None


def test_clearing_empties_the_menu_and_the_first_page_for_good(window, settings, saved):
    saved(settings, "mine.json")
    window.show_welcome()
    assert window.findChild(QWidget, "welcome.recent.mine.json") is not None
    entries(window)
    window.recent_menu.actions()[-1].trigger()
    QTest.qWait(20)
    assert window.findChild(QWidget, "welcome.recent.mine.json") is None
    shown = entries(window)
    assert shown == ["No network has been opened yet", "", "Clear List"]
    assert not any(action.isEnabled() for action in window.recent_menu.actions() if action.text())
    assert Settings(settings.path).recent == ()


def test_folders_lose_their_middle_and_the_home_folder_is_a_tilde():
    assert folder_text(Path("/data/chains"), 20) == "/data/chains"
    assert folder_text(Path("/data/0123456789/abcdefghij"), 20) == "/data/…89/abcdefghij"
    assert folder_text(Path.home()) == "~"
    assert folder_text(Path.home() / "chains") == "~/chains"
