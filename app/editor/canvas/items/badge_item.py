"""The mark of a node's state in its corner: by form as well as by colour."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.evaluation.queries import Badge, BadgeKind

_RADIUS = 7.5
INSET = 12.0  # of its centre, from the node's corner
_SMALLEST_PX = 4.5  # radius on the screen, however small the node
_LARGEST = 3.0  # times the normal size


class BadgeItem(QGraphicsItem):
    """A badge, its tooltip the badge's text."""

    def __init__(self, badge: Badge, style: CanvasStyle, parent: QGraphicsItem) -> None:
        super().__init__(parent)
        self.style = style
        self.setZValue(3)
        self.show_badge(badge)

    def show_badge(self, badge: Badge) -> None:
        """Show another badge."""
        self.badge = badge
        self.setToolTip(badge.text)
        self.update()

    def boundingRect(self) -> QRectF:
        """Where it may draw, at any zoom."""
        return _BOUNDS

    def paint(
        self,
        painter: QPainter,
        _option: QStyleOptionGraphicsItem,
        _widget: QWidget | None = None,
    ) -> None:
        """Draw it, never too small to be seen."""
        zoom = max(painter.worldTransform().m11(), 1e-3)
        painter.save()
        scale = min(max(1.0, _SMALLEST_PX / (_RADIUS * zoom)), _LARGEST)
        if scale > 1:  # on the very corner, where it hides little of the title
            painter.translate(INSET, -INSET)
        painter.scale(scale, scale)
        colour = QColor(self.style.theme.badges[self.badge.kind])
        ground = QColor(self.style.theme.node)
        painter.setPen(QPen(ground, 1.5))
        painter.setBrush(colour)
        if self.badge.kind == "warning":
            painter.drawPolygon(_TRIANGLE)
        else:
            painter.drawEllipse(QPointF(), _RADIUS, _RADIUS)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(ground, 1.9, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        _draw_sign(painter, self.badge.kind)
        painter.restore()


def _draw_sign(painter: QPainter, kind: BadgeKind) -> None:
    point = QPointF
    if kind in ("error", "warning"):  # a warning's stands in a triangle
        painter.drawLine(point(0, -4), point(0, 0.8))
        painter.drawPoint(point(0, 4))
    elif kind == "stale":  # a clock
        painter.drawLine(point(0, -4), point(0, 0))
        painter.drawLine(point(0, 0), point(3, 2))
    elif kind == "running":
        painter.drawArc(QRectF(-3.6, -3.6, 7.2, 7.2), 60 * 16, 270 * 16)
    elif kind == "skipped":
        for x in (-3.2, 0.6):
            painter.drawPolyline([point(x, -3), point(x + 2.8, 0), point(x, 3)])
    elif kind == "disabled":
        painter.drawLine(point(-3.2, 3.2), point(3.2, -3.2))
    else:  # incomplete: an open plug
        for x in (-3.4, 0, 3.4):
            painter.drawPoint(point(x, 0))


_TRIANGLE = [QPointF(0, -10), QPointF(9.5, 7), QPointF(-9.5, 7)]
_BOUNDS = QRectF(-20, -40, 60, 60)
