"""A backdrop on the canvas: a titled ground behind nodes that belong together; or a note."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QGraphicsItem

from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.canvas.items.nodegraphqt import AbstractNodeItem
from core.editing.backdrops import Backdrop

HEAD = 26.0
HANDLE = 16.0
SMALLEST = QSizeF(96, 64)
_READABLE_PX = 11.0
_HIGHEST = 190.0  # of a title, in units
_NOTE_TINT = "yellow"
_TEXT, _INSET = 12, 8.0  # units: a note's letters at least, and the space round them
_WRAPPED = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)


def rect_of(backdrop: Backdrop) -> QRectF:
    return QRectF(backdrop.x, backdrop.y, backdrop.width, backdrop.height)


class BackdropItem(AbstractNodeItem):
    """A backdrop. `index` is its place in the document's list."""

    def __init__(self, index: int, shown: Backdrop, style: CanvasStyle) -> None:
        super().__init__(shown.title)
        self.index = index
        self.shown = shown
        self.style = style
        self.setCacheMode(QGraphicsItem.CacheMode.NoCache)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIsMovable, False)
        self.setZValue(-2)
        self.setToolTip("")
        self.place(rect_of(shown))

    @property
    def title(self) -> str:
        """Its title; of a note, its text."""
        return self.shown.title

    def show_backdrop(self, shown: Backdrop) -> None:
        if shown != self.shown:
            self.shown = shown
            self.update()
        if self.frame() != rect_of(shown):
            self.place(rect_of(shown))

    def place(self, rect: QRectF) -> None:
        self.prepareGeometryChange()
        self.setPos(rect.topLeft())
        self._width, self._height = rect.width(), rect.height()
        self.update()

    def frame(self) -> QRectF:
        return QRectF(self.pos(), QSizeF(self._width, self._height))

    def head(self, zoom: float) -> QRectF:
        """Where its title is, to be dragged by; of a note, all of it."""
        if self.shown.note:
            return self.frame()
        return self._head(zoom).translated(self.pos())

    def handle(self) -> QRectF:
        corner = self.frame().bottomRight()
        return QRectF(corner - QPointF(HANDLE, HANDLE), corner)

    def boundingRect(self) -> QRectF:
        return QRectF(-2, -_HIGHEST, self._width + 4, self._height + _HIGHEST + 2)

    def set_style(self, style: CanvasStyle) -> None:
        self.style = style
        self.update()

    def paint(self, painter: QPainter, *_: Any) -> None:
        zoom = max(painter.worldTransform().m11(), 1e-3)
        style = self.style
        frame = QRectF(0, 0, self._width, self._height)
        tint = style.tint(self.shown.colour or (_NOTE_TINT if self.shown.note else ""))
        ground = QColor(style.theme.raised) if tint is None else tint
        ground.setAlpha(255 if self.shown.note else 130)
        border = style.accent if self.selected else QColor(style.theme.line)
        painter.setPen(QPen(border, max(1.4, (2.0 if self.selected else 1.0) / zoom)))
        painter.setBrush(ground)
        painter.drawRoundedRect(frame, 6, 6)
        if self.shown.note:
            self._text(painter, frame.adjusted(_INSET, _INSET, -_INSET, -_INSET), zoom)
            self._corner(painter, frame)
            return
        head = self._head(zoom)
        painter.setFont(style.sized(round(head.height() * 0.58), bold=True))
        painter.setPen(style.text)
        room = head.adjusted(10, 0, -10, 0)
        text = painter.fontMetrics().elidedText(
            self.title, Qt.TextElideMode.ElideRight, int(room.width())
        )
        painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, text)
        self._corner(painter, frame)

    def _text(self, painter: QPainter, area: QRectF, zoom: float) -> None:
        readable = round(_READABLE_PX * self.style.natural_zoom / zoom)
        painter.setPen(self.style.text)
        for size in range(max(_TEXT, readable), _TEXT - 1, -1):
            painter.setFont(self.style.sized(size))
            if painter.boundingRect(area, _WRAPPED, self.title).height() <= area.height():
                break
        painter.drawText(area, _WRAPPED, self.title)

    def _corner(self, painter: QPainter, frame: QRectF) -> None:
        painter.setPen(QPen(self.style.faint, 1.4))
        corner = frame.bottomRight()
        for step in (5.0, 10.0):
            painter.drawLine(corner - QPointF(step, 3), corner - QPointF(3, step))

    def _head(self, zoom: float) -> QRectF:
        """On the ground; or, where letters of that size are too small, larger and above it."""
        height = min(1.7 * _READABLE_PX * self.style.natural_zoom / zoom, _HIGHEST)
        if height <= HEAD:
            return QRectF(0, 0, self._width, HEAD)
        return QRectF(0, -height, self._width, height)
