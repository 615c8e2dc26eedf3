"""A line that marks an abscissa in all panels of a plot, with its name in the first."""

from __future__ import annotations

from collections.abc import Sequence

import pyqtgraph as pg
from PySide6.QtGui import QFont

from app.editor.theme import Theme
from app.editor.viewers.plot.plot_looks import mark_pen, see_through


class PlotMark:
    """An upright dashed line.

    Parameters
    ----------
    plots : sequence of PlotItem
        The panels, the uppermost first.
    theme : Theme
        Colours.
    font : QFont
        Of the name.
    """

    def __init__(self, plots: Sequence[pg.PlotItem], theme: Theme, font: QFont) -> None:
        self._lines: list[pg.InfiniteLine] = []
        for plot in plots:
            line = pg.InfiniteLine(angle=90, pen=mark_pen(theme))
            line.setZValue(5)
            plot.addItem(line)
            self._lines.append(line)
        # Upright beside the line, on its left: on the right the plot may end.
        self._label = pg.InfLineLabel(
            self._lines[0],
            "",
            position=0.03,
            rotateAxis=(1, 0),
            anchors=[(0, 1), (0, 1)],
            color=theme.text,
            fill=see_through(theme.base, 190),
        )
        self._label.setFont(font)

    def show_at(self, frequency: float, text: str) -> None:
        """Mark that abscissa."""
        for line in self._lines:
            line.setValue(frequency)
            line.setVisible(True)
        if text != self._label.format:
            self._label.setFormat(text)

    def hide(self) -> None:
        """Mark nothing. It stays in the plot: to take lines with names out may crash."""
        for line in self._lines:
            line.setVisible(False)
