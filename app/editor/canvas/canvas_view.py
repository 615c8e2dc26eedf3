"""The view of the canvas: panning, zooming and the grid; mouse and keys go to a handler."""

from typing import Any

import numpy as np
from PySide6 import QtGui
from PySide6.QtCore import QEvent, QLineF, QPoint, QPointF, QRect, QRectF, QSize, QSizeF, Qt, Signal
from PySide6.QtWidgets import QGraphicsView, QWidget

from app.editor.canvas.canvas_style import CanvasStyle
from app.editor.canvas.content import Content
from app.editor.canvas.node_item import head_colour
from app.editor.canvas.nodegraphqt import NodeViewer
from app.editor.widgets import accept_copy, is_escape, labelled

SMALLEST_ZOOM, LARGEST_ZOOM = 0.02, 4.0  # of the natural zoom; 200 nodes in a row are framed
_SMALLEST_FRAMED = 0.001  # of the natural zoom: a square of 60,000 nodes is 150 pixels wide
_GRID = 24.0
_GRID_LEAST_PX = 14.0
_MARGIN = 16  # pixels around what is framed
_TITLE_PX, _TITLES_ABOVE = 21.0, 0.72  # of a backdrop; below this zoom it stands above its frame
_STEP = 1.0015  # of zoom, for each eighth of a degree of the wheel
_EIGHTHS_A_PIXEL = 2.0  # where a touchpad gives no pixels
_LEAST_PINCH = 0.2  # one event makes nothing smaller than that


class GraphView(NodeViewer):
    """Shows a part of the scene; mouse and keys go to others, nothing of its base acts itself."""

    looked_elsewhere = Signal()  # it shows another part of the scene, or at another zoom
    # `Mouse`, `Keys`, `Menus` and `Dropping`, which know this view: the canvas gives them.
    mouse: Any
    keys: Any
    menus: Any
    dropping: Any

    def __init__(self, style: CanvasStyle, parent: QWidget | None = None) -> None:
        self.style_of_canvas = style
        self._centre = QPointF()
        self.zoom = style.natural_zoom
        self._framed: QRectF | None = None  # what a resize is to frame again
        self._ready = False
        super().__init__(parent)
        self._ready = True
        labelled(self, "canvas.view", "Canvas")
        self.setMouseTracking(True)
        self.setFrameShape(QGraphicsView.Shape.NoFrame)
        self.setCacheMode(QGraphicsView.CacheModeFlag.CacheNone)
        self.setViewportUpdateMode(QGraphicsView.ViewportUpdateMode.SmartViewportUpdate)
        self.setTransformationAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setResizeAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop)
        self.resize(640, 420)
        for item in (self._cursor_text, self._LIVE_PIPE, self._SLICER_PIPE):
            self.scene().removeItem(item)
        menus = (self._ctx_graph_menu, self._ctx_node_menu, self._ctx_menu_bar)
        for widget in (self._search_widget, *menus):
            widget.setParent(None)
            widget.deleteLater()
        self._show()

    @property
    def rubber_band(self) -> QWidget:
        return self._rubber_band

    def visible_rect(self) -> QRectF:
        size = self.viewport().size()
        rect = QRectF(0, 0, size.width() / self.zoom, size.height() / self.zoom)
        rect.moveCenter(self._centre)
        return rect

    def natural_room(self) -> tuple[float, float]:
        """Width and height of what can be framed at the natural zoom."""
        natural = self.style_of_canvas.natural_zoom
        wide, high = self._room()
        return wide / natural, high / natural

    def _room(self) -> tuple[float, float]:
        size = self.viewport().size()
        return max(size.width() - 2 * _MARGIN, 20.0), max(size.height() - 2 * _MARGIN, 20.0)

    def scene_point(self, pos: QPoint | QPointF) -> QPointF:
        return QPointF(self.mapToScene(QPointF(pos).toPoint()))

    def pixel(self, point: QPointF) -> QPoint:
        return QPoint(self.mapFromScene(point))

    def pan(self, by: QPointF) -> None:
        self.look_at(self._centre - by / self.zoom)

    def look_at(self, point: QPointF) -> None:
        self._framed = None
        self._centre = QPointF(point)
        self._show()

    def zoom_at(self, factor: float, pos: QPointF | None = None) -> None:
        self._framed = None
        natural = self.style_of_canvas.natural_zoom
        zoom = self.zoom * factor
        least = min(SMALLEST_ZOOM * natural, self.zoom)  # smaller where that frames the network
        zoom = min(max(zoom, least), LARGEST_ZOOM * natural)
        where = pos if pos is not None else QRectF(self.viewport().rect()).center()
        fixed = self.visible_rect().topLeft() + where / self.zoom
        self.zoom = zoom
        self._centre += fixed - (self.visible_rect().topLeft() + where / zoom)
        self._show()

    def frame(self, rect: QRectF) -> None:
        """Show this part of the scene, no larger than natural; also once the view is resized."""
        self._framed = QRectF(rect)
        self.zoom = natural = self.style_of_canvas.natural_zoom
        if not rect.isEmpty():
            wide, high = self._room()
            fitting = min(wide / rect.width(), high / rect.height())
            if fitting < _TITLES_ABOVE * natural:
                high = max(high - _TITLE_PX + _MARGIN, 20.0)
                fitting = min(fitting, high / rect.height())
            self.zoom = min(max(fitting, _SMALLEST_FRAMED * natural), natural)
        self._centre = rect.center()
        if rect.height() > 0 and self.zoom < _TITLES_ABOVE * natural:
            above = (self.viewport().height() - rect.height() * self.zoom) / 2
            self._centre.setY(self._centre.y() - max(0.0, _TITLE_PX - above) / self.zoom)
        self._show()

    def make_visible(self, rect: QRectF) -> None:
        """Pan, as little as needed, so that this part of the scene is seen, or its upper left."""
        margin = _MARGIN / self.zoom
        shown = self.visible_rect().adjusted(margin, margin, -margin, -margin)
        rect = QRectF(rect.topLeft(), rect.size().boundedTo(shown.size()))
        left, top = rect.left() - shown.left(), rect.top() - shown.top()
        right, below = rect.right() - shown.right(), rect.bottom() - shown.bottom()
        by = QPointF(min(left, 0.0) or max(right, 0.0), min(top, 0.0) or max(below, 0.0))
        if not by.isNull():
            self.look_at(self._centre + by)

    def set_style(self, style: CanvasStyle) -> None:
        self.zoom *= style.natural_zoom / self.style_of_canvas.natural_zoom
        self.style_of_canvas = style
        self._show()
        self.viewport().update()

    def _show(self) -> None:
        # The scene's rectangle is its visible part: there is no range to scroll.
        self.setSceneRect(self.visible_rect())
        self.setTransform(QtGui.QTransform.fromScale(self.zoom, self.zoom))
        self.looked_elsewhere.emit()

    # Qt's events

    def drawBackground(self, painter: QtGui.QPainter, rect: QRectF | QRect) -> None:
        theme = self.style_of_canvas.theme
        painter.fillRect(rect, theme.canvas)
        step = _GRID
        while step * self.zoom < _GRID_LEAST_PX:
            step *= 4
        left, top, right, bottom = QRectF(rect).getCoords()
        xs, ys = (
            np.arange(left // step, right // step + 1),
            np.arange(top // step, bottom // step + 1),
        )
        lines = [QLineF(x, top, x, bottom) for x in (xs * step).tolist()]
        lines += [QLineF(left, y, right, y) for y in (ys * step).tolist()]
        pen = QtGui.QPen(theme.grid)
        pen.setCosmetic(True)
        painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing, False)
        painter.setPen(pen)
        painter.drawLines(lines)
        painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing, True)

    def _update_scene(self) -> None:
        if self._ready:
            self._show()

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        QGraphicsView.resizeEvent(self, event)
        if self._ready and self._framed is not None:
            self.frame(self._framed)
        elif self._ready:
            self._show()

    def focusInEvent(self, event: QtGui.QFocusEvent) -> None:
        QGraphicsView.focusInEvent(self, event)

    def focusOutEvent(self, event: QtGui.QFocusEvent) -> None:
        QGraphicsView.focusOutEvent(self, event)

    def focusNextPrevChild(self, onward: bool) -> bool:
        """Tab is a key of the canvas; Shift+Tab leaves it."""
        return False if onward else bool(QGraphicsView.focusNextPrevChild(self, onward))

    def event(self, event: QEvent) -> bool:
        """Keep Esc from shortcuts during a gesture; end that where a dialog opens.

        No button's release arrives behind a dialog.
        """
        if event.type() == QEvent.Type.WindowBlocked:
            self.mouse.cancel()
        if is_escape(event) and self.mouse.busy:
            event.accept()
            return True
        return bool(QGraphicsView.event(self, event))

    def viewportEvent(self, event: QEvent) -> bool:
        pinching = Qt.NativeGestureType.ZoomNativeGesture
        if isinstance(event, QtGui.QNativeGestureEvent) and event.gestureType() == pinching:
            self.zoom_at(max(1.0 + event.value(), _LEAST_PINCH), event.position())
            event.accept()
            return True
        return bool(QGraphicsView.viewportEvent(self, event))

    def mousePressEvent(self, event: QtGui.QMouseEvent) -> None:
        self.mouse.press(event)

    def mouseMoveEvent(self, event: QtGui.QMouseEvent) -> None:
        self.mouse.move(event)

    def mouseReleaseEvent(self, event: QtGui.QMouseEvent) -> None:
        self.mouse.release(event)

    def mouseDoubleClickEvent(self, event: QtGui.QMouseEvent) -> None:
        self.mouse.double_click(event)

    def leaveEvent(self, event: QEvent) -> None:
        QGraphicsView.leaveEvent(self, event)
        self.mouse.leave()

    def wheelEvent(self, event: QtGui.QWheelEvent) -> None:
        """Zoom at the pointer; two fingers on a touchpad pan, and zoom with Ctrl.

        A touchpad has phases, or its system gives its kind.
        """
        angle, pixels = event.angleDelta(), event.pixelDelta()
        touchpad = event.device().type() == QtGui.QInputDevice.DeviceType.TouchPad
        by_fingers = touchpad or event.phase() != Qt.ScrollPhase.NoScrollPhase
        if by_fingers and not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.pan(QPointF(pixels) if not pixels.isNull() else QPointF(angle) / _EIGHTHS_A_PIXEL)
        else:
            self.zoom_at(_STEP ** (angle.y() or angle.x()), event.position())
        event.accept()

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        if not self.keys.press(event):
            event.ignore()

    def keyReleaseEvent(self, event: QtGui.QKeyEvent) -> None:
        self.keys.release(event)

    def contextMenuEvent(self, event: QtGui.QContextMenuEvent) -> None:
        self.menus.open(event)

    def dragEnterEvent(self, event: QtGui.QDragEnterEvent) -> None:
        self.dragMoveEvent(event)

    def dragMoveEvent(self, event: QtGui.QDragMoveEvent) -> None:
        self._answer(event, taken=self.dropping.over(event))

    def dragLeaveEvent(self, event: QtGui.QDragLeaveEvent) -> None:
        self.dropping.left()
        event.accept()

    def dropEvent(self, event: QtGui.QDropEvent) -> None:
        self._answer(event, taken=self.dropping.drop(event))

    def _answer(self, event: QtGui.QDropEvent, *, taken: bool) -> None:
        if taken:
            accept_copy(event)
        else:
            event.ignore()


# A small map of the whole network in a corner, to see where one is and go elsewhere.

_LARGEST = QSize(200, 130)
_SHARE = 0.28  # of the canvas's width and height, at most
_INSET = 10
_PADDING = 6.0
_AROUND = QSizeF(2 * _PADDING, 2 * _PADDING)
_LEAST = QSizeF(2, 2)  # of a node on it


class Minimap(QWidget):
    """Shown while a part of the network is outside the view; a click or a drag goes there."""

    def __init__(self, view: GraphView, content: Content) -> None:
        super().__init__(view.viewport())
        self.setObjectName("canvas.minimap")
        self.setAccessibleName("Map of the network")
        self.setToolTip("Map of the whole network; click or drag to move the view (M)")
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self._view = view
        self._content = content
        self._wanted = True
        self._held = False
        self.hide()
        view.looked_elsewhere.connect(self.follow)

    def toggle(self) -> None:
        self._wanted = not self._wanted
        self.follow()

    def follow(self) -> None:
        whole, seen = self._content.bounds(), self._view.visible_rect()
        useful = self._wanted and not whole.isEmpty() and not seen.contains(whole)
        if useful and not self._held:  # else it would slip from under the mouse
            useful = self._place(whole)
        self.setVisible(useful)
        self.raise_()
        self.update()

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        style, whole = self._view.style_of_canvas, self._content.bounds()
        theme = style.theme
        with QtGui.QPainter(self) as painter:
            ground = QtGui.QColor(theme.raised)
            ground.setAlpha(225)
            painter.fillRect(self.rect(), ground)
            painter.setPen(QtGui.QColor(theme.line))
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
            painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
            painter.setPen(Qt.PenStyle.NoPen)
            scale = self._scale(whole)
            marks = [(QtGui.QColor(theme.canvas), b.frame()) for b in self._content.backdrops]
            for node in self._content.nodes.values():
                marks.append((style.accent if node.selected else head_colour(node), node.frame()))
            for colour, frame in marks:
                painter.setBrush(colour)
                painter.drawRect(_mapped(frame, whole, scale))
            painter.setPen(QtGui.QPen(style.accent, 1.5))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            seen = _mapped(self._view.visible_rect(), whole, scale)
            painter.drawRect(seen.intersected(QRectF(self.rect()).adjusted(1, 1, -2, -2)))

    def mousePressEvent(self, event: QtGui.QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._held = True
            self._go(event.position())

    def mouseMoveEvent(self, event: QtGui.QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._go(event.position())

    def mouseReleaseEvent(self, event: QtGui.QMouseEvent) -> None:
        event.accept()
        self._held = False
        self.follow()
        self._view.setFocus()

    def _go(self, pos: QPointF) -> None:
        whole = self._content.bounds()
        inner = pos - QPointF(_PADDING, _PADDING)
        self._view.look_at(whole.topLeft() + inner / self._scale(whole))

    def _place(self, whole: QRectF) -> bool:
        """Stand in a corner without a node, of the lower ones first; whether there is one."""
        room = self._view.viewport().size()
        most = (room * _SHARE).boundedTo(_LARGEST)
        size = whole.size().scaled(QSizeF(most) - _AROUND, Qt.AspectRatioMode.KeepAspectRatio)
        self.resize((size + _AROUND).toSize().expandedTo(QSize(24, 24)))
        right, low = room.width() - self.width() - _INSET, room.height() - self.height() - _INSET
        nodes = self._content.nodes.values()
        for corner in ((right, low), (_INSET, low), (right, _INSET), (_INSET, _INSET)):
            self.move(*corner)
            ground = self._view.mapToScene(self.geometry()).boundingRect()
            if not any(ground.intersects(node.frame()) for node in nodes):
                return True
        return False

    def _scale(self, whole: QRectF) -> float:
        across = (self.width() - 2 * _PADDING) / max(whole.width(), 1.0)
        down = (self.height() - 2 * _PADDING) / max(whole.height(), 1.0)
        return max(min(across, down), 1e-9)


def _mapped(rect: QRectF, whole: QRectF, scale: float) -> QRectF:
    corner = (rect.topLeft() - whole.topLeft()) * scale + QPointF(_PADDING, _PADDING)
    return QRectF(corner, (rect.size() * scale).expandedTo(_LEAST))
