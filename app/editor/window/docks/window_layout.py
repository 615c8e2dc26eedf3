"""The layout that is in use: it grows with the window, and keeps what the user has dragged."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import get_args

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer
from PySide6.QtWidgets import QMainWindow

from app.editor.window.docks.layouts import DEFAULT, Docks, LayoutName, place, size

_PREFERRED = QSize(1600, 900)  # of a first window, where the screen has room for it
_SHARE_OF_SCREEN = 0.92  # at most; the rest is the window's frame and the desktop's bars
_SHARE_OF_ROOM = 0.85  # of that, on a large screen
Share = tuple[float, float]  # of the window's width and height
Sizes = dict[str, tuple[int, int]]


def first_size(available: QSize) -> QSize:
    """The size of a window where none is remembered: within the screen, larger on a large one."""
    room = available * _SHARE_OF_SCREEN
    return _PREFERRED.expandedTo(room * _SHARE_OF_ROOM).boundedTo(room)


class WindowLayout(QObject):
    """Places the docks by a named layout, and sizes them when the window is resized.

    Parameters
    ----------
    window : QMainWindow
        The window.
    docks : callable
        Gives its docks as they are now.
    """

    def __init__(self, window: QMainWindow, docks: Callable[[], Docks]) -> None:
        super().__init__(window)
        self.name: LayoutName = DEFAULT
        self._window = window
        self._docks = docks
        self._shares: dict[str, Share] = {}  # by the docks' object names
        self._shown = self._placing = False
        self._pressed: Sizes | None = None
        self._followed: set[str] = set()
        self._soon = QTimer(self)
        self._soon.setSingleShot(True)
        self._soon.timeout.connect(self.keep)
        window.installEventFilter(self)

    def choose(self, name: LayoutName) -> None:
        """Place and size every dock by that layout."""
        self.name = name
        self._shares = {}
        self.place()
        self.begin()

    def place(self) -> None:
        """Place every dock by the layout in use."""
        with self.placing():
            place(self._window, self._docks(), self.name)

    @contextmanager
    def placing(self) -> Iterator[None]:
        """While docks are moved by the program, not by the user."""
        self._placing = True
        try:
            yield
        finally:
            self._placing = False

    def begin(self) -> None:
        """Size the docks, which are shown from now on."""
        self._shown = True
        self._follow_docks()
        self._size()

    def keep(self) -> None:
        """Keep the sizes of the docks, remembered or dragged, as shares of the window."""
        self._shown = True
        self._follow_docks()
        width, height = self._window.width(), self._window.height()
        shares = {name: (w / width, h / height) for name, (w, h) in self._sizes().items()}
        if shares:  # none is shown beside the first page
            self._shares = shares

    def state(self) -> str:
        """The layout in use and the shares that are kept, to be remembered."""
        return json.dumps({"name": self.name, "shares": self._shares})

    def restore(self, state: str) -> bool:
        """Use what `state` gave; whether it is that."""
        try:
            stored = json.loads(state)
            name = stored["name"]
            shares = {
                dock: (float(share[0]), float(share[1])) for dock, share in stored["shares"].items()
            }
        except (ValueError, TypeError, LookupError, AttributeError):
            return False
        sound = all(0 < part <= 1 for share in shares.values() for part in share)
        if name not in get_args(LayoutName) or not sound:
            return False
        self.name, self._shares = name, shares
        return True

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """See the window resized, and the end of a drag at the line between two docks."""
        if watched is self._window and self._shown:
            if event.type() is QEvent.Type.Resize:
                self._size()
            elif event.type() is QEvent.Type.MouseButtonPress:
                self._pressed = self._sizes()
            elif event.type() is QEvent.Type.MouseButtonRelease:
                pressed, self._pressed = self._pressed, None
                if pressed is not None and pressed != self._sizes():
                    self.keep()
        return False

    def _sizes(self) -> Sizes:
        """Width and height of the docks that are seen in the window."""
        window = self._window
        return {
            dock.objectName(): (dock.width(), dock.height())
            for dock in self._docks().all
            if dock.isVisible()
            and not dock.isFloating()
            and window.rect().intersects(dock.geometry())  # Qt has those behind another outside
        }

    def _follow_docks(self) -> None:
        """Hear of docks that are moved or floated, those made lately too."""
        for dock in self._docks().all:
            if dock.objectName() not in self._followed:
                self._followed.add(dock.objectName())
                dock.topLevelChanged.connect(self._moved)
                dock.dockLocationChanged.connect(self._moved)

    def _moved(self, *_: object) -> None:
        """A dock has another place: the shares are those of a while later, once all are laid."""
        if self._shown and not self._placing:
            self._soon.start(0)

    def _size(self) -> None:
        if not self._shares:
            size(self._window, self._docks(), self.name)
            return
        width, height = self._window.width(), self._window.height()
        docks = [
            dock
            for dock in self._docks().all
            if dock.objectName() in self._shares and not dock.isFloating()
        ]
        shares = [self._shares[dock.objectName()] for dock in docks]
        widths = [max(1, round(share[0] * width)) for share in shares]
        heights = [max(1, round(share[1] * height)) for share in shares]
        self._window.resizeDocks(docks, widths, Qt.Orientation.Horizontal)
        self._window.resizeDocks(docks, heights, Qt.Orientation.Vertical)
