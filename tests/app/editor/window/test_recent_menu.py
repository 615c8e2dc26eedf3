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


def test_files_are_listed_opened_by_keys_missed_and_cleared(window, settings, saved):
    names = [f"net_{number}.json" for number in range(11)]
    paths = saved(settings, "here & there/a & b.json", *names)
    shown = entries(window)
    assert [text.split("\t")[0].split() for text in shown[1:10]] == [
        [str(number), name] for number, name in enumerate(names[:9], start=2)
    ]
    assert shown[10:] == ["", "Clear List"]
    assert window.recent_menu.actions()[3].toolTip() == str(paths[3])
    # A file that goes while the menu is open is named.
    text = window.recent_menu.actions()[0].text()
    assert "a && b.json" in text
    assert "here && there" in text
    paths[0].unlink()
    window.recent_menu.actions()[0].trigger()
    assert "a & b.json" in window.status.said("error")
    assert window.session.document.path is None
    # Keys alone open the second.
    second = settings.recent[1]
    window.activateWindow()
    menu = window.menus["&File"]
    texts = [action.text() for action in menu.actions()]
    assert texts[texts.index("&Open…") + 1] == "Open &Recent"
    menu.popup(window.mapToGlobal(window.rect().center()))
    QTest.keyClick(menu, KEY.Key_R)
    assert window.recent_menu.isVisible()
    QTest.keyClick(window.recent_menu, KEY.Key_2)
    assert window.session.document.path == Path(second)
    assert entries(window)[0].startswith(f"1  {Path(second).name}")
    # Clearing empties the menu and the first page for good.
    window.show_welcome()
    recent = f"welcome.recent.{Path(second).name}"
    assert window.findChild(QWidget, recent) is not None
    window.recent_menu.actions()[-1].trigger()
    QTest.qWait(20)
    assert window.findChild(QWidget, recent) is None
    assert entries(window) == ["No recent networks", "", "Clear List"]
    assert not any(action.isEnabled() for action in window.recent_menu.actions() if action.text())
    assert Settings(settings.path).recent == ()


def test_folders_lose_their_middle_and_the_home_folder_is_a_tilde():
    assert folder_text(Path("/data/chains"), 20) == "/data/chains"
    assert folder_text(Path("/data/0123456789/abcdefghij"), 20) == "/data/…89/abcdefghij"
    long = "/" + "0123456789" * 5
    assert folder_text(Path(long[:44])) == long[:44]
    assert folder_text(Path(long[:45])) == f"{long[:14]}…{long[16:45]}"  # 44 letters
    assert folder_text(Path.home()) == "~"
    assert folder_text(Path.home() / "chains") == "~/chains"
