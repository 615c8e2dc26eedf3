"""The frame around a region on a picture: outline, handles, and its name."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QPoint, QRectF, Qt, Signal
from PySide6.QtGui import QPainter, QPainterPath
from PySide6.QtWidgets import (
    QGraphicsItem,
    QGraphicsObject,
    QGraphicsRectItem,
    QGraphicsSceneContextMenuEvent,
    QGraphicsSceneMouseEvent,
)

from app.editor.theme import Theme
from app.editor.viewers.pixels.regions import ALL, Grip
from app.editor.viewers.plot.plot_looks import see_through, thick

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

    Signals
    -------
    pressed(grip, place), moved(place), released
        What is held, and where the pointer is.
    menu_wanted(point)
        The menu is wanted there on the screen.
    """

    pressed = Signal(object, object)
    moved = Signal(object)
    released = Signal()
    menu_wanted = Signal(QPoint)

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        self.setZValue(20)
        self._rect = QRectF()
        self._room = 0.0
        self._colour = theme.accent
        self._movable = True
        self.handles = {grip: _Handle(self, grip, theme) for grip in _CURSORS}

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
        """With room for the outline."""
        room = self._room
        return self._rect.adjusted(-room, -room, room, room)

    def shape(self) -> QPainterPath:
        """Where it is grasped."""
        path = QPainterPath()
        path.addRect(self._rect)
        return path

    def paint(self, painter: QPainter, *_: Any) -> None:
        """Draw the outline."""
        for pen in (
            thick(see_through(_SHADE, _SHADE_ALPHA), 4),
            thick(self._colour, 2),
        ):
            painter.setPen(pen)
            painter.drawRect(self._rect)

    def mousePressEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """Take hold of all of it."""
        if not self._movable:
            event.ignore()
            return
        self.press(event, ALL)

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """Emit where it is drawn to."""
        self.moved.emit(self.mapFromScene(event.scenePos()))

    def mouseReleaseEvent(self, _event: QGraphicsSceneMouseEvent) -> None:
        """Emit the end of the drag."""
        self.released.emit()

    def contextMenuEvent(self, event: QGraphicsSceneContextMenuEvent) -> None:
        """Offer what else can be done."""
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

    def __init__(self, frame: RegionFrame, grip: Grip, theme: Theme) -> None:
        super().__init__(-_REACH, -_REACH, 2 * _REACH, 2 * _REACH, frame)
        self._frame = frame
        self._grip = grip
        self._full = False
        self._colour = theme.accent
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
        """Begin at this corner."""
        self._frame.press(event, None)

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """The other corner is here."""
        self._frame.mouseMoveEvent(event)

    def mouseReleaseEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """It is drawn."""
        self._frame.mouseReleaseEvent(event)
