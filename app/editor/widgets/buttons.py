"""Small buttons of the viewers' bars."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMenu, QToolButton, QWidget

from app.editor.widgets.outlined import Toggle


def tool_button(name: str, text: str, description: str, parent: QWidget) -> QToolButton:
    """A button that the keyboard reaches."""
    return _named(QToolButton(parent), name, text, description)


def toggle_button(name: str, text: str, description: str, parent: QWidget) -> Toggle:
    """One that stays down, and shows it in the colours of a theme."""
    button = Toggle(parent)
    _named(button, name, text, description)
    return button


def _named(button: QToolButton, name: str, text: str, description: str) -> QToolButton:
    button.setObjectName(name)
    button.setText(text)
    button.setToolTip(description)
    button.setAccessibleName(description)
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return button


def menu_button(name: str, text: str, description: str, parent: QWidget) -> QToolButton:
    """One that opens a menu of its own."""
    button = tool_button(name, text, description, parent)
    button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setMenu(QMenu(button))
    return button
