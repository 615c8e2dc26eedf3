"""The trade-off dock: figures of merit as a parameter moves, following every edit."""

from __future__ import annotations

import math
from collections.abc import Hashable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.editor.evaluation.queries import Answer, Query
from app.editor.number_text import shown_figure, shown_number
from app.editor.session import Session, renamed_node
from app.editor.theme import Theme
from app.editor.tradeoff.bar import TradeOffBar
from app.editor.tradeoff.plots import Graph, TradeOffPlots
from app.editor.tradeoff.ranges import Span, coarse_first, usual_span
from app.editor.tradeoff.tradeoff_query import Part, TradeOffQuery
from app.editor.tradeoff.varied import Varied
from app.editor.tradeoff.wording import first_figures, in_order, listed_titles, renamed, title_of
from app.editor.viewers.network_ports import ports_depend_on
from app.editor.viewers.plot.curve_list import CurveList
from app.editor.viewers.plot.plot_export import export_picture
from app.editor.viewers.plot.plot_looks import thick
from app.editor.viewers.plot.plotted_lines import Entry
from app.editor.viewers.status_line import StatusLine
from app.editor.viewers.viewer import Viewer
from app.tradeoff.sweep import Point
from app.tradeoff.texts import csv_text
from app.tradeoff.tradeoff_figures import Figure, figures_of
from app.tradeoff.tradeoff_results import Curve, Results
from app.tradeoff.values import Variation
from core.atomic import write_text
from core.errors import UsageError
from core.network.network import Network
from nodes.files.common.file_format import CSV

if TYPE_CHECKING:
    from app.editor.evaluation.evaluator import Evaluator

_LIST_SHARE = 0.36  # of the width, at most
_HINT = "Choose a parameter above, or Trade off… in the menu of its value on a control panel"
_HOW = "The upright line is the value now: drag it, or press ← and →"


class TradeOffView(Viewer):
    """Charts of figures over one parameter.

    Parameters
    ----------
    session, evaluator, theme, parent
        As for `Viewer`.

    Signals
    -------
    export_wanted
        The person is to be asked where to write it.
    """

    export_wanted = Signal()

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        theme: Theme,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, theme, "tradeoff", parent)
        self.setAccessibleName("Trade-off")
        self.varied = Varied(session, self._refuse)
        self.span: Span | None = None
        self.figures: dict[str, Figure] = {}
        self.points: dict[Any, Point] = {}
        self._chosen: frozenset[str] | None = None
        self._state: Hashable = None
        self._known: Hashable = None
        self._listed = False
        self._build()
        self.set_theme(theme)
        self._follow_nodes()

    @property
    def shown(self) -> tuple[Figure, ...]:
        """The figures that are ticked."""
        chosen = self._chosen
        if chosen is None:
            chosen = first_figures(self.session.network, self.figures, self.varied.analysis)
        return tuple(figure for name, figure in self.figures.items() if name in chosen)

    def trade_off(self, node: str, name: str) -> None:
        """Vary this parameter, over its usual range."""
        self.varied.choose(node, name)
        parameter = self.varied.parameter
        if parameter is None:
            self.varied.choose()
        self.span = usual_span(parameter, self.varied.present) if parameter else None
        self._fill_list()
        self.list.scroll_to_ticked()
        self._begin()

    def set_span(self, span: Any) -> None:
        """Vary it over another range."""
        self.span = span
        self._begin()

    def show_figure(self, name: str, on: bool) -> None:
        """Show a figure, or leave it out."""
        chosen = {figure.text for figure in self.shown}
        self._chosen = frozenset(chosen | {name} if on else chosen - {name})
        self._fill_list()
        self._draw()
        self.ask()

    def export(self, path: Path) -> None:
        """Write the charts (``.png``, ``.svg``), or their numbers (``.csv``).

        Raises
        ------
        ImagechainError
            If nothing is shown, or it cannot be written.
        """
        parameter, span = self.varied.parameter, self.span
        if parameter is None or span is None or not self.points:
            raise UsageError("the trade-off shows no curves")
        if CSV.matches(path):
            points = tuple(self.points[value] for value in sorted(self.points))
            varied = Variation(self.varied.node, parameter, tuple(sorted(self.points)), span.log)
            curves = (Curve(None, points),)
            results = Results(self.session.network.name, varied, None, self.shown, curves)
            write_text(path, csv_text(results))
        else:
            export_picture(self.plots, path)

    def set_theme(self, theme: Theme) -> None:
        """Draw in other colours."""
        self.theme = theme
        self.bar.set_theme(theme)
        self.plots.set_theme(theme)
        self.status.set_theme(theme)
        self._fill_list()

    def queries(self) -> tuple[Query, ...]:
        """The figures over the range in parts, the coarsest first."""
        if self.span is None or not self.shown:
            return ()
        varied, parts = self.varied, coarse_first(self.span.values())
        return tuple(TradeOffQuery(varied.node, varied.name, part, self.shown) for part in parts)

    def take(self, answer: Answer) -> None:
        """Put points with those of the same network; with another one, all begins anew."""
        if answer.error is not None:
            self.status.show_text(str(answer.error), failed=True)
            return
        part: Part = answer.value
        if part.state != self._state:
            self._state = part.state
            self.points.clear()
        self.points.update({point.value: point for point in part.points})
        self._draw()

    def follow(self, before: Network, after: Network) -> None:
        """Move the mark; follow nodes that are renamed."""
        old, new = renamed_node(before, after) or ("", "")
        if old and self._chosen is not None:
            self._chosen = frozenset(renamed(name, old, new) for name in self._chosen)
        if old and old == self.varied.node:
            self.varied.choose(new, self.varied.name)
        if ports_depend_on(after) != self._known:
            self._follow_nodes()
        self._show_mark()

    def follow_opening(self) -> None:
        """Vary nothing of another document."""
        self._chosen = None
        self.varied.choose()
        self.span = None
        self._follow_nodes()

    def sizeHint(self) -> QSize:
        """Room for some charts."""
        width, line = self.fontMetrics().averageCharWidth(), self.fontMetrics().height()
        return QSize(75 * width, 20 * line)

    def _build(self) -> None:
        self.bar = TradeOffBar(self.session, self.theme, self)
        self.plots = TradeOffPlots(self.theme, self)
        self.list = CurveList(self)
        self.list.setObjectName("tradeoff.figures")
        self.list.setAccessibleName("Figures that are shown")
        self.status = StatusLine(self.owner, "What could not be computed", "Values there", self)
        beside = QHBoxLayout()
        beside.setSpacing(2)
        beside.addWidget(self.plots, 1)
        beside.addWidget(self.list, 0)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(self.bar)
        layout.addLayout(beside, 1)
        layout.addWidget(self.status)
        self.plots.show_hint(_HINT)
        self.bar.parameter.chosen.connect(self.trade_off)
        self.bar.span_chosen.connect(self.set_span)
        self.bar.refused.connect(self._refuse)
        self.bar.figures.toggled.connect(self.list.setVisible)
        self.bar.export.clicked.connect(self.export_wanted)
        self.list.toggled.connect(self.show_figure)
        self.plots.moved.connect(self.varied.move)
        self.plots.stepped.connect(self._step)
        self.plots.released.connect(self.varied.release)
        self.plots.pointed.connect(self._read)

    def _begin(self) -> None:
        """Show what is varied now, and post its queries."""
        self.points.clear()
        self._state = None
        self.bar.parameter.choose(self.varied.node, self.varied.name)
        self.bar.show_span(self.span)
        self._show_mark()
        self._draw()
        self.ask()

    def _follow_nodes(self) -> None:
        network = self.session.network
        self._known = ports_depend_on(network)
        self.figures = in_order(figures_of(network, self.session.library), network)
        if self.varied.parameter is None:
            self.varied.choose()
            self.span = None
        self._fill_list()
        self._begin()

    def showEvent(self, event: QShowEvent) -> None:
        """List the figures, which takes long where there are thousands."""
        super().showEvent(event)
        if not self._listed:
            self._fill_list()
            self.list.scroll_to_ticked()

    def _fill_list(self) -> None:
        """List the figures, once they are seen."""
        self._listed = self.isVisible()
        if not self._listed:
            return
        every = tuple(self.figures.values())
        titles = listed_titles(every)
        entries = [Entry(one.text, title) for one, title in zip(every, titles, strict=True)]
        names = [figure.text for figure in self.shown]
        colours = self.theme.curves
        pens = {name: thick(colours[n % len(colours)], 2) for n, name in enumerate(names)}
        other = thick(self.theme.base, 2)
        self.list.fill(entries, names, lambda name: pens.get(name, other))
        most = int(_LIST_SHARE * max(self.width(), self.sizeHint().width()))
        self.list.setFixedWidth(min(self.list.sizeHint().width(), most))

    def _draw(self) -> None:
        shown = self.shown
        if self.span is None:
            self.plots.show_graphs((), None, "")
            self.plots.show_hint(_HINT)
            self.status.show_text("")
            return
        self.plots.show_hint("" if shown else "No figure is ticked")
        values = sorted(self.points)
        x = np.array(values, np.float64)
        graphs = []
        for figure in shown:
            numbers = [self.points[value].figures.get(figure.text, math.nan) for value in values]
            y = np.array(numbers, np.float64)
            y[~np.isfinite(y)] = np.nan
            graphs.append(Graph(figure.text, title_of(figure, shown), x, y))
        self.plots.show_graphs(graphs, self.span, self.varied.label)
        self._show_gaps()

    def _show_gaps(self) -> None:
        """Show how many values have a gap, and why the first has."""
        names = [figure.text for figure in self.shown]
        gaps = [
            next(reason for name, reason in point.reasons.items() if name in names)
            for _, point in sorted(self.points.items())
            if any(name in names for name in point.reasons)
        ]
        many = f"{len(gaps)} of {len(self.points)} values have gaps: {gaps[0]}" if gaps else _HOW
        self.status.show_text(many, failed=bool(gaps))

    def _show_mark(self) -> None:
        self.plots.show_mark(self.varied.present)

    def _step(self, steps: int) -> None:
        if self.span is not None:
            self.varied.step(self.span, steps)

    def _read(self, value: float) -> None:
        """Show the figures there, between points on straight lines."""
        parts = []
        for graph in self.plots.graphs if math.isfinite(value) else ():
            if len(graph.x) and graph.x[0] <= value <= graph.x[-1]:
                height = float(np.interp(value, graph.x, graph.y))
                if math.isfinite(height):
                    parts.append(f"{graph.title.partition(' (')[0]} {shown_figure(height)}")
        place = f"{shown_number(value)}: {', '.join(parts)}" if parts else ""
        self.status.show_more(place.replace("-", "\N{MINUS SIGN}"))

    def _refuse(self, text: str) -> None:
        self.status.show_text(text, failed=True)
