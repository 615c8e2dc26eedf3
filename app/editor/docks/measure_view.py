"""Work on pictures beside the window, and the dock that measures: edges, their MTF, the noise."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QMimeData, QSignalBlocker, QSize, Qt, Signal

from app.editor import declared_text, messages, widgets
from app.editor.docks.edges import EdgeCanvas, EdgeTable, MtfChart, edge_words
from app.editor.evaluation.queries import as_error
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot.plot_export import have_plot_menu
from app.editor.viewers.viewer import StatusLine
from core.chain.wires import Image
from core.errors import Cancelled, UsageError
from core.network.network import Network
from nodes.files.file_format import CSV, HTML, JSON, dialog_filter

if TYPE_CHECKING:
    from app.measure.picture_measurement import MeasuredEdge, PictureFile, PictureMeasurement

    Pictures = tuple[Path, ...] | PictureFile

# Pictures that viewers show, ready to be measured.


def picture_of(number: int, viewer: ImageViewer) -> PictureFile:
    # Imported where it is used: the window opens without it.
    from app.measure.picture_measurement import PictureFile

    picture, port = viewer.picture, viewer.choices.port
    if picture is None or port is None:
        raise UsageError(f"viewer {number} shows no picture")
    value = picture.value
    if not isinstance(value, Image) or picture.facts.kind != "picture":
        raise UsageError(f"viewer {number} shows {port}, which is not a picture of a scene")
    if picture.reduced > 1:
        raise UsageError(f"viewer {number} still shows a preview: wait for the full-size picture")
    if viewer.choices.mapping == "spectrum" or viewer.choices.mode == "difference":
        raise UsageError(
            f"viewer {number} shows a spectrum or a difference: show the picture instead"
        )
    wavelengths = picture.facts.wavelengths_um
    taken = f"the band at {wavelengths[0]:.4g} µm" if wavelengths else ""
    return PictureFile.of(
        f"viewer {number}: {port}", [np.asarray(picture.samples)], unit=picture.facts.unit,
        interval_x_mrad=value.interval_x_mrad, interval_y_mrad=value.interval_y_mrad, taken=taken,
        band_um=picture.facts.band_um,
    )  # fmt: skip


def shown_in(viewers: Mapping[int, ImageViewer]) -> list[int]:
    return [number for number, viewer in sorted(viewers.items()) if viewer.picture is not None]


Report = Callable[[Any], None]
Job = Callable[[threading.Event, Report], Any]
_LONGEST_END_S = 20.0


def check_stop(stop: threading.Event) -> None:
    if stop.is_set():
        raise Cancelled("stopped on request")


class WorkerView(QtWidgets.QWidget):
    """Works on pictures, also on files that are dropped; networks are left to its window.

    One job at a time is carried out in a thread of its own; a new one stops the one before.
    """

    status: StatusLine
    _said = Signal(object, object, object)

    def __init__(self, name: str, words: str) -> None:
        super().__init__()
        widgets.labelled(self, name, words)
        self.setAcceptDrops(True)
        self._stop: threading.Event | None = None
        self._thread: threading.Thread | None = None
        self._said.connect(self._pass_on)

    def take_files(self, paths: tuple[Path, ...]) -> None:
        raise NotImplementedError

    def show_progress(self, what: Any) -> None:
        raise NotImplementedError

    def show_result(self, result: Any) -> None:
        raise NotImplementedError

    def show_end(self, text: str, *, failed: bool = False) -> None:
        self._say(text, failed=failed)
        self._show_buttons()

    @property
    def busy(self) -> bool:
        """Whether a job goes on whose result is wanted."""
        return self._stop is not None

    def start(self, job: Job) -> None:
        self.drop()
        self._stop = stop = threading.Event()
        self._thread = threading.Thread(target=self._carry_out, args=(job, stop), daemon=True)
        self._thread.start()

    def cancel(self) -> None:
        if self.busy:
            self.drop()
            self.show_end("Stopped")

    def drop(self) -> None:
        """Stop the job, and show nothing of it."""
        if self._stop is not None:
            self._stop.set()
            self._stop = None

    def end_work(self) -> None:
        self.drop()
        if self._thread is not None:
            self._thread.join(_LONGEST_END_S)
            self._thread = None

    def _carry_out(self, job: Job, stop: threading.Event) -> None:
        def say(shown: Callable[[Any], None], what: Any) -> None:
            if not stop.is_set():
                self._said.emit(stop, shown, what)

        try:
            result = job(stop, partial(say, self.show_progress))
        except Exception as raised:
            say(partial(self.show_end, failed=True), declared_text.error_text(as_error(raised)))
        else:
            say(self.show_result, result)

    def _pass_on(self, stop: object, shown: Any, what: Any) -> None:
        if stop is not self._stop:  # another one has begun since
            return
        if shown != self.show_progress:
            self._stop = None
        shown(what)

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(48 * line, 21 * line)

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and self.busy:
            self.cancel()
            event.accept()
        else:
            super().keyPressEvent(event)

    def dragEnterEvent(self, event: QtGui.QDragEnterEvent) -> None:
        if _dropped(event.mimeData()):
            widgets.accept_copy(event)

    def dropEvent(self, event: QtGui.QDropEvent) -> None:
        widgets.accept_copy(event)
        if event.isAccepted():
            self.take_files(_dropped(event.mimeData()))

    def _report(self, kind: str, text: str) -> None:
        self._say(text, failed=kind == "error")

    def _say(self, text: str, *, failed: bool = False) -> None:
        self.status.show_text(text, failed=failed)

    def _show_buttons(self) -> None:
        raise NotImplementedError


def split(across: Qt.Orientation, *parts: tuple[QtWidgets.QWidget, int]) -> QtWidgets.QSplitter:
    """Parts with their stretches, between which the person moves the border."""
    splitter = QtWidgets.QSplitter(across, childrenCollapsible=False)
    for index, (part, stretch) in enumerate(parts):
        splitter.addWidget(part)
        splitter.setStretchFactor(index, stretch)
    return splitter


def _dropped(data: QMimeData) -> tuple[Path, ...]:
    paths = tuple(map(Path, widgets.local_files(data)))
    network = any(path.suffix.lower() in JSON.suffixes for path in paths)
    return () if network or len(paths) < len(data.urls()) else paths


# The pictures that are measured, or fitted to: files, or what a viewer shows.


def pictures_name(pictures: Pictures) -> str:
    if not isinstance(pictures, tuple):
        return pictures.name
    more = len(pictures) - 1
    return pictures[0].name + (f" and {more} more" if more else "")


def pictures_text(pictures: Pictures) -> str:
    if not isinstance(pictures, tuple):
        return pictures.name
    return "\n".join(map(str, pictures))


_KINDS = ";;".join(
    (dialog_filter("Page", HTML), dialog_filter("Everything", JSON), dialog_filter("MTF", CSV))
)
_NO_BAND, _LAST_BAND = -1, 99_999
_BAND = (
    "Band to measure in a file with several bands (the first is 0). Leave at “–” for a file with "
    "one band, or for the luminance of a colour picture"
)


def _said(remark: str) -> tuple[messages.Severity, str]:
    text = remark.removeprefix("warning: ")
    return "information" if text == remark else "warning", messages.sentence(text)


class _Measuring(NamedTuple):
    """What is measured; of a viewer's picture, the network that it is of."""

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
        focus = QtWidgets.QApplication.focusWidget()
        in_use = [n for n in shown if focus is not None and self._viewers[n].isAncestorOf(focus)]
        self.measure_viewer((*in_use, *shown, 1)[0])

    def measure_viewer(self, number: int) -> None:
        try:
            picture = picture_of(number, self._viewers[number])
        except UsageError as error:
            self._say(str(error), failed=True)
            return
        self._files = ()

        def job(stop: threading.Event, report: Report) -> PictureMeasurement:
            from app.measure.measuring import measure_pictures

            return measure_pictures([picture], check=partial(check_stop, stop), report=report)

        network = self._session.document.network
        self._begin(_Measuring(picture.name, picture, network), job)

    def take_files(self, paths: tuple[Path, ...]) -> None:
        self._files = paths
        with QSignalBlocker(self.band):
            self.band.setValue(_NO_BAND)
        self._measure_band()

    def _measure_band(self, *_: object) -> None:
        paths, chosen = self._files, self.band.value()
        band = None if chosen == _NO_BAND else chosen
        if not paths:
            return

        def job(stop: threading.Event, report: Report) -> PictureMeasurement:
            from app.measure.measuring import measure_files

            return measure_files(paths, band, check=partial(check_stop, stop), report=report)

        of = "" if band is None else f", band {band}"
        self._begin(_Measuring(pictures_name(paths) + of, paths), job)

    def _choose_files(self) -> None:
        title, name = "Measure pictures from one camera", "measure_dialog"
        messages.choose_pictures(self.window(), title, name=name, chosen=self.take_files)

    def _choose_target(self) -> None:
        name, title = "measure_export_dialog", "Save the measurement"
        dialog = messages.SaveDialog(self.window(), name, title, _KINDS, self.export, suffix="html")
        dialog.selectFile("measured.html")
        messages.show_beside(self.window(), dialog)

    def _list_viewers(self) -> None:
        menu = self.viewer.menu()
        menu.clear()
        shown = shown_in(self._viewers)
        for number in shown:
            action = menu.addAction(f"Viewer &{number}: {self._viewers[number].choices.port}")
            action.setObjectName(f"measure.viewer_{number}")
            action.setData(number)
        if not shown:
            menu.addAction("No viewer shows a picture").setEnabled(False)

    def export(self, path: Path) -> None:
        measured = self.measured
        if measured is None:
            self._say("nothing has been measured yet", failed=True)
            return

        def job(_stop: threading.Event, _report: Report) -> Path:
            from app.measure.measurement_page import write_measurement

            write_measurement(measured, path)
            return path

        self._say(f"Writing {path.name} …")
        self.start(job)
        self._show_buttons()

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
        from app.measure.measuring import without_edge

        self.measured = without_edge(measured, self.current, again=not edge.used)
        self._show_all()

    def _forget_network(self) -> None:
        if self._coming is not None and self._coming.network is not None:
            self.drop()
            self._coming = None
        if self._shown is not None and self._shown.network is not None:
            self._shown, self.measured, self.current = None, None, -1
            self._show_all()
            self.source_changed.emit()
        self._show_buttons()

    # --- the widget --------------------------------------------------------------------------

    def _build(self) -> None:
        self.viewer = widgets.menu_button(
            "measure.viewer", "Measure Viewer", "Measure the picture in a viewer (Ctrl+M)", self
        )
        about = (
            "Measure one picture or several from the same camera; you can also drop pictures here"
        )
        self.file = widgets.tool_button("measure.file", "Files…", about, self, self._choose_files)
        about = "Stop measuring (Esc)"
        self.stop = widgets.tool_button("measure.cancel", "Cancel", about, self, self.cancel)
        about = "Exclude the selected edge from the pooled MTF, or include it again (Del)"
        self.remove = widgets.tool_button("measure.remove", "Remove Edge", about, self, self.switch)
        self.fit = widgets.tool_button("measure.fit", "Fit", "Show the whole picture (F)", self)
        self.unused = widgets.toggle_button(
            "measure.unused", "Not Used", "Also draw the edges that cannot be used", self
        )
        self.unused.setChecked(True)
        about = "Save all results (.json), the MTF (.csv) or a report (.html)"
        self.write = widgets.tool_button(
            "measure.export", "Export…", about, self, self._choose_target
        )
        about = "Picture to show"
        self.pictures = widgets.labelled(
            QtWidgets.QComboBox(self), "measure.pictures", about, about
        )
        band = QtWidgets.QSpinBox(
            self, prefix="Band ", specialValueText="Band –", keyboardTracking=False
        )
        self.band = widgets.labelled(band, "measure.band", _BAND, _BAND)
        self.band.setRange(_NO_BAND, _LAST_BAND)
        self.band.setValue(_NO_BAND)
        bar = QtWidgets.QWidget(self)
        buttons = (self.viewer, self.file, self.stop, self.remove, self.unused, self.fit)
        parts = (*buttons, self.write, self.band, self.pictures)
        widgets.filled(widgets.FlowLayout(bar, across=4, down=2), *parts, margins=(4, 4, 4, 2))
        self.notices = messages.NoticeList(
            "measure.notices", "Warnings and notes from the measurement", self
        )
        self.canvas = EdgeCanvas(self)
        self.chart = MtfChart(self)
        self.table = EdgeTable(self)
        self.figures = widgets.CopiedTable(("Figure", "Value", "Unit"), self)
        about = "MTF and noise figures; Ctrl+C copies them"
        widgets.labelled(self.figures, "measure.figures", about)
        self.tabs = widgets.labelled(QtWidgets.QTabWidget(self, documentMode=True), "measure.tabs")
        self.tabs.addTab(self.figures, "Figures")
        self.tabs.addTab(self.table, "Edges")
        self.tabs.tabBar().setAccessibleName("Figures or edges")
        self.right = split(Qt.Orientation.Vertical, (self.chart, 1), (self.tabs, 1))
        halves = split(Qt.Orientation.Horizontal, (self.canvas, 5), (self.right, 4))
        about = "Status of the measurement, or why no measurement is possible"
        self.status = StatusLine("measure", about, "Values there", self)
        widgets.filled(
            QtWidgets.QVBoxLayout(self), bar, self.notices, (halves, 1), self.status, spacing=1
        )

    def _connect(self) -> None:
        self.viewer.menu().aboutToShow.connect(self._list_viewers)
        self.viewer.menu().triggered.connect(lambda one: self.measure_viewer(one.data()))
        self.band.valueChanged.connect(self._measure_band)
        self.fit.clicked.connect(self.canvas.fit)
        self.unused.toggled.connect(self.canvas.show_unused)
        self.canvas.chosen.connect(self.choose)
        self.canvas.stepped.connect(self.step)
        self.canvas.switched.connect(self.switch)
        self.table.chosen.connect(self.choose)
        self.table.switched.connect(self.switch)
        self.chart.read.connect(self.status.show_more)
        self.pictures.currentIndexChanged.connect(self._show_picture)
        self._session.changed.connect(self._say_shown)
        self._session.opened.connect(self._forget_network)

    @property
    def _title(self) -> str:
        if self._shown is None:
            return ""
        title, _, own = self._shown
        now = self._session.document.network
        return title if own is None or own == now else f"{title} (measured before the latest edits)"

    def _begin(self, measuring: _Measuring, job: Job) -> None:
        self._say(f"Measuring {measuring.title} …")
        self.start(job)
        self._coming = measuring
        self._show_buttons()

    def show_progress(self, what: Any) -> None:
        self._say(f"Measuring {what} …")

    def show_result(self, result: Any) -> None:
        if isinstance(result, Path):
            self._session.message.emit("note", f"wrote {result}")
            self._say_shown()
            self._show_buttons()
            return
        self.measured = result
        self._shown, self._coming = self._coming, None
        self._show_all()
        self.choose(next((place for place, one in enumerate(result.edges) if one.used), -1))
        self.source_changed.emit()

    def show_end(self, text: str, *, failed: bool = False) -> None:
        measuring, self._coming = self._coming, None
        still = measuring is not None and self._shown is not None
        super().show_end(f"{text}; still showing {self._title}" if still else text, failed=failed)

    def _show_picture(self, _index: int) -> None:
        self.canvas.show_measured(self.measured, max(0, self.pictures.currentIndex()))

    def _show_all(self) -> None:
        measured = self.measured
        count = 0 if measured is None else len(measured.previews)
        names = [measured.picture_name(number) for number in range(count)] if measured else []
        shown = self.pictures.currentIndex()
        with QSignalBlocker(self.pictures):
            self.pictures.clear()
            self.pictures.addItems([Path(name).name for name in names])
            self.pictures.setCurrentIndex(min(max(shown, 0), len(names) - 1))
        self.pictures.setVisible(len(names) > 1)
        self._show_picture(0)
        self.table.show_measured(measured)
        self.right.setVisible(measured is not None)
        if measured is None:
            self.figures.show_rows(())
            self.notices.show_notices(())
        else:
            from app.measure.measurement_text import figure_rows, frame_rows, remarks

            rows = (*figure_rows(measured), *frame_rows(measured))
            self.figures.show_rows(
                [[(text, name) for text in (meaning, *value)] for name, *value, meaning in rows],
                right=1,
            )
            self.notices.show_notices(map(_said, remarks(measured)))
        self._show_edge()

    def _show_edge(self) -> None:
        self.chart.show_measured(self.measured, self.edge)
        self._show_buttons()
        self._say_shown()

    def _say_shown(self, *_: object) -> None:
        measured, edge = self.measured, self.edge
        if self.busy:
            return
        if measured is None:
            self._say("")
        elif edge is None:
            used = sum(one.used for one in measured.edges)
            self._say(f"{self._title}: {used} of {len(measured.edges)} edges are used")
        else:
            self._say(f"{self._title}: {edge_words(self.current, edge)}")

    def _show_buttons(self) -> None:
        edge, busy = self.edge, self.busy
        self.stop.setEnabled(busy)
        self.canvas.show_busy(busy)
        self.band.setEnabled(bool(self._files))
        self.write.setEnabled(self.measured is not None and not busy)
        self.fit.setEnabled(self.measured is not None)
        usable = edge is not None and edge.curve is not None
        self.remove.setEnabled(usable)
        again = usable and edge is not None and not edge.used
        self.remove.setText("Use Edge Again" if again else "Remove Edge")
