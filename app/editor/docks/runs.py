"""The runs of a window: those waiting, the one that runs, and those that have ended; their list."""

import contextlib
import itertools
import math
import time
from pathlib import Path
from typing import Any, Literal

from PySide6 import QtWidgets
from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, QSize, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QIcon, QKeySequence, QPixmap, QShortcut

from app.editor.declared_text import tip
from app.editor.session import Session
from app.editor.widgets import FlowLayout, centred_hint, filled, labelled, tool_button
from app.run.job import Job, Kind, Result, message_line, read_message
from app.run.terminal import command, environment
from core.atomic import sweep
from core.errors import NetworkError, in_line

State = Literal["waiting", "running", "stopping", "done", "failed", "cancelled"]
_SURE = 0.1  # the share that must be done before the speed is known
_PATIENCE_MS = 15_000  # a stop is seen between two blocks of work; then it is ended by force
_CLOSING_MS = 3_000  # the same where the window waits for it
_PREFIX = "imagechain: "


class Run(QObject):
    """A job in a process of its own, which stops by itself when its input ends.

    `text` says why it failed, `result` is there once it is done.
    """

    changed = Signal()  # it has another state, or is further

    def __init__(self, title: str, job: Job, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.title, self.job = title, job
        self.state: State = "waiting"
        self.share, self.doing = 0.0, ""
        self.begun = self.seconds = 0.0
        self.first: tuple[float, float] | None = None  # moment and share once it was loaded
        self.text = ""
        self.result: Result | None = None
        self._errors = b""
        self._process = QProcess(self)
        self._process.setProcessEnvironment(python_environment())
        self._process.readyReadStandardOutput.connect(self._read)
        self._process.readyReadStandardError.connect(self._read_errors)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)

    @property
    def is_over(self) -> bool:
        return self.state in ("done", "failed", "cancelled")

    @property
    def pid(self) -> int:
        return self._process.processId()

    @property
    def page(self) -> Path | None:
        return self.result.page if self.result is not None else None

    @property
    def folder(self) -> Path:
        return self.job.output.parent if self.job.kind == "report" else self.job.output

    def left_s(self, now: float) -> float | None:
        """Seconds until it is done; None while its speed is not known."""
        began, before = self.first or (now, self.share)
        done = self.share - before
        return (now - began) * (1 - self.share) / done if done >= _SURE else None

    def start(self) -> None:
        self.begun = time.monotonic()
        program, *words = command("app.command.run_job")
        self._process.start(program, words)
        self._process.write((message_line(self.job) + "\n").encode("ascii"))
        self._set("running")

    def stop(self) -> None:
        if self.state == "waiting":
            self._set("cancelled")
        elif self.state == "running":
            self._process.closeWriteChannel()
            self._process.terminate()
            QTimer.singleShot(_PATIENCE_MS, self._process, self._process.kill)
            self._set("stopping")

    def close(self) -> None:
        """Wait until it has stopped."""
        if not self.is_over and not self._process.waitForFinished(_CLOSING_MS):
            self._process.kill()
            self._process.waitForFinished(_CLOSING_MS)

    def _read(self) -> None:
        while self._process.canReadLine():
            line = bytes(self._process.readLine().data()).decode("utf-8", "replace").rstrip()
            message = read_message(line)
            if isinstance(message, Result):
                self.result = message
            elif isinstance(message, tuple) and self.state == "running":
                self.share, self.doing = message
                self.first = self.first or (time.monotonic(), self.share)
                self.changed.emit()

    def _read_errors(self) -> None:
        self._errors += bytes(self._process.readAllStandardError().data())

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._end("failed", f"Python cannot be started: {self._process.errorString()}")

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._read()
        self._read_errors()
        crashed = status == QProcess.ExitStatus.CrashExit
        if crashed:
            output = self.job.output
            with contextlib.suppress(OSError):
                sweep(next(folder for folder in (output, *output.parents) if folder.is_dir()))
        if self.result is not None and code == 0 and not crashed:
            self._end("done")
        elif self.state == "stopping":
            self._end("cancelled")
        elif crashed:
            text = f"the system ended the process (signal {code}): memory may have run out"
            self._end("failed", text)
        else:
            lines = self._errors.decode("utf-8", "replace").strip().splitlines()
            said = lines[-1] if lines else "the process stopped without an error message"
            self._end("failed", in_line(said.removeprefix(_PREFIX)))

    def _end(self, state: State, text: str = "") -> None:
        self.text = text
        self.seconds = time.monotonic() - self.begun
        self._set(state)

    def _set(self, state: State) -> None:
        self.state = state
        self.changed.emit()


class RunQueue(QObject):
    """Carries runs out one after the other, reports at once."""

    changed = Signal(object)  # (run): it has another state, or is further
    listed = Signal()  # a run has been added or removed

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.runs: list[Run] = []
        self._closed = False

    @property
    def unfinished(self) -> list[Run]:
        return [run for run in self.runs if not run.is_over]

    def add(self, title: str, job: Job) -> Run:
        """Put a run at the end of the list, and begin where nothing else runs."""
        run = Run(title, job, self)
        run.changed.connect(lambda: self._follow(run))
        self.runs.append(run)
        self.listed.emit()
        self._go_on()
        return run

    def clear(self) -> None:
        for run in self.runs:
            if run.is_over:
                run.deleteLater()
        self.runs = self.unfinished
        self.listed.emit()

    def close(self) -> None:
        """Stop what runs and begin nothing more; returns once no process is left."""
        self._closed = True
        going = self.unfinished
        for run in going:
            run.stop()  # all at once: they clear away side by side
        for run in going:
            run.close()

    def _follow(self, run: Run) -> None:
        self.changed.emit(run)
        self._go_on()

    def _go_on(self) -> None:
        going = [run for run in self.runs if run.state in ("running", "stopping")]
        busy = any(run.job.kind != "report" for run in going)
        for run in self.runs:
            at_once = run.job.kind == "report"
            if run.state == "waiting" and not self._closed and (at_once or not busy):
                busy = busy or not at_once
                run.start()


def python_environment() -> QProcessEnvironment:
    made = QProcessEnvironment()
    for name, value in environment().items():
        made.insert(name, value)
    return made


# The network of the window as it is now, as a job.


def job_of(session: Session, kind: Kind, output: Path, **choices: Any) -> Job:
    """A job of the document as it stands, unsaved changes too; `choices` as for `Job`."""
    document = session.document
    if not document.network.nodes:
        raise NetworkError("the network has no nodes")
    return Job(
        kind,
        document.text(),
        document.folder.absolute(),
        None if document.path is None else document.path.absolute(),
        output.absolute(),
        chosen=session.chosen_outputs,
        **choices,
    )


def proposed_folder(session: Session, kind: str, taken: set[Path]) -> Path:
    """A folder beside the document's file that is not there yet, and nobody else's to be."""
    path = session.document.path
    base = path.parent.absolute() if path is not None else Path.cwd()
    first = base / f"{session.stem}-{kind}"
    others = (first.with_name(f"{first.name}-{number}") for number in itertools.count(2))
    free = (one for one in itertools.chain([first], others) if one not in taken)
    return next(folder for folder in free if not folder.exists())


_TICK_MS = 1000
_ONE_PX, _SEVERAL_PX = 160, 96
_HINT = (
    "No runs yet. Click Add… to start a parameter sweep, frames, a list of pictures, or one run "
    "that also writes the network's files. You can edit during a run."
)


class RunsView(QtWidgets.QWidget):
    add_wanted = Signal()  # another run is to be added

    def __init__(self, queue: RunQueue) -> None:
        super().__init__()
        labelled(self, "runs", "Runs")
        self._queue = queue
        self._build()
        queue.listed.connect(self._fill)
        queue.changed.connect(self._show)
        self._tick = QTimer(self, interval=_TICK_MS)
        self._tick.timeout.connect(self._show_times)
        self._fill()

    def _build(self) -> None:
        self.add = tool_button("runs.add", "Add…", "Add a run to the queue", self)
        about = "Stop the selected run (Del)"
        self.stop = tool_button("runs.cancel", "Cancel", about, self, self._stop)
        about = "Remove finished runs from the list"
        self.clear = tool_button("runs.clear", "Clear", about, self, self._queue.clear)
        about = "Open the folder with the selected run's files"
        self.folder = tool_button("runs.folder", "Open Folder", about, self, self._open_folder)
        about = "Open the selected run's report (for a sweep: its trade-off page)"
        self.page = tool_button("runs.page", "Open Report", about, self, self._open_page)
        bar = QtWidgets.QWidget(self)
        buttons = (self.add, self.stop, self.clear, self.folder, self.page)
        filled(FlowLayout(bar, across=4, down=2), *buttons, margins=(4, 4, 4, 2))
        runs = QtWidgets.QTreeWidget(self, columnCount=2, headerHidden=True, rootIsDecorated=False)
        self.list = labelled(runs, "runs.list", "Queued, running and finished runs")
        self.list.header().setSectionResizeMode(QtWidgets.QHeaderView.ResizeMode.Stretch)
        self.hint = labelled(centred_hint(_HINT, self), "runs.hint")
        icons = QtWidgets.QListWidget(self, viewMode=QtWidgets.QListWidget.ViewMode.IconMode)
        self.previews = labelled(icons, "runs.previews", "Pictures from the selected run")
        self.previews.setMovement(QtWidgets.QListWidget.Movement.Static)
        self.previews.setResizeMode(QtWidgets.QListWidget.ResizeMode.Adjust)
        self.previews.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        parts = (bar, (self.hint, 1), (self.list, 2), (self.previews, 3))
        filled(QtWidgets.QVBoxLayout(self), *parts, spacing=2)
        self.add.clicked.connect(self.add_wanted)
        self.list.itemActivated.connect(lambda *_: self._open_page() or self._open_folder())
        self.list.currentItemChanged.connect(self._show_current)
        delete, context = QKeySequence.StandardKey.Delete, Qt.ShortcutContext.WidgetShortcut
        QShortcut(QKeySequence(delete), self.list, self._stop, context=context)

    @property
    def current(self) -> Run | None:
        row = self.list.indexOfTopLevelItem(self.list.currentItem())
        return self._queue.runs[row] if row >= 0 else None

    def mark(self, run: Run) -> None:
        item = self.list.topLevelItem(self._queue.runs.index(run))
        if item is not None:
            self.list.setCurrentItem(item)

    def _fill(self) -> None:
        runs = self._queue.runs
        self.list.clear()
        self.list.addTopLevelItems([QtWidgets.QTreeWidgetItem() for _ in runs])
        for run in runs:
            self._show(run)
        self.hint.setVisible(not runs)
        self.list.setVisible(bool(runs))
        self.setFocusProxy(self.list if runs else self.add)
        if runs:
            self.mark(runs[-1])
        self._show_current()

    def _show_times(self) -> None:
        for run in self._queue.runs:
            if run.state == "running":
                self._show(run)

    def _show(self, run: Any) -> None:
        item = self.list.topLevelItem(self._queue.runs.index(run))
        if item is None:
            return
        now = time.monotonic()
        for column, text in enumerate((run.title, state_text(run, now))):
            item.setText(column, text)
            item.setToolTip(column, tip(whole_text(run, now)))
        if run is self.current:
            self._show_current()
        if any(each.state == "running" for each in self._queue.runs):
            self._tick.start()
        else:
            self._tick.stop()

    def _show_current(self, *_: object) -> None:
        run = self.current
        done = run is not None and run.state == "done"
        self.stop.setEnabled(run is not None and run.state in ("waiting", "running"))
        self.clear.setEnabled(any(each.is_over for each in self._queue.runs))
        self.folder.setEnabled(done)
        self.page.setEnabled(done and run is not None and run.page is not None)
        previews = run.result.previews if run is not None and run.result is not None else ()
        self.previews.setVisible(bool(previews))
        side = _ONE_PX if len(previews) == 1 else _SEVERAL_PX
        self.previews.setIconSize(QSize(side, side))
        self.previews.clear()
        for name, png in previews:
            picture = QPixmap()
            picture.loadFromData(png, "PNG")  # type: ignore[call-overload]
            value = name.rpartition("=")[2]
            QtWidgets.QListWidgetItem(QIcon(picture), value, self.previews).setToolTip(name)

    def _stop(self) -> None:
        if self.current is not None:
            self.current.stop()

    def _open_folder(self) -> bool:
        return self.folder.isEnabled() and self.current is not None and _open(self.current.folder)

    def _open_page(self) -> bool:
        page = self.current.page if self.current is not None else None
        return self.page.isEnabled() and page is not None and _open(page)


def _open(path: Path) -> bool:
    return QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))


# What the list says of a run.


def duration(seconds: float) -> str:
    """A time as exact as one can use: ``0.8 s``, ``45 s``, ``3 min``, ``2 h 10 min``."""
    if seconds < 59.5:
        return f"{seconds:.1f} s" if seconds < 9.95 else f"{seconds:.0f} s"
    hours, minutes = divmod(math.ceil(seconds / 60), 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min"


def state_text(run: Run, now: float) -> str:
    if run.state == "running":
        left = run.left_s(now)
        soon = "" if left is None else f"{duration(max(1.0, left))} left"
        return " · ".join(filter(None, (f"{100 * run.share:.0f} %", soon, run.doing)))
    if run.state == "failed":
        return f"failed: {run.text}"
    if run.state == "done":
        return " · ".join(filter(None, ["done", duration(run.seconds), failures_text(run)]))
    return run.state


def failures_text(run: Run) -> str:
    """How many of several runs could not be made, and why the first of them; empty where all."""
    result = run.result
    if result is None or not result.failures:
        return ""
    name, why = result.failures[0]
    return f"{len(result.failures)} of {result.runs} runs failed; the first, {name}: {why}"


def whole_text(run: Run, now: float) -> str:
    lines = [run.title, state_text(run, now), f"Output: {run.job.output}"]
    if run.result is not None:
        lines += [f"{name}: {why}" for name, why in run.result.failures[1:10]]
        lines += run.result.warnings[:10]
    return "\n".join(lines)
