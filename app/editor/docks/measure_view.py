"""The measuring dock: a picture with its edges, the MTF they give, and the noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtWidgets import (
    QApplication,
    QComboBox,
    QSpinBox,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from app.editor.dialogs import SaveDialog, choose_pictures, show_beside
from app.editor.docks.background_work import (
    Check,
    PictureDrops,
    Pictures,
    WorkerView,
    picture_of,
    pictures_name,
    shown_in,
)
from app.editor.docks.edges import EdgeCanvas, EdgeTable, FigureTable, MtfChart, edge_words
from app.editor.gestures import without_argument
from app.editor.notices import NoticeList, Severity, sentence
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot.plot_export import have_plot_menu
from app.editor.viewers.viewer import StatusLine
from app.editor.widgets import FlowLayout, filled, labelled, menu_button, toggle_button, tool_button
from core.errors import UsageError
from core.network.network import Network
from nodes.files.common.file_format import CSV, HTML, JSON, dialog_filter

if TYPE_CHECKING:
    from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement


_KINDS = ";;".join(
    (dialog_filter("Page", HTML), dialog_filter("Everything", JSON), dialog_filter("MTF", CSV))
)
_REMOVE, _USE = "Remove Edge", "Use Edge Again"


def _said(remark: str) -> tuple[Severity, str]:
    text = remark.removeprefix("warning: ")
    return "information" if text == remark else "warning", sentence(text)


@dataclass(frozen=True)
class _Measuring:
    title: str
    pictures: Pictures
    network: Network | None = None


class MeasureView(WorkerView):
    """Measures what viewers show, or files, in the background, and shows what that gives."""

    source_changed = Signal()  # other pictures are shown as measured

    def __init__(self, session: Session, viewers: Mapping[int, ImageViewer]) -> None:
        super().__init__("measure", "Measure a picture")
        self._session = session
        self._viewers = viewers
        self.measured: PictureMeasurement | None = None
        self.current = -1
        self._shown: _Measuring | None = None
        self._coming: _Measuring | None = None
        self._files: tuple[Path, ...] = ()
        self.drops = PictureDrops(self, self.measure_files)
        self._build()
        self._connect()
        have_plot_menu(self.chart, self._report, table=self._choose_target)
        have_plot_menu(self.canvas, self._report)
        self._show_all()

    # --- measuring ---------------------------------------------------------------------------

    @property
    def source(self) -> Pictures | None:
        return self._shown.pictures if self._shown is not None else None

    def measure_shown(self) -> None:
        """Measure what the viewer with the focus shows, or the first that shows something."""
        shown = shown_in(self._viewers)
        focus = QApplication.focusWidget()
        in_use = [n for n in shown if focus is not None and self._viewers[n].isAncestorOf(focus)]
        self.measure_viewer((*in_use, *shown, 1)[0])

    def measure_viewer(self, number: int) -> None:
        try:
            picture = picture_of(number, self._viewers[number])
        except UsageError as error:
            self._say(str(error), failed=True)
            return
        self._files = ()

        def job(check: Check, report: Callable[[str], None]) -> PictureMeasurement:
            # Imported where it is used: the window opens without it.
            from app.measure.measuring import Source, measure_pictures
            from app.measure.picture_measurement import MeasuredFile

            rows, columns = picture.samples.shape
            samples = picture.samples.astype("float64")
            return measure_pictures(
                Source(
                    (MeasuredFile(picture.name, 1, picture.taken),), [samples],
                    rows, columns, picture.unit, picture.interval_x_mrad, picture.interval_y_mrad,
                ),
                check=check,
                report=report,
            )  # fmt: skip

        network = self._session.document.network
        self._begin(_Measuring(picture.name, picture, network), job)

    def measure_files(self, paths: tuple[Path, ...]) -> None:
        self._files = paths
        with QSignalBlocker(self.band):
            self.band.choose_none()
        self._measure_band()

    def _measure_band(self, *_: object) -> None:
        paths, band = self._files, self.band.band
        if not paths:
            return

        def job(check: Check, report: Callable[[str], None]) -> PictureMeasurement:
            from app.measure.measuring import MeasurePlan, measure_files

            return measure_files(MeasurePlan(paths, band=band), check=check, report=report)

        of = "" if band is None else f", band {band}"
        self._begin(_Measuring(pictures_name(paths) + of, paths), job)

    def _choose_files(self) -> None:
        title, name = "Measure pictures of one camera", "measure_dialog"
        choose_pictures(self.window(), title, name=name, chosen=self.measure_files)

    def _choose_target(self) -> None:
        name, title = "measure_export_dialog", "Save the measurement"
        dialog = SaveDialog(self.window(), name, title, _KINDS, self.export, suffix="html")
        dialog.selectFile("measured.html")
        show_beside(self.window(), dialog)

    def _list_viewers(self) -> None:
        menu = self.viewer.menu()
        menu.clear()
        shown = shown_in(self._viewers)
        for number in shown:
            action = menu.addAction(f"Viewer &{number}: {self._viewers[number].choices.port}")
            action.setObjectName(f"measure.viewer_{number}")
            measure = partial(self.measure_viewer, number)
            action.triggered.connect(partial(without_argument, measure))
        if not shown:
            menu.addAction("No viewer shows a picture").setEnabled(False)

    def export(self, path: Path) -> None:
        measured = self.measured
        if measured is None:
            self._say("nothing has been measured yet", failed=True)
            return

        def job(_check: Check, _report: Callable[[str], None]) -> Path:
            from app.measure.measurement_files import write_measurement

            write_measurement(measured, path)
            return path

        self._say(f"Writing {path.name} …")
        self._start(job)

    # --- edges -------------------------------------------------------------------------------

    @property
    def edge(self) -> MeasuredEdge | None:
        if self.measured is None or not 0 <= self.current < len(self.measured.edges):
            return None
        return self.measured.edges[self.current]

    def choose(self, place: int) -> None:
        self.current = place
        edge = self.edge
        if edge is not None and edge.picture < self.pictures.count():
            self.pictures.setCurrentIndex(edge.picture)
        self.canvas.choose(place)
        self.table.choose(place)
        self._show_edge()

    def step(self, by: int) -> None:
        if self.measured is not None and self.measured.edges:
            self.choose((self.current + by) % len(self.measured.edges))

    def switch(self) -> None:
        """Remove the chosen edge, or use it again; the MTF is pooled anew."""
        measured, edge = self.measured, self.edge
        if measured is None or edge is None:
            return
        if edge.curve is None:
            self._say(f"edge {self.current + 1} cannot be used: {edge.why_not}", failed=True)
            return
        from app.measure.measuring import with_edge, without_edge

        change = without_edge if edge.used else with_edge
        self.measured = change(measured, self.current)
        self._show_all()

    def _network_changed(self, *_: object) -> None:
        if self._shown is not None and not self.worker.busy:
            self._say_shown()

    def _forget_network(self) -> None:
        if self._coming is not None and self._coming.network is not None:
            self.worker.drop()
            self._coming = None
        if self._shown is not None and self._shown.network is not None:
            self._shown, self.measured, self.current = None, None, -1
            self._fill_pictures()
            self._show_all()
            self.source_changed.emit()
        self._show_buttons()

    # --- the widget --------------------------------------------------------------------------

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(48 * line, 22 * line)

    def _build(self) -> None:
        self.viewer = menu_button(
            "measure.viewer", "Measure Viewer", "Measure the picture of a viewer (Ctrl+M)", self
        )
        self.file = tool_button(
            "measure.file",
            "Files…",
            "Measure a picture, or several from the same camera together; you can also drop "
            "them here",
            self,
        )
        self.stop = tool_button("measure.cancel", "Cancel", "Stop measuring (Esc)", self)
        self.remove = tool_button("measure.remove", _REMOVE, "", self)
        self.fit = tool_button("measure.fit", "Fit", "Show the whole picture (F)", self)
        self.unused = toggle_button(
            "measure.unused", "Not Used", "Also draw the edges that cannot be used", self
        )
        self.unused.setChecked(True)
        self.write = tool_button(
            "measure.export",
            "Export…",
            "Save everything (.json), the MTF (.csv) or a page (.html)",
            self,
        )
        self.pictures = labelled(
            QComboBox(self), "measure.pictures", "Picture to show", "Picture to show"
        )
        self.band = BandBox(self)
        bar = QWidget(self)
        buttons = (self.viewer, self.file, self.stop, self.remove, self.unused, self.fit)
        parts = (*buttons, self.write, self.band, self.pictures)
        filled(FlowLayout(bar, across=4, down=2), *parts, margins=(4, 4, 4, 2))
        self.notices = NoticeList("measure.notices", "Warnings and notes of the measurement", self)
        self.canvas = EdgeCanvas(self)
        self.chart = MtfChart(self)
        self.table = EdgeTable(self)
        self.figures = FigureTable(self)
        self.tabs = labelled(QTabWidget(self, documentMode=True), "measure.tabs")
        self.tabs.addTab(self.figures, "Figures")
        self.tabs.addTab(self.table, "Edges")
        self.tabs.tabBar().setAccessibleName("Figures or edges")
        right = QSplitter(Qt.Orientation.Vertical, self)
        right.addWidget(self.chart)
        right.addWidget(self.tabs)
        right.setStretchFactor(0, 1)
        right.setStretchFactor(1, 1)
        self.halves = QSplitter(Qt.Orientation.Horizontal, self)
        self.halves.addWidget(self.canvas)
        self.halves.addWidget(right)
        self.halves.setStretchFactor(0, 5)
        self.halves.setStretchFactor(1, 4)
        for splitter in (right, self.halves):
            splitter.setChildrenCollapsible(False)
        self.status = StatusLine(
            "measure", "What is measured, or why it cannot be", "Values there", self
        )
        filled(QVBoxLayout(self), bar, self.notices, (self.halves, 1), self.status, spacing=1)

    def _connect(self) -> None:
        self.file.clicked.connect(self._choose_files)
        self.viewer.menu().aboutToShow.connect(self._list_viewers)
        self.band.valueChanged.connect(self._measure_band)
        self.write.clicked.connect(self._choose_target)
        self.stop.clicked.connect(self.cancel)
        self.remove.clicked.connect(self.switch)
        self.fit.clicked.connect(self.canvas.fit)
        self.unused.toggled.connect(self.canvas.show_unused)
        self.canvas.chosen.connect(self.choose)
        self.canvas.stepped.connect(self.step)
        self.canvas.switched.connect(self.switch)
        self.table.chosen.connect(self.choose)
        self.table.switched.connect(self.switch)
        self.chart.read.connect(self.status.show_more)
        self.pictures.currentIndexChanged.connect(self._show_picture)
        self.worker.progressed.connect(lambda text: self._say(f"Measuring {text} …"))
        self.worker.done.connect(self._take)
        self.worker.failed.connect(self._fail)
        self.worker.cancelled.connect(self._stopped)
        self._session.changed.connect(self._network_changed)
        self._session.opened.connect(self._forget_network)

    @property
    def _title(self) -> str:
        if self._shown is None:
            return ""
        title, own = self._shown.title, self._shown.network
        now = self._session.document.network
        old = own is not None and own is not now and own != now
        return f"{title}, before an edit" if old else title

    def _begin(self, measuring: _Measuring, job: Callable[..., object]) -> None:
        self._say(f"Measuring {measuring.title} …")
        self._start(job)
        self._coming = measuring

    def _start(self, job: Callable[..., object]) -> None:
        self.worker.start(job)
        self._show_buttons()

    def _take(self, result: object) -> None:
        if isinstance(result, Path):
            self._session.message.emit("note", f"wrote {result}")
            self._say_shown()
            self._show_buttons()
            return
        self.measured = result  # type: ignore[assignment] # a measurement
        self._shown, self._coming = self._coming, None
        self.current = -1
        self._fill_pictures()
        self._show_all()
        used = [place for place, edge in enumerate(self.measured.edges) if edge.used]  # type: ignore[union-attr]
        self.choose(used[0] if used else -1)
        self.source_changed.emit()

    def _fail(self, text: str) -> None:
        kept = self._coming is not None and self._shown is not None
        self._coming = None
        self._say(f"{text}; still showing {self._title}" if kept else text, failed=True)
        self._show_buttons()

    def _stopped(self) -> None:
        self._coming = None
        self._say(f"Stopped; still showing {self._title}" if self._shown is not None else "Stopped")
        self._show_buttons()

    def _fill_pictures(self) -> None:
        measured = self.measured
        self.pictures.blockSignals(True)
        self.pictures.clear()
        if measured is not None:
            for preview in measured.previews:
                self.pictures.addItem(Path(measured.picture_name(preview.picture)).name)
        self.pictures.blockSignals(False)
        self.pictures.setVisible(self.pictures.count() > 1)

    def _show_picture(self, _index: int) -> None:
        self.canvas.show_measured(self.measured, max(0, self.pictures.currentIndex()))

    def _show_all(self) -> None:
        measured = self.measured
        self._show_picture(0)
        self.pictures.setVisible(self.pictures.count() > 1)
        self.table.show_measured(measured)
        if measured is None:
            self.figures.show_rows(())
            self.notices.show_notices(())
        else:
            from app.measure.measurement_text import figure_rows, frame_rows, remarks

            self.figures.show_rows([*figure_rows(measured), *frame_rows(measured)])
            self.notices.show_notices(map(_said, remarks(measured)))
        self._show_edge()

    def _show_edge(self) -> None:
        measured, edge = self.measured, self.edge
        self.chart.show_measured(measured, edge)
        self._show_buttons()
        self._say_shown()

    def _say_shown(self) -> None:
        measured, edge = self.measured, self.edge
        if measured is None:
            self._say("")
        elif edge is None:
            used = sum(one.used for one in measured.edges)
            self._say(f"{self._title}: {used} of {len(measured.edges)} edges are used")
        else:
            self._say(f"{self._title}: {edge_words(self.current, edge)}")

    def _show_buttons(self) -> None:
        edge, busy = self.edge, self.worker.busy
        self.stop.setEnabled(busy)
        self.band.setEnabled(bool(self._files))
        self.write.setEnabled(self.measured is not None and not busy)
        self.fit.setEnabled(self.measured is not None)
        self.remove.setEnabled(edge is not None and edge.curve is not None)
        again = edge is not None and not edge.used
        self.remove.setText(_USE if again and edge is not None and edge.curve else _REMOVE)
        about = (
            "First select an edge in the picture or in the list"
            if edge is None
            else f"Edge {self.current + 1} cannot be used: {edge.why_not}"
            if edge.curve is None
            else "Use the selected edge in the pooled MTF again (Del)"
            if again
            else "Leave the selected edge out of the pooled MTF (Del)"
        )
        self.remove.setToolTip(about)
        self.remove.setAccessibleName(about)


# Which band of files that have several is measured.

_NONE, _MOST = -1, 99_999
_ABOUT = "Band to measure in files with several bands, counted from 0"


class BandBox(QSpinBox):
    """A band's number, or none: the only band there is, or the luminance of colours."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("measure.band")
        self.setAccessibleName(_ABOUT)
        self.setToolTip(f"{_ABOUT}; –: the only band, or the luminance of a colour picture")
        self.setRange(_NONE, _MOST)
        self.setPrefix("Band ")
        self.setSpecialValueText("Band –")
        self.setKeyboardTracking(False)
        self.setValue(_NONE)

    @property
    def band(self) -> int | None:
        return None if self.value() == _NONE else self.value()

    def choose_none(self) -> None:
        self.setValue(_NONE)
