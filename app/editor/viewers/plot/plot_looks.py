"""Plots in the colours of the theme, without pyqtgraph's own menus and buttons."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QGraphicsItem

from app.editor.theme import Theme
from app.editor.viewers.plot.plotted_lines import Entry

_DASHES = (
    Qt.PenStyle.SolidLine,
    Qt.PenStyle.DashLine,
    Qt.PenStyle.DotLine,
    Qt.PenStyle.DashDotLine,
)
_PIECE = 9.0  # dots of a curve before what is beneath is seen
_KEPT = (5.0, 4.0)  # dots of a kept curve, and of its gaps
_STRONG = 3  # dots that the curve which is looked at is wide
_FAINT = 200  # of 255, the opacity of a limit
_PLAIN = range(-4, 5)  # powers of ten that are written out


class PlotAxis(pg.AxisItem):  # type: ignore[misc]
    """An axis; of a logarithmic one, only some values between powers of ten have a number."""

    def logTickStrings(self, values: Sequence[float], scale: float, spacing: float) -> list[str]:
        """Text of ticks at these logarithms: of 2 to 9 between powers of ten, few have room."""
        texts: list[str] = super().logTickStrings(values, scale, spacing)
        decades = abs(self.range[1] - self.range[0])
        labelled = range(1, 10) if decades < 0.5 else (1, 2, 5) if decades < 2.5 else (1,)
        labels = []
        for value, text in zip(values, texts, strict=True):
            power = math.floor(value + 1e-9)
            first = round(10 ** (value - power))
            plain = f"{first * 10.0**power:.1g}" if power < 0 else str(first * 10**power)
            labels.append("" if first not in labelled else plain if power in _PLAIN else text)
        return labels


class EndingAxis(pg.AxisItem):  # type: ignore[misc]
    """The axis of a picture, left or bottom: it ends with the picture where the view shows more."""

    ends: tuple[float, float] | None = None

    def end_at(self, low: float, high: float) -> None:
        if self.ends != (low, high):
            self.ends = low, high
            self.picture = None  # the drawing that pyqtgraph keeps
            self.update()

    def tickValues(self, minVal: float, maxVal: float, size: float) -> list[Any]:
        levels: list[Any] = super().tickValues(minVal, maxVal, size)
        if self.ends is None:
            return levels
        low, high = self.ends
        slack = 1e-6 * abs(high - low)
        return [
            (spacing, [value for value in values if low - slack <= value <= high + slack])
            for spacing, values in levels
        ]

    def generateDrawSpecs(self, p: QPainter) -> Any:
        specs = super().generateDrawSpecs(p)
        if specs is None or self.ends is None or self.range[0] == self.range[1]:
            return specs
        (pen, start, end), ticks, texts = specs
        bounds = self.mapRectFromParent(self.geometry())
        first, last = self.range
        shares = sorted(min(max((v - first) / (last - first), 0.0), 1.0) for v in self.ends)
        if self.orientation == "bottom":
            start, end = (
                QPointF(bounds.left() + share * bounds.width(), start.y()) for share in shares
            )
        else:
            start, end = (
                QPointF(start.x(), bounds.bottom() - share * bounds.height()) for share in shares
            )
        return (pen, start, end), ticks, texts


def bare(plot: pg.PlotItem) -> None:
    """Take away menus, buttons and powers of ten before the units."""
    plot.setMenuEnabled(False)
    plot.hideButtons()
    for name in ("left", "bottom"):
        plot.getAxis(name).enableAutoSIPrefix(False)


def paint_axes(plot: pg.PlotItem, theme: Theme) -> None:
    for name in ("left", "bottom"):
        paint_axis(plot.getAxis(name), theme)


def paint_axis(axis: pg.AxisItem, theme: Theme) -> None:
    """One axis; drawn anew only when it changes, as its text and grid take long."""
    axis.setCacheMode(QGraphicsItem.CacheMode.DeviceCoordinateCache)
    axis.setPen(theme.line)
    axis.setTextPen(theme.text)


def thick(colour: str | QColor, width: int, style: Qt.PenStyle = Qt.PenStyle.SolidLine) -> QPen:
    """A pen of that width on the screen, whatever the plot's scale."""
    pen: QPen = pg.mkPen(colour, width=width, style=style)
    return pen


def entry_pens(entries: Iterable[Entry], theme: Theme) -> dict[str, QPen]:
    """The pens of the legend's entries, by their names.

    Products have the text's colour, a limit that of the curve it is around; what lies on other
    curves is dashed, and so is a kept curve, in the colour of the present one.
    """
    pens: dict[str, QPen] = {}
    colours, curves, totals = theme.curves, 0, 0
    for entry in entries:
        if entry.of:
            pen = QPen(pens[entry.of])
            pen.setDashPattern([length / pen.widthF() for length in _KEPT])
        elif entry.total:
            pen = thick(theme.text, 2, _DASHES[min(totals, 1)])
            totals += 1
        elif entry.bound:
            colour = colours[max(curves - 1, 0) % len(colours)]
            pen = thick(see_through(colour, _FAINT), 1, Qt.PenStyle.DotLine)
        else:
            style = _DASHES[curves // len(colours) % len(_DASHES)]
            pen = thick(colours[curves % len(colours)], _STRONG if entry.strong else 1, style)
            if entry.over:  # three curves on one another are seen in turn
                pen.setDashPattern([_PIECE, 2 * _PIECE])
                pen.setDashOffset(_PIECE * entry.over)
            curves += 1
        pens[entry.name] = pen
    return pens


def mark_pen(theme: Theme) -> QPen:
    return thick(theme.faint_text, 1, Qt.PenStyle.DashLine)


def see_through(colour: str, alpha: int) -> QColor:
    mixed = QColor(colour)
    mixed.setAlpha(alpha)
    return mixed
