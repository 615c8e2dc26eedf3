"""Small buttons of the viewers' bars."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMenu, QToolButton, QWidget


def tool_button(name: str, text: str, told: str, parent: QWidget) -> QToolButton:
    """A button that the keyboard reaches."""
    button = QToolButton(parent)
    button.setObjectName(name)
    button.setText(text)
    button.setToolTip(told)
    button.setAccessibleName(told)
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return button


def menu_button(name: str, text: str, told: str, parent: QWidget) -> QToolButton:
    """One that opens a menu of its own."""
    button = tool_button(name, text, told, parent)
    button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setMenu(QMenu(button))
    return button
