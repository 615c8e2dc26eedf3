"""Which part of the canvas handles which of the view's events."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import (
    QKeyEvent,
)

from app.editor.canvas.hands.dropping import Dropping
from app.editor.canvas.hands.keys import Keys
from app.editor.canvas.hands.menus import Menus
from app.editor.canvas.hands.mouse import Mouse


class Handling:
    """Leads the view's events to where they are handled."""

    def __init__(self, mouse: Mouse, keys: Keys, menus: Menus, dropping: Dropping) -> None:
        self._mouse = mouse
        self._keys = keys
        self._menus = menus
        self._dropping = dropping
        self.press = mouse.press
        self.move = mouse.move
        self.release = mouse.release
        self.double_click = mouse.double_click
        self.leave = mouse.leave
        self.interrupted = mouse.cancel
        self.key_released = keys.release
        self.menu = menus.open
        self.drag_over = dropping.over
        self.drag_left = dropping.left
        self.drop = dropping.drop

    def wants_key(self, event: QKeyEvent) -> bool:
        """Whether a key is for a gesture under way, and no shortcut."""
        return self._mouse.busy and event.key() == Qt.Key.Key_Escape

    def key(self, event: QKeyEvent) -> bool:
        """Handle a key; whether it was for the canvas."""
        if self.wants_key(event):
            self._mouse.cancel()
            return True
        return self._keys.press(event)
