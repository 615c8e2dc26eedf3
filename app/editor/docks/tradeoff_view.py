"""The trade-off dock: figures of merit as a parameter moves, following every edit."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QFrame, QScrollArea, QVBoxLayout, QWidget, QWidgetAction

from app.editor.declared_text import label_of, shown_figure, shown_number
from app.editor.docks import tradeoff_plots
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.panels.fields.type_in import TypeIn
from app.editor.session import Session, followed_name, renamed_node
from app.editor.viewers.plot.plot_export import KINDS, have_plot_menu, save_plot
from app.editor.viewers.plot.plot_looks import CurveList, thick
from app.editor.viewers.plot.plotted_lines import Entry, Line, value_at
from app.editor.viewers.viewer import StatusLine, Viewer, ports_depend_on
from app.editor.widgets import FlowLayout, Menu, filled, labelled, menu_button, search_field
from app.run.overrides import Variation
from app.run.transfer_chain import SYSTEM, TOTAL
from app.tradeoff.tradeoff_results import (
    SENSORS,
    Figure,
    Point,
    Results,
    figures_of,
    makes_pixels,
    parameter_of,
    points_at,
)
from core.chain.engine import Plan
from core.errors import ImagechainError, UsageError
from core.evaluation.recipes import Store
from core.evaluation.work import Work
from core.modules.preview import signed
from core.network.network import Network
from core.records import dataclass

if TYPE_CHECKING:
    from app.editor.evaluation.evaluator import Evaluator

_HINT = "Choose a parameter above, or right-click a value on a control panel and choose Trade off…"
_HOW = "To change the value, drag the line or press ← and →"


class TradeOffView(Viewer):
    room = 75, 20
    export_kinds = KINDS

    def __init__(self, session: Session, evaluator: Evaluator) -> None:
        super().__init__(session, evaluator, "tradeoff")
        self.setAccessibleName("Trade-off")
        self.varied = tradeoff_plots.Varied(session, self._refuse)
        self.span: tradeoff_plots.Span | None = None
        self.figures: dict[str, Figure] = {}
        self.points: dict[Any, Point] = {}
        self._chosen: frozenset[str] | None = None
        self._state: Hashable = None
        self._known: Hashable = None
        self._build()
        self._follow_nodes()

    @property
    def shown(self) -> tuple[Figure, ...]:
        chosen = self._chosen
        if chosen is None:
            chosen = first_figures(self.session.network, self.figures, self.varied.analysis)
        return tuple(figure for name, figure in self.figures.items() if name in chosen)

    def trade_off(self, node: str, name: str) -> None:
        self.varied.choose(node, name)
        parameter = self.varied.parameter
        if parameter is None:
            self.varied.choose()
        self.span = tradeoff_plots.usual_span(parameter, self.varied.present) if parameter else None
        self._begin()

    def set_span(self, span: Any) -> None:
        self.span = span
        self._begin()

    def show_figure(self, name: str, on: bool) -> None:
        chosen = {figure.text for figure in self.shown}
        self._chosen = frozenset(chosen | {name} if on else chosen - {name})
        self._fill_list()
        self._draw()
        self.ask()

    def export(self, path: Path) -> None:
        if not (numbers := self._numbers()):
            raise UsageError("the trade-off has no curves to save")
        save_plot(self.plots, numbers, path)

    def _numbers(self) -> str:
        from app.study.study_drawing import csv_text

        parameter, span = self.varied.parameter, self.span
        if parameter is None or span is None or not self.points:
            return ""
        points = tuple(self.points[value] for value in sorted(self.points))
        varied = Variation(self.varied.node, parameter, tuple(sorted(self.points)), span.log)
        return csv_text(Results(self.session.network.name, (varied,), self.shown, points))

    def queries(self) -> tuple[Query, ...]:
        if self.span is None or not self.shown:
            return ()
        varied, parts = self.varied, tradeoff_plots.coarse_first(self.span.values())
        return tuple(TradeOffQuery(varied.node, varied.name, part, self.shown) for part in parts)

    def take(self, answer: Answer) -> None:
        """Put points with those of the same network; with another one, all begins anew."""
        if answer.error is not None:
            self.status.show_text(str(answer.error), failed=True)
            return
        state, points = answer.value
        if state != self._state:
            self._state = state
            self.points.clear()
        self.points.update({point.values[0]: point for point in points})
        self._draw()

    def follow(self, before: Network, after: Network) -> None:
        renamed = renamed_node(before, after)
        if self._chosen is not None:
            split = (name.rpartition(".") for name in self._chosen)
            self._chosen = frozenset(f"{followed_name(a, renamed)}{dot}{b}" for a, dot, b in split)
        if (node := followed_name(self.varied.node, renamed)) != self.varied.node:
            self.varied.choose(node, self.varied.name)
        if ports_depend_on(after) != self._known:
            self._follow_nodes()
        self._show_mark()

    def follow_opening(self) -> None:
        self._chosen = None
        self.varied.choose()
        self.span = None
        self._follow_nodes()

    def _build(self) -> None:
        self.parameter = tradeoff_plots.ParameterChoice(self.session, self)
        labelled(self.parameter, "tradeoff.parameter", "Parameter to vary")
        self.range = labelled(
            TypeIn(self, characters=16), "tradeoff.range", "Range", tradeoff_plots.RANGE
        )
        self.choose = menu_button("tradeoff.choose", "Figures", "Choose the figures to show", self)
        self.choice = FigureMenu(self.choose)
        self.choose.setMenu(self.choice)
        bar = QWidget(self)
        parts = (self.parameter, self.range, self.choose)
        filled(FlowLayout(bar, across=4, down=2), *parts, margins=(2, 2, 2, 0))
        self.plots = tradeoff_plots.TradeOffPlots(self)
        self.list = self.choice.list
        self.status = StatusLine(
            self.owner, "Values that could not be computed", "Values there", self
        )
        scrolled = QScrollArea(self, frameShape=QFrame.Shape.NoFrame, widgetResizable=True)
        scrolled.setWidget(self.plots)
        filled(QVBoxLayout(self), bar, (scrolled, 1), self.status, spacing=1)
        self.plots.show_hint(_HINT)
        have_plot_menu(self.plots, self.session.message.emit, self._numbers)
        self.parameter.chosen.connect(self.trade_off)
        self.range.committed.connect(self._typed)
        self.range.given_up.connect(self._show_range)
        self.choice.aboutToShow.connect(self._open_list)
        self.list.toggled.connect(self.show_figure)
        self.plots.moved.connect(self.varied.move)
        self.plots.stepped.connect(self._step)
        self.plots.released.connect(self.varied.release)
        self.plots.given_up.connect(self.varied.give_up)
        self.plots.pointed.connect(self._read)

    def _begin(self) -> None:
        self.points.clear()
        self._state = None
        self.parameter.choose(self.varied.node, self.varied.name)
        self._show_range()
        self._show_mark()
        self._draw()
        self.evaluator.forget(self.owner)  # the same question may be asked again
        self.ask()

    def _show_range(self) -> None:
        self.range.setEnabled(self.span is not None)
        self.range.show_text("" if self.span is None else self.span.text)

    def _typed(self, text: str) -> None:
        try:
            self.set_span(tradeoff_plots.typed_span(self.session, self.varied, text))
        except ImagechainError as error:
            self.range.mark()
            self._refuse(error.message)

    def _follow_nodes(self) -> None:
        network = self.session.network
        self._known = ports_depend_on(network)
        self.figures = figures_of(network, self.session.library)
        if self.varied.parameter is None:
            self.varied.choose()
            self.span = None
        self._fill_list()
        self._begin()

    def _open_list(self) -> None:
        self.choice.search.clear()
        self._fill_list(opening=True)
        self.list.scroll_to_ticked()

    def _fill_list(self, *, opening: bool = False) -> None:
        if not opening and not self.choice.isVisible():
            return
        entries = [Entry(one.text, title_of(one)) for one in self.figures.values()]
        names = [figure.text for figure in self.shown]
        colours = self.theme.curves
        pens = {name: thick(colours[n % len(colours)], 2) for n, name in enumerate(names)}
        other = thick(self.theme.base, 2)
        self.list.fill(
            entries, names, {entry.name: pens.get(entry.name, other) for entry in entries}
        )
        self.choice.fit()

    def _draw(self) -> None:
        shown = self.shown
        if self.span is None:
            self.plots.show_graphs((), None, "")
            self.plots.show_hint(_HINT)
            self.status.show_text("")
            return
        self.plots.show_hint("" if shown else "No figure is selected")
        values = sorted(self.points)
        x = np.array(values, np.float64)
        graphs = []
        for figure in shown:
            numbers = [self.points[value].figures.get(figure.text, math.nan) for value in values]
            y = np.array(numbers, np.float64)
            y[~np.isfinite(y)] = np.nan
            alike = sum(other.name == figure.name for other in shown) > 1
            graphs.append((title_of(figure, whose=alike), Line(figure.text, x, y)))
        self.plots.show_graphs(graphs, self.span, self.varied.label)
        self._show_gaps()

    def _show_gaps(self) -> None:
        names = [figure.text for figure in self.shown]
        gaps = [
            next(reason for name, reason in point.reasons.items() if name in names)
            for _, point in sorted(self.points.items())
            if any(name in names for name in point.reasons)
        ]
        many = (
            f"figures are missing at {len(gaps)} of {len(self.points)} values: {gaps[0]}"
            if gaps
            else _HOW
        )
        self.status.show_text(many, failed=bool(gaps))

    def _show_mark(self) -> None:
        self.plots.show_mark(self.varied.present)

    def _step(self, steps: int) -> None:
        if self.span is not None:
            self.varied.step(self.span, steps)

    def _read(self, value: float) -> None:
        parts = []
        for title, line in self.plots.graphs:
            height = value_at(line, value)
            if height is not None:
                parts.append(f"{title.partition(' (')[0]} {shown_figure(height)}")
        place = f"{shown_number(value)}: {', '.join(parts)}" if parts else ""
        self.status.show_more(signed(place))

    def _refuse(self, text: str) -> None:
        self.status.show_text(text, failed=True)


# What the dock calls figures, and which it shows at first.

_FIRST = ("netd_system_K", "netd_K", "snr")
_RANGES = ("mrtd_x_K", "detection_range_km", "ttp_range_km")
_MOST_FIRST = 2


def title_of(figure: Figure, *, whose: bool = True) -> str:
    if figure.is_total:
        axis = "ξ" if figure.name.endswith("x") else "η"
        half, of = "½ " * ("half" in figure.name), "pixels" if "pixel" in figure.name else "samples"
        more = ", with electronics" if figure.node == SYSTEM else ""
        return f"MTF {axis}, {half}{of}' Nyquist{more}"
    unit = f" ({figure.unit})" if figure.unit else ""
    return f"{label_of(figure.name)}{f' of {figure.node}' if whose else ''}{unit}"


def first_figures(
    network: Network, known: Mapping[str, Figure], analysis: str = ""
) -> frozenset[str]:
    """What is shown until the person chooses: NETD, SNR and the MTF at the pixels' Nyquist.

    Where a network makes no pixels, it is the MTF at the samples' Nyquist.

    They do not hang on the parameters of an analysis node: where one of these is varied, it is
    that node's own figures.
    """
    own = [figure.text for figure in known.values() if figure.node == analysis]
    if own:
        ranges = [name for name in own if name.rpartition(".")[2] in _RANGES]
        return frozenset(ranges or own[:_MOST_FIRST])
    sensors = [node.id for node in network.nodes.values() if node.module in SENSORS][-1:]
    of = "pixel_" if makes_pixels(network) else ""
    names = {f"{node}.{name}" for node in sensors for name in _FIRST}
    names |= {f"{TOTAL}.mtf_{of}nyquist_x"}
    if not sensors:
        names |= {f"{TOTAL}.mtf_half_{of}nyquist_x"}
    return frozenset(names & {*known} or [*known][:_MOST_FIRST])


# The query of the trade-off dock: figures at some values of a parameter.


@dataclass(frozen=True)
class TradeOffQuery(Query):
    """Figures at some of the values, the coarsest first; nodes held back count as generated."""

    waits: ClassVar[bool] = True

    node: str
    parameter: str
    values: tuple[Any, ...]
    figures: tuple[Figure, ...]

    def key(self, plan: Plan) -> Hashable:
        """The question, and all that the figures depend on but the parameter that is varied."""
        return self, self._state(plan)

    def answer(self, passing: Passing) -> tuple[Hashable, list[Point]]:
        parameter_of(passing.plan.network, passing.engine, self.node, self.parameter)
        places = ((value,) for value in self.values)
        work = SideWork(passing.work)
        points = points_at(passing.engine, passing.plan, work, [self._varied], places, self.figures)
        return self._state(passing.plan), list(points)

    def _state(self, plan: Plan) -> Hashable:
        network = plan.network
        nodes = []
        for name, node in network.nodes.items():
            params = sorted((n, v) for n, v in node.params.items() if (name, n) != self._varied)
            nodes.append((name, node.module, node.disabled, repr(params), _files(plan, name)))
        links, final = network.links, repr(network.extra.get("final"))
        return tuple(nodes), links, network.seed, network.marked, final

    @property
    def _varied(self) -> tuple[str, str]:
        return self.node, self.parameter


def _files(plan: Plan, name: str) -> Hashable:
    """What a node that reads a file has found there: it may have changed meanwhile."""
    planned = plan.nodes.get(name)
    if planned is None or planned.module is None:
        return None
    if not any(isinstance(value, Path) for value in planned.module.values().values()):
        return None
    return tuple(getattr(value, "key", None) for value in planned.outputs.values())


# Work beside a pass: it takes what the pass's store holds, and leaves nothing there.
#
# The pictures of a trade-off would crowd out what the next edit of the network needs again.

SIDE_BYTES = 1 << 28


class SideStore(Store):
    """Finds values in another store too, and keeps its own to itself."""

    def __init__(self, base: Store) -> None:
        super().__init__(SIDE_BYTES)
        self._base = base

    def peek(self, key: str, default: Any = None) -> Any:
        value = super().peek(key, self)
        return self._base.peek(key, default) if value is self else value


class SideWork(Work):
    """An evaluation that stops when another one is to stop, and works in its threads."""

    def __init__(self, work: Work) -> None:
        super().__init__(work.policy, SideStore(work.store))
        self._work = work

    def check(self) -> None:
        self._work.check()

    def for_each(self, function: Callable[[Any], None], items: Sequence[Any]) -> None:
        self._work.for_each(function, items)


# All figures, to be ticked: those in whose names what is typed occurs.


_MOST_ROWS = 16


class FigureMenu(Menu):
    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.search = search_field("tradeoff.search", "Search figures", "Search figures", self)
        self.list = labelled(CurveList(self), "tradeoff.figures", "Figures to show")
        for widget in (self.search, self.list):
            action = QWidgetAction(self)
            action.setDefaultWidget(widget)
            self.addAction(action)
        self.search.textChanged.connect(self.narrow)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self.setActiveAction(self.actions()[0])  # from which Tab goes on to the list
        self.search.setFocus(Qt.FocusReason.PopupFocusReason)

    def fit(self) -> None:
        """Be as wide as the titles, and at most so many rows high."""
        frame, bar = 2 * self.list.frameWidth(), self.list.verticalScrollBar().sizeHint().width()
        rows = min(self.list.count(), _MOST_ROWS) * max(self.list.sizeHintForRow(0), 1)
        self.list.setFixedSize(self.list.sizeHintForColumn(0) + frame + bar + 4, rows + frame)
        self.narrow()

    def narrow(self) -> None:
        words = self.search.text().casefold().split()
        for item in map(self.list.item, range(self.list.count())):
            item.setHidden(not all(word in item.text().casefold() for word in words))
        if words:
            self.list.scrollToTop()
