"""Plots in the colours of the theme, without pyqtgraph's own menus and buttons."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPen
from PySide6.QtWidgets import QGraphicsItem

from app.editor.theme import Theme


def bare(plot: pg.PlotItem) -> None:
    """Take away menus, buttons and powers of ten before the units."""
    plot.setMenuEnabled(False)
    plot.hideButtons()
    for name in ("left", "bottom"):
        plot.getAxis(name).enableAutoSIPrefix(False)


def paint_axes(plot: pg.PlotItem, theme: Theme) -> None:
    """Axes, their titles and frame in the theme's colours."""
    for name in ("left", "bottom"):
        paint_axis(plot.getAxis(name), theme)


def paint_axis(axis: pg.AxisItem, theme: Theme) -> None:
    """One axis; drawn anew only when it changes, as its text and grid take long."""
    axis.setCacheMode(QGraphicsItem.CacheMode.DeviceCoordinateCache)
    axis.setPen(theme.line)
    axis.setTextPen(theme.text)


def thick(colour: str, width: int, style: Qt.PenStyle = Qt.PenStyle.SolidLine) -> QPen:
    """A pen of that width on the screen, whatever the plot's scale."""
    pen: QPen = pg.mkPen(colour, width=width, style=style)
    return pen


def mark_pen(theme: Theme) -> QPen:
    """Of lines that mark a place."""
    return thick(theme.faint_text, 1, Qt.PenStyle.DashLine)


def see_through(colour: str, alpha: int) -> QColor:
    """A colour that lets what is below shine through, `alpha` 0 to 255."""
    mixed = QColor(colour)
    mixed.setAlpha(alpha)
    return mixed
