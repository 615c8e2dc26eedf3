"""One viewer over the whole screen, and back to its dock."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QDockWidget, QVBoxLayout, QWidget

from app.editor.window.docks.viewer_docks import ViewerDocks

_BACK = ("F11", "Esc")


class FullScreen(QObject):
    """Shows the viewer that was used last over the whole screen, and puts it back.

    Parameters
    ----------
    viewers : ViewerDocks
        The viewers with their docks.
    window : QWidget
        The window they belong to.
    """

    def __init__(self, viewers: ViewerDocks, window: QWidget) -> None:
        super().__init__(window)
        self._viewers = viewers
        self._window = window
        self._used: QDockWidget | None = None
        self.page: FullScreenPage | None = None
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.focusChanged.connect(self._focus_changed)

    def toggle(self) -> None:
        """Show the viewer that was used last over the whole screen, or put it back."""
        if self.page is not None:
            self.leave()
            return
        dock = self._last_used()
        if dock.widget() is None:
            return
        self.page = FullScreenPage(dock, self._window)
        self.page.left.connect(self.leave)
        self.page.setGeometry(self._window.screen().geometry())
        self.page.showFullScreen()
        self.page.activateWindow()

    def leave(self) -> None:
        """Put the viewer back into its dock."""
        page, self.page = self.page, None
        if page is not None:
            page.give_back()
            self._window.activateWindow()

    def _last_used(self) -> QDockWidget:
        """The dock of the viewer that had the focus last; the first one's where none has."""
        used = self._used
        return used if used is not None and used.isVisible() else self._viewers.docks[1]

    def _focus_changed(self, _before: object, now: QWidget | None) -> None:
        viewers = self._viewers
        for dock in (*viewers.docks.values(), viewers.plot_dock, viewers.tradeoff_dock):
            if now is not None and dock.isAncestorOf(now):
                self._used = dock


class FullScreenPage(QWidget):
    """A window with nothing but the viewer of a dock.

    Signals
    -------
    left
        The user wants it back in the dock.
    """

    left = Signal()

    def __init__(self, dock: QDockWidget, window: QWidget) -> None:
        super().__init__(window, Qt.WindowType.Window)
        self.setObjectName("full_screen")
        self.setWindowTitle(f"{dock.windowTitle()} — Imagechain")
        self._dock = dock
        self.viewer: QWidget = dock.widget()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.viewer)
        self.viewer.show()
        for key in _BACK:
            QShortcut(QKeySequence(key), self).activated.connect(self.left)

    def give_back(self) -> None:
        """Put the viewer into its dock, and be gone."""
        self._dock.setWidget(self.viewer)
        self.viewer.show()
        self.hide()
        self.deleteLater()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Closed by the window manager: back to the dock."""
        event.ignore()
        self.left.emit()
