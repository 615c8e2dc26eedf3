"""Work beside the window, one piece at a time, and the pictures that it is done on."""

import threading
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QMimeData, QObject, QSize, Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import QSplitter, QWidget

from app.editor.declared_text import error_text
from app.editor.evaluation.badges import as_error
from app.editor.gestures import accept_copy, local_files
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.viewer import StatusLine
from app.editor.widgets import labelled
from core.chain.wires import Image
from core.errors import Cancelled, UsageError
from core.records import dataclass
from nodes.files.file_format import JSON

# Pictures that viewers show, ready to be measured.


@dataclass(frozen=True, eq=False)
class ViewerPicture:
    name: str
    samples: Any
    unit: str
    interval_x_mrad: float | None
    interval_y_mrad: float | None
    taken: str
    band_um: tuple[float, float] | None = None


def picture_of(number: int, viewer: ImageViewer) -> ViewerPicture:
    picture, port = viewer.picture, viewer.choices.port
    if picture is None:
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
    return ViewerPicture(
        f"viewer {number}: {port}", np.asarray(picture.samples), picture.facts.unit,
        value.interval_x_mrad, value.interval_y_mrad, taken, picture.facts.band_um,
    )  # fmt: skip


def shown_in(viewers: Mapping[int, ImageViewer]) -> list[int]:
    return [number for number, viewer in sorted(viewers.items()) if viewer.picture is not None]


Report = Callable[[Any], None]
Job = Callable[[threading.Event, Report], Any]
_LONGEST_END_S = 20.0


def check_stop(stop: threading.Event) -> None:
    if stop.is_set():
        raise Cancelled("stopped on request")


class MeasureWorker(QObject):
    """One job at a time in a thread of its own; a new one stops the one before."""

    progressed = Signal(object)  # what the job has come to
    done = Signal(object)  # (result): it has ended
    failed = Signal(str)  # (text): it could not be carried out
    cancelled = Signal()  # it was stopped
    _said = Signal(object, str, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._stop: threading.Event | None = None
        self._thread: threading.Thread | None = None
        self._said.connect(self._pass_on)

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
        if self._stop is not None:
            self.drop()
            self.cancelled.emit()

    def drop(self) -> None:
        """Stop the job, and show nothing of it."""
        if self._stop is not None:
            self._stop.set()
            self._stop = None

    def close(self) -> None:
        self.drop()
        if self._thread is not None:
            self._thread.join(_LONGEST_END_S)
            self._thread = None

    def _carry_out(self, job: Job, stop: threading.Event) -> None:
        def say(signal: str, what: Any) -> None:
            if not stop.is_set():
                self._said.emit(stop, signal, what)

        try:
            result = job(stop, partial(say, "progressed"))
        except Exception as raised:
            say("failed", error_text(as_error(raised)))
        else:
            say("done", result)

    def _pass_on(self, stop: object, signal: str, what: Any) -> None:
        if stop is not self._stop:  # another one has begun since
            return
        if signal != "progressed":
            self._stop = None
        getattr(self, signal).emit(what)


class WorkerView(QWidget):
    """Works on pictures, also on files that are dropped; networks are left to its window."""

    status: StatusLine

    def __init__(self, name: str, words: str) -> None:
        super().__init__()
        labelled(self, name, words)
        self.setAcceptDrops(True)
        self.worker = MeasureWorker(self)

    def take_files(self, paths: tuple[Path, ...]) -> None:
        raise NotImplementedError

    def cancel(self) -> None:
        self.worker.cancel()

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(48 * line, 21 * line)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and self.worker.busy:
            self.cancel()
            event.accept()
        else:
            super().keyPressEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if _dropped(event.mimeData()):
            accept_copy(event)

    def dropEvent(self, event: QDropEvent) -> None:
        accept_copy(event)
        if event.isAccepted():
            self.take_files(_dropped(event.mimeData()))

    def _report(self, kind: str, text: str) -> None:
        self._say(text, failed=kind == "error")

    def _say(self, text: str, *, failed: bool = False) -> None:
        self.status.show_text(text, failed=failed)


def split(across: Qt.Orientation, *parts: tuple[QWidget, int]) -> QSplitter:
    """Parts with their stretches, between which the person moves the border."""
    splitter = QSplitter(across, childrenCollapsible=False)
    for index, (part, stretch) in enumerate(parts):
        splitter.addWidget(part)
        splitter.setStretchFactor(index, stretch)
    return splitter


def _dropped(data: QMimeData) -> tuple[Path, ...]:
    paths = tuple(map(Path, local_files(data)))
    network = any(path.suffix.lower() in JSON.suffixes for path in paths)
    return () if network or len(paths) < len(data.urls()) else paths


# The pictures that are measured, or fitted to: files, or what a viewer shows.

Pictures = tuple[Path, ...] | ViewerPicture


def pictures_name(pictures: Pictures) -> str:
    if isinstance(pictures, ViewerPicture):
        return pictures.name
    more = len(pictures) - 1
    return pictures[0].name + (f" and {more} more" if more else "")


def pictures_text(pictures: Pictures) -> str:
    if isinstance(pictures, ViewerPicture):
        return pictures.name
    return "\n".join(map(str, pictures))
