"""The other viewers of the same window."""

from __future__ import annotations

from typing import TypeVar

from PySide6.QtWidgets import QWidget

V = TypeVar("V", bound=QWidget)


def neighbours(viewer: V) -> list[V]:
    """Viewers of the same kind, by their numbers, floating ones too."""
    top: QWidget = viewer
    while (above := top.parentWidget()) is not None:
        top = above
    viewers = top.findChildren(type(viewer))
    return sorted((other for other in viewers if other is not viewer), key=_number)


def _number(viewer: QWidget) -> int:
    number: int = getattr(viewer, "number", 0)
    return number
