"""Settings kept from one start to the next: look, window, files opened lately."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from PySide6.QtCore import QByteArray, QSettings
from PySide6.QtWidgets import QMainWindow

from app.editor.theme import THEMES, Look
from app.user_folders import settings_folder

MOST_RECENT = 10  # files that are offered
_MOST_STORED = 30  # of them and those that are not there: a disk may be put in again
_DOCKS_VERSION = 2  # of the docks' stored places; of an earlier one the default layout is taken


class Settings:
    """Settings in an ini file of the user; a damaged one counts as empty.

    Parameters
    ----------
    path : Path, optional
        The file; None for the usual place.

    Attributes
    ----------
    first : bool
        Whether there was no file: the program is started for the first time.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or settings_folder() / "editor.ini"
        self.first = not self.path.exists()
        self._stored = QSettings(str(self.path), QSettings.Format.IniFormat)

    @property
    def look(self) -> Look:
        """Dark or light."""
        stored = self._stored.value("look", "dark")
        return stored if stored in THEMES else "dark"

    @look.setter
    def look(self, look: Look) -> None:
        self._stored.setValue("look", look)

    @property
    def recent(self) -> tuple[Path, ...]:
        """The ten files opened or saved last that are there, the last one first."""
        there = (path for path in map(Path, self._stored_recent()) if path.is_file())
        return tuple(islice(there, MOST_RECENT))

    def add_recent(self, path: Path) -> None:
        """Store a file as the last one opened."""
        text = str(path.absolute())
        others = [other for other in self._stored_recent() if other != text]
        self._stored.setValue("recent", [text, *others][:_MOST_STORED])

    def forget_recent(self) -> None:
        """Forget which files were opened or saved."""
        self._stored.remove("recent")

    def _stored_recent(self) -> list[str]:
        stored = self._stored.value("recent", [])
        texts = [stored] if isinstance(stored, str) else stored
        if not isinstance(texts, list):
            return []
        return [text for text in texts if isinstance(text, str) and text]

    @property
    def layout(self) -> str:
        """What the window's layout gave to be remembered; empty where nothing is."""
        stored = self._stored.value("layout", "")
        return stored if isinstance(stored, str) else ""

    def remember_window(self, window: QMainWindow, layout: str) -> None:
        """Store size, place, docks and layout of a window, in the file at once."""
        self._stored.setValue("geometry", window.saveGeometry())
        self._stored.setValue("layout", layout)
        self._stored.setValue("docks", window.saveState(_DOCKS_VERSION))
        self._stored.sync()

    def restore_window(self, window: QMainWindow) -> bool:
        """Give a window the size and docks remembered; whether there were docks to restore."""
        geometry, docks = self._bytes("geometry"), self._bytes("docks")
        if geometry is not None:
            window.restoreGeometry(geometry)
        return docks is not None and window.restoreState(docks, _DOCKS_VERSION)

    def _bytes(self, name: str) -> QByteArray | None:
        stored = self._stored.value(name)
        return stored if isinstance(stored, QByteArray) else None
