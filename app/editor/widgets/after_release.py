"""Putting off what would move widgets until no button of the mouse is down."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication


class AfterRelease(QObject):
    """Calls once the mouse is up; of several calls waiting, each kind is made once.

    Looks at the application's events only while something waits.
    """

    def __init__(self, owner: QObject) -> None:
        super().__init__(owner)
        self._waiting: dict[str, Callable[[], None]] = {}

    def do(self, name: str, call: Callable[[], None]) -> None:
        """Call at the next release; in the place of what waits under that name."""
        if not self._waiting:
            QApplication.instance().installEventFilter(self)
        self._waiting[name] = call

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """See the release, or that it was missed: the mouse moves with no button down."""
        released = event.type() == QEvent.Type.MouseButtonRelease or (
            event.type() == QEvent.Type.MouseMove
            and isinstance(event, QMouseEvent)
            and event.buttons() == Qt.MouseButton.NoButton
        )
        if released and self._waiting:
            QApplication.instance().removeEventFilter(self)
            # What the release itself does comes first.
            QTimer.singleShot(0, self, self._call)
        return super().eventFilter(watched, event)

    def _call(self) -> None:
        waiting, self._waiting = self._waiting, {}
        for call in waiting.values():
            call()
