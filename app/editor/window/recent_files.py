"""File > Open Recent: the networks opened or saved last, and how their folders are written."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from PySide6.QtCore import QByteArray, QSettings
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QMenu, QWidget

from app.editor.gestures import without_argument
from app.editor.theme import THEMES, Look
from app.editor.widgets import Menu
from app.user_folders import settings_folder

FOLDER_LETTERS = 44
_NAME_LETTERS = 60
_NUMBERED = 10  # the tenth by 0


class RecentMenu(Menu):
    """The list as a menu, made anew each time it opens: another window may have added to it."""

    def __init__(
        self,
        settings: Settings,
        choose: Callable[[str], object],
        cleared: Callable[[], object],
        parent: QWidget,
    ) -> None:
        super().__init__("Open &Recent", parent)
        self.setObjectName("menu.recent")
        self.setToolTipsVisible(True)
        self.menuAction().setToolTip("Open a recent network")
        self._settings = settings
        self._choose = choose
        self._cleared = cleared
        self.aboutToShow.connect(self._fill)
        self._fill()

    def stand_after(self, action: QAction, menu: QMenu) -> None:
        actions = menu.actions()
        below = actions[actions.index(action) + 1 :]
        menu.insertMenu(below[0], self) if below else menu.addMenu(self)

    def _fill(self) -> None:
        self.clear()
        recent = self._settings.recent
        for number, path in enumerate(recent, start=1):
            # Behind the tab stands what menus have in a column of its own.
            texts = (_shortened(path.name, _NAME_LETTERS), folder_text(path.parent))
            name, folder = (text.replace("&", "&&").replace("\t", " ") for text in texts)
            key = f"&{number}" if number < _NUMBERED else "1&0"
            item = self.addAction(f"{key}  {name}\t{folder}")
            item.setObjectName(f"recent.{number}")
            item.setToolTip(str(path))
            item.triggered.connect(partial(without_argument, partial(self._choose, str(path))))
        if not recent:
            none = self.addAction("No network has been opened yet")
            none.setEnabled(False)
        self.addSeparator()
        clear = self.addAction("&Clear List")
        clear.setObjectName("recent.clear")
        clear.setToolTip("Clear this list; the files stay")
        clear.setEnabled(bool(recent))
        clear.triggered.connect(self._clear)

    def _clear(self) -> None:
        self._settings.forget_recent()
        self._cleared()


def folder_text(folder: Path, letters: int = FOLDER_LETTERS) -> str:
    """A folder in one short line: the home folder as ``~``, what is too long left out mid-way."""
    home, text = Path.home(), str(folder)
    if folder != home and folder.is_relative_to(home):
        text = str(Path("~") / folder.relative_to(home))
    elif folder == home:
        text = "~"
    return _shortened(text, letters)


def _shortened(text: str, letters: int) -> str:
    """A third of the beginning and all the rest of the end, which differs more."""
    if len(text) <= letters:
        return text
    head = (letters - 1) // 3
    return f"{text[:head]}…{text[len(text) - (letters - 1 - head) :]}"


# Settings kept from one start to the next: look, window, files opened lately.

MOST_RECENT = 10  # files that are offered
_MOST_STORED = 30  # of them and those that are not there: a disk may be put in again
DOCKS_VERSION = 2  # of the docks' stored places; of an earlier one the default layout is taken


class Settings:
    """Settings in an ini file of the user; a damaged one counts as empty.

    `first`: there was no file, so the program is started for the first time.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or settings_folder() / "editor.ini"
        self.first = not self.path.exists()
        self._stored = QSettings(str(self.path), QSettings.Format.IniFormat)

    @property
    def look(self) -> Look:
        stored = self._stored.value("look", "dark")
        return stored if stored in THEMES else "dark"

    @look.setter
    def look(self, look: Look) -> None:
        self._stored.setValue("look", look)

    @property
    def illustrations(self) -> frozenset[str]:
        """Modules whose panels show an illustration or none, other than at first."""
        stored = self._stored.value("illustrations", "")
        return frozenset(stored.split()) if isinstance(stored, str) else frozenset()

    @illustrations.setter
    def illustrations(self, modules: Collection[str]) -> None:
        self._stored.setValue("illustrations", " ".join(sorted(modules)))

    @property
    def recent(self) -> tuple[Path, ...]:
        there = (path for path in map(Path, self._stored_recent()) if path.is_file())
        return tuple(islice(there, MOST_RECENT))

    def add_recent(self, path: Path) -> None:
        text = str(path.absolute())
        others = [other for other in self._stored_recent() if other != text]
        self._stored.setValue("recent", [text, *others][:_MOST_STORED])

    def forget_recent(self) -> None:
        self._stored.remove("recent")

    def _stored_recent(self) -> list[str]:
        stored = self._stored.value("recent", [])
        texts = [stored] if isinstance(stored, str) else stored
        if not isinstance(texts, list):
            return []
        return [text for text in texts if isinstance(text, str) and text]

    @property
    def layout(self) -> str:
        stored = self._stored.value("layout", "")
        return stored if isinstance(stored, str) else ""

    @property
    def layouts(self) -> dict[str, list[Any]]:
        """The arguments of `Pages.restore_layout` by the user's name for them."""
        stored = self._stored.value("layouts", {})
        return stored if isinstance(stored, dict) else {}

    @layouts.setter
    def layouts(self, layouts: dict[str, list[Any]]) -> None:
        self._stored.setValue("layouts", layouts)

    def remember_window(self, window: QMainWindow, layout: str) -> None:
        self._stored.setValue("geometry", window.saveGeometry())
        self._stored.setValue("layout", layout)
        self._stored.setValue("docks", window.saveState(DOCKS_VERSION))
        self._stored.sync()

    def restore_window(self, window: QMainWindow) -> bool:
        geometry, docks = self._bytes("geometry"), self._bytes("docks")
        if geometry is not None:
            window.restoreGeometry(geometry)
        return docks is not None and window.restoreState(docks, DOCKS_VERSION)

    def _bytes(self, name: str) -> QByteArray | None:
        stored = self._stored.value(name)
        return stored if isinstance(stored, QByteArray) else None
