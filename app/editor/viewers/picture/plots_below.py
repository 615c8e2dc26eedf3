"""What is plotted below a picture: samples along a line, means of lines, spectra of its bands."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any, ClassVar

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtWidgets import QWidget

from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.theme import Theme, theme_of
from app.editor.viewers.pixels.picture_facts import CHANNELS, BandChoice, bands_of
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.viewers.pixels.probing import Place, along_line
from app.editor.viewers.plot.plot_looks import bare, paint_axes, see_through, thick
from core.chain.band_stack import BandStack
from core.chain.engine import Plan

Vector = NDArray[np.float64]
_LINES = 8  # of text that a plot is high


class PlotBelow(QObject):
    """A plot in a row of the picture's layout, made once it is needed: that takes long."""

    _row: ClassVar[int]

    def __init__(self, layout: pg.GraphicsLayout, canvas: QWidget) -> None:
        super().__init__(canvas)
        self._layout = layout
        self._canvas = canvas
        self._plot: pg.PlotItem | None = None
        self.shown = False

    @property
    def plot(self) -> pg.PlotItem:
        if self._plot is None:
            self._plot = pg.PlotItem(enableMenu=False)
            bare(self._plot)
            self._plot.setMouseEnabled(x=False, y=False)
            self._plot.setFixedHeight(_LINES * self._line_height)
            self._fill(self._plot)
            self.set_theme(theme_of(self._canvas))
        return self._plot

    @property
    def height(self) -> float:
        return float(self.plot.minimumHeight()) if self.shown else 0.0

    def set_theme(self, theme: Theme) -> None:
        if self._plot is not None:
            paint_axes(self._plot, theme)
            self._paint(theme)

    @property
    def _line_height(self) -> int:
        return self._canvas.fontMetrics().height()

    def _fill(self, plot: pg.PlotItem) -> None:
        """Make what is in the plot."""

    def _paint(self, theme: Theme) -> None:
        """Give what is in the plot the theme's colours."""

    def _put(self, shown: bool) -> None:
        # A hidden item would keep its room in the layout.
        if shown and not self.shown:
            self._layout.addItem(self.plot, row=self._row, col=0, colspan=2)
        elif self.shown and not shown:
            self._layout.removeItem(self.plot)
        self.shown = shown


# A line across a picture that can be dragged, and the samples along it.

Ends = tuple[float, ...]
_ACROSS: Ends = (0.1, 0.5, 0.9, 0.5)


class ProfileLine(PlotBelow):
    _row = 1

    def __init__(
        self, picture_plot: pg.PlotItem, layout: pg.GraphicsLayout, canvas: QWidget
    ) -> None:
        super().__init__(layout, canvas)
        self._picture_plot = picture_plot
        self._picture: Picture | None = None
        self.ends: Ends = _ACROSS
        """Start and end as shares of the picture: x, y, x, y."""
        self._writing = False

    def show(self, shown: bool, ends: Ends | None = None) -> None:
        self._put(shown)
        self.ends = ends or self.ends
        if self._plot is not None:
            self._line.setVisible(shown)
        self._put_line()
        self._draw()

    def show_picture(self, picture: Picture) -> None:
        moved = self._picture is None or self._picture.facts.extent != picture.facts.extent
        self._picture = picture
        if moved:
            self._put_line()
        self._draw()

    def clear(self) -> None:
        self._picture = None
        if self._plot is None:
            return
        for curve in (self._curve, self._other, *self._colours):
            curve.setData([], [])

    def _fill(self, plot: pg.PlotItem) -> None:
        plot.setLabel("bottom", "distance (samples)")
        self._curve = plot.plot()
        self._other = plot.plot()
        self._colours = [plot.plot() for _ in CHANNELS]
        self._line = pg.LineSegmentROI([(0, 0), (1, 1)])
        self._line.setZValue(10)
        self._picture_plot.addItem(self._line)
        self._line.sigRegionChanged.connect(self._moved)

    def _paint(self, theme: Theme) -> None:
        self._curve.setPen(theme.curves[0])
        self._other.setPen(theme.curves[1])
        for curve, colour in zip(self._colours, theme.channels, strict=True):
            curve.setPen(colour)
        self._line.setPen(theme.accent, width=2)
        self._line.hoverPen = pg.mkPen(theme.changed, width=3)
        for handle in self._line.getHandles():
            handle.pen.setColor(pg.mkColor(theme.accent))
            handle.currentPen = handle.pen

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
        columns, rows = picture.facts.columns, picture.facts.rows
        x0, y0, x1, y1 = self.ends
        return (x0 * columns - 0.5, y0 * rows - 0.5), (x1 * columns - 0.5, y1 * rows - 0.5)


# The mean of every row and of every column: banding, shading and drift show in them.


class LineMeans(PlotBelow):
    """Means of rows and of columns over their place; those of a second picture are dashed."""

    _row = 3

    def __init__(self, layout: pg.GraphicsLayout, canvas: QWidget) -> None:
        super().__init__(layout, canvas)
        self._picture: Picture | None = None

    def show(self, shown: bool) -> None:
        self._put(shown)
        self.show_picture(self._picture)

    def show_picture(self, picture: Picture | None) -> None:
        self._picture = picture
        if not self.shown:
            return
        facts = picture.facts if picture is not None else None
        self.plot.setLabel("left", (facts.unit or facts.quantity) if facts is not None else "")
        pictures = (picture, picture.other if picture is not None else None)
        for one, curves in zip(pictures, (self.curves[:2], self.curves[2:]), strict=True):
            for axis, curve in enumerate(curves):
                samples = one.samples if one else np.empty((0, 0))
                means = samples.sum(axis=1 - axis, dtype=np.float64) / (
                    samples.shape[1 - axis] or 1
                )
                step = one.facts.rows / samples.shape[0] if one else 1.0
                curve.setData((np.arange(len(means)) + 0.5) * step - 0.5, means)

    def _fill(self, plot: pg.PlotItem) -> None:
        self.curves = tuple(plot.plot() for _ in range(4))

    def _paint(self, theme: Theme) -> None:
        for number, curve in enumerate(self.curves):
            dash = Qt.PenStyle.DashLine if number > 1 else Qt.PenStyle.SolidLine
            curve.setPen(thick(theme.curves[number % 2], 1, dash))
        names = zip(("rows", "columns"), theme.curves, strict=False)
        coloured = (f"<span style='color: {colour}'>{name}</span>" for name, colour in names)
        self.plot.setLabel("bottom", f"means of {' and '.join(coloured)}, by number")


# The spectra of a picture with bands: its mean, and that of the probed sample.

_PICTURE = 12  # lines that the plot leaves the picture, or is not there
_FEW = 24  # bands up to which every one has a dot
_ROOM, _ABOVE = 0.06, 0.6  # beside the curves, of their range; above them stands the legend
_LONGEST = 110  # letters of a problem beside the curves
MEAN = "mean of the picture"
NO_SAMPLE = "a single sample's NER is shown on wires before filtering"
PAUSE_MS = 30
"""While the cursor moves, the spectrum under it is taken at most so often."""


class Spectra(PlotBelow):
    """Curves over wavelength, with a line at every band that is shown alone or as a colour."""

    # line, wavelength: the person drags a line: 0, or 0 to 2 for red, green and blue
    dragged = Signal(int, float)
    wanted = Signal()  # its queries are others
    _row = 2

    def __init__(self, layout: pg.GraphicsLayout, canvas: QWidget) -> None:
        super().__init__(layout, canvas)
        self._bands: BandStack | None = None
        self._port = ""
        self._places: tuple[int, ...] = ()
        self._on = True
        self._height = math.inf
        self._place: tuple[int, int] | None = None
        self._axes: object = None
        self._range: tuple[float, float] | None = None
        self._name = self._problem = ""
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self.wanted)

    @property
    def queries(self) -> tuple[Query, ...]:
        if not self.shown:
            return ()
        mean = MeanSpectrumQuery(self._port)
        if self._place is None:
            return (mean,)
        return mean, SampleSpectrumQuery(self._port, *self._place)

    def switch(self, on: bool) -> None:
        if on != self._on:
            self._on = on
            self._show_where_it_fits()

    def fit(self, height: float) -> None:
        """Have that height for picture and plot; the picture goes first."""
        self._height = height
        self._show_where_it_fits()

    def show_picture(self, picture: Picture | None, port: str | None, choice: BandChoice) -> None:
        """Have the bands of a picture; at the same wavelengths curves stay until newer."""
        bands = bands_of(picture.value) if picture is not None else None
        self._bands, self._port = bands, port or ""
        if bands is not None and picture is not None:
            unit = picture.value.unit
            if bands.density:
                unit = f"{unit}/µm" if unit else "1/µm"
            self._places = choice.places(bands)
            self._show_axes(self.plot, bands, unit)
            self._put_lines()
        self._show_where_it_fits()

    def point_at(self, place: Any) -> None:
        """The probe is at a row and column of the picture, or nowhere."""
        if place == self._place:
            return
        self._place = place
        if self._place is None:
            if self._plot is not None:
                self._show_sample(None, "")
        elif self.shown and not self._pause.isActive():
            self._pause.start()

    def accepts(self, query: Query) -> bool:
        """Whether it is of this picture's spectra; also of a sample that the cursor has left."""
        if not isinstance(query, MeanSpectrumQuery | SampleSpectrumQuery):
            return False
        return query.port == self._port

    def take(self, answer: Answer) -> bool:
        query, problem = answer.query, _problem(answer)
        if isinstance(query, MeanSpectrumQuery):
            self._show_mean(answer.value, problem)
        elif not isinstance(query, SampleSpectrumQuery):
            return False
        elif self._place is not None:  # else the cursor has left
            place = f"row {query.row}  column {query.column}"
            self._show_sample(
                answer.value, problem or (NO_SAMPLE if answer.value is None else place)
            )
        return True

    def _show_where_it_fits(self) -> None:
        before = self.shown
        fits = self._height >= (_LINES + _PICTURE) * self._line_height
        self._put(self._bands is not None and self._on and fits)
        if before != self.shown or self._bands is not None:
            self._pause.start()

    def _fill(self, plot: pg.PlotItem) -> None:
        plot.disableAutoRange()
        plot.setLabel("bottom", "wavelength (µm)")
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

    def _show_axes(self, plot: pg.PlotItem, bands: BandStack, unit: str) -> None:
        axes = bands.centres_um, bands.widths_um, unit
        if axes == self._axes:
            return
        self._axes, self._range = axes, None
        self.mean.setData([], [])
        self._show_sample(None, "")
        plot.setLabel("left", unit or "value")
        plot.setXRange(*bands.band_um, padding=0.01)
        for line in self.lines:
            line.setBounds((bands.centres_um[0], bands.centres_um[-1]))
        self.set_theme(theme_of(self._canvas))

    def _show_mean(self, values: Vector | None, problem: str) -> None:
        """Without a mean, the problem is written in its place."""
        if problem != self._problem:
            self._problem = problem
            self._write_legend()
        self._range = None
        self._draw(self.mean, values)
        drawn = self.sample.getData()[1]
        if drawn is not None:
            self._see(drawn)

    def _show_sample(self, values: Vector | None, name: str) -> None:
        self._draw(self.sample, values)
        if name != self._name:
            self._name = name
            self._write_legend()

    def _paint(self, theme: Theme) -> None:
        few = self._bands is not None and self._bands.count <= _FEW
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
            shown = number < len(self._places) and self._bands is not None
            line.setVisible(shown)
            colour = theme.channels[number] if three else theme.changed
            line.setPen(thick(colour, 2))
            line.setHoverPen(thick(theme.text, 3))
            if shown and self._bands is not None and not line.moving:
                line.setValue(self._bands.centres_um[self._places[number]])

    def _drag(self, line: pg.InfiniteLine) -> None:
        self.dragged.emit(self.lines.index(line), float(line.value()))

    def _draw(self, curve: pg.PlotDataItem, values: Vector | None) -> None:
        if values is None or self._bands is None:
            curve.setData([], [])
            return
        curve.setData(np.array(self._bands.centres_um), np.asarray(values, np.float64))
        self._see(values)

    def _see(self, values: Vector) -> None:
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


def _problem(answer: Answer) -> str:
    """Why there is no spectrum; of a long line its end, as it begins with the name of a file."""
    text = "" if answer.error is None else " ".join(str(answer.error).split())
    return text if len(text) <= _LONGEST else f"…{text[1 - _LONGEST :]}"


@dataclass(frozen=True)
class MeanSpectrumQuery(Query):
    """The mean of every band, once edits pause: it may take reading the whole of a file."""

    waits: ClassVar[bool] = True

    port: str

    def key(self, plan: Plan) -> Hashable:
        bands = bands_of(plan.output(self.port))
        return bands and bands.key

    def answer(self, passing: Passing) -> Vector | None:
        bands = bands_of(passing.plan.output(self.port))
        return None if bands is None else np.asarray(passing.work.value(bands.means()))


@dataclass(frozen=True)
class SampleSpectrumQuery(Query):
    """All bands of a sample; None without any, or where each would have to be filtered."""

    urgency: ClassVar[int] = 1

    port: str
    row: int
    column: int

    def key(self, plan: Plan) -> Hashable:
        bands = bands_of(plan.output(self.port))
        return bands and (bands.key, self.row, self.column)

    def answer(self, passing: Passing) -> Vector | None:
        image: Any = passing.plan.output(self.port)
        bands = bands_of(image)
        if bands is None or not (0 <= self.row < image.rows and 0 <= self.column < image.columns):
            return None
        recipe = bands.spectrum(self.row, self.column)
        return None if recipe is None else np.asarray(passing.work.value(recipe))
