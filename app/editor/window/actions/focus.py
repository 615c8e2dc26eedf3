"""Going from one part of the window to the next with the keyboard."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QWidget


def go_to_next(parts: Sequence[QWidget], step: int) -> None:
    """Give the focus to the next of the parts that can be seen, or to the first widget in it."""
    seen = [part for part in parts if part.isVisible()]
    focus = QApplication.focusWidget()
    at = next((number for number, part in enumerate(seen) if _holds(part, focus)), -1)
    part = seen[(at + step) % len(seen)]
    part.setFocus(Qt.FocusReason.TabFocusReason)
    if _holds(part, QApplication.focusWidget()):
        return
    for child in part.findChildren(QWidget):
        if child.isVisible() and child.focusPolicy() & Qt.FocusPolicy.TabFocus:
            child.setFocus(Qt.FocusReason.TabFocusReason)
            return


def _holds(part: QWidget, widget: QWidget | None) -> bool:
    return widget is not None and (part is widget or part.isAncestorOf(widget))
