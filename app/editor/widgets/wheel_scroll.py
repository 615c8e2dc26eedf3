"""Scrolling by the wheel, which changes no value on the way."""

from __future__ import annotations

import time

from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QScrollArea, QWidget

PAUSE_S = 0.5
"""Turns of the wheel no further apart are one."""


class WheelScrollArea(QScrollArea):
    """A scroll area in which a turn of the wheel that began as scrolling goes on as scrolling.

    A control that slides under the mouse meanwhile lets it pass, also if it has the focus.
    """

    _scrolled_at = float("-inf")

    @property
    def is_scrolling(self) -> bool:
        """Whether it was scrolled by the wheel just now."""
        return time.monotonic() - self._scrolled_at < PAUSE_S

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll."""
        self._scrolled_at = time.monotonic()
        super().wheelEvent(event)


def takes_wheel(control: QWidget) -> bool:
    """Whether the wheel is meant for a control: it has the focus, and nothing is scrolling."""
    if not control.hasFocus():
        return False
    above = control.parentWidget()
    while above is not None:
        if isinstance(above, WheelScrollArea) and above.is_scrolling:
            return False
        above = above.parentWidget()
    return True
