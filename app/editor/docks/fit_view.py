"""The fit dock: free parameters, a picture, and the edges of both as the values change."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from math import floor, log10
from typing import TYPE_CHECKING, Any

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QSignalBlocker, Qt, Signal

from app.editor.declared_text import about, label_of, shown_number, tip, typed_number
from app.editor.docks import measure_view
from app.editor.docks.edges import DrawnEdge, SpreadChart, drawn_edges
from app.editor.messages import NoticeList, Severity, choose_pictures, sentence
from app.editor.session import FreeNumber, Session
from app.editor.theme import CHANGED
from app.editor.viewers.plot.plot_export import have_plot_menu
from app.editor.viewers.viewer import StatusLine
from app.editor.widgets import RIGHT, CopiedTable, FlowLayout, filled, labelled, tool_button
from core.editing.operations import Operation, set_parameter, together
from core.errors import ParameterError, UsageError
from core.evaluation.recipes import Store
from core.evaluation.work import Policy
from core.modules.parameters import Parameter, plain
from core.network.network import Network
from core.records import replace

if TYPE_CHECKING:
    from app.fit.chain_transfer import FreeParameter
    from app.fit.edge_fit import EdgesAt, Patch
    from app.fit.fit_result import FitResult, FittedParameter
    from app.measure.picture_measurement import PictureFile

_NO_PICTURE = "no picture"
_NOTHING_FREE = "no parameter is free: right-click a number on a panel and choose Free for a fit"
_TAKE = "Write all fitted values to the network, as one step that you can undo"
_HELD_BYTES = 1 << 28
_PAUSE_S = 0.05  # between edges that are shown while values change


class FitView(measure_view.WorkerView):
    """Fits the network to a picture in the background, and shows what that gives.

    `default_pictures` gives those that are fitted to where no others are chosen, `finish_typing`
    takes what is being typed before a fit.
    """

    def __init__(
        self,
        session: Session,
        default_pictures: Callable[[], measure_view.Pictures | None],
        finish_typing: Callable[[], None],
    ) -> None:
        super().__init__("fit", "Fit to a picture")
        self.outcome: FitResult | None = None
        self._session = session
        self._default, self._finish_typing = default_pictures, finish_typing
        self._own: measure_view.Pictures | None = None
        self._fits: list[object] = []  # what was fitted, and that with the values taken
        self._edges: dict[str, DrawnEdge] = {}
        self._build()
        self._connect()
        have_plot_menu(self.chart, self._report, self.chart.numbers)
        self.show_state()

    @property
    def pictures(self) -> measure_view.Pictures | None:
        return self._own if self._own is not None else self._default()

    def take_files(self, paths: measure_view.Pictures) -> None:
        self._own = paths
        self.show_state()

    def _choose_file(self) -> None:
        window, name = self.window(), "fit_dialog"
        choose_pictures(window, "Fit to pictures", name=name, chosen=self.take_files)

    # --- fitting -----------------------------------------------------------------------------

    @property
    def _given(self) -> object:
        """What a fit is made of: with another one, what is shown is old."""
        free = {(one.place, one.low, one.high) for one in self._session.free}
        return self._session.document.network, self.pictures, free

    def begin(self) -> None:
        self._finish_typing()
        pictures = self.pictures
        if pictures is None:
            self._say("choose a picture first", failed=True)
            return
        session, network = self._session, self._session.plain
        folder, free = session.folder, session.free

        def job(stop: threading.Event, report: measure_view.Report) -> FitResult:
            # Imported where it is used: the window opens without it.
            from app.fit.picture_fit import fit_pictures
            from core.chain.engine import Engine
            from core.network.validation import check_network

            check_network(network, library=session.library)
            engine = Engine(session.library, Store(_HELD_BYTES))
            given: dict[str, Any] = {"free": limited(free, network, session), "report": report}
            report("picture")
            given["pictures"] = opened(pictures)
            plan, work = engine.plan(network, folder=folder), engine.work(Policy(), cancel=stop)
            next_time = 0.0

            def watch(patches: tuple[Patch, ...], edges: EdgesAt) -> None:
                nonlocal next_time
                measure_view.check_stop(stop)
                if time.monotonic() >= next_time:
                    next_time = time.monotonic() + _PAUSE_S
                    report(drawn_edges(patches, edges))

            return fit_pictures(engine, plan, work, watch=watch, **given)

        self._show_outcome(None)
        self._fits = [self._given]
        self._say(f"Fitting to {measure_view.pictures_name(pictures)} …")
        self.start(job)
        self._show_buttons()

    def forget(self) -> None:
        self.drop()
        self._show_outcome(None)
        self._fits = []
        self.show_state()

    def take(self) -> None:
        steps: list[Operation] = []
        for one in self._determined:
            node, _, name = one.port.rpartition(".")
            parameter = self._session.parameter(node, name)
            try:
                if parameter is None:
                    raise UsageError("the parameter no longer exists")
                if why := self._session.follows(node, (name,)):
                    raise UsageError(why)
                value = plain(parameter.coerce(_rounded(one)))
            except (ParameterError, UsageError) as error:
                self._say(f"{one.port}: {error.message}", failed=True)
                return
            steps.append(set_parameter(node, name, value))
        if steps:
            self._session.end_gesture()
            self._session.do(together(steps, "Take fitted values"))
            self._fits.append(self._given)
            self.show_state()

    # --- the widget --------------------------------------------------------------------------

    def _build(self) -> None:
        about = (
            "Choose pictures to fit to, or drop them here; otherwise the last measured pictures "
            "are used"
        )
        self.file = tool_button("fit.file", "Pictures…", about, self, self._choose_file)
        name = QtWidgets.QLabel(_NO_PICTURE, self, textFormat=Qt.TextFormat.PlainText)
        self.name = labelled(name, "fit.picture")
        self.name.setMinimumHeight(self.file.sizeHint().height())  # level with the buttons' texts
        about = "Fit the free parameters to the picture"
        self.fit = tool_button("fit.begin", "Fit", about, self, self.begin)
        self.stop = tool_button("fit.cancel", "Cancel", "Stop the fit (Esc)", self, self.cancel)
        self.taking = tool_button("fit.take", "Take Values", _TAKE, self, self.take)
        about = "Hold the selected parameter fixed again (Del)"
        self.table = FreeTable(self._session, self)
        self.remove = tool_button("fit.remove", "Remove", about, self, self.table.remove_marked)
        about = "Choose which edge of the picture to plot"
        self.which = labelled(QtWidgets.QComboBox(self), "fit.edges", "Edge to plot", about)
        self.which.setSizeAdjustPolicy(QtWidgets.QComboBox.SizeAdjustPolicy.AdjustToContents)
        bar = QtWidgets.QWidget(self)
        buttons = (self.file, self.fit, self.stop, self.taking, self.remove)
        parts = (*buttons, self.name, self.which)
        filled(FlowLayout(bar, across=4, down=2), *parts, margins=(4, 4, 4, 2))
        self.notices = NoticeList("fit.notices", "Warnings and notes from the fit", self)
        self.chart = SpreadChart(self)
        halves = measure_view.split(Qt.Orientation.Horizontal, (self.table, 1), (self.chart, 1))
        self.status = StatusLine("fit", "Status of the fit, or why no fit is possible", "", self)
        filled(QtWidgets.QVBoxLayout(self), bar, self.notices, (halves, 1), self.status, spacing=1)

    def _connect(self) -> None:
        self.table.refused.connect(lambda text: self._say(text, failed=True))
        self.table.itemSelectionChanged.connect(self._show_buttons)
        self.which.currentIndexChanged.connect(self._show_edge)
        self._session.free_changed.connect(self.show_state)
        self._session.opened.connect(self.forget)
        self._session.changed.connect(self.show_state)

    def show_state(self, *_: object) -> None:
        self.table.write()
        pictures = self.pictures
        self.name.setText(_NO_PICTURE if pictures is None else measure_view.pictures_name(pictures))
        self.name.setToolTip("" if pictures is None else measure_view.pictures_text(pictures))
        count = len(self._session.free)
        self.table.setVisible(bool(count))
        self._show_buttons()
        if self.busy:
            return
        old = self._given not in self._fits
        if self.outcome is not None:
            self._say("The fit is out of date: fit again" if old else self._result)
        elif old:
            self._say(f"{count} free" if count else _NOTHING_FREE)

    @property
    def _determined(self) -> list[FittedParameter]:
        if self.outcome is None:
            return []
        from app.fit.fit_result import hardly_determined  # start-up time

        free = {one.port for one in self._session.free}
        return [
            one
            for one in self.outcome.parameters
            if one.value is not None
            and not hardly_determined(one.value, one.sigma)
            and one.port in free
        ]

    @property
    def _result(self) -> str:
        assert self.outcome is not None
        count, many = len(self._determined), len(self.outcome.parameters)
        chi2, degrees = self.outcome.chi2_per_degree, self.outcome.fit.misfit.degrees
        return (
            f"{count} of {many} parameters determined, reduced χ² {chi2:.3g} "
            f"({degrees} degrees of freedom)"
        )

    def _show_buttons(self) -> None:
        busy, free = self.busy, self._session.free
        self.fit.setEnabled(not busy and bool(free) and self.pictures is not None)
        self.stop.setEnabled(busy)
        self.taking.setEnabled(not busy and bool(self._determined))
        self.remove.setEnabled(bool(free) and self.table.currentRow() >= 0)
        self.which.setVisible(self.which.count() > 1)

    def _show_outcome(self, outcome: FitResult | None) -> None:
        self.outcome = outcome
        self.table.show_fitted(() if outcome is None else outcome.parameters)
        self.notices.show_notices(() if outcome is None else _said(outcome))
        if outcome is None:
            self._show_edges(())
        else:
            self._show_edges(drawn_edges(outcome.fit.patches, outcome.fit.edges))

    def _show_edges(self, edges: tuple[DrawnEdge, ...]) -> None:
        self._edges = {one.name: one for one in edges}
        with QSignalBlocker(self.which):
            self.which.clear()
            self.which.addItems(list(self._edges))
        if self._edges:
            most = max(self._edges.values(), key=lambda one: len(one.distance))
            self.which.setCurrentText(most.name)
        self._show_edge()

    def _show_edge(self, _index: int = 0) -> None:
        self.chart.show_edge(self._edges.get(self.which.currentText()))

    def show_progress(self, what: Any) -> None:
        """The name of what is done next, or edges as the values change."""
        if isinstance(what, str):
            self._say(f"Fitting: {what} …")
        elif {*self._edges} >= {one.name for one in what}:
            self._edges |= {one.name: one for one in what}
            self._show_edge()
        else:
            self._show_edges(what)

    def show_result(self, result: Any) -> None:
        self._show_outcome(result)
        self.show_state()


def limited(
    numbers: tuple[FreeNumber, ...], network: Network, session: Session
) -> tuple[FreeParameter, ...]:
    """The free parameters within the limits that were typed."""
    from app.fit.chain_transfer import free_parameters

    if not numbers:
        raise UsageError(_NOTHING_FREE)
    free = free_parameters([one.port for one in numbers], network, session.library, option="")
    return tuple(
        replace(
            parameter,
            low=parameter.low if one.low is None else one.low,
            high=parameter.high if one.high is None else one.high,
        )
        for one, parameter in zip(numbers, free, strict=True)
    )


def opened(pictures: measure_view.Pictures) -> list[PictureFile]:
    from app.fit.picture_fit import opened_pictures

    if not isinstance(pictures, tuple):
        return [pictures]
    show = "show one band in a viewer and fit to that picture"
    return opened_pictures(pictures, instead=show)


def _said(result: FitResult) -> list[tuple[Severity, str]]:
    noise = [result.noise] if isinstance(result.noise, str) and result.noise else []
    warnings: list[tuple[Severity, str]] = [("warning", sentence(one)) for one in result.warnings]
    notes = (*result.notes, *noise)
    return [*warnings, *(("information", sentence(one)) for one in notes)]


def _rounded(fitted: FittedParameter) -> float:
    """Its value to a hundredth of its error: what lies beyond is no knowledge."""
    value, sigma = float(fitted.value or 0.0), fitted.sigma
    if sigma is None or not 0.0 < sigma < abs(value):
        return value
    return round(value, 2 - floor(log10(sigma)))


_HEADS = ("Parameter", "Now", "Fitted", "±", "Unit", "Low", "High")
_FITTED, _UNIT, _LOW, _HIGH = 2, 4, 5, 6
_LIMITS = (_LOW, _HIGH)
_UNDETERMINED = "not determined"


class FreeTable(CopiedTable):
    refused = Signal(str)  # (text): why a limit is not taken

    def __init__(self, session: Session, parent: QtWidgets.QWidget) -> None:
        super().__init__(_HEADS, parent)
        self._session = session
        self._fitted: tuple[FittedParameter, ...] = ()
        labelled(
            self, "fit.free",
            "Free parameters, limits and fitted values; Del fixes the selected parameter",
            "Parameters that the fit determines. You can type limits; they are not saved with the "
            "network",
        )  # fmt: skip
        how = QtWidgets.QTableWidget.EditTrigger
        self.setEditTriggers(how.DoubleClicked | how.EditKeyPressed | how.AnyKeyPressed)
        self.setSelectionMode(QtWidgets.QTableWidget.SelectionMode.SingleSelection)
        self.itemChanged.connect(self._typed)

    def show_fitted(self, fitted: tuple[FittedParameter, ...]) -> None:
        self._fitted = fitted
        self.write()

    def remove_marked(self) -> None:
        free = self._session.free
        if 0 <= self.currentRow() < len(free):
            self._session.fix(*free[self.currentRow()].place)

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and not event.modifiers():
            self.remove_marked()
        else:
            super().keyPressEvent(event)

    def write(self) -> None:
        by_port = {one.port: one for one in self._fitted}
        free = self._session.free
        with QSignalBlocker(self):
            self.setRowCount(len(free))
            for row, number in enumerate(free):
                fitted = by_port.get(number.port)
                parameter = self._session.parameter(*number.place)
                for column, text in enumerate(self._cells(number, parameter, fitted)):
                    item = self._put(row, column, text)
                    if parameter is not None and column not in _LIMITS:
                        more = f"{about(parameter)}\nIn network files: {number.port}"
                        item.setToolTip(tip(more))
                    if column == _FITTED and text == _UNDETERMINED:
                        item.setForeground(self.palette().color(CHANGED))

    def _put(self, row: int, column: int, text: str) -> QtWidgets.QTableWidgetItem:
        item = self.item(row, column)  # one that is being typed in has to stay
        if item is None:
            item = QtWidgets.QTableWidgetItem()
            self.setItem(row, column, item)
            flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
            if column in _LIMITS:
                flags |= Qt.ItemFlag.ItemIsEditable
                item.setToolTip(tip("Limit for the fit; empty: the parameter's own limit"))
            item.setFlags(flags)
            if column not in (0, _UNIT):
                item.setTextAlignment(RIGHT)
        item.setText(text)
        item.setData(Qt.ItemDataRole.ForegroundRole, None)
        return item

    def _cells(
        self, number: FreeNumber, parameter: Parameter | None, fitted: FittedParameter | None
    ) -> tuple[str, ...]:
        node = self._session.network.nodes.get(number.node)
        now = value = error = unit = ""
        if node is not None and parameter is not None:
            present, unit = node.params.get(number.name, parameter.default), parameter.param.unit
            now = f"{present:.6g}" if isinstance(present, int | float) else ""
        low, high = ("" if v is None else shown_number(v) for v in (number.low, number.high))
        if fitted is not None:
            value = _UNDETERMINED if fitted.value is None else f"{fitted.value:.6g}"
            error = "" if fitted.sigma is None else f"{fitted.sigma:.2g}"
        return f"{label_of(number.name)} of {number.node}", now, value, error, unit, low, high

    def _typed(self, item: QtWidgets.QTableWidgetItem) -> None:
        number = self._session.free[item.row()]
        parameter, text = self._session.parameter(*number.place), item.text().strip()
        if parameter is None or item.column() not in _LIMITS:
            return
        param = parameter.param
        try:
            limit = None if not text else parameter.coerce(typed_number(text, parameter))
            end = None if limit is None else float(limit)
            low_typed = item.column() == _LOW
            changed = replace(number, low=end) if low_typed else replace(number, high=end)
            low = next(v for v in (changed.low, param.low, -math.inf) if v is not None)
            high = next(v for v in (changed.high, param.high, math.inf) if v is not None)
            if low >= high:
                raise UsageError(f"the lower limit {low:g} must be below the upper limit {high:g}")
        except (ParameterError, UsageError) as error:
            self.refused.emit(f"{number.port}: {error.message}")
            self.write()
        else:
            self._session.make_free(changed)
