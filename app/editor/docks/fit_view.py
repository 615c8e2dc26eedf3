"""The fit dock: free parameters, a picture, and the edges of both as the values change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import floor, log10

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import (
    QComboBox,
    QHeaderView,
    QLabel,
    QPlainTextEdit,
    QSplitter,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import FreeNumber, about, label_of, shown_number, tip, typed_number
from app.editor.dialogs import choose_pictures
from app.editor.docks.background_work import (
    Check,
    DrawnEdge,
    FitOutcome,
    FitTask,
    FittedNumber,
    PictureDrops,
    Pictures,
    WorkerView,
    fit_to_picture,
    pictures_name,
    pictures_text,
)
from app.editor.notices import NoticeList, sentence
from app.editor.panels.chart import Chart, ChartWidget
from app.editor.session import Session
from app.editor.theme import CHANGED
from app.editor.viewers.plot.plot_export import columns_text, have_plot_menu
from app.editor.viewers.viewer import StatusLine
from app.editor.widgets import RIGHT, FlowLayout, filled, labelled, tool_button
from app.fit.fit_result import hardly_determined
from core.editing.operations import Operation, Together, set_parameter
from core.errors import ParameterError
from core.modules.parameters import Parameter, plain
from core.modules.preview import Axis
from core.network.network import Network

_NO_PICTURE = "no picture"
_NOTHING_FREE = "Right-click a number on a panel and choose Free for a fit"
_SAID_HERE = "Fit reports here how well the chain matches the picture"
_TAKE = "Write all fitted values into the network, as one step that you can undo"


class FitView(WorkerView):
    """Fits the network to a picture in the background, and shows what that gives.

    `default_pictures` gives those that are fitted to where no others are chosen, `finish_typing`
    takes what is being typed before a fit.
    """

    _seen = Signal(object, object)

    def __init__(
        self,
        session: Session,
        default_pictures: Callable[[], Pictures | None],
        finish_typing: Callable[[], None],
    ) -> None:
        super().__init__("fit", "Fit to a picture")
        self.outcome: FitOutcome | None = None
        self._session = session
        self._default, self._finish_typing = default_pictures, finish_typing
        self._own: Pictures | None = None
        self._fitted_to: Pictures | None = None
        self._run: object | None = None
        self._failed_with: object = None
        self._fits: list[Network] = []  # as fitted, and as the values were taken
        self._edges: dict[str, DrawnEdge] = {}
        self.drops = PictureDrops(self, self.choose_pictures)
        self._build()
        self._connect()
        have_plot_menu(self.chart, self._report, self.chart.numbers)
        self.show_state()

    @property
    def pictures(self) -> Pictures | None:
        return self._own if self._own is not None else self._default()

    def choose_pictures(self, pictures: Pictures) -> None:
        self._own = pictures
        self.show_state()

    def _choose_file(self) -> None:
        window, name = self.window(), "fit_dialog"
        choose_pictures(window, "Fit to pictures", name=name, chosen=self.choose_pictures)

    # --- fitting -----------------------------------------------------------------------------

    def begin(self) -> None:
        self._finish_typing()
        session, pictures = self._session, self.pictures
        if pictures is None:
            self._say("choose a picture first", failed=True)
            return
        task = FitTask(session.plain, session.library, session.folder, session.free.all, pictures)
        run = self._run = object()

        def watch(edges: tuple[DrawnEdge, ...]) -> None:
            self._seen.emit(run, edges)

        def job(check: Check, report: Callable[[str], None]) -> FitOutcome:
            return fit_to_picture(task, check, report, watch)

        self._show_outcome(None)
        self._fits, self._fitted_to = [session.document.network], pictures
        self._say(f"Fitting to {pictures_name(pictures)} …")
        self.worker.start(job)
        self._show_buttons()

    def close_worker(self) -> None:
        self._run = None
        self.worker.close()

    def forget(self) -> None:
        self._run = self._failed_with = None
        self.worker.drop()
        self._show_outcome(None)
        self.show_state()

    def take(self) -> None:
        steps: list[Operation] = []
        network = self._session.network
        for one in self._determined:
            node, name = one.number.place
            declared = self._session.declared(node) if node in network.nodes else None
            parameter = declared.parameter(name) if declared is not None else None
            if parameter is None or name in network.nodes[node].linked:
                why = "no longer exists" if parameter is None else "is now linked to others"
                self._say(f"{one.number.port} {why}: no value was changed", failed=True)
                return
            try:
                value = plain(parameter.coerce(_rounded(one)))
            except ParameterError as error:
                self._say(f"{one.number.port}: {error.message}", failed=True)
                return
            steps.append(set_parameter(node, name, value))
        if not steps:
            return
        self._session.end_gesture()
        before = list(self._fits)
        self._fits = []
        self._session.do(Together(steps, "Take fitted values"))
        self._fits = [*before, self._session.document.network]
        self._say_result()

    # --- the widget --------------------------------------------------------------------------

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(48 * line, 20 * line)

    def _build(self) -> None:
        self.file = tool_button(
            "fit.file",
            "Pictures…",
            "Choose pictures to fit to, or drop them here; if you choose none, the pictures "
            "measured last are used",
            self,
        )
        self.name = labelled(QLabel(_NO_PICTURE, self), "fit.picture")
        self.name.setTextFormat(Qt.TextFormat.PlainText)
        self.name.setMinimumHeight(self.file.sizeHint().height())  # level with the buttons' texts
        self.fit = tool_button("fit.begin", "Fit", "Fit the free parameters to the picture", self)
        self.stop = tool_button("fit.cancel", "Cancel", "Stop the fit (Esc)", self)
        self.taking = tool_button("fit.take", "Take Values", _TAKE, self)
        self.remove = tool_button(
            "fit.remove", "Remove", "Fix the selected parameter again (Del)", self
        )
        self.which = QComboBox(self)
        self.which.setObjectName("fit.edges")
        self.which.setAccessibleName("Edge to plot")
        self.which.setToolTip("Choose which of the picture's edges is plotted")
        self.which.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        bar = QWidget(self)
        buttons = (self.file, self.fit, self.stop, self.taking, self.remove)
        parts = (*buttons, self.name, self.which)
        filled(FlowLayout(bar, across=4, down=2), *parts, margins=(4, 4, 4, 2))
        self.notices = NoticeList("fit.notices", "Warnings of the fit", self)
        self.table = FreeTable(self._session, self)
        self.words = labelled(QPlainTextEdit(self, readOnly=True), "fit.words", "Result of the fit")
        self.words.setTabChangesFocus(True)
        self.chart = SpreadChart(self)
        left = QSplitter(Qt.Orientation.Vertical, self)
        left.addWidget(self.table)
        left.addWidget(self.words)
        halves = QSplitter(Qt.Orientation.Horizontal, self)
        halves.addWidget(left)
        halves.addWidget(self.chart)
        for splitter in (left, halves):
            splitter.setChildrenCollapsible(False)
            splitter.setStretchFactor(0, 1)
            splitter.setStretchFactor(1, 1)
        self.status = StatusLine("fit", "What is fitted, or why no fit is possible", "", self)
        filled(QVBoxLayout(self), bar, self.notices, (halves, 1), self.status, spacing=1)

    def _connect(self) -> None:
        self.file.clicked.connect(self._choose_file)
        self.fit.clicked.connect(self.begin)
        self.stop.clicked.connect(self.cancel)
        self.taking.clicked.connect(self.take)
        self.remove.clicked.connect(self.table.remove_marked)
        self.table.refused.connect(lambda text: self._say(text, failed=True))
        self.table.itemSelectionChanged.connect(self._show_buttons)
        self.which.currentIndexChanged.connect(self._show_edge)
        self._seen.connect(self._show_on_the_way)
        self.worker.progressed.connect(lambda text: self._say(f"Fitting: {text} …"))
        self.worker.done.connect(self._done)
        self.worker.failed.connect(self._fail)
        self.worker.cancelled.connect(self._stopped)
        self._session.free.changed.connect(self.show_state)
        self._session.opened.connect(self.forget)
        self._session.changed.connect(self._network_changed)

    def show_state(self, *_: object) -> None:
        self.table.write()
        pictures = self.pictures
        self.name.setText(_NO_PICTURE if pictures is None else pictures_name(pictures))
        self.name.setToolTip("" if pictures is None else pictures_text(pictures))
        count = len(self._session.free.all)
        self.words.setPlaceholderText(_SAID_HERE if count else _NOTHING_FREE)
        self.words.viewport().update()  # Qt does not draw it anew
        self._show_buttons()
        if self.outcome is not None:
            self._say_result()
        elif not self.worker.busy and self._failed_with != self._given:
            self._say(f"{count} free" if count else "no parameter is free")

    @property
    def _given(self) -> object:
        """What a fit is made of: as long as it is the same, the reason why one failed stays."""
        return self.pictures, tuple(self._session.free.all)

    def _network_changed(self, *_: object) -> None:
        self.table.write()
        self._say_result()

    @property
    def _determined(self) -> list[FittedNumber]:
        numbers = self.outcome.numbers if self.outcome is not None else ()
        free = {one.place for one in self._session.free.all}
        return [
            one
            for one in numbers
            if one.value is not None
            and not hardly_determined(one.value, one.sigma)
            and one.number.place in free
        ]

    def _show_buttons(self) -> None:
        busy, free = self.worker.busy, self._session.free.all
        self.fit.setEnabled(not busy and bool(free) and self.pictures is not None)
        self.stop.setEnabled(busy)
        self.taking.setEnabled(not busy and bool(self._determined))
        self.remove.setEnabled(bool(free) and self.table.currentRow() >= 0)
        self.which.setVisible(self.which.count() > 1)

    def _show_outcome(self, outcome: FitOutcome | None) -> None:
        self.outcome = outcome
        self.table.show_fitted(() if outcome is None else outcome.numbers)
        lines = [] if outcome is None else _lines(outcome, self._fitted_to)
        self.words.setPlainText("\n".join(lines))
        warned = () if outcome is None else outcome.warnings
        self.notices.show_notices(("warning", sentence(line)) for line in warned)
        self._show_edges(() if outcome is None else outcome.edges)

    def _show_edges(self, edges: tuple[DrawnEdge, ...]) -> None:
        self._edges = {one.name: one for one in edges}
        self.which.blockSignals(True)
        self.which.clear()
        self.which.addItems(list(self._edges))
        self.which.blockSignals(False)
        if self._edges:
            most = max(self._edges.values(), key=lambda one: len(one.distance))
            self.which.setCurrentText(most.name)
        self._show_edge()

    def _show_edge(self, _index: int = 0) -> None:
        self.chart.show_edge(self._edges.get(self.which.currentText()))

    def _show_on_the_way(self, run: object, drawn: object) -> None:
        """Edges as the values change: the chosen one, if it is among them."""
        edges: tuple[DrawnEdge, ...] = drawn  # type: ignore[assignment] # of the job
        if run is not self._run or not self.worker.busy:
            return
        if {*self._edges} >= {one.name for one in edges}:
            self._edges |= {one.name: one for one in edges}
            self._show_edge()
        else:
            self._show_edges(edges)

    def _done(self, outcome: object) -> None:
        self._show_outcome(outcome)  # type: ignore[arg-type] # of the job
        self._show_buttons()
        self._say_result()

    def _fail(self, text: str) -> None:
        self._failed_with = self._given
        self._say(text, failed=True)
        self._show_buttons()

    def _stopped(self) -> None:
        self._say("Stopped")
        self._show_buttons()

    @property
    def _why_old(self) -> str:
        session, outcome = self._session, self.outcome
        now = session.document.network
        fitted = {one.number.place for one in outcome.numbers} if outcome is not None else set()
        if not any(now is one or now == one for one in self._fits):
            return "to the network before an edit"
        if self._fitted_to is not None and self.pictures != self._fitted_to:
            return f"to {pictures_name(self._fitted_to)}"
        if fitted != {one.place for one in session.free.all}:
            return "while other parameters were free"
        return ""

    def _say_result(self) -> None:
        outcome = self.outcome
        if outcome is None or self.worker.busy:
            return
        if why := self._why_old:
            self._say(f"Fitted {why}: fit again")
            return
        count = len(self._determined)
        of = f"{count} of {len(outcome.numbers)} determined"
        warned = len(outcome.warnings)
        more = f", {warned} warning{'s' * (warned > 1)}" if warned else ""
        self._say(f"{of}, χ² per degree of freedom {outcome.chi2_per_degree:.3g}{more}")


def _lines(outcome: FitOutcome, pictures: Pictures | None) -> list[str]:
    to = [] if pictures is None else [f"Fitted to {pictures_name(pictures)}."]
    return [
        *to,
        f"χ² per degree of freedom {outcome.chi2_per_degree:.4g} ({outcome.degrees} degrees)",
        *map(sentence, outcome.notes),
    ]


def _rounded(fitted: FittedNumber) -> float:
    """Its value to a hundredth of its error: what lies beyond is no knowledge."""
    value, sigma = float(fitted.value or 0.0), fitted.sigma
    if sigma is None or not 0.0 < sigma < abs(value):
        return value
    return round(value, 2 - floor(log10(sigma)))


# The samples of an edge and the chain's spread of it, in one small chart.

_MOST = 3000  # samples that are drawn
_LOWEST, _HIGHEST = -0.2, 1.2  # of the step
_DOT = 2.0  # pixels


class SpreadChart(ChartWidget):
    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(width=24, height=14, parent=parent)
        self.setObjectName("fit.spread")
        self.setAccessibleName("Edge profile measured and modelled")
        self.setToolTip(
            "Profile across the edge, from the dark level 0 to the bright level 1: the "
            "picture's samples and the chain's edge spread"
        )
        self.edge: DrawnEdge | None = None

    def show_edge(self, edge: DrawnEdge | None) -> None:
        """Draw an edge; None draws an empty chart."""
        self.edge = edge
        self.update()

    def numbers(self) -> str:
        edge = self.edge
        names = ("distance (samples)", "picture", "chain")
        parts = () if edge is None else (edge.distance, edge.sample, edge.spread)
        return columns_text([(n, part.tolist()) for n, part in zip(names, parts, strict=False)])

    def draw(self, painter: QPainter, area: QRectF) -> None:
        edge = self.edge
        reach = 8.0 if edge is None else max(1.0, float(np.abs(edge.distance).max(initial=0.0)))
        x = Axis(-reach, reach, "distance from the edge (samples)")
        y = Axis(_LOWEST, _HIGHEST, "fraction of the step")
        chart = Chart(painter, area, x, y, self.theme)
        if edge is not None:
            self._paint(painter, chart, edge, x, y)

    def _paint(self, painter: QPainter, chart: Chart, edge: DrawnEdge, x: Axis, y: Axis) -> None:
        samples, line = self.theme.faint_text, self.theme.curves[0]
        order = np.argsort(edge.distance, kind="stable")
        if len(order) > _MOST:
            order = order[np.linspace(0, len(order) - 1, _MOST).astype(np.intp)]
        distance, sample = edge.distance[order], edge.sample[order]
        frame = chart.frame
        across = frame.left() + x.share(distance) * frame.width()
        along = frame.bottom() - y.share(sample) * frame.height()
        good = np.isfinite(along)
        points = map(QPointF, across[good].tolist(), along[good].tolist())
        painter.save()
        painter.setClipRect(frame)
        pen = QPen(QColor(samples), _DOT)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawPoints(QPolygonF(list(points)))
        painter.restore()
        chart.curve(distance, edge.spread[order], line, width=2.0)
        solid = Qt.PenStyle.SolidLine
        chart.legend([("picture", samples, Qt.PenStyle.DotLine), ("chain", line, solid)])


_HEADS = ("Parameter", "Now", "Fitted", "±", "Unit", "Low", "High")
_FITTED, _UNIT, _LOW, _HIGH = 2, 4, 5, 6
_UNDETERMINED = "not determined"


class FreeTable(QTableWidget):
    refused = Signal(str)  # (text): why a limit is not taken

    def __init__(self, session: Session, parent: QWidget) -> None:
        super().__init__(0, len(_HEADS), parent)
        self._session = session
        self._fitted: tuple[FittedNumber, ...] = ()
        self.setObjectName("fit.free")
        self.setAccessibleName("Free parameters with their limits and fitted values; Del fixes one")
        self.setToolTip(
            "The parameters that the fit determines. Limits can be typed in; they are not "
            "saved with the network"
        )
        self.setHorizontalHeaderLabels(list(_HEADS))
        self.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
        self.setSelectionMode(QTableWidget.SelectionMode.SingleSelection)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.verticalHeader().hide()
        head = self.horizontalHeader()
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        head.setHighlightSections(False)
        self.itemChanged.connect(self._typed)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.write()

    def show_fitted(self, fitted: tuple[FittedNumber, ...]) -> None:
        self._fitted = fitted
        self.write()

    def remove_marked(self) -> None:
        free = self._session.free.all
        if 0 <= self.currentRow() < len(free):
            self._session.free.fix(*free[self.currentRow()].place)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and not event.modifiers():
            self.remove_marked()
        else:
            super().keyPressEvent(event)

    def write(self) -> None:
        by_place = {one.number.place: one for one in self._fitted}
        free = self._session.free.all
        with QSignalBlocker(self):
            self.setRowCount(len(free))
            for row, number in enumerate(free):
                fitted = by_place.get(number.place)
                for column, text in enumerate(self._cells(number, fitted)):
                    self._put(row, column, text, number)
                value = self.item(row, _FITTED)
                if value is not None and fitted is not None and fitted.value is None:
                    value.setForeground(self.palette().color(CHANGED))

    def _put(self, row: int, column: int, text: str, number: FreeNumber) -> None:
        item = self.item(row, column)  # one that is being typed in has to stay
        if item is None:
            item = QTableWidgetItem()
            self.setItem(row, column, item)
        item.setText(text)
        item.setForeground(self.palette().text())
        parameter = self._parameter(number)
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        if column in (_LOW, _HIGH):
            item.setFlags(flags | Qt.ItemFlag.ItemIsEditable)
            end = "Low" if column == _LOW else "High"
            item.setToolTip(
                tip(f"{end} limit for the fit; empty: the limit of the parameter itself")
            )
        else:
            item.setFlags(flags)
            if parameter is not None:
                item.setToolTip(tip(f"{about(parameter)}\nIn network files: {number.port}"))
        if column not in (0, _UNIT):
            item.setTextAlignment(RIGHT)

    def _cells(self, number: FreeNumber, fitted: FittedNumber | None) -> tuple[str, ...]:
        parameter = self._parameter(number)
        unit = parameter.param.unit if parameter is not None else ""
        low, high = ("" if v is None else shown_number(v) for v in (number.low, number.high))
        value = error = ""
        if fitted is not None:
            value = _UNDETERMINED if fitted.value is None else f"{fitted.value:.6g}"
            error = "" if fitted.sigma is None else f"{fitted.sigma:.2g}"
        name = f"{label_of(number.name)} of {number.node}"
        return name, self._now(number), value, error, unit, low, high

    def _now(self, number: FreeNumber) -> str:
        node, parameter = self._session.network.nodes.get(number.node), self._parameter(number)
        if node is None or parameter is None:
            return ""
        value = node.params.get(number.name, parameter.default)
        return f"{value:.6g}" if isinstance(value, int | float) else ""

    def _parameter(self, number: FreeNumber) -> Parameter | None:
        declared = self._session.declared(number.node)
        return declared.parameter(number.name) if declared is not None else None

    def _typed(self, item: QTableWidgetItem) -> None:
        row, column = item.row(), item.column()
        number = self._session.free.all[row]
        parameter, text = self._parameter(number), item.text().strip()
        if parameter is None or column not in (_LOW, _HIGH):
            return
        try:
            limit = None if not text else parameter.coerce(typed_number(text, parameter))
        except ParameterError as error:
            self.refused.emit(f"{number.port}: {error.message}")
            self.write()
            return
        end = None if limit is None else float(limit)
        changed = replace(number, low=end) if column == _LOW else replace(number, high=end)
        if changed.low is not None and changed.high is not None and changed.low >= changed.high:
            self.refused.emit(
                f"{number.port}: the low limit, {changed.low:g}, must lie below {changed.high:g}"
            )
            self.write()
            return
        self._session.free.put(changed)
