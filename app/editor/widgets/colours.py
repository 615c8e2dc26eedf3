"""Colouring single widgets."""

from __future__ import annotations

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QWidget

_INK = (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text)


def set_ink(widget: QWidget, colour: str) -> None:
    """Write in that colour."""
    palette = widget.palette()
    if palette.color(QPalette.ColorRole.WindowText) != QColor(colour):
        for role in _INK:
            palette.setColor(role, QColor(colour))
        widget.setPalette(palette)


def set_ground(widget: QWidget, colour: str) -> None:
    """Fill the background with that colour."""
    palette = widget.palette()
    palette.setColor(QPalette.ColorRole.Window, QColor(colour))
    widget.setPalette(palette)
    widget.setAutoFillBackground(True)
