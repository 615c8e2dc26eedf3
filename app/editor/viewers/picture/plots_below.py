"""What is plotted below a picture: samples along a line, means of lines, spectra of its bands."""

import math
from collections.abc import Hashable
from typing import Any, ClassVar

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QTransform

from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.theme import Theme
from app.editor.viewers.picture.picture_facts import bands_of
from app.editor.viewers.picture.picture_query import Picture
from app.editor.viewers.plot.plot_looks import bare, coloured, paint_axes, thick
from core.arrays import Vector
from core.chain.engine import Plan
from core.records import dataclass

LINES = 8  # of text that a plot is high
_NONE = np.empty((0, 0))


class PlotBelow(pg.PlotItem):  # type: ignore[misc]
    """A plot in a row of the picture's layout."""

    row: ClassVar[int]

    def __init__(self, canvas: pg.GraphicsLayoutWidget) -> None:
        super().__init__(enableMenu=False)
        bare(self)
        self.setMouseEnabled(x=False, y=False)
        self.setFixedHeight(LINES * canvas.fontMetrics().height())
        self.shown = False

    def set_theme(self, theme: Theme) -> None:
        paint_axes(self, theme)

    def show_picture(self, picture: Picture | None) -> None:
        raise NotImplementedError


def placed_at(place: QRectF) -> QTransform:
    """From shares of a picture's width and height to where it is drawn."""
    scale = QTransform.fromScale(place.width(), place.height())
    return scale * QTransform.fromTranslate(place.left(), place.top())


class ProfileLine(PlotBelow):
    """Samples of the picture, of a second one, and of red, green and blue, a curve each."""

    row = 1

    def __init__(self, canvas: pg.GraphicsLayoutWidget) -> None:
        super().__init__(canvas)
        self.setLabel("bottom", "distance (samples)")
        self.curves = [self.plot() for _ in range(5)]
        self._picture: Picture | None = None
        self._shares = pg.ItemGroup()
        canvas.view.addItem(self._shares, ignoreBounds=True)
        self.line = pg.LineSegmentROI([(0.1, 0.5), (0.9, 0.5)], parent=self._shares)
        self.line.sigRegionChanged.connect(self._draw)

    def set_theme(self, theme: Theme) -> None:
        super().set_theme(theme)
        for curve, colour in zip(self.curves, (*theme.curves[:2], *theme.channels), strict=True):
            curve.setPen(colour)
        self.line.setPen(thick(theme.accent, 2))
        self.line.hoverPen = thick(theme.changed, 3)
        for handle in self.line.getHandles():
            handle.pen = handle.currentPen = self.line.pen

    def show_picture(self, picture: Picture | None) -> None:
        self._picture = picture
        self._shares.setVisible(self.shown)
        if picture is not None:
            self._shares.setTransform(placed_at(picture.facts.extent))
        self._draw()

    def _draw(self) -> None:
        picture = self._picture
        layers: list[NDArray[Any]] = []
        if picture is not None and self.shown:
            self.setLabel("left", picture.facts.unit or picture.facts.quantity)
            other = _NONE if picture.other is None else picture.other.samples
            own = _NONE if picture.channels else picture.samples
            layers = [own, other, *(channel.samples for channel in picture.channels)]
        for number, curve in enumerate(self.curves):
            samples = layers[number] if number < len(layers) else _NONE
            curve.setData(*self._along(samples), connect="finite")

    def _along(self, samples: NDArray[Any]) -> tuple[Vector, Vector]:
        """Distance in samples of the picture, and value."""
        if self._picture is None or not samples.size:
            return np.zeros(0), np.zeros(0)
        start, end = (self.line.mapToParent(handle.pos()) for handle in self.line.getHandles())
        across, along = end.x() - start.x(), end.y() - start.y()
        facts = self._picture.facts
        length = math.hypot(across * facts.columns, along * facts.rows)
        shares = np.linspace(0.0, 1.0, max(2, math.ceil(length) + 1))
        values = along_line(samples, start.x() + shares * across, start.y() + shares * along)
        return shares * length, values


def along_line(samples: NDArray[Any], x: Vector, y: Vector) -> Vector:
    """Values between samples, at shares of the width and height; NaN outside the picture."""
    rows, columns = samples.shape
    places = np.column_stack((y * rows - 0.5, x * columns - 0.5))
    return np.asarray(pg.interpolateArray(samples, places, default=np.nan))


class LineMeans(PlotBelow):
    """Means of rows and of columns over their place; those of a second picture are dashed."""

    row = 3

    def __init__(self, canvas: pg.GraphicsLayoutWidget) -> None:
        super().__init__(canvas)
        self.curves = tuple(self.plot() for _ in range(4))

    def set_theme(self, theme: Theme) -> None:
        super().set_theme(theme)
        for number, curve in enumerate(self.curves):
            dash = Qt.PenStyle.DashLine if number > 1 else Qt.PenStyle.SolidLine
            curve.setPen(thick(theme.curves[number % 2], 1, dash))
        rows, columns = map(coloured, ("rows", "columns"), theme.curves)
        self.setLabel("bottom", f"means of {rows} and {columns}, by index")

    def show_picture(self, picture: Picture | None) -> None:
        if not self.shown:
            return
        pictures = (picture, picture.other if picture is not None else None)
        for number, curve in enumerate(self.curves):
            one, axis = pictures[number // 2], number % 2
            if one is None:
                curve.setData([], [])
                continue
            means = one.samples.mean(axis=1 - axis, dtype=np.float64)
            at = (one.facts.across if axis else one.facts.along).at
            curve.setData([at(index) for index in range(len(means))], means)
            self.setLabel("left", one.facts.unit or one.facts.quantity)


_FEW = 24  # bands up to which every one has a dot
_LONGEST = 110  # letters of a problem below the curves
MEAN = "mean of the picture"
NO_SAMPLE = "the NER of a single sample is available only on wires before filtering"


class Spectra(PlotBelow):
    """Curves over wavelength, with a line at every band that is shown alone or as a colour."""

    row = 2

    def __init__(self, canvas: pg.GraphicsLayoutWidget) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self.disableAutoRange()
        self.mean, self.sample = self.plot(symbolSize=4), self.plot(symbolSize=4)
        self.lines = tuple(pg.InfiniteLine(angle=90, movable=True) for _ in range(3))
        for line in self.lines:
            self.addItem(line, ignoreBounds=True)
            line.sigDragged.connect(self._drag)
            line.sigPositionChangeFinished.connect(self._put_lines)
        self._wavelengths: tuple[float, ...] = ()  # shown alone, or as colours
        self._centres = np.zeros(0)
        self._range: tuple[float, float] | None = None
        self.names = [MEAN, ""]

    def set_theme(self, theme: Theme) -> None:
        super().set_theme(theme)
        self._theme = theme
        dashed = thick(theme.faint_text, 1, Qt.PenStyle.DashLine)
        for curve, pen in ((self.mean, dashed), (self.sample, thick(theme.accent, 2))):
            curve.setPen(pen)
            curve.setSymbolPen(None)
            curve.setSymbolBrush(pen.color())
        self._write_names()
        self._put_lines()

    def show_picture(self, picture: Picture | None) -> None:
        bands = bands_of(picture.value) if picture is not None else None
        if picture is None or bands is None:
            return
        centres = np.array(bands.centres_um)
        if not np.array_equal(centres, self._centres):  # else curves stay until newer ones
            self._centres, self._range = centres, None
            for curve in (self.mean, self.sample):
                curve.setData([], [])
                curve.setSymbol("o" if bands.count <= _FEW else None)
            self.setXRange(*bands.band_um, padding=0.01)
            for line in self.lines:
                line.setBounds((centres[0], centres[-1]))
        unit = picture.value.unit
        density = f"{unit}/µm" if unit else "1/µm"
        self.setLabel("left", (density if bands.density else unit) or "value")
        self._wavelengths = picture.facts.wavelengths_um
        self._put_lines()

    def show_answer(self, answer: Answer) -> None:
        query, values = answer.query, answer.value
        if isinstance(query, MeanSpectrumQuery):
            self._range = None
            self._show(0, values, _problem(answer) or MEAN)
        elif isinstance(query, SampleSpectrumQuery):
            place = f"row {query.row}  column {query.column}"
            self._show(1, values, _problem(answer) or (NO_SAMPLE if values is None else place))

    def forget_sample(self) -> None:
        self._show(1, None, "")

    def _show(self, which: int, values: Vector | None, name: str) -> None:
        curve = self.sample if which else self.mean
        if values is None or len(values) != len(self._centres):
            curve.setData([], [])
        else:
            curve.setData(self._centres, np.asarray(values, np.float64))
            self._see(values)
        if name != self.names[which]:
            self.names[which] = name
            self._write_names()

    def _write_names(self) -> None:
        colours = (self._theme.faint_text, self._theme.accent)
        names = ", ".join(map(coloured, filter(None, self.names), colours))
        self.setLabel("bottom", f"wavelength (µm): {names}")

    def _put_lines(self) -> None:
        theme, shown = self._theme, self._wavelengths
        for number, line in enumerate(self.lines):
            line.setVisible(number < len(shown))
            colour = theme.channels[number] if len(shown) == 3 else theme.changed
            line.setPen(thick(colour, 2))
            line.setHoverPen(thick(theme.text, 3))
            if number < len(shown) and not line.moving:
                line.setValue(shown[number])

    def _drag(self, line: pg.InfiniteLine) -> None:
        self._canvas.band_dragged.emit(self.lines.index(line), float(line.value()))

    def _see(self, values: Vector) -> None:
        """Have the values in sight; while the cursor moves, the range only grows."""
        good = values[np.isfinite(values)]
        if len(good):
            low, high = self._range or (np.inf, -np.inf)
            self._range = min(low, float(good.min())), max(high, float(good.max()))
            self.setYRange(*self._range, padding=0.08)


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
