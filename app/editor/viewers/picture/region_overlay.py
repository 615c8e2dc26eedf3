"""A region shown on a picture: dragged by its frame, drawn anew, or moved by the arrow keys."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPainterPath
from PySide6.QtWidgets import (
    QGraphicsObject,
    QGraphicsSceneContextMenuEvent,
    QGraphicsSceneHoverEvent,
    QGraphicsSceneMouseEvent,
)

from app.editor.theme import Theme, theme_of
from app.editor.viewers.plot.plot_looks import see_through, thick

Size = tuple[int, int]
"""Columns and rows of a picture."""
Grip = tuple[int, int]
"""What of a rectangle is dragged: −1 its first edge, 1 its last, across and along; 0, 0 all."""
ALL: Grip = (0, 0)
_LAST: Grip = (1, 1)
ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
_TITLE_ROOM = 30  # dots above the frame that its title takes
_SHARP = 4.0  # dots of the screen from the middle of a handle to its side
_REACH = 8.0  # and to where it can still be grasped
_NEAR = 6 * _SHARP  # a side shorter than that has no handle in its middle
_SHADE = QColor(0, 0, 0, 200)
_CURSORS = {
    ALL: Qt.CursorShape.SizeAllCursor,
    (-1, -1): Qt.CursorShape.SizeFDiagCursor,
    (1, 1): Qt.CursorShape.SizeFDiagCursor,
    (1, -1): Qt.CursorShape.SizeBDiagCursor,
    (-1, 1): Qt.CursorShape.SizeBDiagCursor,
    (-1, 0): Qt.CursorShape.SizeHorCursor,
    (1, 0): Qt.CursorShape.SizeHorCursor,
    (0, -1): Qt.CursorShape.SizeVerCursor,
    (0, 1): Qt.CursorShape.SizeVerCursor,
}


@dataclass(frozen=True)
class Region:
    left: int
    top: int
    width: int
    height: int

    def description(self) -> str:
        return f"{self.width} × {self.height} at column {self.left}, row {self.top}"


def dragged(region: Region, grip: Grip, columns: int, rows: int, size: Size) -> Region:
    """The region with what the grip holds moved by so many samples, as far as the picture goes."""
    left, width = _moved(region.left, region.width, grip[0], grip == ALL, columns, size[0])
    top, height = _moved(region.top, region.height, grip[1], grip == ALL, rows, size[1])
    return Region(left, top, width, height)


def _moved(
    first: int, length: int, edge: int, everything: bool, by: int, whole: int
) -> tuple[int, int]:
    last = first + length
    if everything:
        return min(max(first + by, 0), whole - length), length
    if edge < 0:
        first = min(max(first + by, 0), last - 1)
    elif edge > 0:
        last = min(max(last + by, first + 1), whole)
    return first, last - first


def drawn(start: tuple[float, float], end: tuple[float, float], size: Size) -> Region:
    """The region between two corners, counted in samples from the picture's own first corner."""
    left, width = _between(start[0], end[0], size[0])
    top, height = _between(start[1], end[1], size[1])
    return Region(left, top, width, height)


def _between(one: float, other: float, whole: int) -> tuple[int, int]:
    low, high = sorted((one, other))
    first = min(max(round(low), 0), whole - 1)
    return first, max(min(round(high), whole) - first, 1)


class RegionOverlay(QGraphicsObject):
    """Shows a region, with edges seen on any picture; signals what the person makes of it."""

    began = Signal()  # a drag, or a key that is held, begins
    changed = Signal(object)  # region: its region now
    ended = Signal(bool)  # accepted: it is over; not accepted where it was given up
    draw_wanted = Signal()  # the key to draw a region was pressed
    armed_changed = Signal(bool)  # armed: whether the next drag draws a region
    menu_wanted = Signal(QPoint)  # point: of the screen

    def __init__(self, view: pg.ViewBox, canvas: pg.GraphicsLayoutWidget) -> None:
        super().__init__()
        self._view = view
        self._canvas = canvas
        self.region: Region | None = None
        self.rect = QRectF()
        """Where the region lies on the axes."""
        self.armed = self.held = False
        self._size: Size = (1, 1)
        self._on = QRectF()
        self._fits = True
        self._dot = 1.0, 1.0  # a dot of the screen in units of the axes
        self._start: tuple[Region, Grip | None, QPointF] | None = None
        self._key: int | None = None
        self.title = pg.TextItem(anchor=(0, 1))
        self._named = ""
        small = canvas.font()
        small.setPointSizeF(0.85 * small.pointSizeF())
        self.title.setFont(small)
        for item, height in ((self, 20), (self.title, 21)):
            item.setZValue(height)
            view.addItem(item, ignoreBounds=True)
            item.hide()
        self.setAcceptHoverEvents(True)
        view.sigTransformChanged.connect(self._fit_to_screen)
        canvas.scene().sigMouseClicked.connect(self._clicked_beside)
        canvas.installEventFilter(self)

    def set_theme(self, theme: Theme) -> None:
        self.title.setColor(theme.text)
        self.title.fill = pg.mkBrush(see_through(theme.base, 215))
        self._show_anew()

    def frame(self, region: Region, fits: bool, size: Size, place: QRectF, title: str) -> None:
        """Show a region of a picture of that size that is drawn at that place."""
        self.prepareGeometryChange()
        self.region, self._fits, self._size, self._on = region, fits, size, place
        step_x, step_y = self._step
        self.rect = QRectF(
            place.left() + region.left * step_x,
            place.top() + region.top * step_y,
            region.width * step_x,
            region.height * step_y,
        )
        self._named = title
        self.title.setPos(self.rect.topLeft())
        self.show()
        self.title.show()
        if self.armed:
            self.hold(True)
        self._fit_to_screen()
        self._show_anew()

    def clear(self) -> None:
        self._end(accepted=False)
        self.hold(False)
        self.region = None
        self.hide()
        self.title.hide()

    def arm(self, on: bool) -> None:
        if on != self.armed:
            self.prepareGeometryChange()
            self.armed = on
            self.armed_changed.emit(on)

    def hold(self, on: bool) -> None:
        if on != self.held:
            self.held = on
            self._show_anew()

    def give_up(self) -> bool:
        """End what is going on, the last thing begun first; whether there was something."""
        if self._start is not None:
            self._end(accepted=False)
        elif self.armed:
            self.arm(False)
        elif self.held:
            self.hold(False)
        else:
            return False
        return True

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Take the keys that are for the region before the canvas, and the window, get them."""
        kind = event.type()
        if kind == QEvent.Type.KeyPress and isinstance(event, QKeyEvent):
            return self._take_key(event)
        if kind == QEvent.Type.KeyRelease and isinstance(event, QKeyEvent):
            if event.key() == self._key and not event.isAutoRepeat():
                self._end(accepted=True)
        elif kind == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            busy = self._start is not None or self.armed or self.held
            if event.key() == Qt.Key.Key_Escape and busy:
                event.accept()  # else it would stop the computation
                return True
        elif kind == QEvent.Type.FocusOut and self._key is not None:
            self._end(accepted=True)
        return False

    def _take_key(self, event: QKeyEvent) -> bool:
        key, modifiers = event.key(), event.modifiers()
        if key == Qt.Key.Key_Escape:
            return self.give_up()
        if key == Qt.Key.Key_R and not modifiers:
            self.draw_wanted.emit()
            return True
        step = ARROWS.get(Qt.Key(key))
        if step is None or not self.held or self.region is None:
            return False
        if self._key is None:
            if self._start is not None:  # the mouse has it
                return True
            self._key = key
            self.began.emit()
        far = 10 if modifiers & Qt.KeyboardModifier.ShiftModifier else 1
        grip = _LAST if modifiers & Qt.KeyboardModifier.ControlModifier else ALL
        self._emit_changed(dragged(self.region, grip, step[0] * far, step[1] * far, self._size))
        return True

    @property
    def _step(self) -> tuple[float, float]:
        """A sample of the full-size picture in units of the axes: in a preview these may differ."""
        return self._on.width() / self._size[0], self._on.height() / self._size[1]

    @property
    def _movable(self) -> bool:
        return self.region is not None and (self.region.width, self.region.height) != self._size

    def _handles(self) -> dict[Grip, QPointF]:
        rect, middle = self.rect, self.rect.center()
        across = rect.left(), middle.x(), rect.right()
        along = rect.top(), middle.y(), rect.bottom()
        wide = rect.width() >= _NEAR * self._dot[0]
        high = rect.height() >= _NEAR * self._dot[1]
        return {
            (x, y): QPointF(across[x + 1], along[y + 1])
            for x, y in _CURSORS
            if (x, y) != ALL and (x or wide) and (y or high)
        }

    def _around(self, place: QPointF, dots: float) -> QRectF:
        """A square of the same size at any zoom."""
        x, y = dots * self._dot[0], dots * self._dot[1]
        return QRectF(place.x() - x, place.y() - y, 2 * x, 2 * y)

    def _grip_at(self, point: QPointF) -> Grip | None:
        """What is held there; None: nothing, or that a region is drawn."""
        if self.armed:
            return None
        for grip, place in reversed(self._handles().items()):
            if self._around(place, _REACH).contains(point):
                return grip
        return ALL if self._movable and self.rect.contains(point) else None

    def boundingRect(self) -> QRectF:
        x, y = _REACH * self._dot[0], _REACH * self._dot[1]
        return (self.rect | self._on if self.armed else self.rect).adjusted(-x, -y, x, y)

    def shape(self) -> QPainterPath:
        path = QPainterPath()
        path.setFillRule(Qt.FillRule.WindingFill)
        if self.armed:
            path.addRect(self._on)
            return path
        path.addRect(self.rect)
        for place in self._handles().values():
            path.addRect(self._around(place, _REACH))
        return path

    def paint(self, painter: QPainter, *_: Any) -> None:
        theme = theme_of(self._canvas)
        colour = QColor(theme.accent if self._fits else theme.error)
        for pen in (thick(_SHADE, 4), thick(colour, 2)):
            painter.setPen(pen)
            painter.drawRect(self.rect)
        for place in self._handles().values():
            painter.fillRect(self._around(place, _SHARP + 2), _SHADE)
            painter.fillRect(self._around(place, _SHARP), colour)
            if not self.held:
                painter.fillRect(self._around(place, _SHARP - 2), Qt.GlobalColor.white)

    def hoverMoveEvent(self, event: QGraphicsSceneHoverEvent) -> None:
        grip = self._grip_at(event.pos())
        if self.armed:
            self.setCursor(Qt.CursorShape.CrossCursor)
        elif grip is None:
            self.unsetCursor()
        else:
            self.setCursor(_CURSORS[grip])

    def mousePressEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """Take hold by the left button; other ones do what they do on the picture."""
        grip = self._grip_at(event.pos())
        left = event.button() == Qt.MouseButton.LeftButton
        if self.region is None or not left or (grip is None and not self.armed):
            event.ignore()
            return
        self._end(accepted=True)
        self._canvas.setFocus(Qt.FocusReason.MouseFocusReason)
        self._start = self.region, grip, event.pos()
        self.hold(True)
        self.began.emit()

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        if self._start is None:
            return
        (region, grip, start), place = self._start, event.pos()
        step_x, step_y = self._step
        if grip is None:
            first, now = (
                ((at.x() - self._on.left()) / step_x, (at.y() - self._on.top()) / step_y)
                for at in (start, place)
            )
            self._emit_changed(drawn(first, now, self._size))
            return
        by = (place.x() - start.x()) / step_x, (place.y() - start.y()) / step_y
        self._emit_changed(dragged(region, grip, round(by[0]), round(by[1]), self._size))

    def mouseReleaseEvent(self, _event: QGraphicsSceneMouseEvent) -> None:
        drew = self._start is not None and self._start[1] is None
        self._end(accepted=True)
        if drew:
            self.arm(False)

    def contextMenuEvent(self, event: QGraphicsSceneContextMenuEvent) -> None:
        self.menu_wanted.emit(event.screenPos())
        event.accept()

    def _end(self, *, accepted: bool) -> None:
        if self._start is None and self._key is None:
            return
        self._start = self._key = None
        self.ended.emit(accepted)

    def _emit_changed(self, region: Region) -> None:
        if region != self.region:
            self.changed.emit(region)

    def _clicked_beside(self, *_: object) -> None:
        self.hold(False)

    def _fit_to_screen(self, *_: object) -> None:
        """Size handles and title by the frame on the screen."""
        if self.region is None:
            return
        wide, high = self._view.viewPixelSize()
        if wide > 0 and high > 0 and (wide, high) != self._dot:
            self.prepareGeometryChange()
            self._dot = wide, high
        above = (self.title.pos().y() - self._view.viewRect().top()) / (high or 1.0)
        self.title.setAnchor((0, 1.3 if above > _TITLE_ROOM else -0.3))

    def _show_anew(self) -> None:
        self.update()
        if self.region is not None:
            size = f"  {self.region.width} × {self.region.height}" if self.held else ""
            self.title.setText(self._named + (size if self._fits else "  beyond the picture"))
