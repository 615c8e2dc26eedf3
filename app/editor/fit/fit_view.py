"""The fit dock: free parameters, a picture, and the edges of both as the values change."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QMimeData, QSize, Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import QComboBox, QLabel, QPlainTextEdit, QSplitter, QVBoxLayout, QWidget

from app.editor.fit.fit_job import DrawnEdge, FitOutcome, FitTask, FittedNumber, fit_to_picture
from app.editor.fit.free_table import FreeTable
from app.editor.fit.spread_chart import SpreadChart
from app.editor.measure.measure_worker import Check, MeasureWorker
from app.editor.measure.viewer_pictures import ViewerPicture
from app.editor.session import Session
from app.editor.theme import Theme
from app.editor.viewers.status_line import StatusLine
from app.editor.widgets.buttons import tool_button
from app.editor.widgets.copied_drop import accept_copy
from app.editor.widgets.flow_layout import FlowLayout
from core.editing.fields import set_parameter
from core.editing.operation import Operation, together
from core.errors import ParameterError
from core.modules.parameters import plain
from core.network.network import Network
from nodes.files.common.file_format import JSON

Picture = Path | ViewerPicture
_NO_PICTURE = "no picture"
_NOTHING_FREE = "Right-click a number on a panel: Free for a fit"
_TAKE = "Write all fitted values into the network, as one step that undo takes back"


class FitView(QWidget):
    """Fits in the background, and shows what that gives.

    Signals
    -------
    file_wanted
        The person is to be asked for a picture file.
    """

    file_wanted = Signal()
    _seen = Signal(object, object)

    def __init__(
        self,
        session: Session,
        theme: Theme,
        default_picture: Callable[[], Picture | None],
        finish_typing: Callable[[], None],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName("fit")
        self.setAccessibleName("Fit to a picture")
        self.setAcceptDrops(True)
        self.theme = theme
        self.outcome: FitOutcome | None = None
        self._session = session
        self._default, self._finish_typing = default_picture, finish_typing
        self._own: Picture | None = None
        self._run: object | None = None
        self._fits: list[Network] = []  # as fitted, and as the values were taken
        self._edges: dict[str, DrawnEdge] = {}
        self.worker = MeasureWorker(self)
        self._build()
        self._connect()
        self.set_theme(theme)
        self.show_state()

    @property
    def picture(self) -> Picture | None:
        """The one that was chosen here, or else the one that was measured last."""
        return self._own if self._own is not None else self._default()

    def choose_picture(self, picture: Picture) -> None:
        """Fit to this one from now on."""
        self._own = picture
        self.show_state()

    # --- fitting -----------------------------------------------------------------------------

    def begin(self) -> None:
        """Fit the network as it stands."""
        self._finish_typing()
        session, picture = self._session, self.picture
        if picture is None:
            self._say("choose a picture first", failed=True)
            return
        network, barred = session.shares.without_barred(session.plain, session.library)
        for why in barred.values():
            self._say(str(why), failed=True)
            return
        task = FitTask(network, session.library, session.folder, session.free.all, picture)
        run = self._run = object()

        def watch(edges: tuple[DrawnEdge, ...]) -> None:
            self._seen.emit(run, edges)

        def job(check: Check, report: Callable[[str], None]) -> FitOutcome:
            return fit_to_picture(task, check, report, watch)

        self._show_outcome(None)
        self._fits = [session.document.network]
        self._say(f"Fitting to {_name(picture)} …")
        self.worker.start(job)
        self._show_buttons()

    def cancel(self) -> None:
        """Stop the fit."""
        self.worker.cancel()

    def close_worker(self) -> None:
        """Stop the fit, and wait for its end."""
        self._run = None
        self.worker.close()

    def forget(self) -> None:
        """Stop the fit, and show nothing of it: another network is open."""
        self._run = None
        self.worker.drop()
        self._show_outcome(None)
        self.show_state()

    def take(self) -> None:
        """Write the values that are determined into the network, as one step."""
        steps: list[Operation] = []
        network = self._session.network
        for one in self._determined:
            node, name = one.number.place
            declared = self._session.declared(node) if node in network.nodes else None
            parameter = declared.parameter(name) if declared is not None else None
            if parameter is None or name in network.nodes[node].linked:
                why = "is not there any more" if parameter is None else "follows others now"
                self._say(f"{one.number.port} {why}: nothing was taken", failed=True)
                return
            try:
                value = plain(parameter.coerce(one.value))
            except ParameterError as error:
                self._say(f"{one.number.port}: {error.message}", failed=True)
                return
            steps.append(set_parameter(node, name, value))
        if not steps:
            return
        self._session.end_gesture()
        before = list(self._fits)
        self._fits = []
        self._session.do(together(steps, "Take fitted values"))
        self._fits = [*before, self._session.document.network]
        self._say_result()

    def network_changed(self) -> None:
        """Say where values are those of a network that has changed."""
        if self.outcome is not None and self._fits and not self.worker.busy:
            now = self._session.document.network
            if any(now is one or now == one for one in self._fits):
                self._say_result()
            else:
                self._say("Fitted to the network as it was before an edit: fit again")

    # --- the widget --------------------------------------------------------------------------

    def set_theme(self, theme: Theme) -> None:
        """Draw in other colours."""
        self.theme = theme
        for part in (self.table, self.chart, self.status):
            part.set_theme(theme)

    def sizeHint(self) -> QSize:
        """Room for a table with a chart beside it."""
        line = self.fontMetrics().height()
        return QSize(48 * line, 20 * line)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc stops the fit."""
        if event.key() == Qt.Key.Key_Escape and self.worker.busy:
            self.cancel()
            event.accept()
        else:
            super().keyPressEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Let a picture in; networks are for the window."""
        self._accept(event)

    def dragMoveEvent(self, event: QDragMoveEvent) -> None:
        """The same on the way."""
        self._accept(event)

    def dropEvent(self, event: QDropEvent) -> None:
        """Fit to what is dropped."""
        picture = _dropped(event.mimeData())
        self._accept(event)
        if picture is not None:
            self.choose_picture(picture)

    def _accept(self, event: QDropEvent) -> None:
        if _dropped(event.mimeData()) is None:
            event.ignore()
        else:
            accept_copy(event)

    def _build(self) -> None:
        self.file = tool_button(
            "fit.file",
            "Picture…",
            "Choose the picture to fit to, or drop one here; the one measured last, if none is",
            self,
        )
        self.name = QLabel(_NO_PICTURE, self)
        self.name.setObjectName("fit.picture")
        self.name.setTextFormat(Qt.TextFormat.PlainText)
        self.fit = tool_button("fit.begin", "Fit", "Fit the free parameters to the picture", self)
        self.stop = tool_button("fit.cancel", "Cancel", "Stop the fit (Esc)", self)
        self.taking = tool_button("fit.take", "Take Values", _TAKE, self)
        self.remove = tool_button(
            "fit.remove", "Remove", "Fix the marked parameter again (Del)", self
        )
        self.which = QComboBox(self)
        self.which.setObjectName("fit.edges")
        self.which.setAccessibleName("Which edge is drawn")
        self.which.setToolTip("Which of the picture's edges is drawn")
        self.which.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        bar = QWidget(self)
        flow = FlowLayout(bar, across=4, down=2)
        flow.setContentsMargins(4, 4, 4, 2)
        for widget in (
            *(self.file, self.name, self.fit, self.stop, self.taking, self.remove, self.which),
        ):
            flow.addWidget(widget)
        self.table = FreeTable(self._session, self.theme, self)
        self.words = QPlainTextEdit(self)
        self.words.setObjectName("fit.words")
        self.words.setAccessibleName("What the fit says of itself")
        self.words.setReadOnly(True)
        self.words.setTabChangesFocus(True)
        self.words.setPlaceholderText(_NOTHING_FREE)
        self.chart = SpreadChart(self.theme, self)
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
        self.status = StatusLine("fit", "What is fitted, or why not", "", self)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(1)
        column.addWidget(bar)
        column.addWidget(halves, 1)
        column.addWidget(self.status)

    def _connect(self) -> None:
        self.file.clicked.connect(self.file_wanted)
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
        self._session.changed.connect(self._changed)

    def show_state(self) -> None:
        """Show what is free, and the picture."""
        self.table.write()
        picture = self.picture
        self.name.setText(_NO_PICTURE if picture is None else _name(picture))
        self.name.setToolTip("" if picture is None else _full(picture))
        self._show_buttons()
        if self.outcome is None and not self.worker.busy:
            count = len(self._session.free.all)
            self._say(f"{count} free" if count else _NOTHING_FREE)

    def _changed(self, *_: object) -> None:
        self.network_changed()

    @property
    def _determined(self) -> list[FittedNumber]:
        numbers = self.outcome.numbers if self.outcome is not None else ()
        return [one for one in numbers if one.value is not None]

    def _show_buttons(self) -> None:
        busy, free = self.worker.busy, self._session.free.all
        self.fit.setEnabled(not busy and bool(free) and self.picture is not None)
        self.stop.setEnabled(busy)
        self.taking.setEnabled(not busy and bool(self._determined))
        self.remove.setEnabled(bool(free) and self.table.currentRow() >= 0)
        self.which.setVisible(self.which.count() > 1)

    def _show_outcome(self, outcome: FitOutcome | None) -> None:
        self.outcome = outcome
        self.table.show_fitted(() if outcome is None else outcome.numbers)
        self.words.setPlainText("" if outcome is None else "\n".join(_lines(outcome)))
        self._show_edges(() if outcome is None else outcome.edges)

    def _show_edges(self, edges: tuple[DrawnEdge, ...]) -> None:
        """List them anew, with the one of the most samples chosen."""
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
        self.network_changed()

    def _fail(self, text: str) -> None:
        self._say(text, failed=True)
        self._show_buttons()

    def _stopped(self) -> None:
        self._say("Stopped")
        self._show_buttons()

    def _say_result(self) -> None:
        outcome = self.outcome
        if outcome is None:
            return
        count = len(self._determined)
        of = f"{count} of {len(outcome.numbers)} determined"
        warned = len(outcome.warnings)
        more = f", {warned} warning{'s' * (warned > 1)}" if warned else ""
        self._say(f"{of}, χ² per degree of freedom {outcome.chi2_per_degree:.3g}{more}")

    def _say(self, text: str, *, failed: bool = False) -> None:
        self.status.show_text(text, failed=failed)


def _lines(outcome: FitOutcome) -> list[str]:
    """The quality of a fit, its warnings and what was assumed."""
    return [
        f"χ² per degree of freedom {outcome.chi2_per_degree:.4g} ({outcome.degrees} degrees)",
        *(f"Warning: {line}." for line in outcome.warnings),
        *(f"{line[:1].upper()}{line[1:]}." for line in outcome.notes),
    ]


def _name(picture: Picture) -> str:
    return picture.name


def _full(picture: Picture) -> str:
    return str(picture) if isinstance(picture, Path) else picture.name


def _dropped(data: QMimeData) -> Path | None:
    """The picture file that is dragged; None of anything else."""
    paths = [Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile()]
    return paths[0] if len(paths) == 1 and paths[0].suffix.lower() not in JSON.suffixes else None
