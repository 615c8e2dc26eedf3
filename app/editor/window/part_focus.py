"""Which part of the window has the keyboard: a ring around it, F6 from part to part."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, QTimer
from PySide6.QtGui import QPainter, QPaintEvent, QPalette, QRegion
from PySide6.QtWidgets import QApplication, QDockWidget, QWidget

_TAB = Qt.FocusPolicy.TabFocus
_FOLLOWED = (QEvent.Type.Resize, QEvent.Type.Move, QEvent.Type.Show, QEvent.Type.Hide)
_DOTS = 2


class PartFocus(QObject):
    """Raises what gets the focus behind other tabs, and draws a ring around its part.

    `parts` gives the parts of the window there are now, in the order of F6.
    """

    def __init__(self, parts: Callable[[], Sequence[QWidget]], window: QWidget) -> None:
        super().__init__(window)
        self._parts = parts
        self._window = window
        self._at: QWidget | None = None
        # A page that comes back into its dock has the focus before it has its place, and a widget
        # that is shown has the window laid out at once.
        self._settled = QTimer(self, singleShot=True, interval=0)
        self._settled.timeout.connect(self._settle)
        self.ring = FocusRing(window)
        QApplication.instance().focusChanged.connect(self._follow)

    def go(self, step: int) -> None:
        """Give the focus to the next part in sight."""
        seen = [part for part in self._parts() if in_sight(part)]
        focus = QApplication.focusWidget()
        at = next((number for number, part in enumerate(seen) if _holds(part, focus)), -1)
        part = seen[(at + step) % len(seen)]
        for widget in (part, *part.findChildren(QWidget)):
            if widget is part or (widget.isVisible() and widget.focusPolicy() & _TAB):
                widget.setFocus(Qt.FocusReason.TabFocusReason)
                if _holds(part, QApplication.focusWidget()):
                    return

    def close(self) -> None:
        self._settled.stop()
        QApplication.instance().focusChanged.disconnect(self._follow)

    def _follow(self, _old: QWidget | None, new: QWidget | None) -> None:
        if new is None or new.window() is not self._window:
            return  # a menu or a dialog; the part has the keyboard again after it
        part = next((part for part in self._parts() if _holds(part, new)), None)
        if part is not self._at:
            if self._at is not None:
                self._at.removeEventFilter(self)
            if part is not None:
                part.installEventFilter(self)
            self._at = part
        self._settled.start()

    def _settle(self) -> None:
        """Bring the dock of what has the focus before others in its place, and ring its part."""
        above = QApplication.focusWidget()
        while above is not None and not isinstance(above, QDockWidget):
            above = above.parentWidget()
        if above is not None and above.window() is self._window and not in_sight(above):
            above.raise_()
        self._place()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        if event.type() in _FOLLOWED:
            self._settled.start()
        return False

    def _place(self) -> None:
        part = self._at
        if part is None or not part.isVisible():
            self.ring.hide()
            return
        self.ring.surround(QRect(part.mapTo(self._window, QPoint(0, 0)), part.size()))


class FocusRing(QWidget):
    """A frame of the accent's colour; only its edges are a widget, so what is inside is not hit."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("focus_ring")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.hide()

    def surround(self, place: QRect) -> None:
        if place != self.geometry():
            self.setGeometry(place)
            inside = self.rect().adjusted(_DOTS, _DOTS, -_DOTS, -_DOTS)
            self.setMask(QRegion(self.rect()) - QRegion(inside))
        self.show()
        self.raise_()

    def paintEvent(self, _event: QPaintEvent) -> None:
        QPainter(self).fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Highlight))


def in_sight(part: QWidget) -> bool:
    """Whether it is shown, and not behind another tab."""
    if not part.isVisible():
        return False
    window = part.window()
    hit = window.childAt(part.mapTo(window, part.rect().center()))
    return part is window or _holds(part, hit)


def _holds(part: QWidget, widget: QWidget | None) -> bool:
    return widget is not None and (part is widget or part.isAncestorOf(widget))
