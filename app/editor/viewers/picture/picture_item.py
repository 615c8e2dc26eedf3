"""A picture as an item of a plot: 8-bit levels with a table of colours, or colours of its own."""

from __future__ import annotations

from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter

from app.editor.viewers.pixels.grey_levels import Table, colour_table
from app.editor.viewers.pixels.picture_facts import Facts
from app.editor.viewers.pixels.picture_query import Picture


def extent(facts: Facts) -> QRectF:
    """What the samples of a picture cover on its axes, each of them around its place."""
    x, y = facts.across, facts.along
    return QRectF(
        x.first - x.step / 2, y.first - y.step / 2, x.step * facts.columns, y.step * facts.rows
    )


class PictureItem(pg.ImageItem):  # type: ignore[misc]
    """Shows a picture between two shares of its width: 0 and 1, all of it."""

    def __init__(self) -> None:
        super().__init__(axisOrder="row-major")
        self._part = (0.0, 1.0)

    def show_picture(self, picture: Picture, table: Table, place: QRectF) -> None:
        self.setImage(picture.grey, autoLevels=False, levels=None, lut=_lookup(table, picture.grey))
        self.setRect(place)

    def set_table(self, table: Table) -> None:
        self.setLookupTable(_lookup(table, self.image))

    def show_part(self, start: float, end: float) -> None:
        if (start, end) != self._part:
            self._part = start, end
            self.update()

    def paint(self, painter: QPainter, *args: Any) -> None:
        if self._part == (0.0, 1.0):
            super().paint(painter, *args)
            return
        bounds, (start, end) = self.boundingRect(), self._part
        left, width = bounds.left(), bounds.width()
        bounds.setLeft(left + start * width)
        bounds.setRight(left + end * width)
        painter.save()
        painter.setClipRect(bounds)
        super().paint(painter, *args)
        painter.restore()


def _lookup(table: Table, levels: Any) -> Table | None:
    """Levels that are greys already, or colours, need no table, and are shown faster without."""
    is_colour = levels is not None and levels.ndim == 3
    return None if is_colour or table is colour_table("grey") else table
