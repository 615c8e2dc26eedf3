"""Where curves are drawn, with marks and the cursor that reads them; and charts of bars."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import zip_longest
from typing import Any

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QFont,
    QFontMetrics,
    QKeyEvent,
    QPainter,
    QPaintEvent,
    QPen,
)
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget

from app.editor.theme import Theme, theme_of
from app.editor.viewers.plot.plot_looks import (
    PlotAxis,
    bare,
    entry_pens,
    mark_pen,
    paint_axes,
    see_through,
)
from app.editor.viewers.plot.plotted_lines import (
    Drawing,
    Line,
    Vector,
    same_points,
    value_at,
    y_range,
)
from app.editor.widgets import LEFT, RIGHT

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
        self.setAccessibleName("Curves")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.ci.layout.setContentsMargins(2, 4, 6, 2)
        self.drawing = Drawing("")
        self.shown: frozenset[str] = frozenset()
        self.pens: dict[str, QPen] = {}
        self.framed = True
        self._small = self.font()
        self._small.setPointSizeF(0.85 * self._small.pointSizeF())
        self._plots: list[pg.PlotItem] = []
        self._axes: list[tuple[str, str, bool, bool]] = []
        self._curves: list[dict[str, pg.PlotCurveItem]] = []
        self._spare: list[list[pg.PlotCurveItem]] = []
        self._cursors: list[pg.InfiniteLine] = []
        self._marks: list[PlotMark] = []
        self._ranges: _Ranges | None = None
        self._at: tuple[int, float, str] | None = None
        self.scene().sigMouseMoved.connect(self._mouse_moved)
        self.scene().sigMouseClicked.connect(self._clicked)
        self._take_colours()

    def _take_colours(self) -> None:
        self.theme = theme_of(self)
        self.setBackground(self.theme.base)
        self._make_plots(len(self.drawing.panels))
        self.show_drawing(self.drawing, self.shown)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if self.theme not in (None, theme_of(self)):
            self._take_colours()
            self.recoloured.emit()

    def show_drawing(self, drawing: Drawing, shown: Collection[str]) -> None:
        self.drawing = drawing
        self.pens = entry_pens(drawing.entries, theme_of(self))
        if len(drawing.panels) != len(self._plots):
            self._make_plots(len(drawing.panels))
        self._write_axes()
        self._take_curves()
        self.show_entries(shown)

    def show_entries(self, shown: Collection[str]) -> None:
        self.shown = frozenset(shown)
        for row, panel in enumerate(self.drawing.panels):
            for line in panel.lines:
                self._show_line(row, line)
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
        low, high = self._plots[0].getViewBox().viewRange()[along]
        return (10.0**low, 10.0**high) if self._is_log(along) else (low, high)

    def set_limits(self, along: bool, low: float, high: float) -> None:
        log = self._is_log(along)
        if low < high and (low > 0 or not log):
            box = self._plots[0].getViewBox()
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

    def _make_plots(self, count: int) -> None:
        self._read_nothing()
        self.ci.clear()
        self._plots, self._axes, self._cursors, self._marks = [], [], [], []
        self._ranges = None
        self._curves, self._spare = [{} for _ in range(count)], [[] for _ in range(count)]
        for row in range(count):
            axes = {side: PlotAxis(side) for side in ("left", "bottom")}
            plot = self.addPlot(row=row, col=0, axisItems=axes, enableMenu=False)
            bare(plot)
            paint_axes(plot, theme_of(self))
            plot.showGrid(x=True, y=True, alpha=0.12)
            plot.getAxis("left").setWidth(self.fontMetrics().averageCharWidth() * 9)
            plot.disableAutoRange()
            plot.getViewBox().sigRangeChangedManually.connect(self._seen_otherwise)
            plot.getViewBox().sigXRangeChanged.connect(self._follow_x)
            plot.getViewBox().sigResized.connect(self._follow_marks)
            self._plots.append(plot)
            cursor = pg.InfiniteLine(angle=90, pen=pg.mkPen(theme_of(self).accent))
            cursor.setVisible(False)
            plot.addItem(cursor)
            self._cursors.append(cursor)

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
        for plot, (across, along, log_x, log_y) in zip(self._plots, axes, strict=True):
            plot.setLabel("left", along)
            plot.setLabel("bottom", across)
            for side in ("left", "bottom"):
                plot.getAxis(side).setLogMode(log_x, log_y)

    def _take_curves(self) -> None:
        """Have an item for each line, in its pen; what others leave is used again.

        To make one takes longer than to draw it.
        """
        behind = {
            entry.name: 1 if entry.bound or entry.of else 2 if entry.total else 3
            for entry in self.drawing.entries
        }
        rows = zip(self.drawing.panels, self._plots, self._curves, self._spare, strict=True)
        for panel, plot, curves, spare in rows:
            for name in curves.keys() - {line.name for line in panel.lines}:
                spare.append(curves.pop(name))
                spare[-1].setVisible(False)
            for number, line in enumerate(panel.lines):
                curve = curves.get(line.name)
                if curve is None and spare:
                    curve = spare.pop()
                elif curve is None:
                    curve = pg.PlotCurveItem()
                    plot.getViewBox().addItem(curve)
                curves[line.name] = curve
                if curve.opts["pen"] != (pen := self.pens[line.name]):
                    curve.setPen(pen)
                curve.setZValue(behind[line.name] + 1e-3 * number)

    def _follow_marks(self, *_: object) -> None:
        along = self.drawing.x_range
        marks = [
            mark
            for mark in self.drawing.marks
            if along is not None and along[0] <= mark.x <= along[1] * (1 + 1e-9)
        ]
        while self._plots and len(self._marks) < len(marks):
            high = len(self._marks) % 2 == 1
            self._marks.append(PlotMark(self._plots, theme_of(self), self._small, high))
        for item, mark in zip_longest(self._marks, marks):
            if mark is None:
                item.hide()
            else:
                item.show_at(mark.x, mark.text)

    def _show_line(self, row: int, line: Line) -> None:
        """Draw a line, unless it is there: of a chain's curves an edit changes one or two."""
        curve = self._curves[row][line.name]
        curve.setVisible(line.name in self.shown)
        x, y = self.drawing.drawn_x(line.x), self.drawing.panels[row].drawn(line.y)
        if not same_points((curve.xData, curve.yData), (x, y)):
            curve.setData(x, y, connect="finite")

    def _whole(self) -> _Ranges:
        """Abscissae of all panels, and ordinates of each, that show all of the curves."""
        ordinates = tuple(y_range(panel, self.shown) for panel in self.drawing.panels)
        return self.drawing.x_range, ordinates

    def _frame(self, whole: _Ranges) -> None:
        self._ranges = whole
        along, ordinates = whole
        for plot, ordinate in zip(self._plots, ordinates, strict=True):
            if along is not None:
                plot.setXRange(*along, padding=0.02)
            plot.setYRange(*ordinate, padding=0.0)

    def _follow_x(self, moved: pg.ViewBox, along: tuple[float, float]) -> None:
        """Show the same abscissae in all panels; pyqtgraph's own link shifts them by some dots."""
        for plot in self._plots:
            box = plot.getViewBox()
            if box is not moved and tuple(box.viewRange()[0]) != tuple(along):
                box.blockSignals(True)
                box.setXRange(*along, padding=0.0)
                box.blockSignals(False)
                plot.getAxis("bottom").linkedViewChanged(box)

    def _seen_otherwise(self) -> None:
        self.framed, self._ranges = False, None

    def _mouse_moved(self, point: QPointF) -> None:
        for index, plot in enumerate(self._plots):
            box = plot.getViewBox()
            if box.sceneBoundingRect().contains(point):
                place = box.mapSceneToView(point)
                line = self._nearest(index, place.x(), point.y())
                if line is not None:
                    self._read(index, place.x(), line.name)
                    return
        self._read_nothing()

    def _nearest(self, index: int, x: float, height: float) -> Line | None:
        box, panel = self._plots[index].getViewBox(), self.drawing.panels[index]
        nearest: tuple[float, Line] | None = None
        for line in self._lines(index):
            value = value_at(line, self.drawing.x_at(x))
            if value is None or not np.isfinite(value := float(panel.drawn(np.array(value)))):
                continue
            far = abs(box.mapViewToScene(QPointF(x, value)).y() - height)
            if nearest is None or far < nearest[0]:
                nearest = far, line
        return nearest[1] if nearest else None

    def _lines(self, index: int) -> list[Line]:
        if index >= len(self.drawing.panels):
            return []
        return [line for line in self.drawing.panels[index].lines if line.name in self.shown]

    def _step(self, sideways: int, lines: int) -> None:
        along = self.drawing.x_range
        index, x, name = self._at or (0, along[0] if along else 0.0, "")
        choice = self._lines(index)
        if along is None or not choice:
            return
        names = [line.name for line in choice]
        place = names.index(name) + lines if name in names else 0
        x += sideways * _STEP * (along[1] - along[0])
        self._read(index, min(along[1], max(along[0], x)), names[place % len(names)])

    def _read(self, index: int, x: float, name: str) -> None:
        line = next((line for line in self._lines(index) if line.name == name), None)
        place = self.drawing.x_at(x)
        value = None if line is None else value_at(line, place)
        if value is None:
            self._read_nothing()
            return
        self._at = index, x, name
        for cursor in self._cursors:
            cursor.setValue(x)
            cursor.setVisible(True)
        title = next(entry.title for entry in self.drawing.entries if entry.name == name)
        quantity, _, unit = self.drawing.panels[index].y_label.rstrip(")").partition(" (")
        _, _, x_unit = self.drawing.x_label.rstrip(")").partition(" (")
        what = f"{title}: " if quantity in title else f"{title}, {quantity}: "
        text = f"{place:.4g} {x_unit}".rstrip() + f"   {what}{value:.5g} {unit}".rstrip()
        self.read.emit(text.replace("-", "\N{MINUS SIGN}"))

    def _read_nothing(self) -> None:
        if self._at is not None:
            self._at = None
            for cursor in self._cursors:
                cursor.setVisible(False)
        self.read.emit("")


# A line that marks an abscissa in all panels of a plot, with its name in the first.


class PlotMark:
    def __init__(self, plots: Sequence[pg.PlotItem], theme: Theme, font: QFont, high: bool) -> None:
        self._lines: list[pg.InfiniteLine] = []
        for plot in plots:
            line = pg.InfiniteLine(angle=90, pen=mark_pen(theme))
            line.setZValue(5)
            plot.addItem(line)
            self._lines.append(line)
        # Upright beside the line, on its left: on the right the plot may end. Every other one is
        # at the upper end: two may be a few dots apart.
        end = 1.0 if high else 0.0
        self._label = pg.InfLineLabel(
            self._lines[0],
            "",
            position=0.97 if high else 0.03,
            rotateAxis=(1, 0),
            anchors=[(end, 1), (end, 1)],
            color=theme.text,
            fill=see_through(theme.base, 190),
        )
        self._label.setFont(font)

    def show_at(self, frequency: float, name: str) -> None:
        """With its name where the plot is high enough for it."""
        for line in self._lines:
            line.setValue(frequency)
            line.setVisible(True)
        text = f"{name} {frequency:.4g}"
        room = 0.97 * self._lines[0].getViewBox().height()
        if QFontMetrics(self._label.textItem.font()).horizontalAdvance(text) > room:
            text = f"{frequency:.4g}"
        if text != self._label.format:
            self._label.setFormat(text)

    def hide(self) -> None:
        """It stays in the plot: to take lines with names out may crash."""
        for line in self._lines:
            line.setVisible(False)


_NAMES = 0.45  # of the width, at most, for the names
_THICK = 1.5  # lines of text that a bar is high at most
_GAP = 6
_ROUNDED = 2  # dots that a text may be wider than the whole number Qt returns


class BarChart(QScrollArea):
    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Bars")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._bars = _Bars(self)
        self.setWidget(self._bars)

    def show_drawing(
        self, drawing: Drawing, shown: Collection[str], pens: Mapping[str, QPen]
    ) -> None:
        self._bars.drawing = drawing
        self._bars.pens = pens
        self.show_entries(shown)

    def show_entries(self, shown: Collection[str]) -> None:
        self._bars.shown = frozenset(shown)
        self._bars.setMinimumHeight(self._bars.least_height())
        self._bars.update()
        self.setAccessibleDescription("; ".join(self._bars.descriptions()))


class _Bars(QWidget):
    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.drawing = Drawing("")
        self.shown: frozenset[str] = frozenset()
        self.pens: Mapping[str, QPen] = {}

    def descriptions(self) -> list[str]:
        return [
            f"{name}: {', '.join(_text(line.y, place) for line in self._lines())}"
            for place, name in enumerate(self.drawing.bars)
        ]

    def least_height(self) -> int:
        """That leaves each bar a line of text."""
        line = self.fontMetrics().height()
        groups = len(self.drawing.bars) * (max(1, len(self._lines())) * line + _GAP)
        return groups + 2 * line

    def sizeHint(self) -> QSize:
        return QSize(60 * self.fontMetrics().averageCharWidth(), self.least_height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().base())
        lines, names = self._lines(), self.drawing.bars
        if not names or not self.drawing.panels:
            return
        metrics = self.fontMetrics()
        text = metrics.height()
        values = [_text(line.y, place) for line in lines for place in range(len(names))]
        before = min(
            max(metrics.horizontalAdvance(name) for name in names) + _ROUNDED,
            int(_NAMES * self.width()),
        )
        behind = max((metrics.horizontalAdvance(value) for value in values), default=0) + 2 * _GAP
        panel = self.drawing.panels[0]
        drawn = [panel.drawn(line.y) for line in lines]
        low, high, zero = _range(drawn, panel.log)
        left = before + 2 * _GAP + (behind if low < zero else 0)
        wide = max(self.width() - left - behind, 1)
        group_height = (self.height() - 2.0 * text) / len(names)
        alone = _each_alone([line.y for line in lines], len(names))
        beside = 1 if alone else max(1, len(lines))
        thick = min((group_height - _GAP) / beside, _THICK * text)

        def at(value: float) -> float:
            return left + wide * (value - low) / (high - low)

        for place, name in enumerate(names):
            top = place * group_height + (group_height - thick * beside) / 2
            group = QRectF(_GAP, place * group_height, before, group_height)
            painter.setPen(self.palette().text().color())
            shown = metrics.elidedText(name, Qt.TextElideMode.ElideMiddle, before)
            painter.drawText(group, RIGHT, shown)
            pairs = list(zip(lines, drawn, strict=True))
            if alone:
                pairs = sorted(pairs, key=lambda pair: _at(pair[0].y, place) == 0.0)[:1]
            for number, (line, heights) in enumerate(pairs):
                box = QRectF(0, top + number * thick, self.width(), thick)
                value = _at(heights, place)
                end = at(min(max(value, low), high)) if math.isfinite(value) else at(zero)
                bar = QRectF(at(zero), box.top(), end - at(zero), thick).normalized()
                if math.isfinite(value):
                    painter.fillRect(bar.adjusted(0, 1, 0, -1), self.pens[line.name].color())
                label = _text(line.y, place)
                if end < at(zero):
                    box.setRight(bar.left() - _GAP)
                    painter.drawText(box, RIGHT, label)
                else:
                    box.setLeft(bar.right() + _GAP)
                    painter.drawText(box, LEFT, label)
        painter.setPen(self.palette().mid().color())
        painter.drawLine(round(at(zero)), 0, round(at(zero)), round(group_height * len(names)))
        painter.setPen(self.palette().text().color())
        foot = QRectF(0, self.height() - 1.6 * text, self.width(), 1.6 * text)
        foot.setLeft(min(left, self.width() - metrics.horizontalAdvance(panel.y_label) - _GAP))
        painter.drawText(foot, LEFT, panel.y_label + (", logarithmic" if panel.log else ""))

    def _lines(self) -> list[Line]:
        return [
            line
            for panel in self.drawing.panels[:1]
            for line in panel.lines
            if line.name in self.shown
        ]


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


def _at(heights: Vector, place: int) -> float:
    return float(heights[place]) if place < len(heights) else math.nan


def _each_alone(lines: Sequence[Vector], count: int) -> bool:
    """Whether each bar belongs to one line, as of temporal and fixed noise a source makes one."""
    values = [[_at(line, place) for line in lines] for place in range(count)]
    return len(lines) > 1 and all(sum(value != 0.0 for value in group) <= 1 for group in values)


def _text(heights: Vector, place: int) -> str:
    value = _at(heights, place)
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "\N{MINUS SIGN}∞"
    return f"{value:.4g}".replace("e-0", "e-").replace("-", "\N{MINUS SIGN}")
