"""Work beside the window, one piece at a time, that can be stopped; and a fit as such work."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from PySide6.QtCore import QEvent, QMimeData, QObject, Qt, Signal
from PySide6.QtGui import QDropEvent, QKeyEvent
from PySide6.QtWidgets import QWidget

from app.editor.declared_text import FreeNumber, error_text
from app.editor.evaluation.badges import as_error
from app.editor.gestures import accept_copy, local_files
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.viewer import StatusLine
from app.editor.widgets import labelled
from core.chain.wires import Image
from core.errors import Cancelled, UsageError
from core.evaluation.policy import Policy
from core.evaluation.store import Store
from core.evaluation.work import Work
from core.modules.declaration import Library
from core.network.network import Network
from nodes.files.common.file_format import JSON

if TYPE_CHECKING:
    from app.fit.edge_fit import EdgesAt
    from app.fit.fit_result import FitResult
    from app.fit.free_parameter import FreeParameter
    from app.fit.patch import Patch
    from app.fit.picture_fit import FittedPictures

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
    if picture is None or port is None:
        raise UsageError(f"viewer {number} shows no picture")
    value = picture.value
    if not isinstance(value, Image) or picture.facts.kind != "picture":
        raise UsageError(f"viewer {number} shows {port}, which is not a picture of a scene")
    if picture.reduced > 1:
        raise UsageError(f"viewer {number} still shows a preview: wait for the picture itself")
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


Check = Callable[[], None]
Job = Callable[[Check, Callable[[str], None]], Any]
_LONGEST_END_S = 20.0


class MeasureWorker(QObject):
    progressed = Signal(str)  # (text): what the job has come to
    done = Signal(object)  # (result): it has ended
    failed = Signal(str)  # (text): it could not be carried out
    cancelled = Signal()  # it was stopped
    _ended = Signal(object, str, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._stop: threading.Event | None = None
        self._thread: threading.Thread | None = None
        self._ended.connect(self._take)

    @property
    def busy(self) -> bool:
        """Whether a job goes on whose result is wanted."""
        return self._stop is not None

    def start(self, job: Job) -> None:
        """Carry out a job; one that goes on still is stopped, and nothing of it is shown."""
        self.drop()
        stop = threading.Event()
        self._stop = stop
        self._thread = threading.Thread(
            target=self._carry_out, args=(job, stop), name="measure", daemon=True
        )
        self._thread.start()

    def cancel(self) -> None:
        if self._stop is not None:
            self.drop()
            self.cancelled.emit()

    def drop(self) -> None:
        if self._stop is not None:
            self._stop.set()
            self._stop = None

    def close(self) -> None:
        self.drop()
        if self._thread is not None:
            self._thread.join(_LONGEST_END_S)
            self._thread = None

    def _carry_out(self, job: Job, stop: threading.Event) -> None:
        def check() -> None:
            if stop.is_set():
                raise Cancelled("stopped on request")

        def report(text: str) -> None:
            if not stop.is_set():
                self.progressed.emit(text)

        try:
            result, error = job(check, report), ""
        except Exception as raised:
            result, error = None, error_text(as_error(raised))
        if not stop.is_set():
            self._ended.emit(result, error, stop)

    def _take(self, result: Any, error: str, stop: object) -> None:
        if stop is not self._stop:  # another one has begun since
            return
        self._stop = None
        if error:
            self.failed.emit(error)
        else:
            self.done.emit(result)


class WorkerView(QWidget):
    status: StatusLine

    def __init__(self, name: str, words: str) -> None:
        super().__init__()
        labelled(self, name, words)
        self.worker = MeasureWorker(self)

    def cancel(self) -> None:
        self.worker.cancel()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and self.worker.busy:
            self.cancel()
            event.accept()
        else:
            super().keyPressEvent(event)

    def _report(self, kind: str, text: str) -> None:
        self._say(text, failed=kind == "error")

    def _say(self, text: str, *, failed: bool = False) -> None:
        self.status.show_text(text, failed=failed)


# The pictures that are measured, or fitted to: files, or what a viewer shows.

Pictures = tuple[Path, ...] | ViewerPicture
_DRAGGING = (QEvent.Type.DragEnter, QEvent.Type.DragMove, QEvent.Type.Drop)


def pictures_name(pictures: Pictures) -> str:
    if isinstance(pictures, ViewerPicture):
        return pictures.name
    more = len(pictures) - 1
    return pictures[0].name + (f" and {more} more" if more else "")


def pictures_text(pictures: Pictures) -> str:
    if isinstance(pictures, ViewerPicture):
        return pictures.name
    return "\n".join(map(str, pictures))


class PictureDrops(QObject):
    """Takes picture files that are dropped on a widget. Networks are left to its window."""

    def __init__(self, widget: QWidget, taken: Callable[[tuple[Path, ...]], object]) -> None:
        super().__init__(widget)
        self._taken = taken
        widget.setAcceptDrops(True)
        widget.installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        if not isinstance(event, QDropEvent) or event.type() not in _DRAGGING:
            return False
        paths = _dropped(event.mimeData())
        if not paths:
            event.ignore()
            return True
        accept_copy(event)
        if event.type() == QEvent.Type.Drop and event.isAccepted():
            self._taken(paths)
        return True


def _dropped(data: QMimeData) -> tuple[Path, ...]:
    paths = tuple(map(Path, local_files(data)))
    network = any(path.suffix.lower() in JSON.suffixes for path in paths)
    return () if network or len(paths) < len(data.urls()) else paths


_HELD_BYTES = 1 << 28
_PAUSE_S = 0.05  # between edges that are shown while values change


@dataclass(frozen=True)
class FitTask:
    network: Network  # its macros written out
    library: Library
    folder: Path
    numbers: tuple[FreeNumber, ...]  # those that are free
    pictures: Pictures


class DrawnEdge(NamedTuple):
    """An edge's samples by their distance from it, and the chain's spread there, from 0 to 1."""

    name: str
    distance: Any
    sample: Any
    spread: Any


class FittedNumber(NamedTuple):
    """A parameter as fitted; both numbers are None where the picture does not determine it."""

    number: FreeNumber
    value: float | None
    sigma: float | None


class FitOutcome(NamedTuple):
    numbers: tuple[FittedNumber, ...]
    chi2_per_degree: float
    degrees: int
    warnings: tuple[str, ...]
    notes: tuple[str, ...]
    edges: tuple[DrawnEdge, ...]


Watch = Callable[[tuple[DrawnEdge, ...]], None]


class CheckedWork(Work):
    """An evaluation that stops when a check of the caller's raises."""

    def __init__(self, policy: Policy, store: Store, check: Callable[[], None]) -> None:
        super().__init__(policy, store)
        self._check = check

    def check(self) -> None:
        self._check()


def fit_to_picture(
    task: FitTask, check: Callable[[], None], report: Callable[[str], None], watch: Watch
) -> FitOutcome:
    # Imported where it is used: the window opens without it.
    from app.fit.picture_fit import fit_pictures
    from core.chain.engine import Engine
    from core.network.validation import check_network

    check_network(task.network, library=task.library)
    free = limited_parameters(task)
    engine = Engine(task.library, Store(_HELD_BYTES))
    plan = engine.plan(task.network, folder=task.folder)
    work = CheckedWork(Policy(), engine.store, check)
    report("picture")
    pictures = _pictures(task.pictures)
    check()
    seen = _Paced(check, watch)
    result = fit_pictures(
        engine, plan, work, free=free, pictures=pictures, report=report, watch=seen
    )
    return _outcome(task, result)


def limited_parameters(task: FitTask) -> tuple[FreeParameter, ...]:
    from app.fit.free_parameter import free_parameters

    if not task.numbers:
        raise UsageError(
            "no parameter is free: right-click a number on a panel and choose Free for a fit"
        )
    ports = [one.port for one in task.numbers]
    free = free_parameters(ports, task.network, task.library, option="")
    limited = []
    for one, parameter in zip(task.numbers, free, strict=True):
        low = parameter.low if one.low is None else one.low
        high = parameter.high if one.high is None else one.high
        if not low < high:
            raise UsageError(f"{one.port}: the low limit, {low:g}, must lie below {high:g}")
        limited.append(replace(parameter, low=low, high=high))
    return tuple(limited)


class _Paced:
    def __init__(self, check: Callable[[], None], watch: Watch) -> None:
        self._check, self._watch = check, watch
        self._next = 0.0

    def __call__(self, patches: tuple[Patch, ...], edges: EdgesAt) -> None:
        self._check()
        now = time.monotonic()
        if now >= self._next:
            self._next = now + _PAUSE_S
            self._watch(drawn_edges(patches, edges))


def drawn_edges(patches: tuple[Patch, ...], edges: EdgesAt) -> tuple[DrawnEdge, ...]:
    drawn = []
    for row, patch in enumerate(patches):
        count = len(patch.value)
        weight = edges.weight[row, :count]
        spread = edges.spread[row, :count].copy()
        with np.errstate(all="ignore"):
            rest = edges.residual[row, :count] / weight / edges.step[row]
        drawn.append(
            DrawnEdge(patch.name, edges.distance[row, :count].copy(), spread + rest, spread)
        )
    return tuple(drawn)


def _pictures(pictures: Pictures) -> FittedPictures:
    from app.fit.picture_fit import FittedPictures, TakenWith, read_pictures
    from app.measure.picture_loading import BandsError

    if not isinstance(pictures, ViewerPicture):
        try:
            return read_pictures(pictures)
        except BandsError as error:
            raise UsageError(
                f"{error.what}: show one of them in a viewer and fit to that"
            ) from error
    taken = TakenWith(
        pictures.name, pictures.interval_x_mrad, pictures.interval_y_mrad, pictures.band_um
    )
    samples = (np.asarray(pictures.samples, np.float64),)
    return FittedPictures((pictures.name,), samples, taken=(taken,))


def _outcome(task: FitTask, result: FitResult) -> FitOutcome:
    fit = result.fit
    numbers = tuple(
        FittedNumber(number, one.value, one.sigma)
        for number, one in zip(task.numbers, result.parameters, strict=True)
    )
    noise = (result.noise,) if isinstance(result.noise, str) and result.noise else ()
    edges = drawn_edges(fit.patches, fit.edges)
    return FitOutcome(
        numbers,
        result.chi2_per_degree,
        fit.misfit.degrees,
        result.warnings,
        (*result.notes, *noise),
        edges,
    )
