"""A line across a picture that can be dragged, and the samples along it below.

Both are made when they are first shown: they take a quarter of the time of a viewer.
"""

from __future__ import annotations

import math
from itertools import zip_longest

import pyqtgraph as pg
from PySide6.QtCore import QObject, QPointF
from PySide6.QtWidgets import QWidget

from app.editor.theme import Theme, theme_of
from app.editor.viewers.pixels.picture_choices import CHANNELS
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.viewers.pixels.probing import Place, along_line
from app.editor.viewers.plot.plot_looks import bare, paint_axes

Ends = tuple[float, ...]
_LINES = 8  # of text that the plot is high
_ACROSS: Ends = (0.1, 0.5, 0.9, 0.5)


class ProfileLine(QObject):
    """The line in one plot, and the plot of what lies along it; there is none until it is shown.

    While it is shown that plot has the second row of the layout.
    """

    def __init__(
        self, picture_plot: pg.PlotItem, layout: pg.GraphicsLayout, parent: QWidget
    ) -> None:
        super().__init__(parent)
        self._canvas = parent
        self._picture_plot = picture_plot
        self._layout = layout
        self._text_height = parent.fontMetrics().height
        self._plot: pg.PlotItem | None = None
        self._picture: Picture | None = None
        self.ends: Ends = _ACROSS
        """Start and end as shares of the picture: x, y, x, y."""
        self.shown = False
        self._writing = False

    @property
    def height(self) -> float:
        """What its plot takes of the layout."""
        return float(self._plot.minimumHeight()) if self._plot and self.shown else 0.0

    def show(self, shown: bool, ends: Ends | None = None) -> None:
        if shown and self._plot is None:
            self._make()
        # A hidden item would keep its room in the layout.
        if shown and not self.shown:
            self._layout.addItem(self._plot, row=1, col=0, colspan=2)
        elif self.shown and not shown:
            self._layout.removeItem(self._plot)
        self.shown = shown
        self.ends = ends or self.ends
        if self._plot is not None:
            self._line.setVisible(shown)
        self._put_line()
        self._draw()

    def show_picture(self, picture: Picture) -> None:
        """Show the profile along the line in another picture."""
        moved = self._picture is None or self._picture.facts.extent != picture.facts.extent
        self._picture = picture
        if moved:
            self._put_line()
        self._draw()

    def clear(self) -> None:
        """Show no profile: there is no picture."""
        self._picture = None
        if self._plot is None:
            return
        for curve in (self._curve, self._other, *self._colours):
            curve.setData([], [])

    def set_theme(self, theme: Theme) -> None:
        if self._plot is None:
            return
        paint_axes(self._plot, theme)
        self._curve.setPen(theme.curves[0])
        self._other.setPen(theme.curves[1])
        for curve, colour in zip(self._colours, theme.channels, strict=True):
            curve.setPen(colour)
        self._line.setPen(theme.accent, width=2)
        self._line.hoverPen = pg.mkPen(theme.changed, width=3)
        for handle in self._line.getHandles():
            handle.pen.setColor(pg.mkColor(theme.accent))
            handle.currentPen = handle.pen

    def _make(self) -> None:
        self._plot = plot = pg.PlotItem(enableMenu=False)
        bare(plot)
        plot.setMouseEnabled(x=False, y=False)
        plot.setLabel("bottom", "distance (samples)")
        plot.setFixedHeight(_LINES * self._text_height())
        self._curve = plot.plot()
        self._other = plot.plot()
        self._colours = [plot.plot() for _ in CHANNELS]
        self._line = pg.LineSegmentROI([(0, 0), (1, 1)])
        self._line.setZValue(10)
        self._picture_plot.addItem(self._line)
        self._line.sigRegionChanged.connect(self._moved)
        self.set_theme(theme_of(self._canvas))

    def _put_line(self) -> None:
        if self._picture is None or self._plot is None:
            return
        place = self._picture.facts.extent
        self._writing = True
        for handle, (x, y) in zip(
            self._line.getHandles(), (self.ends[:2], self.ends[2:]), strict=True
        ):
            point = QPointF(place.left() + x * place.width(), place.top() + y * place.height())
            self._line.movePoint(handle, point, finish=False, coords="parent")
        self._writing = False

    def _moved(self) -> None:
        if self._writing or self._picture is None:
            return
        place = self._picture.facts.extent
        shares = []
        for handle in self._line.getHandles():
            point = self._line.mapToParent(handle.pos())
            shares += [
                (point.x() - place.left()) / place.width(),
                (point.y() - place.top()) / place.height(),
            ]
        self.ends = tuple(shares)
        self._draw()

    def _draw(self) -> None:
        picture = self._picture
        if picture is None or self._plot is None or not self.shown:
            return
        self._plot.setLabel("left", picture.facts.unit or picture.facts.quantity)
        start, end = self._on(picture)
        self._curve.setData([], [])
        for curve, channel in zip_longest(self._colours, picture.channels):
            curve.setData(*(along_line(channel.samples, start, end) if channel else ([], [])))
        if not picture.channels:
            self._curve.setData(*along_line(picture.samples, start, end))
        if picture.other is None:
            self._other.setData([], [])
            return
        starts, ends = self._on(picture.other)
        distance, value = along_line(picture.other.samples, starts, ends)
        shorter = math.dist(start, end) / (math.dist(starts, ends) or 1.0)
        self._other.setData(distance * shorter, value)

    def _on(self, picture: Picture) -> tuple[Place, Place]:
        """The ends as fractional indices of columns and rows."""
        columns, rows = picture.facts.columns, picture.facts.rows
        x0, y0, x1, y1 = self.ends
        return (x0 * columns - 0.5, y0 * rows - 0.5), (x1 * columns - 0.5, y1 * rows - 0.5)
