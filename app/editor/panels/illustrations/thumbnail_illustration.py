"""Read Image and Test Scene: the picture, small, and what it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter, QPen

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.chart import brief, pair
from app.editor.panels.illustrations.illustration import Illustration, NodeQuery
from app.editor.panels.illustrations.shrinking import shrunk
from app.editor.viewers.pixels.grey_levels import extremes, grey_levels
from core.chain.engine import PlannedNode
from core.chain.wires import Image


class ThumbnailIllustration(Illustration):
    """The picture at the left, its numbers at the right."""

    lines = 10.0

    def queries(self) -> Sequence[Query]:
        return (ThumbnailQuery(self.node),)

    def keep(self, thumbnail: Thumbnail) -> str:
        self._thumbnail = thumbnail
        return ", ".join(facts(thumbnail))

    def draw(self, painter: QPainter, area: QRectF) -> None:
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


# The query for a source's picture, answered by a small grey one.

MOST_SAMPLES = 320  # across or along


@dataclass(frozen=True, eq=False)
class Thumbnail:
    """A picture made small."""

    grey: NDArray[np.uint8]  # shape (high, wide): from its least to its greatest sample, C order
    image: Image  # what it is a picture of
    low: float  # low, high: extremes of the picture itself
    high: float


def thumbnail_of(planned: PlannedNode, passing: Passing) -> Thumbnail:
    """The picture that a node gives, small."""
    image: Image = planned.outputs["image"]
    samples = passing.work.value(image.recipe)
    low, high = extremes(samples, for_each=passing.work.for_each)
    small = shrunk(samples, MOST_SAMPLES)
    return Thumbnail(grey_levels(small, low, high), image, low, high)


ThumbnailQuery = partial(NodeQuery, made=thumbnail_of, ports=("image",))
