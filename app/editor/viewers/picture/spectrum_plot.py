"""Below a picture with bands: its mean spectrum, that of the probed sample, what is shown."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QWidget

from app.editor.theme import Theme, theme_of
from app.editor.viewers.plot.plot_looks import bare, paint_axes, see_through, thick
from core.chain.band_stack import BandStack

Vector = NDArray[np.float64]
_LINES = 8  # of text that the plot is high
_PICTURE = 12  # lines that it leaves the picture, or is not there
_ROW = 2  # of the layout: the picture, its profile, its spectrum
_FEW = 24  # bands up to which every one has a dot
_ROOM, _ABOVE = 0.06, 0.6  # beside the curves, of their range; above them stands the legend
MEAN = "mean of the picture"
NO_SAMPLE = "a single sample's is shown on wires before filtering"


class SpectrumPlot(QObject):
    """Curves over wavelength, and a line at every band that is shown alone or as a colour.

    Its place and its axes stay as they are while the cursor moves: the ordinate only grows. While
    it is shown it has a row of the layout.
    """

    # line, wavelength: the person drags a line: 0, or 0 to 2 for red, green and blue
    dragged = Signal(int, float)

    def __init__(self, layout: pg.GraphicsLayout, parent: QWidget) -> None:
        super().__init__(parent)
        self._layout = layout
        self.plot = plot = pg.PlotItem(enableMenu=False)
        bare(plot)
        plot.setMouseEnabled(x=False, y=False)
        plot.disableAutoRange()
        plot.setLabel("bottom", "wavelength (µm)")
        self._line = parent.fontMetrics().height()
        plot.setFixedHeight(_LINES * self._line)
        self.mean, self.sample = plot.plot(), plot.plot()
        self._no_curve = pg.PlotDataItem(pen=None)
        self.legend = plot.addLegend(offset=(-2, -1), colCount=2)
        self.legend.layout.setContentsMargins(3, 0, 3, 0)
        self.legend.anchor((1, 0), (1, 0), offset=(-2, 0))
        self.lines = tuple(pg.InfiniteLine(angle=90, movable=True) for _ in range(3))
        for line in self.lines:
            plot.addItem(line, ignoreBounds=True)
            line.sigDragged.connect(self._drag)
            line.sigPositionChangeFinished.connect(self._put_lines)
        self.bands: BandStack | None = None
        self._places: tuple[int, ...] = ()
        self._canvas = parent
        self._axes: object = None
        self._range: tuple[float, float] | None = None
        self.is_shown = False
        self._name = self._problem = ""

    def fits(self, height: float) -> bool:
        """Whether a height has room for it and for a picture that can be looked at."""
        return height >= (_LINES + _PICTURE) * self._line

    def show(self, shown: bool) -> None:
        """Take a row of the layout, or none."""
        # A hidden item would keep its room in the layout.
        if shown and not self.is_shown:
            self._layout.addItem(self.plot, row=_ROW, col=0, colspan=2)
        elif self.is_shown and not shown:
            self._layout.removeItem(self.plot)
        self.is_shown = shown

    def show_bands(self, bands: BandStack, unit: str, places: tuple[int, ...]) -> None:
        """Have these bands, with lines at those that are shown alone.

        At the same wavelengths the curves stay until there are newer ones: an edit does not blink.
        """
        self._places, self.bands = places, bands
        if self._axes != (bands.centres_um, bands.widths_um, unit):
            self._axes = (bands.centres_um, bands.widths_um, unit)
            self._range = None
            self.mean.setData([], [])
            self.show_sample(None, "")
            self.plot.setLabel("left", unit or "value")
            low, high = bands.band_um
            self.plot.setXRange(low, high, padding=0.01)
            for line in self.lines:
                line.setBounds((bands.centres_um[0], bands.centres_um[-1]))
            self.set_theme(theme_of(self._canvas))
        self._put_lines()

    def show_mean(self, values: Vector | None, problem: str = "") -> None:
        """Show the mean of every band, and fit the ordinate to what is drawn now.

        Without it, the problem is written in its place.
        """
        if problem != self._problem:
            self._problem = problem
            self._write_legend()
        self._range = None
        self._draw(self.mean, values)
        drawn = self.sample.getData()[1]
        if drawn is not None:
            self._see(drawn)

    def show_sample(self, values: Vector | None, name: str) -> None:
        """Show the spectrum of a sample, of that name; none without values."""
        self._draw(self.sample, values)
        if name != self._name:
            self._name = name
            self._write_legend()

    def set_theme(self, theme: Theme) -> None:
        paint_axes(self.plot, theme)
        few = self.bands is not None and self.bands.count <= _FEW
        dashed = thick(theme.faint_text, 1, Qt.PenStyle.DashLine)
        for curve, pen in ((self.mean, dashed), (self.sample, thick(theme.accent, 2))):
            curve.setPen(pen)
            curve.setSymbol("o" if few else None)
            curve.setSymbolSize(4)
            curve.setSymbolPen(None)
            curve.setSymbolBrush(pen.color())
        self.legend.setLabelTextColor(theme.text)
        self.legend.setBrush(pg.mkBrush(see_through(theme.base, 190)))
        self._write_legend()
        self._put_lines()

    def _write_legend(self) -> None:
        self.legend.clear()
        if self._problem:
            self.legend.addItem(self._no_curve, self._problem)
        else:
            self.legend.addItem(self.mean, MEAN)
        if self._name:
            drawn = self.sample.xData is not None and len(self.sample.xData) > 0
            self.legend.addItem(self.sample if drawn else self._no_curve, self._name)

    def _put_lines(self) -> None:
        theme, three = theme_of(self._canvas), len(self._places) == 3
        for number, line in enumerate(self.lines):
            shown = number < len(self._places) and self.bands is not None
            line.setVisible(shown)
            colour = theme.channels[number] if three else theme.changed
            line.setPen(thick(colour, 2))
            line.setHoverPen(thick(theme.text, 3))
            if shown and self.bands is not None and not line.moving:
                line.setValue(self.bands.centres_um[self._places[number]])

    def _drag(self, line: pg.InfiniteLine) -> None:
        self.dragged.emit(self.lines.index(line), float(line.value()))

    def _draw(self, curve: pg.PlotDataItem, values: Vector | None) -> None:
        if values is None or self.bands is None:
            curve.setData([], [])
            return
        curve.setData(np.array(self.bands.centres_um), np.asarray(values, np.float64))
        self._see(values)

    def _see(self, values: Vector) -> None:
        """Let the ordinate reach over these values, and what it reached over before."""
        good = values[np.isfinite(values)]
        if not len(good):
            return
        low, high = float(good.min()), float(good.max())
        before = self._range
        if before is not None:
            low, high = min(low, before[0]), max(high, before[1])
        if (low, high) != before:
            self._range = low, high
            reach = (high - low) or abs(high) * 1e-2 or 1.0
            self.plot.setYRange(low - _ROOM * reach, high + _ABOVE * reach, padding=0.0)
