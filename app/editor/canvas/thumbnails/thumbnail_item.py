"""A thumbnail on the canvas, below its node."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.canvas.thumbnails.node_thumbnail_query import Small, SmallPicture

HIGHEST, CURVE_HEIGHT = 104.0, 44.0
GAP = 4.0  # below the node
Z_THUMBNAIL = -1.5  # above backdrops, below wires and nodes
_LEAST_PX = 4.0  # on the screen; a lower one shows nothing but its ground
_LEAST_SHARE = 0.35  # of the node's width, of a picture that is very high


class ThumbnailItem(QGraphicsItem):
    """A small picture or curve as wide as its node, in the scene's units.

    Parameters
    ----------
    small : SmallPicture or SmallCurve
        What it shows.
    width : float
        The node's width.
    style : CanvasStyle
        What it is drawn with.
    """

    def __init__(self, small: Small, width: float, style: CanvasStyle) -> None:
        super().__init__()
        self.style = style
        self.setZValue(Z_THUMBNAIL)
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)
        self._room = width
        self.show_small(small)

    def show_small(self, small: Small) -> None:
        """Show another one."""
        self.prepareGeometryChange()
        self.small = small
        self._box = box_of(small, self._room)
        self._image: QImage | None = None
        self._points: QPolygonF | None = None
        if isinstance(small, SmallPicture):
            high, wide = small.grey.shape
            grey = QImage(small.grey.data, wide, high, wide, QImage.Format.Format_Grayscale8)
            self._image = grey.copy()  # Qt's own: the array may go
        self.update()

    def boundingRect(self) -> QRectF:
        """Its box with the border."""
        return self._box.adjusted(-1, -1, 1, 1)

    def frame(self) -> QRectF:
        """Where it is in the scene."""
        return self._box.translated(self.pos())

    def paint(
        self,
        painter: QPainter,
        _option: QStyleOptionGraphicsItem,
        _widget: QWidget | None = None,
    ) -> None:
        """Draw it with a border."""
        style, box = self.style, self._box
        painter.fillRect(box, QColor(style.theme.base))
        if box.height() * painter.worldTransform().m11() < _LEAST_PX:
            return
        if self._image is not None:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(box, self._image)
        else:
            self._curve(painter, box)
        painter.setPen(style.border)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(box)

    def _curve(self, painter: QPainter, box: QRectF) -> None:
        small = self.small
        assert not isinstance(small, SmallPicture)
        inner = box.adjusted(3, 3, -3, -3)
        span = (small.high - small.low) or 1.0
        if small.low < 0:
            zero = inner.bottom() + small.low / span * inner.height()
            painter.setPen(QPen(QColor(self.style.theme.line), 1.0))
            painter.drawLine(QPointF(inner.left(), zero), QPointF(inner.right(), zero))
        if self._points is None:
            self._points = QPolygonF(
                [
                    QPointF(
                        inner.left() + place * inner.width(),
                        inner.bottom() - (value - small.low) / span * inner.height(),
                    )
                    for place, value in zip(
                        small.places.tolist(), small.values.tolist(), strict=True
                    )
                ]
            )
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(self.style.theme.curves[0]), 2.0))
        painter.drawPolyline(self._points)


def box_of(small: Small, width: float) -> QRectF:
    """Where it stands below the upper left corner of the room below its node."""
    if not isinstance(small, SmallPicture):
        return QRectF(0, GAP, width, CURVE_HEIGHT)
    shape = small.height / small.width if small.width > 0 else 1.0
    wide = width
    high = wide * shape
    if high > HIGHEST:
        high = HIGHEST
        wide = max(high / shape, _LEAST_SHARE * width)
    return QRectF((width - wide) / 2, GAP, wide, max(high, 8.0))
