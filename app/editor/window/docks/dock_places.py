"""Docks of the window."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QObject, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QWidget


def add_dock(
    window: QMainWindow, title: str, name: str, widget: QWidget, area: Qt.DockWidgetArea
) -> QDockWidget:
    """Put a widget in a dock of that title; `name` is what its place is remembered under."""
    dock = QDockWidget(title, window)
    dock.setObjectName(name)
    dock.setWidget(widget)
    window.addDockWidget(area, dock)
    return dock


def stand_behind(window: QMainWindow, front: QDockWidget, dock: QDockWidget) -> None:
    """Have a dock that is closed open behind another one.

    What a window of an earlier version has stored has no place for it.
    """
    if dock.isHidden() and not front.isFloating():
        window.tabifyDockWidget(front, dock)


class Curtain(QObject):
    """Hides the docks while the first page is shown."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._arranged: QByteArray | None = None

    def close(self) -> None:
        """Hide the docks that belong to the window."""
        if self._arranged is None:
            self._arranged = self._window.saveState()
            for dock in self._window.findChildren(QDockWidget):
                if not dock.isFloating():
                    dock.hide()

    def open(self) -> None:
        """Show them again as they were."""
        if self._arranged is not None:
            self._window.restoreState(self._arranged)
            self._arranged = None
