"""Small charts of figures over one parameter, with a mark at its present value to be dragged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFontMetricsF,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QResizeEvent,
)
from PySide6.QtWidgets import QWidget

from app.editor.docks.tradeoff_ranges import Span
from app.editor.panels.chart import Chart, ordinate_ticks, room_for_ticks
from app.editor.theme import theme_of
from app.editor.widgets import labelled
from core.modules.preview import Axis

Vector = NDArray[np.float64]
LOG_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
FAINTEST = 1e-9  # of the largest value: what is below is not resolved
_MOST_DOTS = 40
_ABOVE = 2.0  # dots free above a chart
_LINES = 5.5  # of text, the least height of a chart
_STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_PageUp: 10, Qt.Key.Key_PageDown: -10}


@dataclass(frozen=True, eq=False)
class Graph:
    name: str
    title: str
    x: Vector
    y: Vector


class TradeOffPlots(QWidget):
    """Charts side by side and below one another, all over the same abscissae."""

    moved = Signal(float)  # (value): the mark is dragged, or was put elsewhere by a click
    stepped = Signal(int)  # (steps): the mark is moved by the keys: so many small steps
    released = Signal()  # mouse or key is up
    pointed = Signal(float)  # (value): the mouse is at this abscissa; NaN where it is at none

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "tradeoff.plots", "Figures of merit; arrow keys move the parameter")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.graphs: tuple[Graph, ...] = ()
        self.span: Span | None = None
        self.mark: float | None = None
        self._label, self._hint = "", ""
        self._frames: list[QRectF] = []
        self._dragged = False

    def show_graphs(self, graphs: Sequence[Graph], span: Span | None, label: str) -> None:
        self.graphs, self.span, self._label = tuple(graphs), span, label
        self._make_room()
        self.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._make_room()

    def _make_room(self) -> None:
        """Leave each chart so high that it is read: what it stands in scrolls."""
        down = -(-len(self.graphs) // self._across()) if self.graphs else 1
        self.setMinimumHeight(round(down * _LINES * self.fontMetrics().height()))

    def show_mark(self, value: float | None) -> None:
        if value != self.mark:
            self.mark = value
            self.update()

    def show_hint(self, text: str) -> None:
        if text != self._hint:
            self._hint = text
            self.setAccessibleDescription(text)
            self.update()

    def place(self, index: int, value: float) -> QPointF:
        """Where an abscissa lies, half the way up a chart that has been drawn."""
        frame = self._frames[index]
        assert self.span is not None
        return QPointF(frame.left() + self.span.share(value) * frame.width(), frame.center().y())

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(26 * line, 12 * line)

    def minimumSizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(10 * line, round(_LINES * line))

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme_of(self).base))
        self._frames = []
        if self.span is None or not self.graphs:
            painter.setPen(QColor(theme_of(self).faint_text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.rect().adjusted(8, 8, -8, -8), int(flags), self._hint)
            painter.end()
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        font = painter.font()
        font.setPointSizeF(0.9 * font.pointSizeF())
        painter.setFont(font)
        across = self._across()
        down = -(-len(self.graphs) // across)
        width, height = self.width() / across, self.height() / down
        left = self._room_for_ticks(height - _ABOVE, QFontMetricsF(font))
        for index, graph in enumerate(self.graphs):
            area = QRectF(index % across * width, index // across * height, width, height)
            lowest = index + across >= len(self.graphs)
            inside = area.adjusted(2, _ABOVE, -2, 0)
            self._paint(painter, inside, graph, index, left=left, lowest=lowest)
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        inside = self._frame_at(event.position()) is not None
        if event.button() == Qt.MouseButton.LeftButton and inside:
            self._dragged = True
            self._drag(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._dragged:
            self._drag(event.position())
        frame = self._frame_at(event.position())
        shape = Qt.CursorShape.ArrowCursor if frame is None else Qt.CursorShape.SplitHCursor
        self.setCursor(shape)
        self.pointed.emit(math.nan if frame is None else self._value(frame, event.position()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._dragged and event.button() == Qt.MouseButton.LeftButton:
            self._dragged = False
            self.released.emit()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.pointed.emit(math.nan)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = _STEPS.get(Qt.Key(event.key()))
        if steps is None:
            super().keyPressEvent(event)
            return
        far = 10 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        self.stepped.emit(steps * far)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        super().keyReleaseEvent(event)
        if event.key() in _STEPS and not event.isAutoRepeat():
            self.released.emit()

    def _across(self) -> int:
        line, count = self.fontMetrics().height(), len(self.graphs)
        most = max(1, min(count, self.width() // (11 * line)))

        def shape(across: int) -> float:
            down = -(-count // across)
            ratio = self.width() / across / (self.height() / down)
            return abs(math.log(ratio / 1.7)) + 0.1 * (across * down - count)

        return min(range(1, most + 1), key=shape)

    def _room_for_ticks(self, height: float, metrics: QFontMetricsF) -> float:
        """What all charts leave free at their left, so that their frames line up."""
        ticks = (ordinate_ticks(_ordinate(graph), height, metrics) for graph in self.graphs)
        return max(room_for_ticks(rows, metrics) for rows in ticks)

    def _paint(
        self,
        painter: QPainter,
        area: QRectF,
        graph: Graph,
        index: int,
        *,
        left: float,
        lowest: bool,
    ) -> None:
        span, theme = self.span, theme_of(self)
        assert span is not None
        x = Axis(span.low, span.high, self._label if lowest else "", log=span.log)
        painter.save()
        painter.translate(area.topLeft())
        room = QRectF(QPointF(), area.size())
        chart = Chart(painter, room, x, _ordinate(graph), theme, left=left)
        self._frames.append(chart.frame.translated(area.topLeft()))
        colour = theme.curves[index % len(theme.curves)]
        chart.curve(graph.x, graph.y, colour)
        known = np.isfinite(graph.y)
        alone = known & ~(np.append(False, known[:-1]) | np.append(known[1:], False))
        dots = known if len(graph.x) <= _MOST_DOTS else alone
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colour))
        for place, value in zip(graph.x[dots].tolist(), graph.y[dots].tolist(), strict=True):
            painter.drawEllipse(chart.at(place, value), 2.0, 2.0)
        frame = chart.frame
        gaps = [span.share(value) for value in graph.x[~known].tolist()]
        self._paint_gaps(painter, frame, gaps)
        if self.mark is not None and span.low <= self.mark <= span.high:
            place = frame.left() + span.share(self.mark) * frame.width()
            painter.setPen(QPen(QColor(theme.accent), 2.0))
            painter.drawLine(QPointF(place, frame.top()), QPointF(place, frame.bottom()))
        painter.restore()

    def _paint_gaps(self, painter: QPainter, frame: QRectF, shares: Sequence[float]) -> None:
        painter.setPen(QPen(QColor(theme_of(self).error), 1.4))
        for share in shares:
            x, foot = frame.left() + share * frame.width(), frame.bottom()
            for side in (-3.0, 3.0):
                painter.drawLine(QPointF(x - side, foot - 6.0), QPointF(x + side, foot))

    def _frame_at(self, point: QPointF) -> QRectF | None:
        return next((frame for frame in self._frames if frame.contains(point)), None)

    def _value(self, frame: QRectF, point: QPointF) -> float:
        assert self.span is not None
        return self.span.value_at((point.x() - frame.left()) / frame.width())

    def _drag(self, point: QPointF) -> None:
        """Below or above the charts the nearest one counts."""
        if self._frames:
            frame = self._frame_at(point) or min(
                self._frames, key=lambda candidate: abs(candidate.center().x() - point.x())
            )
            self.moved.emit(float(self._value(frame, point)))


def _ordinate(graph: Graph) -> Axis:
    """Decades where the values span many, else from least to greatest with some room."""
    values = graph.y[np.isfinite(graph.y)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    if low > 0 and high > LOG_FROM * low:
        return Axis(max(low, FAINTEST * high) / 1.2, high * 1.2, graph.title, log=True)
    room = 0.08 * (high - low)
    if high - low <= 1e-6 * max(abs(low), abs(high)):  # rounding is not to fill the chart
        room = 0.1 * abs(high) or 1.0
    return Axis(low - room, high + room, graph.title)
