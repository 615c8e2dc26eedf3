"""A trade-off's parameter with its range, and small charts of figures over it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QPalette, QResizeEvent, QStandardItem
from PySide6.QtWidgets import QComboBox, QCompleter, QGridLayout, QLineEdit, QWidget

from app.editor.declared_text import label_of, shown_number, tip, titled
from app.editor.docks.edges import DockChart
from app.editor.panels.fields.number import LARGEST_WHOLE_RANGE, scale_of
from app.editor.session import Session
from app.editor.theme import theme_of
from app.editor.viewers.plot.plot_looks import thick
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

Vector = NDArray[np.float64]
DECADES_FROM = 100.0  # the largest over the smallest value, from which on decades are shown
FAINTEST = 1e-9  # of the largest value: what is below is not resolved
_MOST_DOTS = 40
_LINES = 5.5  # of text, the least height of a chart
_SCALE = 4.2  # lines of text that the numbers of an ordinate have room in
_WIDE = 11  # lines of text, the least width of a chart beside others
_STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_PageUp: 10, Qt.Key.Key_PageDown: -10}


@dataclass(frozen=True, eq=False)
class Graph:
    name: str
    title: str
    x: Vector
    y: Vector


class FigureChart(DockChart):
    """A figure over the parameter, with a line at its present value that can be dragged."""

    def __init__(self, plots: TradeOffPlots) -> None:
        super().__init__(plots, _WIDE, _LINES)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # a click gives it to all of them
        self.getAxis("left").setWidth(_SCALE * self.fontMetrics().height())  # so frames line up
        self.plots = plots
        self._look: tuple[object, ...] = ()
        self.curve = self.plot(
            antialias=True, connect="finite", symbol="o", symbolSize=4, symbolPen=None
        )
        self.line = pg.InfiniteLine(movable=True)
        self.addItem(self.line, ignoreBounds=True)
        self.line.sigDragged.connect(lambda line: plots.moved.emit(self._value(line.value())))
        self.line.sigPositionChangeFinished.connect(plots.released)
        self.scene().sigMouseMoved.connect(self._point)
        self.scene().sigMouseClicked.connect(self._click)

    def show_graph(self, graph: Graph, span: Span, label: str, colour: str) -> None:
        axes = (Axis(span.low, span.high, label, log=span.log), _ordinate(graph))
        if (look := (*axes, colour, self.theme)) != self._look:  # to lay it out takes long
            self._look = look
            self._name_and_range(*axes)
            self.curve.setPen(thick(colour, 2))
            self.line.setPen(thick(self.theme.accent, 2))
            self.line.setHoverPen(thick(self.theme.changed, 3))
        self.curve.setSymbolBrush(colour if len(graph.x) <= _MOST_DOTS else None)
        there = slice(None if np.isfinite(graph.y).any() else 0)  # NaN alone has no bounds
        self.curve.setData(graph.x[there], graph.y[there])
        self.show_mark()

    def _name_and_range(self, *axes: Axis) -> None:
        ends = [np.log10((one.low, one.high)) if one.log else (one.low, one.high) for one in axes]
        self.setLogMode(*(one.log for one in axes))
        self.setRange(xRange=ends[0], yRange=ends[1], padding=0.0)
        self.setLabel("bottom", axes[0].title)
        size = f"{self.font().pointSizeF()}pt"
        self.setTitle(axes[1].title, size=size, color=self.theme.text)
        self.plotItem.layout.setRowFixedHeight(0, self.fontMetrics().height())
        self.line.setBounds(ends[0])

    def show_mark(self) -> None:
        span, mark = self.plots.span, self.plots.mark
        shown = span is not None and mark is not None and span.low <= mark <= span.high
        self.line.setVisible(shown)
        if shown:
            self.line.setValue(math.log10(mark) if span.log else mark)  # type: ignore[union-attr, arg-type]

    def _value(self, place: float) -> float:
        span = self.plots.span
        assert span is not None
        return float(span.value_at(span.share(10.0**place if span.log else place)))

    def _value_at(self, scene: QPointF) -> float:
        """The value at a point of the scene; NaN beside the frame."""
        box = self.getViewBox()
        inside = box.sceneBoundingRect().contains(scene)
        return self._value(box.mapSceneToView(scene).x()) if inside else math.nan

    def _point(self, scene: QPointF) -> None:
        self.plots.pointed.emit(self._value_at(scene))

    def _click(self, event: Any) -> None:
        value = self._value_at(event.scenePos())
        if event.button() is Qt.MouseButton.LeftButton and math.isfinite(value):
            self.plots.moved.emit(value)
            self.plots.released.emit()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.plots.pointed.emit(math.nan)


class TradeOffPlots(QWidget):
    moved = Signal(float)  # (value): the mark is dragged, or was put elsewhere by a click
    stepped = Signal(int)  # (steps): the mark is moved by the keys: so many small steps
    released = Signal()  # mouse or key is up
    given_up = Signal()  # Esc during a drag
    pointed = Signal(float)  # (value): the mouse is at this abscissa; NaN where it is at none

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.graphs: tuple[Graph, ...] = ()
        self.span: Span | None = None
        self.mark: float | None = None
        self.label = ""
        self.across = 1
        self.charts: list[FigureChart] = []
        labelled(self, "tradeoff.plots", "Figures of merit; arrow keys change the parameter")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAutoFillBackground(True)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self._hint = centred_hint("", self)
        self._grid = filled(QGridLayout(self), self._hint, spacing=0)

    def show_graphs(self, graphs: Sequence[Graph], span: Span | None, label: str) -> None:
        self.graphs, self.span, self.label = tuple(graphs) if span else (), span, label
        while len(self.charts) > len(self.graphs):
            self.charts.pop().deleteLater()
        while len(self.charts) < len(self.graphs):
            self.charts.append(FigureChart(self))
        self._place_charts()

    def show_mark(self, value: float | None) -> None:
        if value != self.mark:
            self.mark = value
            for chart in self.charts:
                chart.show_mark()

    def show_hint(self, text: str) -> None:
        show_or_hide(self._hint, text)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._place_charts()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_grid"):
            self._place_charts()

    def _place_charts(self) -> None:
        """Beside one another as many as are wide enough and fill their rows."""
        count, colours = max(1, len(self.charts)), theme_of(self).curves
        fitting = max(1, min(count, self.width() // (_WIDE * self.fontMetrics().height())))
        self.across = -(-count // -(-count // fitting))
        for index, (chart, graph) in enumerate(zip(self.charts, self.graphs, strict=True)):
            self._grid.addWidget(chart, *divmod(index, self.across))
            label = self.label if index + self.across >= len(self.graphs) else ""
            if self.span is not None:
                chart.show_graph(graph, self.span, label, colours[index % len(colours)])

    def event(self, event: QEvent) -> bool:
        for chart in self.charts if is_escape(event) else ():
            if chart.line.moving:
                chart.line.moving = False
                self.given_up.emit()
                event.accept()
        return bool(super().event(event))

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


PART = 8  # values in one query: it starts anew if an edit comes
NEAR = 0.2  # of a declared range: below that share of its end it would hide what happens
LOG_FROM = 3000.0  # the end of a range over its beginning, from which on its steps are factors
DEFAULT_COUNT = 25
MOST_COUNT = 201
RANGE = "FROM:TO:COUNT, or FROM:TO:COUNT:log for logarithmic steps"


@dataclass(frozen=True)
class Span:
    """From one number to a greater one, in equal steps or factors."""

    low: float
    high: float
    log: bool = False
    whole: bool = False
    count: int = DEFAULT_COUNT

    @property
    def text(self) -> str:
        ends = f"{shown_number(self.low)}:{shown_number(self.high)}"
        return f"{ends}:{self.count}{':log' if self.log else ''}"

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
    return Span(low, high, values.log, values.parameter.kind == "integer", int(parts[2]))


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
