"""The names of two pictures that are compared, written on them."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QRect, QRectF, Qt
from PySide6.QtWidgets import QGraphicsView, QLabel

from app.editor.theme import Theme, set_ground, set_ink

_GAP = 6  # dots between a name and the edge of its picture
_PAD = 4  # around the text


class SideNames(QObject):
    """A name in the upper corner of each side of a wipe; of one picture alone, on its left.

    Parameters
    ----------
    view : ViewBox
        Where the pictures are drawn.
    canvas : QGraphicsView
        The widget that shows it; the names lie above it and take no mouse events.
    theme : Theme
        Colours.
    """

    def __init__(self, view: Any, canvas: QGraphicsView, theme: Theme) -> None:
        super().__init__(canvas)
        self._view, self._canvas = view, canvas
        self._texts = "", ""
        self._place = QRectF()
        self._split = 1.0
        self.left, self.right = self._label("left"), self._label("right")
        view.sigRangeChanged.connect(self._moved)
        view.sigResized.connect(self._moved)
        self.set_theme(theme)

    def set_theme(self, theme: Theme) -> None:
        """Write in other colours."""
        for label in (self.left, self.right):
            set_ground(label, theme.raised)
            set_ink(label, theme.text)

    def show(self, left: str, right: str) -> None:
        """Have these names; an empty one is not written."""
        self._texts = left, right
        self._lay()

    def place(self, place: QRectF, split: float) -> None:
        """The pictures lie there, divided at that share of their width; empty: there is one."""
        self._place, self._split = place, split
        self._lay()

    def _label(self, side: str) -> QLabel:
        label = QLabel(self._canvas)
        label.setObjectName(f"side.{side}")
        label.setAccessibleName(f"What is on the {side}")
        label.setTextFormat(Qt.TextFormat.PlainText)
        label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        label.setMargin(_PAD)
        label.hide()
        return label

    def _moved(self, *_: object) -> None:
        if not self._place.isEmpty():
            self._lay()

    def _lay(self) -> None:
        """Put each name into the part of its side that is seen."""
        if self._place.isEmpty():
            self.left.hide()
            self.right.hide()
            return
        seen = self._dots(self._view.sceneBoundingRect())
        place, to_scene = self._place, self._view.mapViewToScene
        whole = self._dots(QRectF(to_scene(place.topLeft()), to_scene(place.bottomRight())))
        box = seen & whole
        divider = round(whole.left() + self._split * whole.width())
        divider = min(max(divider, box.left()), box.left() + box.width())
        self._write(self.left, self._texts[0], QRect(box), box.left(), divider, False)
        self._write(self.right, self._texts[1], QRect(box), divider, box.left() + box.width(), True)

    def _write(
        self, label: QLabel, text: str, box: QRect, start: int, end: int, at_end: bool
    ) -> None:
        room = end - start - 2 * _GAP
        metrics = label.fontMetrics()
        if not text or box.isEmpty() or room < metrics.averageCharWidth() * 4:
            label.hide()
            return
        shown = metrics.elidedText(text, Qt.TextElideMode.ElideRight, room - 2 * _PAD)
        if label.text() != shown:
            label.setText(shown)
            label.adjustSize()
        label.setAccessibleDescription(text)
        left = end - _GAP - label.width() if at_end else start + _GAP
        label.move(left, box.top() + _GAP)
        label.show()

    def _dots(self, scene: QRectF) -> QRect:
        """A rectangle of the scene in dots of the canvas."""
        scene = scene.normalized()
        return QRect(
            self._canvas.mapFromScene(scene.topLeft()),
            self._canvas.mapFromScene(scene.bottomRight()),
        ).normalized()
