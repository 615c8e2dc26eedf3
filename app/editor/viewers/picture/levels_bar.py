"""The histogram beside a picture, with the levels of black and white to be dragged."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from itertools import zip_longest

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QTimer, Signal
from PySide6.QtGui import QPainter

from app.editor.theme import Theme
from app.editor.viewers.pixels.grey_levels import Range, Spread, colour_map
from app.editor.viewers.plot.plot_looks import paint_axis, see_through

SPREAD_MS = 100
"""While pictures follow one another, the histogram is drawn at most so often.

It takes more than the picture does: 2.9 ms of 5.2.
"""
_WIDTH = 60
_ROOM = 0.06  # beside the histogram at both ends, of its length
_FILLED = 0.8  # of the axis, by the histogram: else the axis is fitted anew


class LevelsBar(pg.HistogramLUTItem):  # type: ignore[misc]
    """Shows a histogram made elsewhere: it is tied to no picture, and computes nothing.

    The length of its bars is the logarithm of the count, so that rare samples are seen beside a
    uniform background.
    """

    dragged = Signal(float, float)  # low, high: the person drags the levels
    released = Signal()  # the person has let them go

    def __init__(self) -> None:
        with without_matplotlib():
            super().__init__()
        self._writing = False
        self._spread: Range | None = None
        self._next: tuple[Spread, Range, tuple[Spread, ...]] | None = None
        self._pause = QTimer(singleShot=True, interval=SPREAD_MS)
        self._pause.timeout.connect(self._show_next)
        self.vb.setMaximumWidth(_WIDTH)
        self.vb.setMenuEnabled(False)
        self.vb.setMouseEnabled(x=False, y=False)
        self.gradient.setEnabled(False)
        self.gradient.showTicks(False)
        self.axis.enableAutoSIPrefix(False)
        self.disableAutoHistogramRange()
        self._channels = self.plots[1:4]
        for plot in self._channels:
            plot.setFillLevel(None)
            plot.setCompositionMode(QPainter.CompositionMode.CompositionMode_SourceOver)
        # The curve is turned: its bars grow to the left of zero, up to 1.
        self.vb.setXRange(-1.02, 0.0, padding=0.0)
        self.sigLevelsChanged.connect(self._levels_changed)
        self.sigLevelChangeFinished.connect(self._level_change_finished)

    def set_theme(self, theme: Theme) -> None:
        paint_axis(self.axis, theme)
        self.plot.setPen(theme.faint_text)
        self.plot.setBrush(see_through(theme.faint_text, 110))
        for plot, colour in zip(self._channels, theme.channels, strict=True):
            plot.setPen(colour)
        self.region.setBrush(see_through(theme.accent, 50))
        self.region.setHoverBrush(see_through(theme.accent, 90))
        for line in self.region.lines:
            line.setPen(theme.accent)
            line.setHoverPen(theme.text)

    def set_colours(self, name: str) -> None:
        self.gradient.setColorMap(colour_map(name))
        self.gradient.showTicks(False)

    @property
    def is_behind(self) -> bool:
        return self._next is not None

    def show_spread(self, spread: Spread, levels: Range, channels: tuple[Spread, ...] = ()) -> None:
        """Show a histogram, and levels unless the person drags them; the newest, in a while.

        Of red, green and blue it is three lines, on the same axis.
        """
        self._next = spread, levels, channels
        if not self._pause.isActive():
            self._show_next()

    def _show_next(self) -> None:
        if self._next is None:
            return
        (spread, levels, channels), self._next = self._next, None
        self._pause.start()
        low, high = spread.low, spread.high
        if not high > low:
            reach = abs(low) * 1e-3 or 1.0
            low, high = low - reach, high + reach
        ends = low, high
        if channels:
            self.plot.setData([], [])
        else:
            self.plot.setData(*_bars(spread, ends))
        for plot, channel in zip_longest(self._channels, channels):
            plot.setData(*(_bars(channel, ends) if channel is not None else ([], [])))
        self._see(low, high, levels)
        if not any(line.moving for line in (*self.region.lines, self.region)):
            self._writing = True
            self.setLevels(*levels)
            self._writing = False

    def _see(self, low: float, high: float, levels: Range) -> None:
        """Keep histogram and levels in view, without jumping while levels or sliders are dragged.

        The axis stays as it is where that fits nearly as well: to draw it takes a millisecond.
        """
        if (low, high) == self._spread:
            return
        self._spread = low, high
        bottom, top = min(low, levels[0]), max(high, levels[1])
        first, last = self.vb.viewRange()[1]
        least = _FILLED * (last - first)
        if first <= bottom and top <= last and top - bottom >= least:
            return
        self.setHistogramRange(bottom, top, padding=_ROOM)

    def _levels_changed(self) -> None:
        if not self._writing:
            low, high = self.getLevels()
            self.dragged.emit(float(low), float(high))

    def _level_change_finished(self) -> None:
        if not self._writing:
            self.released.emit()


def _bars(spread: Spread, ends: Range) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places and lengths of the bars; between these ends where all samples are alike."""
    bars = np.log1p(spread.counts.astype(np.float64))
    bars /= max(1.0, float(bars.max()))
    centres = spread.centres if spread.high > spread.low else np.linspace(*ends, len(bars))
    return centres, bars


# Keeping pyqtgraph from loading all of matplotlib for a menu that is never opened.

_NAME = "matplotlib"


@contextlib.contextmanager
def without_matplotlib() -> Iterator[None]:
    """Make matplotlib seem not to be installed, unless it has been loaded already.

    A histogram of pyqtgraph lists matplotlib's colour maps in the menu of its gradient, which takes
    a third of a second of the time until the first picture.
    """
    if _NAME in sys.modules:
        yield
        return
    sys.modules[_NAME] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[_NAME]
