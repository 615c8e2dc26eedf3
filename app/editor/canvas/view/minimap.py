"""A small map of the whole network in the canvas's corner, to see where one is and go elsewhere."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPointF, QRect, QRectF, QSize, QSizeF, Qt
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen, QWheelEvent
from PySide6.QtWidgets import QWidget

from app.editor.canvas.items.content import Content
from app.editor.canvas.items.node_item import head_colour
from app.editor.canvas.view.canvas_view import GraphView

_LARGEST = QSize(200, 130)
_SHARE = 0.28  # of the canvas's width and height, at most
_INSET = 10
_PADDING = 6.0
_LEAST = QSizeF(2, 2)  # of a node on it


class Minimap(QWidget):
    """Shown while a part of the network is outside the view; a click or a drag goes there."""

    def __init__(self, view: GraphView, content: Content) -> None:
        super().__init__(view.viewport())
        self.setObjectName("canvas.minimap")
        self.setAccessibleName("Map of the network")
        self.setToolTip("The whole network; click or drag to go there (M)")
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self._view = view
        self._content = content
        self._wanted = True
        self._held = False
        self.hide()
        view.viewport().installEventFilter(self)
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

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Resize:
            self.follow()
        return False

    def paintEvent(self, _event: QPaintEvent) -> None:
        style = self._view.style_of_canvas
        whole = self._content.bounds()
        with QPainter(self) as painter:
            ground = QColor(style.theme.raised)
            ground.setAlpha(225)
            painter.fillRect(self.rect(), ground)
            painter.setPen(QColor(style.theme.line))
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(Qt.PenStyle.NoPen)
            scale = self._scale(whole)
            for backdrop in self._content.backdrops:
                painter.setBrush(QColor(style.theme.canvas))
                painter.drawRect(_mapped(backdrop.frame(), whole, scale))
            for node in self._content.nodes.values():
                painter.setBrush(style.accent if node.selected else head_colour(node))
                painter.drawRect(_mapped(node.frame(), whole, scale))
            painter.setPen(QPen(style.accent, 1.5))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            seen = _mapped(self._view.visible_rect(), whole, scale)
            painter.drawRect(seen.intersected(QRectF(self.rect()).adjusted(1, 1, -2, -2)))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._held = True
            self._go(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._go(event.position())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        self._held = False
        self.follow()
        self._view.setFocus()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self._go(event.position())

    def wheelEvent(self, event: QWheelEvent) -> None:
        self._view.zoom_by_wheel(event)
        event.accept()

    def _go(self, pos: QPointF) -> None:
        whole = self._content.bounds()
        scale = self._scale(whole)
        inner = pos - QPointF(_PADDING, _PADDING)
        self._view.look_at(whole.topLeft() + inner / scale)

    def _place(self, whole: QRectF) -> bool:
        """Stand in a corner without a node, of the lower ones first; whether there is one."""
        room = self._view.viewport().size()
        most = QSize(round(room.width() * _SHARE), round(room.height() * _SHARE))
        most = most.boundedTo(_LARGEST)
        across, down = most.width() - 2 * _PADDING, most.height() - 2 * _PADDING
        scale = max(min(across / whole.width(), down / whole.height()), 1e-6)
        width = max(round(whole.width() * scale + 2 * _PADDING), 24)
        height = max(round(whole.height() * scale + 2 * _PADDING), 24)
        right, low = room.width() - width - _INSET, room.height() - height - _INSET
        for x, y in ((right, low), (_INSET, low), (right, _INSET), (_INSET, _INSET)):
            corner = QRect(x, y, width, height)
            ground = self._view.mapToScene(corner).boundingRect()
            nodes = self._content.nodes.values()
            if not any(ground.intersects(node.frame()) for node in nodes):
                self.setGeometry(corner)
                return True
        return False

    def _scale(self, whole: QRectF) -> float:
        across = (self.width() - 2 * _PADDING) / max(whole.width(), 1.0)
        down = (self.height() - 2 * _PADDING) / max(whole.height(), 1.0)
        return max(min(across, down), 1e-9)


def _mapped(rect: QRectF, whole: QRectF, scale: float) -> QRectF:
    corner = (rect.topLeft() - whole.topLeft()) * scale + QPointF(_PADDING, _PADDING)
    return QRectF(corner, (rect.size() * scale).expandedTo(_LEAST))
