"""A trade-off's parameter with its range, and small charts of figures over it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QFocusEvent,
    QFontMetricsF,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QResizeEvent,
    QStandardItem,
)
from PySide6.QtWidgets import QComboBox, QCompleter, QLineEdit, QWidget

from app.editor.declared_text import label_of, tip, titled
from app.editor.panels.chart import Chart, ordinate_ticks, room_for_ticks
from app.editor.panels.fields.number import LARGEST_WHOLE_RANGE, scale_of
from app.editor.session import Session
from app.editor.theme import theme_of
from app.editor.viewers.viewer import VALUE, NodeChoice, entry
from app.editor.widgets import labelled
from app.run.output import ANALYSIS
from app.tradeoff.values import is_number, spaced
from core.editing.operations import set_parameter
from core.errors import ParameterError
from core.modules.parameters import Parameter, plain
from core.modules.preview import Axis
from core.names import thaw
from core.network.network import MACRO

Vector = NDArray[np.float64]
DECADES_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
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
        for index in range(len(self.graphs)):
            area = QRectF(index % across * width, index // across * height, width, height)
            lowest = index + across >= len(self.graphs)
            inside = area.adjusted(2, _ABOVE, -2, 0)
            self._paint(painter, inside, index, left=left, lowest=lowest)
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
        """Charts beside one another: as many as are wide enough and fill their rows."""
        count = len(self.graphs)
        fitting = max(1, min(count, self.width() // (22 * self.fontMetrics().height())))
        return -(-count // -(-count // fitting)) if count else 1

    def _room_for_ticks(self, height: float, metrics: QFontMetricsF) -> float:
        """What all charts leave free at their left, so that their frames line up."""
        ticks = (ordinate_ticks(_ordinate(graph), height, metrics) for graph in self.graphs)
        return max(room_for_ticks(rows, metrics) for rows in ticks)

    def _paint(
        self, painter: QPainter, area: QRectF, index: int, *, left: float, lowest: bool
    ) -> None:
        graph = self.graphs[index]
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
        if len(graph.x) <= _MOST_DOTS:
            known = np.isfinite(graph.y)
            chart.dots(graph.x[known], graph.y[known], colour, 2.0)
        frame = chart.frame
        if self.mark is not None and span.low <= self.mark <= span.high:
            place = frame.left() + span.share(self.mark) * frame.width()
            painter.setPen(QPen(QColor(theme.accent), 2.0))
            painter.drawLine(QPointF(place, frame.top()), QPointF(place, frame.bottom()))
        painter.restore()

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
    if low > 0 and high > DECADES_FROM * low:
        return Axis(max(low, FAINTEST * high) / 1.2, high * 1.2, graph.title, log=True)
    room = 0.08 * (high - low)
    if high - low <= 1e-6 * max(abs(low), abs(high)):  # rounding is not to fill the chart
        room = 0.1 * abs(high) or 1.0
    return Axis(low - room, high + room, graph.title)


COARSE = 5
PART = 8  # values in one query: it starts anew if an edit comes
NEAR = 0.2  # of a declared range: below that share of its end it would hide what happens
LOG_FROM = 3000.0  # the end of a range over its beginning, from which on its steps are factors
DEFAULT_COUNT = 25
LEAST_COUNT, MOST_COUNT = 2, 201


@dataclass(frozen=True)
class Span:
    """From one number to a greater one, in equal steps or factors."""

    low: float
    high: float
    log: bool = False
    whole: bool = False
    count: int = DEFAULT_COUNT

    def values(self) -> tuple[float | int, ...]:
        return spaced(self.low, self.high, self.count, log=self.log, whole=self.whole)

    def share(self, value: float) -> float:
        """Where a number lies: 0 at the low end, 1 at the high one."""
        low, high, value = (self._scaled(number) for number in (self.low, self.high, value))
        return (value - low) / (high - low)

    def value_at(self, share: float) -> float | int:
        """The number at a place, with no more digits than it can be placed by."""
        share = min(max(share, 0.0), 1.0)
        low, high = self._scaled(self.low), self._scaled(self.high)
        value = low + share * (high - low)
        if self.log:
            value = float(f"{math.exp(value):.3g}")
        else:
            value = round(value, max(0, math.ceil(-math.log10((high - low) / 1000))))
        value = min(max(value, self.low), self.high)
        return round(value) if self.whole else value

    def _scaled(self, value: float) -> float:
        return math.log(max(value, 1e-300)) if self.log else value


def usual_span(parameter: Parameter, present: Any) -> Span:
    """A range to begin with: the declared one, else around the present value."""
    scale, param = scale_of(parameter), parameter.param
    whole = parameter.kind == "integer"
    bounded = param.low is not None and param.high is not None
    declared = param.slider is not None or (
        bounded and param.high - param.low <= LARGEST_WHOLE_RANGE  # type: ignore[operator]
    )
    value = float(present) if is_number(present) else 0.0
    near = NEAR * scale.high <= abs(value) and scale.low <= value <= scale.high
    if (declared and near) or not value:
        low, high = scale.low, scale.high
        if low <= 0 and _zero_is_empty(parameter):
            low = 1.0 if whole else scale.high / 100
        return Span(low, high, _spans_decades(low, high), whole)
    if _spans_decades(scale.low, scale.high) and value > 0:
        return _within(parameter, Span(value / 10, value * 10, log=True, whole=whole))
    start = 0.5 * value if _zero_is_empty(parameter) or param.above else 0.0
    low, high = sorted((start, 2.0 * value))
    return _within(parameter, Span(low, high, whole=whole))


def coarse_first(values: tuple[Any, ...]) -> tuple[tuple[Any, ...], ...]:
    """The values in parts: a few over the whole range, then those halfway between, and so on."""
    last = len(values) - 1
    done = sorted({round(number * last / (COARSE - 1)) for number in range(COARSE)})
    parts = [done]
    while len(done) <= last:
        between = [(a + b) // 2 for a, b in pairwise(done) if b - a > 1]
        parts += [between[start : start + PART] for start in range(0, len(between), PART)]
        done = sorted([*done, *between])
    return tuple(tuple(values[index] for index in part) for part in parts)


def _spans_decades(low: float, high: float) -> bool:
    return low > 0 and high / low >= LOG_FROM


def _zero_is_empty(parameter: Parameter) -> bool:
    return parameter.empty and parameter.param.zero_is_empty


def _within(parameter: Parameter, span: Span) -> Span:
    """Cut at the declared limits; whole numbers at least one apart."""
    low, high = span.low, span.high
    if span.whole:
        low = float(math.floor(low))
        if low == 0 and _zero_is_empty(parameter):
            low = 1.0
        high = float(max(math.ceil(high), low + 1))
    if parameter.param.low is not None:
        low = max(low, parameter.param.low)
    if parameter.param.high is not None:
        high = min(high, parameter.param.high)
    if span.log and low <= 0:
        low = high / 100
    return Span(low, high, span.log, span.whole) if low < high else span


# The parameter that is varied: its present value, and setting it by hand.

_STEP = 0.01  # of the range, for an arrow key


class Varied:
    def __init__(self, session: Session, refuse: Callable[[str], None]) -> None:
        self.node, self.name = "", ""
        self._session = session
        self._refuse = refuse
        self._gesture: object | None = None

    @property
    def parameter(self) -> Parameter | None:
        declared = self._session.declared(self.node)
        return declared.parameter(self.name) if declared is not None else None

    @property
    def analysis(self) -> str:
        """Its node where that is one of analysis, which the chain does not hang on; else empty."""
        declared = self._session.declared(self.node)
        return self.node if declared is not None and declared.group == ANALYSIS else ""

    @property
    def label(self) -> str:
        parameter = self.parameter
        unit = parameter.param.unit if parameter is not None else ""
        return label_of(self.name) + (f" ({unit})" if unit else "")

    @property
    def present(self) -> Any:
        """Its value as it stands; None where it is empty or not allowed."""
        parameter, node = self.parameter, self._session.resolved.node(self.node)
        if parameter is None or node is None:
            return None
        if self.name not in node.params:
            return None if parameter.required else parameter.default
        try:
            return parameter.coerce(thaw(node.params[self.name]))
        except ParameterError:
            return None

    def choose(self, node: str = "", name: str = "") -> None:
        self.release()
        self.node, self.name = node, name

    def move(self, value: float) -> None:
        """Set it; all until `release` is one step to undo."""
        parameter = self.parameter
        if parameter is None:
            return
        try:
            plain_value = plain(parameter.coerce(value))
        except ParameterError as error:
            self._refuse(error.message)
            return
        if plain_value is None or plain_value == self.present:
            return
        if why := self._session.follows(self.node, (self.name,)):
            self._refuse(why)
            return
        if self._gesture is None:
            self._gesture = object()
        self._session.do(set_parameter(self.node, self.name, plain_value), gesture=self._gesture)

    def step(self, span: Span, steps: int) -> None:
        """Move it by hundredths of a range, by one at least where it is whole."""
        present = self.present
        share = 0.0 if present is None else span.share(present)
        value = span.value_at(share + steps * _STEP)
        if span.whole and present is not None and value == present:
            value = min(max(present + steps, span.low), span.high)
        self.move(value)

    def release(self) -> None:
        if self._gesture is not None:
            self._gesture = None
            self._session.end_gesture()


# The choice of a number of the network, by node.

NUMERIC = ("number", "integer")
_NOTHING = "Choose a parameter"


class ParameterChoice(NodeChoice):
    chosen = Signal(str, str)  # (node, parameter): the person has chosen one

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, _NOTHING, parent)
        self._field = QLineEdit(self)
        self.setMinimumContentsLength(16)
        self._make_searchable()
        self.fill()

    def _make_searchable(self) -> None:
        self.setLineEdit(self._field)  # which makes it editable
        self.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        completer = QCompleter(self.entries, self)
        self.setCompleter(completer)
        field = self._field
        field.setPlaceholderText(_NOTHING)
        field.setAccessibleName("search a parameter")
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        completer.setCompletionMode(QCompleter.CompletionMode.PopupCompletion)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        completer.setMaxVisibleItems(24)
        field.editingFinished.connect(self._finish_typing)

    def _finish_typing(self) -> None:
        """Take a parameter by its words or its name in files; else show the chosen one again."""
        text = self._field.text().strip()
        place = self.findText(text, Qt.MatchFlag.MatchFixedString)
        if place < 0 and text:
            place = self.findData(text, VALUE)
        if place < 0 or not self.itemData(place, VALUE):
            self.setCurrentIndex(max(0, self.findData(self.value, VALUE)))
            self._field.setText(self.currentText())
        elif self.itemData(place, VALUE) != self.value:
            self.setCurrentIndex(place)
            self.take_at(place)

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        QTimer.singleShot(0, self._select_all)

    def _select_all(self) -> None:
        """Backwards, so that the beginning of a long name stays in sight."""
        end = len(self._field.text())
        self._field.setSelection(end, -end)

    def show_value(self, value: str) -> None:
        """From its beginning, which is the parameter: the field would show the end."""
        super().show_value(value)
        self._field.setCursorPosition(0)

    def choose(self, node: str, parameter: str) -> None:
        self.show_value(f"{node}.{parameter}" if node else "")

    def groups(self) -> Iterable[tuple[str, Sequence[QStandardItem]]]:
        for name in self.session.network.nodes:
            declared = self.session.declared(name)
            numbers = [p for p in declared.parameters if p.kind in NUMERIC] if declared else []
            if declared is not None and declared.key != MACRO and numbers:
                yield titled(name, declared.title), [_entry(name, number) for number in numbers]

    def take(self, value: str | None) -> None:
        if value:
            self.value = value
            node, _, parameter = value.rpartition(".")
            self.chosen.emit(node, parameter)
        else:
            self.setCurrentIndex(max(0, self.findData(self.value, VALUE)))


def _entry(node: str, parameter: Parameter) -> QStandardItem:
    unit = f" ({parameter.param.unit})" if parameter.param.unit else ""
    name = f"{node}.{parameter.name}"
    text = f"{label_of(parameter.name)} of {node}{unit}"
    return entry(text, name, tip(f"{parameter.param.text}\nIn network files: {name}"))
