"""File > Open Recent, and the settings: the networks opened or saved last, look, window."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeVar

from PySide6.QtCore import QByteArray, QSettings
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QWidget

from app.editor.theme import Look
from app.editor.widgets import Menu
from app.user_folders import FOLDERS

MOST_RECENT = 10  # files that are offered
_MOST_STORED = 30  # of them and those that are not there: a disk may be put in again
DOCKS_VERSION = 2  # of the docks' stored places; of an earlier one the default layout is taken
T = TypeVar("T")


def recent_menu(
    settings: Settings,
    choose: Callable[[str], object],
    cleared: Callable[[], object],
    parent: QWidget,
) -> Menu:
    """The list as a menu, made anew each time it opens: another window may have added to it."""
    menu = Menu("Open &Recent", parent)
    menu.setToolTipsVisible(True)
    menu.menuAction().setToolTip("Open a recent network")

    def fill() -> None:
        menu.clear()
        recent = settings.recent
        for number, path in enumerate(recent, start=1):
            # Behind the tab stands what menus have in a column of its own.
            name, folder = (
                text.replace("&", "&&").replace("\t", " ")
                for text in (path.name, folder_text(path.parent))
            )
            key = f"&{number}" if number < MOST_RECENT else "1&0"
            item = menu.addAction(f"{key}  {name}\t{folder}")
            item.setToolTip(str(path))
            item.setData(str(path))
        if not recent:
            menu.addAction("No recent networks").setEnabled(False)
        menu.addSeparator()
        clear = menu.addAction("&Clear List")
        clear.setToolTip("Clear this list without deleting the files")
        clear.setEnabled(bool(recent))

    def chosen(item: QAction) -> None:
        if item.data() is not None:
            choose(item.data())
        else:
            settings.forget_recent()
            cleared()

    menu.aboutToShow.connect(fill)
    menu.triggered.connect(chosen)
    return menu


def folder_text(folder: Path, letters: int = 44) -> str:
    """A folder in one short line: the home folder as ``~``, what is too long left out mid-way."""
    home = Path.home()
    text = str(Path("~") / folder.relative_to(home) if folder.is_relative_to(home) else folder)
    head = (letters - 1) // 3
    return text if len(text) <= letters else f"{text[:head]}…{text[head + 1 - letters :]}"


class Settings:
    """Settings in an ini file of the user; a damaged one counts as empty.

    `first`: there was no file, so the program is started for the first time.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or FOLDERS.user_config_path / "editor.ini"
        self.first = not self.path.exists()
        self._stored = QSettings(str(self.path), QSettings.Format.IniFormat)

    def _of(self, name: str, usual: T) -> T:
        """A stored value, or the usual one where there is none of that type."""
        stored = self._stored.value(name, usual)
        return stored if isinstance(stored, type(usual)) else usual

    @property
    def look(self) -> Look:
        return "light" if self._of("look", "") == "light" else "dark"

    @look.setter
    def look(self, look: Look) -> None:
        self._stored.setValue("look", look)

    @property
    def illustrations(self) -> frozenset[str]:
        """Modules whose panels show an illustration or none, other than at first."""
        return frozenset(self._of("illustrations", "").split())

    @illustrations.setter
    def illustrations(self, modules: Collection[str]) -> None:
        self._stored.setValue("illustrations", " ".join(sorted(modules)))

    @property
    def recent(self) -> tuple[Path, ...]:
        there = [path for path in map(Path, self._stored_recent()) if path.is_file()]
        return tuple(there[:MOST_RECENT])

    def add_recent(self, path: Path) -> None:
        text = str(path.absolute())
        others = [other for other in self._stored_recent() if other != text]
        self._stored.setValue("recent", [text, *others][:_MOST_STORED])

    def forget_recent(self) -> None:
        self._stored.remove("recent")

    def _stored_recent(self) -> list[str]:
        """Of a single file Qt gives the text itself."""
        texts = self._of("recent", list[str]()) or [self._of("recent", "")]
        return [text for text in texts if isinstance(text, str) and text]

    @property
    def layouts(self) -> dict[str, list[Any]]:
        """The arguments of `WindowLayout.restore` by the user's name for them."""
        return self._of("layouts", dict[str, list[Any]]())

    @layouts.setter
    def layouts(self, layouts: dict[str, list[Any]]) -> None:
        self._stored.setValue("layouts", layouts)

    def remember_window(self, geometry: QByteArray, docks: QByteArray, layout: str) -> None:
        stored = {"geometry": geometry, "docks": docks, "layout": layout}
        for name, value in stored.items():
            self._stored.setValue(name, value)
        self._stored.sync()

    @property
    def window(self) -> tuple[QByteArray, QByteArray, str]:
        """Geometry, docks and layout, as they were left."""
        none = QByteArray()
        return self._of("geometry", none), self._of("docks", none), self._of("layout", "")
