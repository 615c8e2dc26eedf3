"""The layout that is in use: it grows with the window, and keeps what the user has dragged."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, QSize, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow

from app.editor.window.docks.layouts import DEFAULT, Docks, LayoutName, place, size

_PREFERRED = QSize(1600, 900)  # of a first window, where the screen has room for it
_SHARE_OF_SCREEN = 0.92  # at most; the rest is the window's frame and the desktop's bars
_SHARE_OF_ROOM = 0.85  # of that, on a large screen


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
        self._shares: dict[QDockWidget, tuple[float, float]] = {}
        self._shown = False
        window.installEventFilter(self)

    def choose(self, name: LayoutName) -> None:
        """Place and size every dock by that layout."""
        self.name = name
        self._shares = {}
        self.place()
        self.begin()

    def place(self) -> None:
        """Place every dock by the layout in use."""
        place(self._window, self._docks(), self.name)

    def begin(self) -> None:
        """Size the docks, which are shown from now on."""
        self._shown = True
        self._size()

    def keep(self) -> None:
        """Keep the sizes of the docks, remembered or dragged, as shares of the window."""
        self._shown = True
        window = self._window
        shares = {
            dock: (dock.width() / window.width(), dock.height() / window.height())
            for dock in self._docks().all
            if dock.isVisible()
            and not dock.isFloating()
            and window.rect().intersects(dock.geometry())  # Qt has those behind another outside
        }
        if shares:  # none is shown beside the first page, where a click ends here, too
            self._shares = shares

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """See the window resized, and the end of a drag at the line between two docks."""
        if watched is self._window and self._shown:
            if event.type() is QEvent.Type.Resize:
                self._size()
            elif event.type() is QEvent.Type.MouseButtonRelease:
                self.keep()
        return False

    def _size(self) -> None:
        if not self._shares:
            size(self._window, self._docks(), self.name)
            return
        width, height = self._window.width(), self._window.height()
        shares = {dock: share for dock, share in self._shares.items() if not dock.isFloating()}
        docks = list(shares)
        widths = [max(1, round(share[0] * width)) for share in shares.values()]
        heights = [max(1, round(share[1] * height)) for share in shares.values()]
        self._window.resizeDocks(docks, widths, Qt.Orientation.Horizontal)
        self._window.resizeDocks(docks, heights, Qt.Orientation.Vertical)
