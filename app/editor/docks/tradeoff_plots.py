"""A trade-off's parameter with its range, and small charts of figures over it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from PySide6 import QtGui
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtWidgets import QComboBox, QCompleter, QGridLayout, QLineEdit, QWidget

from app.editor.declared_text import label_of, shown_number, tip, titled
from app.editor.panels.chart import Chart, ChartWidget, ordinate_ticks, room_for_ticks
from app.editor.panels.fields.number import LARGEST_WHOLE_RANGE, Scale, scale_of
from app.editor.session import Session
from app.editor.viewers.plot.plotted_lines import Line
from app.editor.viewers.viewer import VALUE, NodeChoice, entry
from app.editor.widgets import centred_hint, filled, is_escape, labelled, show_or_hide
from app.run.overrides import MOST, OPTION, Variation, is_number, spaced, variation
from app.run.transfer_chain import ANALYSIS
from core.editing.operations import set_parameter
from core.errors import ParameterError, UsageError, thaw
from core.modules.parameters import Parameter, plain
from core.modules.preview import Axis
from core.network.network import MACRO
from core.records import dataclass

DECADES_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
FAINTEST = 1e-9  # of the largest value: what is below is not resolved
_MOST_DOTS = 40
_LINES = 5.5  # of text, the least height of a chart
_WIDE = 11  # lines of text, the least width of a chart beside others
_STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_PageUp: 10, Qt.Key.Key_PageDown: -10}


Graph = tuple[str, Line]  # with its title


class FigureChart(ChartWidget):
    """A figure over the parameter, with the mark at its present value."""

    def __init__(self, plots: TradeOffPlots) -> None:
        super().__init__(width=_WIDE, height=_LINES, parent=plots)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.plots = plots
        self.frame = QRectF()

    def minimumSizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(10 * line, round(_LINES * line))

    def draw(self, painter: QtGui.QPainter, area: QRectF) -> None:
        plots = self.plots
        index, span = plots.charts.index(self), plots.span
        if span is None:
            return
        graph = plots.graphs[index]
        line = graph[1]
        metrics = QtGui.QFontMetricsF(painter.font())
        rows = (ordinate_ticks(_ordinate(each), area.height(), metrics) for each in plots.graphs)
        left = max(room_for_ticks(ticks, metrics) for ticks in rows)  # so that frames line up
        title = plots.label if index + plots.across >= len(plots.graphs) else ""
        x = Axis(span.low, span.high, title, log=span.log)
        chart = Chart(painter, area, x, _ordinate(graph), self.theme, left=left)
        colour, frame = self.theme.curves[index % len(self.theme.curves)], chart.frame
        chart.curve(line.x, line.y, colour)
        if len(line.x) <= _MOST_DOTS:
            known = np.isfinite(line.y)
            chart.dots(line.x[known], line.y[known], colour, 2.0)
        if plots.mark is not None and span.low <= plots.mark <= span.high:
            place = frame.left() + span.share(plots.mark) * frame.width()
            painter.setPen(QtGui.QPen(QtGui.QColor(self.theme.accent), 2.0))
            painter.drawLine(QPointF(place, frame.top()), QPointF(place, frame.bottom()))
        self.frame = frame.translated(self.pos())


class TradeOffPlots(QWidget):
    moved = Signal(float)  # (value): the mark is dragged, or was put elsewhere by a click
    stepped = Signal(int)  # (steps): the mark is moved by the keys: so many small steps
    released = Signal()  # mouse or key is up
    given_up = Signal()  # Esc during a drag
    pointed = Signal(float)  # (value): the mouse is at this abscissa; NaN where it is at none
    _dragged: FigureChart | None = None

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "tradeoff.plots", "Figures of merit; arrow keys change the parameter")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setAutoFillBackground(True)
        self.setBackgroundRole(QtGui.QPalette.ColorRole.Base)
        self.graphs: tuple[Graph, ...] = ()
        self.span: Span | None = None
        self.mark: float | None = None
        self.label = ""
        self.across = 1
        self.charts: list[FigureChart] = []
        self._hint = centred_hint("", self)
        self._grid = filled(QGridLayout(self), self._hint, spacing=0)

    def show_graphs(self, graphs: Sequence[Graph], span: Span | None, label: str) -> None:
        self.graphs, self.span, self.label = tuple(graphs) if span else (), span, label
        while len(self.charts) > len(self.graphs):
            chart = self.charts.pop()
            chart.hide()  # Qt may paint it once more before it is deleted
            chart.deleteLater()
        while len(self.charts) < len(self.graphs):
            self.charts.append(FigureChart(self))
        self._place_charts()
        self.update()

    def show_mark(self, value: float | None) -> None:
        if value != self.mark:
            self.mark = value
            self.update()

    def show_hint(self, text: str) -> None:
        show_or_hide(self._hint, text)

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        super().resizeEvent(event)
        self._place_charts()

    def _place_charts(self) -> None:
        """Beside one another as many as are wide enough and fill their rows."""
        count = max(1, len(self.charts))
        fitting = max(1, min(count, self.width() // (_WIDE * self.fontMetrics().height())))
        self.across = -(-count // -(-count // fitting))
        for index, chart in enumerate(self.charts):
            self._grid.addWidget(chart, *divmod(index, self.across))

    def event(self, event: QEvent) -> bool:
        if self._dragged is not None and is_escape(event):
            self._dragged = None
            self.given_up.emit()
            event.accept()
        return bool(super().event(event))

    def mousePressEvent(self, event: QtGui.QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._dragged = self._chart_at(event.position())
            self._drag(event.position())

    def mouseMoveEvent(self, event: QtGui.QMouseEvent) -> None:
        self._drag(event.position())
        chart = self._chart_at(event.position())
        self.pointed.emit(math.nan if chart is None else self._value(chart, event.position()))

    def mouseReleaseEvent(self, event: QtGui.QMouseEvent) -> None:
        if self._dragged is not None and event.button() == Qt.MouseButton.LeftButton:
            self._dragged = None
            self.released.emit()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.pointed.emit(math.nan)

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        steps = _STEPS.get(Qt.Key(event.key()))
        if steps is None:
            super().keyPressEvent(event)
            return
        far = 10 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        self.stepped.emit(steps * far)

    def keyReleaseEvent(self, event: QtGui.QKeyEvent) -> None:
        super().keyReleaseEvent(event)
        if event.key() in _STEPS and not event.isAutoRepeat():
            self.released.emit()

    def _chart_at(self, point: QPointF) -> FigureChart | None:
        return next((chart for chart in self.charts if chart.frame.contains(point)), None)

    def _value(self, chart: FigureChart, point: QPointF) -> float:
        assert self.span is not None
        return float(self.span.value_at((point.x() - chart.frame.left()) / chart.frame.width()))

    def _drag(self, point: QPointF) -> None:
        if self._dragged is not None:
            self.moved.emit(self._value(self._dragged, point))


def _ordinate(graph: Graph) -> Axis:
    """Decades where the values span many, else from least to greatest with some room."""
    title, line = graph
    values = line.y[np.isfinite(line.y)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    if low > 0 and high > DECADES_FROM * low:
        return Axis(max(low, FAINTEST * high) / 1.2, high * 1.2, title, log=True)
    room = 0.08 * (high - low)
    if high - low <= 1e-6 * max(abs(low), abs(high)):  # rounding is not to fill the chart
        room = 0.1 * abs(high) or 1.0
    return Axis(low - room, high + room, title)


PART = 8  # values in one query: it starts anew if an edit comes
NEAR = 0.2  # of a declared range: below that share of its end it would hide what happens
LOG_FROM = 3000.0  # the end of a range over its beginning, from which on its steps are factors
DEFAULT_COUNT = 25
MOST_COUNT = 201
RANGE = "FROM:TO:COUNT, or FROM:TO:COUNT:log for logarithmic steps"


@dataclass(frozen=True)
class Span(Scale):
    """A scale with so many values on it."""

    count: int = DEFAULT_COUNT

    @property
    def text(self) -> str:
        ends = f"{shown_number(self.low)}:{shown_number(self.high)}"
        return f"{ends}:{self.count}{':log' if self.log else ''}"

    def values(self) -> tuple[float | int, ...]:
        return spaced(self.low, self.high, self.count, log=self.log, whole=self.whole)


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


def typed_values(session: Session, target: str, text: str, most: int = MOST) -> Variation:
    """Values of a parameter, typed as ``--vary`` takes them."""
    try:
        given = f"{target}={text.replace(' ', '')}"
        return variation(given, session.plain, library=session.library, most=most)
    except UsageError as error:
        words = error.message.replace(f"{OPTION} ", "").replace("NODE.PARAM=", "")
        raise UsageError(words) from error


def typed_span(session: Session, varied: Varied, text: str) -> Span:
    values = typed_values(session, f"{varied.node}.{varied.name}", text, MOST_COUNT)
    parts = text.split(":")
    if len(parts) == 1:
        raise UsageError(f"{text!r:.40} is not a range: write {RANGE}")
    low, high = sorted(map(float, parts[:2]))
    whole = values.parameter.kind == "integer"
    return Span(low, high, values.log, whole, count=int(parts[2]))


def coarse_first(values: tuple[Any, ...]) -> tuple[tuple[Any, ...], ...]:
    """The values in parts: every fourth, then those halfway between, then the others."""
    order = [*values[::4], *values[2::4], *values[1::2]]
    return tuple(tuple(order[start : start + PART]) for start in range(0, len(order), PART))


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
        return self._session.parameter(self.node, self.name)

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

    def give_up(self) -> None:
        if self._gesture is not None:
            self._session.give_up(self._gesture)
            self._gesture = None

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
        self._field = QLineEdit(self, placeholderText=_NOTHING)
        self._field.setAccessibleName("search a parameter")
        self._field.editingFinished.connect(self._finish_typing)
        self.setMinimumContentsLength(27)  # Integration time of focal_plane (s)
        self.setLineEdit(self._field)  # which makes it editable
        self.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        completer = QCompleter(self.entries, self, maxVisibleItems=24)
        self.setCompleter(completer)
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        completer.setCompletionMode(QCompleter.CompletionMode.PopupCompletion)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        self.fill()

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

    def focusInEvent(self, event: QtGui.QFocusEvent) -> None:
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

    def groups(self) -> Iterable[tuple[str, Sequence[QtGui.QStandardItem]]]:
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


def _entry(node: str, parameter: Parameter) -> QtGui.QStandardItem:
    unit = f" ({parameter.param.unit})" if parameter.param.unit else ""
    name = f"{node}.{parameter.name}"
    text = f"{label_of(parameter.name)} of {node}{unit}"
    return entry(text, name, tip(f"{parameter.param.text}\nIn network files: {name}"))
