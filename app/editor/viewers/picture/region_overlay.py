"""A region shown on a picture: dragged by its frame, drawn anew, or moved by the arrow keys."""

from __future__ import annotations

from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QPainter, QPainterPath
from PySide6.QtWidgets import (
    QGraphicsItem,
    QGraphicsObject,
    QGraphicsRectItem,
    QGraphicsSceneContextMenuEvent,
    QGraphicsSceneMouseEvent,
)

from app.editor.theme import Theme, theme_of
from app.editor.viewers.pixels.probing import ALL, Grip, Region, Size, dragged, drawn
from app.editor.viewers.plot.plot_looks import see_through, thick

_ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
_LAST: Grip = (1, 1)
_TITLE_ROOM = 30  # dots above the frame that its title takes


class RegionOverlay(QObject):
    """Shows the region it is given, and signals what the person makes of it."""

    began = Signal()  # a drag, or a key that is held, begins
    changed = Signal(object)  # region: its region now
    ended = Signal(bool)  # accepted: it is over; not accepted where it was given up
    draw_wanted = Signal()  # the key to draw a region was pressed
    armed_changed = Signal(bool)  # armed: whether the next drag draws a region
    menu_wanted = Signal(QPoint)  # point: of the screen

    def __init__(self, view: pg.ViewBox, canvas: pg.GraphicsLayoutWidget) -> None:
        super().__init__(canvas)
        self._view = view
        self._canvas = canvas
        self.region: Region | None = None
        self.armed = self.held = False
        self._size: Size = (1, 1)
        self._on = QRectF()
        self._fits = True
        self._start: tuple[Region, Grip | None, QPointF] | None = None
        self._key: int | None = None
        self.frame = RegionFrame()
        self.sheet = DrawingSheet(self.frame)
        self.title = pg.TextItem(anchor=(0, 1))
        self.title.setZValue(21)
        self._named = ""
        small = canvas.font()
        small.setPointSizeF(0.85 * small.pointSizeF())
        self.title.setFont(small)
        for item in (self.frame, self.sheet, self.title):
            view.addItem(item, ignoreBounds=True)
            item.hide()
        self.frame.pressed.connect(self._press)
        self.frame.moved.connect(self._move)
        self.frame.released.connect(self._release)
        self.frame.menu_wanted.connect(self.menu_wanted)
        view.sigTransformChanged.connect(self._fit_to_screen)
        canvas.scene().sigMouseClicked.connect(self._clicked_beside)
        canvas.installEventFilter(self)

    def set_theme(self, theme: Theme) -> None:
        self.title.setColor(theme.text)
        self.title.fill = pg.mkBrush(see_through(theme.base, 215))
        self._paint()

    def show(self, region: Region, fits: bool, size: Size, place: QRectF, title: str) -> None:
        """Show a region of a picture of that size that is drawn at that place."""
        self.region, self._fits, self._size, self._on = region, fits, size, place
        step_x, step_y = self._step
        rect = QRectF(
            place.left() + region.left * step_x,
            place.top() + region.top * step_y,
            region.width * step_x,
            region.height * step_y,
        )
        self.frame.place(rect, (region.width, region.height) != size)
        self.sheet.setRect(place)
        self._named = title
        self.title.setPos(rect.topLeft())
        self.frame.show()
        self.title.show()
        self.sheet.setVisible(self.armed)
        if self.armed:
            self.hold(True)
        self._fit_to_screen()
        self._paint()

    def hide(self) -> None:
        """Show none; what is being dragged is given up."""
        self._end(accepted=False)
        self.hold(False)
        self.region = None
        for item in (self.frame, self.sheet, self.title):
            item.hide()

    def arm(self, on: bool) -> None:
        """Switch on or off that the next drag draws a region."""
        if on != self.armed:
            self.armed = on
            self.sheet.setVisible(on and self.region is not None)
            self.armed_changed.emit(on)

    def hold(self, on: bool) -> None:
        """Switch on or off that the arrow keys move the region."""
        if on != self.held:
            self.held = on
            self._paint()

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
        step = _ARROWS.get(Qt.Key(key))
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

    def _press(self, grip: Any, place: Any) -> None:
        if self.region is None:
            return
        self._end(accepted=True)
        self._canvas.setFocus(Qt.FocusReason.MouseFocusReason)
        self._start = self.region, grip, place
        self.hold(True)
        self.began.emit()

    def _move(self, place: Any) -> None:
        if self._start is None:
            return
        region, grip, start = self._start
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

    def _release(self) -> None:
        drew = self._start is not None and self._start[1] is None
        self._end(accepted=True)
        if drew:
            self.arm(False)

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
        if wide > 0 and high > 0:
            self.frame.spread_handles(1 / wide, 1 / high)
        above = (self.title.pos().y() - self._view.viewRect().top()) / (high or 1.0)
        self.title.setAnchor((0, 1.3 if above > _TITLE_ROOM else -0.3))

    def _paint(self) -> None:
        theme = theme_of(self._canvas)
        self.frame.paint_as(theme.accent if self._fits else theme.error, self.held)
        if self.region is not None:
            size = f"  {self.region.width} × {self.region.height}" if self.held else ""
            self.title.setText(self._named + (size if self._fits else "  beyond the picture"))


# The frame around a region on a picture: outline, handles, and its name.

_SHARP = 4.0  # dots of the screen from the middle of a handle to its side
_REACH = 8.0  # and to where it can still be grasped
_NEAR = 6 * _SHARP  # a side shorter than that has no handle in its middle
_SHADE, _SHADE_ALPHA = "#000000", 200
_CURSORS = {
    (-1, -1): Qt.CursorShape.SizeFDiagCursor,
    (1, 1): Qt.CursorShape.SizeFDiagCursor,
    (1, -1): Qt.CursorShape.SizeBDiagCursor,
    (-1, 1): Qt.CursorShape.SizeBDiagCursor,
    (-1, 0): Qt.CursorShape.SizeHorCursor,
    (1, 0): Qt.CursorShape.SizeHorCursor,
    (0, -1): Qt.CursorShape.SizeVerCursor,
    (0, 1): Qt.CursorShape.SizeVerCursor,
}


class RegionFrame(QGraphicsObject):
    """A rectangle in the coordinates of its parent, to be dragged.

    Outline and handles have a dark edge, so that they are seen on bright and on dark pictures.
    """

    # pressed(grip, place), moved(place), released: What is held, and where the pointer is
    pressed = Signal(object, object)
    moved = Signal(object)
    released = Signal()
    menu_wanted = Signal(QPoint)  # point: the menu is wanted there on the screen

    def __init__(self) -> None:
        super().__init__()
        self.setZValue(20)
        self._rect = QRectF()
        self._room = 0.0
        self._colour = ""
        self._movable = True
        self.handles = {grip: _Handle(self, grip) for grip in _CURSORS}

    def place(self, rect: QRectF, movable: bool) -> None:
        """Frame that; `movable`: whether there is somewhere to move it to."""
        if rect == self._rect and movable == self._movable:
            return
        self.prepareGeometryChange()
        self._rect, self._movable = rect, movable
        shape = Qt.CursorShape.SizeAllCursor
        (self.setCursor(shape) if movable else self.unsetCursor())
        middle = rect.center()
        for (x, y), handle in self.handles.items():
            handle.setPos(
                (rect.left(), middle.x(), rect.right())[x + 1],
                (rect.top(), middle.y(), rect.bottom())[y + 1],
            )
        self.update()

    def spread_handles(self, dots_x: float, dots_y: float) -> None:
        """Leave handles away that would meet, at so many dots of the screen per unit."""
        room = _SHARP / min(dots_x, dots_y)
        if room != self._room:
            self.prepareGeometryChange()
            self._room = room
        across, along = self._rect.width() * dots_x, self._rect.height() * dots_y
        for (x, y), handle in self.handles.items():
            handle.setVisible((x != 0 or across >= _NEAR) and (y != 0 or along >= _NEAR))

    def paint_as(self, colour: str, held: bool) -> None:
        """Draw in another colour; a frame that takes the arrow keys has full handles."""
        self._colour = colour
        for handle in self.handles.values():
            handle.paint_as(colour, held)
        self.update()

    def boundingRect(self) -> QRectF:
        room = self._room
        return self._rect.adjusted(-room, -room, room, room)

    def shape(self) -> QPainterPath:
        path = QPainterPath()
        path.addRect(self._rect)
        return path

    def paint(self, painter: QPainter, *_: Any) -> None:
        for pen in (thick(see_through(_SHADE, _SHADE_ALPHA), 4), thick(self._colour, 2)):
            painter.setPen(pen)
            painter.drawRect(self._rect)

    def mousePressEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        if not self._movable:
            event.ignore()
            return
        self.press(event, ALL)

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self.moved.emit(self.mapFromScene(event.scenePos()))

    def mouseReleaseEvent(self, _event: QGraphicsSceneMouseEvent) -> None:
        self.released.emit()

    def contextMenuEvent(self, event: QGraphicsSceneContextMenuEvent) -> None:
        self.menu_wanted.emit(event.screenPos())
        event.accept()

    def press(self, event: QGraphicsSceneMouseEvent, grip: Grip | None) -> None:
        """Take hold by the left button; without a grip, to draw anew.

        Other buttons do what they do on the picture.
        """
        if event.button() == Qt.MouseButton.LeftButton:
            self.pressed.emit(grip, self.mapFromScene(event.scenePos()))
            event.accept()
        else:
            event.ignore()


class _Handle(QGraphicsRectItem):
    """A square of the same size at any zoom."""

    def __init__(self, frame: RegionFrame, grip: Grip) -> None:
        super().__init__(-_REACH, -_REACH, 2 * _REACH, 2 * _REACH, frame)
        self._frame = frame
        self._grip = grip
        self._full = False
        self._colour = ""
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.setCursor(_CURSORS[grip])

    def paint_as(self, colour: str, full: bool) -> None:
        self._colour, self._full = colour, full
        self.update()

    def paint(self, painter: QPainter, *_: Any) -> None:
        square = QRectF(-_SHARP, -_SHARP, 2 * _SHARP, 2 * _SHARP)
        painter.fillRect(square.adjusted(-2, -2, 2, 2), see_through(_SHADE, _SHADE_ALPHA))
        painter.fillRect(square, see_through(self._colour, 255))
        if not self._full:
            painter.fillRect(square.adjusted(2, 2, -2, -2), see_through("#ffffff", 255))

    def mousePressEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self._frame.press(event, self._grip)

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self._frame.mouseMoveEvent(event)

    def mouseReleaseEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self._frame.mouseReleaseEvent(event)

    def contextMenuEvent(self, event: QGraphicsSceneContextMenuEvent) -> None:
        self._frame.contextMenuEvent(event)


class DrawingSheet(QGraphicsRectItem):
    """Lies over the picture while a region is to be drawn, and passes the frame its places."""

    def __init__(self, frame: RegionFrame) -> None:
        super().__init__()
        self._frame = frame
        self.setZValue(30)
        self.setPen(Qt.PenStyle.NoPen)
        self.setCursor(Qt.CursorShape.CrossCursor)

    def mousePressEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self._frame.press(event, None)

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self._frame.mouseMoveEvent(event)

    def mouseReleaseEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        self._frame.mouseReleaseEvent(event)
