"""One viewer over the whole screen, and back to its dock."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QDockWidget, QVBoxLayout, QWidget
from shiboken6 import isValid

from app.editor.session import Session
from app.editor.window.docks.viewer_docks import ViewerDocks

_BACK = ("F11", "Esc")


class FullScreen(QObject):
    """Shows the viewer that was used last over the whole screen, and puts it back.

    Parameters
    ----------
    viewers : ViewerDocks
        The viewers with their docks.
    session : Session
        Takes the message where no viewer is open.
    window : QWidget
        The window they belong to.
    """

    def __init__(self, viewers: ViewerDocks, session: Session, window: QWidget) -> None:
        super().__init__(window)
        self._viewers = viewers
        self._session = session
        self._window = window
        self._used: tuple[QDockWidget, QWidget] | None = None
        self.page: FullScreenPage | None = None
        self._app = QApplication.instance()
        if isinstance(self._app, QApplication):
            self._app.focusChanged.connect(self._focus_changed)

    def toggle(self) -> None:
        """Show the viewer that was used last over the whole screen, or put it back."""
        if self.page is not None:
            self.leave()
            return
        used = self._last_used()
        if used is None:
            self._session.message.emit("note", "no viewer is open to show over the whole screen")
            return
        dock, focus = used
        self.page = FullScreenPage(dock, self._window)
        self.page.left.connect(self.leave)
        self.page.setGeometry(self._window.screen().geometry())
        self.page.showFullScreen()
        self.page.activateWindow()
        focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def leave(self) -> None:
        """Put the viewer back into its dock, with the focus where it was in it."""
        page, self.page = self.page, None
        if page is not None:
            focus = page.focusWidget()
            page.give_back()
            self._window.activateWindow()
            if focus is not None:
                focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def close(self) -> None:
        """Put the viewer back, and follow the focus no more: the window closes."""
        self.leave()
        if isinstance(self._app, QApplication):
            self._app.focusChanged.disconnect(self._focus_changed)

    def _last_used(self) -> tuple[QDockWidget, QWidget] | None:
        """The open viewer that had the focus last, else the first; its dock and what had it."""
        viewers = self._viewers
        candidates: list[tuple[QDockWidget, QWidget]] = [
            *((dock, viewers.images[number].canvas) for number, dock in viewers.docks.items()),
            (viewers.plot_dock, viewers.plot.canvas),
        ]
        if self._used is not None and isValid(self._used[1]):  # type: ignore[no-untyped-call]
            candidates.insert(0, self._used)
        return next((one for one in candidates if one[0].isVisible()), None)

    def _focus_changed(self, _before: object, now: QWidget | None) -> None:
        viewers = self._viewers
        for dock in (*viewers.docks.values(), viewers.plot_dock, viewers.tradeoff_dock):
            if now is not None and dock.isAncestorOf(now):
                self._used = dock, now


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
        """Closed by the window manager, or with all windows: back to the dock."""
        self.left.emit()
        event.accept()
