"""One viewer over the whole screen, and back to its dock."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QDockWidget, QGraphicsView, QWidget

from app.editor.session import Session
from app.editor.window.docks.viewer_docks import ViewerDocks

_BACK = ("F11", "Esc")


class FullScreen(QObject):
    """Makes the viewer that was used last a window over the whole screen, and puts it back.

    `page` is that viewer meanwhile.
    """

    def __init__(self, viewers: ViewerDocks, session: Session, window: QWidget) -> None:
        super().__init__(window)
        self._viewers = viewers
        self._session = session
        self._window = window
        self._used: QDockWidget | None = None
        self._keys: list[QShortcut] = []
        self.page: QWidget | None = None
        QApplication.instance().focusChanged.connect(self._focus_changed)

    def toggle(self) -> None:
        docks = (self._used, *self._viewers.docks.values(), self._viewers.plot_dock)
        dock = next((dock for dock in docks if dock is not None and dock.isVisible()), None)
        if self.page is not None:
            self.leave()
        elif dock is None:
            self._session.message.emit("note", "no viewer is open to show over the whole screen")
        else:
            self._used, self.page = dock, dock.widget()
            focus = self.page.focusWidget() or self.page.findChild(QGraphicsView)
            self._keys = [QShortcut(QKeySequence(key), self.page, self.leave) for key in _BACK]
            self.page.installEventFilter(self)
            self.page.setParent(self._window, Qt.WindowType.Window)
            self.page.setWindowTitle(f"{dock.windowTitle()} — Imagechain")
            self.page.setGeometry(self._window.screen().geometry())
            self.page.showFullScreen()
            self.page.activateWindow()
            focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def leave(self) -> None:
        """Put the viewer back into its dock, with the focus where it was in it."""
        page, self.page = self.page, None
        if page is None or self._used is None:
            return
        page.removeEventFilter(self)
        while self._keys:
            self._keys.pop().deleteLater()
        focus = page.focusWidget()
        self._used.setWidget(page)
        self._window.activateWindow()
        if focus is not None:
            focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def close(self) -> None:
        self.leave()
        QApplication.instance().focusChanged.disconnect(self._focus_changed)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Closed by the window manager, or with all windows: back to the dock."""
        if event.type() == QEvent.Type.Close:
            QTimer.singleShot(0, self, self.leave)  # once Qt has hidden it
        return False

    def _focus_changed(self, _before: object, now: QWidget | None) -> None:
        viewers = self._viewers
        for dock in (*viewers.docks.values(), viewers.plot_dock, viewers.tradeoff_dock):
            if now is not None and self.page is None and dock.isAncestorOf(now):
                self._used = dock
