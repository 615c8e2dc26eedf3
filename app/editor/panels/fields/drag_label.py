"""The name of a number, which is dragged sideways to change it."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QLabel

PIXELS_A_STEP = 4
START_PIXELS = 3
FINER, COARSER = 0.1, 10.0


class DragLabel(QLabel):
    """A label that signals how far it is dragged.

    Signals
    -------
    pressed
        The button is down.
    dragged(steps)
        So many steps more, parts of a step included: to the right is up.
    released
        The button is up.
    """

    pressed = Signal()
    dragged = Signal(float)
    released = Signal()

    _drags = False
    _last: float | None = None
    _moving = False

    def set_drags(self, on: bool) -> None:
        """Whether it can be dragged; the cursor shows it."""
        self._drags = on
        self._show_cursor()

    @property
    def drags(self) -> bool:
        """Whether it can be dragged now."""
        return self._drags and self.isEnabled()

    def changeEvent(self, event: QEvent) -> None:
        """Follow what is enabled."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.EnabledChange:
            self._show_cursor()

    def event(self, event: QEvent) -> bool:
        """A dialog ends a drag: the release of the button behind it does not arrive."""
        if event.type() == QEvent.Type.WindowBlocked and self._last is not None:
            self._last = None
            self.released.emit()
        return bool(super().event(event))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin."""
        if event.button() != Qt.MouseButton.LeftButton or not self.drags:
            super().mousePressEvent(event)
            return
        self._last, self._moving = event.position().x(), False
        self.pressed.emit()
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go on, once it is no mere click."""
        if self._last is None:
            super().mouseMoveEvent(event)
            return
        way = event.position().x() - self._last
        if not self._moving and abs(way) < START_PIXELS:
            return
        self._moving, self._last = True, event.position().x()
        if way:
            self.dragged.emit(way / PIXELS_A_STEP * _rate(event.modifiers()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End."""
        if self._last is None or event.button() != Qt.MouseButton.LeftButton:
            super().mouseReleaseEvent(event)
            return
        self._last = None
        self.released.emit()

    def _show_cursor(self) -> None:
        if self.drags:
            self.setCursor(Qt.CursorShape.SizeHorCursor)
        else:
            self.unsetCursor()


def _rate(modifiers: Qt.KeyboardModifier) -> float:
    if modifiers & Qt.KeyboardModifier.ShiftModifier:
        return FINER
    return COARSER if modifiers & Qt.KeyboardModifier.ControlModifier else 1.0
