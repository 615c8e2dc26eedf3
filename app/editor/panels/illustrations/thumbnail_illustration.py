"""Read Image and Test Scene: the picture, small, and what it is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter, QPen

from app.editor.evaluation.queries import Query
from app.editor.panels.illustrations.illustration import Illustration
from app.editor.panels.illustrations.painting.few_digits import brief, pair
from app.editor.panels.illustrations.queries.thumbnail_query import Thumbnail, ThumbnailQuery
from core.chain.wires import Image


class ThumbnailIllustration(Illustration):
    """The picture at the left, its numbers at the right."""

    lines = 10.0

    def queries(self) -> Sequence[Query]:
        """The picture."""
        return (ThumbnailQuery(self.node),)

    def take(self, value: Any) -> str:
        """Keep the picture."""
        self._thumbnail: Thumbnail = value
        return ", ".join(facts(value))

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint both."""
        line = QFontMetricsF(painter.font()).height()
        grey, image = self._thumbnail.grey, self._thumbnail.image
        high, wide = grey.shape
        room = QRectF(area.left(), area.top(), area.width() * 0.54, area.height())
        shape = shape_of(image)
        scale = min(room.width() / shape[0], room.height() / shape[1])
        box = QRectF(room.left(), room.top(), shape[0] * scale, shape[1] * scale)
        picture = QImage(grey.data, wide, high, wide, QImage.Format.Format_Grayscale8)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(box, picture)
        painter.setPen(QPen(QColor(self.theme.line), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(box)
        beside = area.adjusted(box.width() + line * 0.6, 0, 0, 0)
        self.write(painter, beside, facts(self._thumbnail))


def shape_of(image: Image) -> tuple[float, float]:
    """Width and height as they are seen: in mrad where both intervals are known."""
    x, y = image.interval_x_mrad, image.interval_y_mrad
    if x is None or y is None or not 0.1 < (x * image.columns) / (y * image.rows) < 10:
        return float(image.columns), float(image.rows)
    return x * image.columns, y * image.rows


def facts(thumbnail: Thumbnail) -> list[str]:
    """What the picture is, in numbers."""
    image = thumbnail.image
    texts = [
        f"{image.columns} × {image.rows} samples",
        f"{brief(thumbnail.low)} to {brief(thumbnail.high)} {image.unit}".rstrip(),
    ]
    x, y = image.interval_x_mrad, image.interval_y_mrad
    if x is not None and y is not None:
        texts.append(f"interval {pair(x, y)} mrad")
    else:
        texts.append("no field of view")
    if image.band_um is not None:
        texts.append(f"{brief(image.band_um[0])} to {brief(image.band_um[1])} µm")
    return texts
