"""The second press of a double-click, where the first has put something else under the mouse."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QTimer
from PySide6.QtWidgets import QApplication


class SecondClick(QObject):
    """Keeps that press from what is there now: it was meant for what was there before."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._end)

    def drop(self) -> None:
        """The next one, if it comes as soon as a double-click takes and with no first press."""
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.installEventFilter(self)
            self._timer.start(app.doubleClickInterval())

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Hold back that one event; a press before it begins a double-click of its own."""
        second = event.type() == QEvent.Type.MouseButtonDblClick
        if second or event.type() == QEvent.Type.MouseButtonPress:
            self._end()
        return second

    def _end(self) -> None:
        self._timer.stop()
        app = QApplication.instance()
        if app is not None:
            app.removeEventFilter(self)
