"""Where curves are drawn, with marks and the cursor that reads them; and charts of bars."""

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import zip_longest
from typing import Any

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QFont, QFontMetrics, QKeyEvent, QPen
from PySide6.QtWidgets import QGraphicsScene, QWidget

from app.editor.theme import Theme, theme_of
from app.editor.viewers.plot import plot_looks, plotted_lines
from core.arrays import Vector
from core.chain.wires import CurveMark
from core.modules.preview import signed

_Range = tuple[float, float]
_Ranges = tuple[_Range | None, tuple[_Range, ...]]
_STEP = 0.01  # of the abscissa's range, for the arrow keys


class PlotCanvas(pg.GraphicsLayoutWidget):  # type: ignore[misc]
    read = Signal(str)  # text: what the cursor reads; empty where it reads nothing
    recoloured = Signal()  # the pens are others
    menu_wanted = Signal(QPoint)  # (place on the screen)
    theme: Theme | None = None

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        # The bounds of an axis with a grid follow its view's, and pyqtgraph does not tell Qt. Qt's
        # tree of places keeps such an axis once it is taken out; painting it, deleted, crashes.
        self.scene().setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        self.setAccessibleName("Curves")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.ci.layout.setContentsMargins(2, 4, 6, 2)
        self.drawing = plotted_lines.Drawing("")
        self.shown: frozenset[str] = frozenset()
        self.pens: dict[str, QPen] = {}
        self.framed = True
        self.plots: list[CurvePlot] = []
        self.bars: BarPlot | None = None
        self._axes: list[tuple[str, str, bool, bool]] = []
        self._ranges: _Ranges | None = None
        self._at: tuple[int, float, str] | None = None
        self.scene().sigMouseMoved.connect(self._mouse_moved)
        self.scene().sigMouseClicked.connect(self._clicked)
        self._take_colours()

    def _take_colours(self) -> None:
        self.theme = theme_of(self)
        self.setBackground(self.theme.base)
        self._make_plots(self.drawing)
        self.show_drawing(self.drawing, self.shown)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if self.theme not in (None, theme_of(self)):
            self._take_colours()
            self.recoloured.emit()

    def show_drawing(self, drawing: plotted_lines.Drawing, shown: Collection[str]) -> None:
        before, self.drawing = self.drawing, drawing
        self.pens = plot_looks.entry_pens(drawing.entries, theme_of(self))
        alike = len(drawing.panels) == len(before.panels)
        if not alike or bool(drawing.bars) != (self.bars is not None):
            self._make_plots(drawing)
        self._write_axes()
        self.show_entries(shown)

    def show_entries(self, shown: Collection[str]) -> None:
        self.shown = frozenset(shown)
        if self.bars is not None:
            self.bars.show_bars(self.drawing, self.shown, self.pens)
            self.setMinimumHeight(self.bars.least_height)
            self.setAccessibleDescription(self.bars.description)
            return
        for plot, panel in zip(self.plots, self.drawing.panels, strict=True):
            plot.show_lines(self.drawing, panel, self.shown, self.pens)
        self._follow_marks()
        if self.framed and (whole := self._whole()) != self._ranges:
            self._frame(whole)
        if self._at is not None:
            self._read(*self._at)

    def frame(self) -> None:
        self.framed = True
        self._frame(self._whole())

    def limits(self, along: bool) -> _Range:
        """What is shown of the abscissa, or of the first panel's ordinate."""
        low, high = self.plots[0].getViewBox().viewRange()[along]
        return (10.0**low, 10.0**high) if self._is_log(along) else (low, high)

    def set_limits(self, along: bool, low: float, high: float) -> None:
        log = self._is_log(along)
        if low < high and (low > 0 or not log):
            box = self.plots[0].getViewBox()
            ends = np.log10((low, high)) if log else (low, high)
            (box.setYRange if along else box.setXRange)(*ends, padding=0.0)
            self._seen_otherwise()

    def _is_log(self, along: bool) -> bool:
        return self.drawing.panels[0].log if along else self.drawing.log_x

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Open the menu for the key; a right click may also be the beginning of a drag."""
        if event.reason() is QContextMenuEvent.Reason.Keyboard:
            self.menu_wanted.emit(self.mapToGlobal(self.rect().center()))
        event.accept()

    def _clicked(self, event: Any) -> None:
        if event.button() is Qt.MouseButton.RightButton:
            self.menu_wanted.emit(event.screenPos().toPoint())

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self._read_nothing()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Read along the curve with left and right, another with up and down; F or 0 frames."""
        key = Qt.Key(event.key())
        sideways = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(key)
        upwards = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}.get(key)
        far = 10 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        if sideways is not None:
            self._step(sideways * far, 0)
        elif upwards is not None:
            self._step(0, upwards)
        elif key in (Qt.Key.Key_0, Qt.Key.Key_F):
            self.frame()
        else:
            super().keyPressEvent(event)
            return
        event.accept()

    def _make_plots(self, drawing: plotted_lines.Drawing) -> None:
        self._read_nothing()
        self.ci.clear()
        self.setMinimumHeight(0)
        self.plots, self.bars, self._axes, self._ranges = [], None, [], None
        if drawing.bars:
            self.bars = BarPlot(theme_of(self), self.font())
            self.addItem(self.bars)
            return
        for row in range(len(drawing.panels)):
            plot = CurvePlot(theme_of(self), self.font())
            self.addItem(plot, row=row, col=0)
            box = plot.getViewBox()
            box.sigRangeChangedManually.connect(self._seen_otherwise)
            box.sigXRangeChanged.connect(self._follow_x)
            box.sigResized.connect(self._follow_marks)
            self.plots.append(plot)

    def _write_axes(self) -> None:
        drawing = self.drawing
        last = len(drawing.panels) - 1
        axes = [
            (drawing.x_label if row == last else "", panel.y_label, drawing.log_x, panel.log)
            for row, panel in enumerate(drawing.panels)
        ]
        if axes == self._axes:
            return
        self._axes, self.framed, self._ranges = axes, True, None
        self._read_nothing()
        for plot, (across, along, log_x, log_y) in zip(self.plots, axes, strict=False):
            plot.setLabel("left", along)
            plot.setLabel("bottom", across)
            for side in ("left", "bottom"):
                plot.getAxis(side).setLogMode(log_x, log_y)

    def _follow_marks(self, *_: object) -> None:
        low, high = self.drawing.x_range or (math.inf, -math.inf)
        marks = [mark for mark in self.drawing.marks if low <= mark.x <= high * (1 + 1e-9)]
        for row, plot in enumerate(self.plots):
            plot.show_marks(marks, named=row == 0)

    def _whole(self) -> _Ranges:
        """Abscissae of all panels, and ordinates of each, that show all of the curves."""
        ordinates = tuple(plotted_lines.y_range(panel, self.shown) for panel in self.drawing.panels)
        return self.drawing.x_range, ordinates

    def _frame(self, whole: _Ranges) -> None:
        self._ranges = whole
        along, ordinates = whole
        for plot, ordinate in zip(self.plots, ordinates, strict=False):
            if along is not None:
                plot.setXRange(*along, padding=0.02)
            plot.setYRange(*ordinate, padding=0.0)

    def _follow_x(self, moved: pg.ViewBox, along: tuple[float, float]) -> None:
        """Show the same abscissae in all panels; pyqtgraph's own link shifts them by some dots."""
        for plot in self.plots:
            box = plot.getViewBox()
            if box is not moved and tuple(box.viewRange()[0]) != tuple(along):
                box.blockSignals(True)
                box.setXRange(*along, padding=0.0)
                box.blockSignals(False)
                plot.getAxis("bottom").linkedViewChanged(box)

    def _seen_otherwise(self) -> None:
        self.framed, self._ranges = False, None

    def _mouse_moved(self, point: QPointF) -> None:
        for index, plot in enumerate(self.plots):
            box = plot.getViewBox()
            if box.sceneBoundingRect().contains(point):
                place = box.mapSceneToView(point)
                line = self._nearest(index, place.x(), point.y())
                if line is not None:
                    self._read(index, place.x(), line.name)
                    return
        self._read_nothing()

    def _nearest(self, index: int, x: float, height: float) -> plotted_lines.Line | None:
        box, panel = self.plots[index].getViewBox(), self.drawing.panels[index]
        far: dict[float, plotted_lines.Line] = {}
        for line in self._lines(index):
            value = plotted_lines.value_at(line, self.drawing.x_at(x))
            drawn = math.nan if value is None else float(panel.drawn(np.array(value)))
            if math.isfinite(drawn):
                far[abs(box.mapViewToScene(QPointF(x, drawn)).y() - height)] = line
        return far[min(far)] if far else None

    def _lines(self, index: int) -> list[plotted_lines.Line]:
        return [line for line in self.drawing.panels[index].lines if line.name in self.shown]

    def _step(self, sideways: int, lines: int) -> None:
        along = self.drawing.x_range
        if along is None or not self.plots:
            return
        index, x, name = self._at or (0, along[0], "")
        names = [line.name for line in self._lines(index)]
        if names:
            place = names.index(name) + lines if name in names else 0
            x += sideways * _STEP * (along[1] - along[0])
            self._read(index, min(along[1], max(along[0], x)), names[place % len(names)])

    def _read(self, index: int, x: float, name: str) -> None:
        line = next((line for line in self._lines(index) if line.name == name), None)
        place = self.drawing.x_at(x)
        value = None if line is None else plotted_lines.value_at(line, place)
        if value is None:
            self._read_nothing()
            return
        self._at = index, x, name
        for plot in self.plots:
            plot.cursor.setValue(x)
            plot.cursor.setVisible(True)
        title = next(entry.title for entry in self.drawing.entries if entry.name == name)
        quantity, _, unit = self.drawing.panels[index].y_label.rstrip(")").partition(" (")
        _, _, x_unit = self.drawing.x_label.rstrip(")").partition(" (")
        what = f"{title}: " if quantity in title else f"{title}, {quantity}: "
        text = f"{place:.4g} {x_unit}".rstrip() + f"   {what}{value:.5g} {unit}".rstrip()
        self.read.emit(signed(text))

    def _read_nothing(self) -> None:
        self._at = None
        for plot in self.plots:
            plot.cursor.setVisible(False)
        self.read.emit("")


class CurvePlot(pg.PlotItem):  # type: ignore[misc]
    """Curves by their names, marks of abscissae, and a cursor."""

    def __init__(self, theme: Theme, font: QFont) -> None:
        axes = {side: plot_looks.PlotAxis(side) for side in ("left", "bottom")}
        super().__init__(axisItems=axes, enableMenu=False)
        plot_looks.bare(self)
        plot_looks.paint_axes(self, theme)
        self.showGrid(x=True, y=True, alpha=0.12)
        self.getAxis("left").setWidth(QFontMetrics(font).averageCharWidth() * 9)
        self.disableAutoRange()
        self.drawn: dict[str, pg.PlotCurveItem] = {}
        self.marks: list[pg.InfiniteLine] = []
        self.cursor = pg.InfiniteLine(angle=90, pen=pg.mkPen(theme.accent))
        self.cursor.setVisible(False)
        self.addItem(self.cursor)
        self._theme, self._font = theme, QFont(font)

    def show_lines(
        self,
        drawing: plotted_lines.Drawing,
        panel: plotted_lines.Panel,
        shown: Collection[str],
        pens: Mapping[str, QPen],
    ) -> None:
        """Draw what is not there already: of a chain's curves an edit changes one or two."""
        behind = {
            entry.name: 1 if entry.bound or entry.of else 2 if entry.total else 3
            for entry in drawing.entries
        }
        for name in self.drawn.keys() - {line.name for line in panel.lines}:
            self.getViewBox().removeItem(self.drawn.pop(name))
        for number, line in enumerate(panel.lines):
            if line.name not in self.drawn:
                self.drawn[line.name] = pg.PlotCurveItem()
                self.getViewBox().addItem(self.drawn[line.name])
            curve = self.drawn[line.name]
            if curve.opts["pen"] != (pen := pens[line.name]):
                curve.setPen(pen)
            curve.setZValue(behind[line.name] + 1e-3 * number)
            curve.setVisible(line.name in shown)
            x, y = drawing.drawn_x(line.x), panel.drawn(line.y)
            if not plotted_lines.same_points((curve.xData, curve.yData), (x, y)):
                curve.setData(x, y, connect="finite")

    def show_marks(self, marks: Sequence[CurveMark], *, named: bool) -> None:
        """Mark abscissae, with names where the plot is high enough for them."""
        while len(self.marks) < len(marks):
            self._add_mark(high=len(self.marks) % 2 == 1)
        for line, mark in zip_longest(self.marks, marks):
            line.setVisible(mark is not None)  # to take lines with names out may crash
            if mark is None:
                continue
            line.setValue(mark.x)
            text = f"{mark.text} {mark.x:.4g}"
            wide = QFontMetrics(self._font).horizontalAdvance(text)
            if wide > 0.97 * self.getViewBox().height():
                text = f"{mark.x:.4g}"
            line.label.setFormat(text if named else "")
            line.label.setVisible(named)

    def _add_mark(self, *, high: bool) -> None:
        # Upright beside the line, on its left: on the right the plot may end. Every other one is
        # at the upper end: two may be a few dots apart.
        end = 1.0 if high else 0.0
        line = pg.InfiniteLine(
            angle=90,
            pen=plot_looks.thick(self._theme.faint_text, 1, Qt.PenStyle.DashLine),
            label="",
            labelOpts={
                "position": 0.97 if high else 0.03,
                "rotateAxis": (1, 0),
                "anchors": [(end, 1), (end, 1)],
                "color": self._theme.text,
                "fill": plot_looks.see_through(self._theme.base, 235),
            },
        )
        line.label.setFont(self._font)
        line.setZValue(5)
        self.addItem(line)
        self.marks.append(line)


_NAMES = 0.45  # of the width, at most, for the names
_THICK = 1.5  # lines of text that a bar is high at most
_GAP = 6  # dots between groups


class BarPlot(pg.PlotItem):  # type: ignore[misc]
    """The first panel of a drawing: a group of bars for each name, a bar for each line."""

    def __init__(self, theme: Theme, font: QFont) -> None:
        super().__init__(enableMenu=False)
        plot_looks.bare(self)
        plot_looks.paint_axes(self, theme)
        self.showAxis("right")
        right = self.getAxis("right")
        right.setPen(pg.mkPen(None))
        right.setTextPen(theme.text)
        self.setMouseEnabled(x=False, y=False)
        self.invertY(True)
        self.disableAutoRange()
        for side in ("left", "right"):
            self.getAxis(side).setStyle(tickLength=0, tickAlpha=0)
        self.getAxis("bottom").setTicks([])
        self._metrics = QFontMetrics(font)
        self._zero = self.addLine(x=0.0, pen=theme.line)
        self._shown: tuple[plotted_lines.Drawing, Collection[str], Mapping[str, QPen]] | None = None
        self._names: list[str] = []
        self.least_height = 0
        self.description = ""
        self.bars: list[pg.BarGraphItem] = []
        self.getViewBox().sigResized.connect(self._lay)

    def show_bars(
        self, drawing: plotted_lines.Drawing, shown: Collection[str], pens: Mapping[str, QPen]
    ) -> None:
        self._shown = drawing, shown, pens
        self._lay()

    def _lay(self, *resized: object) -> None:
        if self._shown is None:
            return
        drawing, shown, pens = self._shown
        panel, count = drawing.panels[0], len(drawing.bars)
        lines = [line for line in panel.lines if line.name in shown]
        given = [_padded(line.y, count) for line in lines]
        drawn = [panel.drawn(heights) for heights in given]
        low, high, zero = _range(drawn, panel.log)
        # Each bar may belong to one line: a source makes either temporal or fixed noise.
        alone = len(lines) > 1 and (np.count_nonzero(given, axis=0) <= 1).all()
        beside = 1 if alone else max(1, len(lines))
        line_height = self._metrics.height()
        self.least_height = count * (beside * line_height + _GAP) + 3 * line_height
        group = max(1.0, self.getViewBox().height() / count)  # dots
        thickness = min(max(0.0, 1 - _GAP / group) / beside, _THICK * line_height / group)
        texts: dict[float, str] = {}
        while len(self.bars) < len(lines):
            self.bars.append(pg.BarGraphItem(x0=[], x1=[], y=[], height=1.0, pen=pg.mkPen(None)))
            self.addItem(self.bars[-1])
        for bar in self.bars[len(lines) :]:
            self.removeItem(bar)
        self.bars = self.bars[: len(lines)]
        for number, (line, values, heights) in enumerate(zip(lines, given, drawn, strict=True)):
            shift = 0.0 if beside == 1 else (number - (beside - 1) / 2) * thickness
            places = np.arange(count) + shift
            ends = np.clip(np.where(np.isfinite(heights), heights, zero), low, high)
            self.bars[number].setOpts(
                x0=np.minimum(zero, ends),
                x1=np.maximum(zero, ends),
                y=places,
                height=0.94 * thickness,
                brush=pens[line.name].color(),
            )
            for place, value in zip(places.tolist(), values.tolist(), strict=True):
                if value != 0.0 or place not in texts:
                    texts[place] = _text(value)
        self._zero.setValue(zero)
        width = int(_NAMES * self.width())
        middle = Qt.TextElideMode.ElideMiddle
        names = [self._metrics.elidedText(name, middle, width) for name in drawing.bars]
        if resized or names != self._names:  # to draw an axis takes a millisecond
            self._names = names
            self.getAxis("left").setTicks([list(enumerate(names))])
        self.getAxis("right").setTicks([list(texts.items())])
        self.setLabel("bottom", panel.y_label + (", logarithmic" if panel.log else ""))
        self.setXRange(low, high, padding=0.0)
        self.setYRange(-0.5, count - 0.5, padding=0.0)
        self.description = "; ".join(
            f"{name}: {', '.join(_text(float(values[place])) for values in given)}"
            for place, name in enumerate(drawing.bars)
        )


def _padded(heights: Vector, count: int) -> Vector:
    """A height for each name, NaN where there is none."""
    padded = np.full(count, np.nan)
    padded[: len(heights)] = heights[:count]
    return padded


def _range(drawn: list[Vector], log: bool) -> tuple[float, float, float]:
    """Ends of the scale, and where bars begin: at 0, of logarithms at the decade below all."""
    finite = np.concatenate([values[np.isfinite(values)] for values in drawn] or [np.zeros(0)])
    if log:
        if not len(finite):
            return 0.0, 1.0, 0.0
        low = math.ceil(float(finite.min())) - 1.0
        return low, max(float(finite.max()), low + 1.0), low
    low, high = min(0.0, *finite, 0.0), max(0.0, *finite, 0.0)
    return (low, high, 0.0) if high > low else (0.0, 1.0, 0.0)


def _text(value: float) -> str:
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "\N{MINUS SIGN}∞"
    return signed(f"{value:.4g}".replace("e-0", "e-"))
