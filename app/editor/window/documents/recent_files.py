"""File > Open Recent: the networks opened or saved last, and how their folders are written."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from app.editor.gestures import without_argument
from app.editor.window.documents.remembered_settings import Settings

FOLDER_LETTERS = 44
_NAME_LETTERS = 60
_NUMBERED = 10  # the tenth by 0


class RecentMenu(QMenu):
    """The list as a menu, made anew each time it opens: another window may have added to it.

    Parameters
    ----------
    settings : Settings
        What holds the list.
    choose : callable
        Opens the file of that path.
    cleared : callable
        Called when the list has been cleared.
    parent : QWidget
        The window.
    """

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
        self.menuAction().setToolTip("Open one of the networks opened or saved last")
        self._settings = settings
        self._choose = choose
        self._cleared = cleared
        self.aboutToShow.connect(self._fill)
        self._fill()

    def stand_after(self, action: QAction, menu: QMenu) -> None:
        """Take the place below an action of a menu."""
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
            item = self.addAction(f"{_numbered(number)}{name}\t{folder}")
            item.setObjectName(f"recent.{number}")
            item.setToolTip(str(path))
            item.triggered.connect(partial(without_argument, partial(self._choose, str(path))))
        if not recent:
            none = self.addAction("No network has been opened yet")
            none.setEnabled(False)
        self.addSeparator()
        clear = self.addAction("&Clear List")
        clear.setObjectName("recent.clear")
        clear.setToolTip("Forget which networks were opened; the files stay")
        clear.setEnabled(bool(recent))
        clear.triggered.connect(self._clear)

    def _clear(self) -> None:
        self._settings.forget_recent()
        self._cleared()


def folder_text(folder: Path, letters: int = FOLDER_LETTERS) -> str:
    """A folder in one short line: the home folder as ``~``, what is too long left out mid-way.

    Parameters
    ----------
    folder : Path
        The folder.
    letters : int
        Most letters of the line.
    """
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


def _numbered(number: int) -> str:
    return f"&{number}  " if number < _NUMBERED else "1&0  "
