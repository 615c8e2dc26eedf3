"""The list of runs: what each does, how far it is, and what it has made."""

import math
import time
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSize, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QIcon, QKeySequence, QPixmap, QShortcut
from PySide6.QtWidgets import (
    QHeaderView,
    QListWidget,
    QListWidgetItem,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.docks.run_queue import Run, RunQueue
from app.editor.widgets import FlowLayout, centred_hint, filled, labelled, tool_button

_TICK_MS = 1000
_ONE_PX, _SEVERAL_PX = 160, 96
_HINT = (
    "No runs yet. Click Add… to start a parameter sweep, frames, a list of pictures, or one run "
    "that also writes the network's files. You can edit during a run."
)


class RunsView(QWidget):
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
        self.stop = tool_button("runs.cancel", "Cancel", "Stop the selected run (Del)", self)
        self.clear = tool_button("runs.clear", "Clear", "Remove finished runs from the list", self)
        self.folder = tool_button(
            "runs.folder", "Open Folder", "Open the folder with the selected run's files", self
        )
        self.page = tool_button(
            "runs.page", "Open Report", "Open the selected run's report or trade-off", self
        )
        bar = QWidget(self)
        buttons = (self.add, self.stop, self.clear, self.folder, self.page)
        filled(FlowLayout(bar, across=4, down=2), *buttons, margins=(4, 4, 4, 2))
        self.list = labelled(QTreeWidget(self), "runs.list", "Queued, running and finished runs")
        self.list.setColumnCount(2)
        self.list.setHeaderHidden(True)
        self.list.setRootIsDecorated(False)
        self.list.header().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.hint = labelled(centred_hint(_HINT, self), "runs.hint")
        self.previews = labelled(
            QListWidget(self), "runs.previews", "Pictures from the selected run"
        )
        self.previews.setViewMode(QListWidget.ViewMode.IconMode)
        self.previews.setMovement(QListWidget.Movement.Static)
        self.previews.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.previews.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        parts = (bar, (self.hint, 1), (self.list, 2), (self.previews, 3))
        filled(QVBoxLayout(self), *parts, spacing=2)
        self.add.clicked.connect(self.add_wanted)
        self.stop.clicked.connect(self._stop)
        self.clear.clicked.connect(self._queue.clear)
        self.folder.clicked.connect(self._open_folder)
        self.page.clicked.connect(self._open_page)
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
        self.list.addTopLevelItems([QTreeWidgetItem() for _ in runs])
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
        for preview in previews:
            picture = QPixmap()
            picture.loadFromData(preview.png, "PNG")  # type: ignore[call-overload]
            value = preview.name.rpartition("=")[2]
            QListWidgetItem(QIcon(picture), value, self.previews).setToolTip(preview.name)

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
        return " · ".join(filter(None, (f"{100 * run.step.share:.0f} %", soon, run.step.doing)))
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
