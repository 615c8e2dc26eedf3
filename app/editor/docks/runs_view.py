"""The list of runs: what each does, how far it is, and what it has made."""

from __future__ import annotations

import math
import time
from typing import Any

from PySide6.QtCore import QEvent, QRect, QSize, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import (
    QColor,
    QDesktopServices,
    QIcon,
    QKeyEvent,
    QPainter,
    QPalette,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.docks.run_queue import Entry, RunQueue
from app.editor.theme import CHANGED, ERROR, FAINT
from app.editor.widgets import ElidedLabel, FlowLayout, centred_hint, filled, labelled, tool_button

_NUMBER, _SHARE = Qt.ItemDataRole.UserRole, Qt.ItemDataRole.UserRole + 1
_TICK_MS = 1000
PREVIEW_PX, _SEVERAL_PX, _LEAST_PX = 256, 96, 64
_HINT = (
    "No runs yet. Add… starts one: a sweep of a parameter, frames, a list of pictures, or one "
    "run that also writes the network's files. You can edit while it runs."
)
_OPEN_KEYS = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
_DROP_KEYS = (Qt.Key.Key_Delete, Qt.Key.Key_Backspace)


class RunsView(QWidget):
    add_wanted = Signal()  # another run is to be added

    def __init__(self, queue: RunQueue) -> None:
        super().__init__()
        labelled(self, "runs", "Runs")
        self._queue = queue
        self._items: dict[int, QTreeWidgetItem] = {}
        self._build()
        queue.listed.connect(self._fill)
        queue.changed.connect(self._follow)
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
        self.list = _RunList(self)
        self.list.setItemDelegateForColumn(1, _Progress(self.list))
        self.hint: QLabel = labelled(centred_hint(_HINT, self), "runs.hint")
        self.hint.setContentsMargins(12, 0, 12, 0)
        self.detail = ElidedLabel("runs.detail", "State of the selected run", self)
        self.detail.setContentsMargins(6, 0, 6, 0)
        self.previews = QListWidget(self)
        self.previews.setObjectName("runs.previews")
        self.previews.setAccessibleName("Pictures that the selected run has made")
        self.previews.setViewMode(QListWidget.ViewMode.IconMode)
        self.previews.setMovement(QListWidget.Movement.Static)
        self.previews.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.previews.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.previews.setUniformItemSizes(True)
        parts = (bar, (self.hint, 1), (self.list, 2), self.detail, (self.previews, 3))
        filled(QVBoxLayout(self), *parts, spacing=2)
        self.previews.hide()
        self.add.clicked.connect(self.add_wanted)
        self.stop.clicked.connect(self._cancel)
        self.clear.clicked.connect(self._queue.clear)
        self.folder.clicked.connect(self._open_folder)
        self.page.clicked.connect(self._open_page)
        self.list.opened.connect(self.open)
        self.list.dropped.connect(self._drop)
        self.list.currentItemChanged.connect(self._show_current)

    @property
    def current(self) -> Entry | None:
        item = self.list.currentItem()
        return None if item is None else self._queue.entry(int(item.data(0, _NUMBER)))

    def mark(self, number: int) -> None:
        if number in self._items:
            self.list.setCurrentItem(self._items[number])

    def open(self) -> None:
        entry = self.current
        if entry is not None and entry.state == "done":
            if entry.page is not None:
                self._open_page()
            else:
                self._open_folder()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            for number in self._items:
                self._show(number)

    def _fill(self) -> None:
        entries = self._queue.entries
        numbers = {entry.number for entry in entries}
        for number in [known for known in self._items if known not in numbers]:
            item = self._items.pop(number)
            self.list.takeTopLevelItem(self.list.indexOfTopLevelItem(item))
        for entry in entries:
            if entry.number not in self._items:
                item = QTreeWidgetItem(self.list)
                item.setData(0, _NUMBER, entry.number)
                self._items[entry.number] = item
                self._show(entry.number)
                self.list.setCurrentItem(item)
        self.hint.setVisible(not entries)
        self.list.setVisible(bool(entries))
        self.detail.setVisible(bool(entries))
        self.setFocusProxy(self.list if entries else self.add)
        self._show_current()

    def _follow(self, number: int) -> None:
        self._show(number)
        entry = self.current
        if entry is None or entry.number == number:
            self._show_current()
        if any(each.state == "running" for each in self._queue.entries):
            self._tick.start()
        else:
            self._tick.stop()

    def _show_times(self) -> None:
        for entry in self._queue.entries:
            if entry.state == "running":
                self._show(entry.number)

    def _show(self, number: int) -> None:
        entry, item = self._queue.entry(number), self._items.get(number)
        if entry is None or item is None:
            return
        now = time.monotonic()
        item.setText(0, entry.title)
        item.setText(1, state_text(entry, now))
        running = entry.state in ("running", "stopping")
        item.setData(1, _SHARE, entry.share if running else None)
        failed, some = entry.state == "failed", bool(entry.result and entry.result.failures)
        faint = entry.state in ("waiting", "cancelled")
        text = QPalette.ColorRole.Text
        role = ERROR if failed else CHANGED if some else FAINT if faint else text
        for column in (0, 1):
            shown_in = text if column == 0 and not faint else role
            item.setForeground(column, self.palette().color(shown_in))
            item.setToolTip(column, tip(whole_text(entry, now)))

    def _show_current(self, *_: object) -> None:
        entry = self.current
        done = entry is not None and entry.state == "done"
        self.stop.setEnabled(entry is not None and entry.state in ("waiting", "running"))
        self.clear.setEnabled(any(each.is_over for each in self._queue.entries))
        self.folder.setEnabled(done)
        page = entry.page if entry is not None and done else None
        self.page.setEnabled(page is not None)
        sweep = entry is not None and entry.job.kind == "sweep"
        self.page.setText("Open Trade-off" if page and sweep else "Open Report")
        if entry is not None:
            text = state_text(entry, time.monotonic())
            self.detail.show_text(f"{entry.title}: {text}", whole_text(entry, time.monotonic()))
        previews = entry.result.previews if entry is not None and entry.result is not None else ()
        self.previews.setVisible(bool(previews))
        if self.previews.property("run") == (entry.number if previews and entry else 0):
            return
        self.previews.setProperty("run", entry.number if previews and entry else 0)
        self.previews.clear()
        for preview in previews:
            picture = QPixmap()
            picture.loadFromData(preview.png, "PNG")  # type: ignore[call-overload]
            value = preview.name.rpartition("=")[2] if sweep else preview.name
            QListWidgetItem(QIcon(picture), value, self.previews).setToolTip(preview.name)
        self._fit_previews()

    def _fit_previews(self) -> None:
        count, line = self.previews.count(), self.fontMetrics().height()
        room = min(self.previews.viewport().height(), self.previews.viewport().width())
        side = max(_LEAST_PX, min(PREVIEW_PX, room - line)) if count == 1 else _SEVERAL_PX
        self.previews.setIconSize(QSize(side, side))
        for row in range(count):
            item = self.previews.item(row)
            item.setSizeHint(QSize(side + 2 * line, side + (2 * line if item.text() else 0)))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit_previews()

    def _cancel(self) -> None:
        entry = self.current
        if entry is not None:
            self._queue.cancel(entry.number)

    def _drop(self) -> None:
        entry = self.current
        if entry is not None and entry.is_over:
            self._queue.remove(entry.number)
        else:
            self._cancel()

    def _open_folder(self) -> None:
        entry = self.current
        if entry is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(entry.folder)))

    def _open_page(self) -> None:
        entry = self.current
        if entry is not None and entry.page is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(entry.page)))


class _RunList(QTreeWidget):
    opened = Signal()  # Enter or a double click
    dropped = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        labelled(self, "runs.list", "Queued, running and finished runs")
        self.setColumnCount(2)
        self.setHeaderHidden(True)
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setAllColumnsShowFocus(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.header().setStretchLastSection(True)
        self.header().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.header().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        self.itemDoubleClicked.connect(lambda *_: self.opened.emit())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in _OPEN_KEYS and not event.modifiers():
            self.opened.emit()
        elif event.key() in _DROP_KEYS and not event.modifiers():
            self.dropped.emit()
        else:
            super().keyPressEvent(event)


class _Progress(QStyledItemDelegate):
    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Any) -> None:
        share = index.data(_SHARE)
        if share is not None:
            room: QRect = option.rect.adjusted(1, 2, -1, -2)
            palette = option.palette
            colour = QColor(palette.highlight().color())
            colour.setAlpha(40)
            painter.fillRect(room, colour)
            colour.setAlpha(110)
            room.setWidth(round(room.width() * share))
            painter.fillRect(room, colour)
        super().paint(painter, option, index)


# What the status line says of a report: how far it is, then a button that opens it.


class ReportStatus(QWidget):
    message = Signal(str, str)  # (kind, text): how it has ended, as `Session.message`

    def __init__(self, queue: RunQueue, parent: QWidget) -> None:
        super().__init__(parent)
        labelled(self, "report", "Report")
        self._queue = queue
        self._number = 0
        self.label = QLabel(self)
        self.progress = labelled(QProgressBar(self), "report.progress", "Progress of the report")
        self.progress.setTextVisible(False)
        self.progress.setFixedWidth(self.fontMetrics().averageCharWidth() * 14)
        self.stop = QPushButton("Cancel", self)
        self.stop.setObjectName("report.cancel")
        self.stop.setAccessibleName("Cancel the report")
        self.stop.setToolTip("Stop writing the report; no file is written")
        self.open = QPushButton("Open", self)
        self.open.setObjectName("report.open")
        self.open.setAccessibleName("Open the report")
        self.open.setToolTip("Show the report in the browser")
        self.away = tool_button("report.away", "×", "Close this message; the report stays", self)
        filled(QHBoxLayout(self), self.label, self.progress, self.stop, self.open, self.away)
        for part in (self, self.stop, self.open):  # no wider than their texts
            part.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        self.stop.clicked.connect(self.cancel)
        self.open.clicked.connect(self._open)
        self.away.clicked.connect(self.hide)
        queue.changed.connect(self._changed)
        self.hide()

    def follow(self, number: int) -> None:
        self._number = number
        entry = self._queue.entry(number)
        if entry is not None:
            self._show(entry)

    def cancel(self) -> None:
        self._queue.cancel(self._number)

    def _changed(self, number: int) -> None:
        entry = self._queue.entry(number)
        if number != self._number or entry is None:
            return
        self._show(entry)
        name = entry.job.output.name
        if entry.state == "failed":
            self.message.emit("error", f"no report {name}: {entry.text}")
        elif entry.state == "cancelled":
            self.message.emit("note", f"report {name} cancelled: nothing was written")

    def _show(self, entry: Entry) -> None:
        going, done = not entry.is_over, entry.state == "done"
        self.setVisible(going or done)
        self.progress.setVisible(going)
        self.stop.setVisible(going)
        self.open.setVisible(done)
        self.away.setVisible(done)
        self.stop.setEnabled(entry.state != "stopping")
        name = entry.job.output.name
        self.label.setText(f"{name} is written" if done else "Report")
        self.label.setToolTip(str(entry.job.output))
        self.progress.setRange(0, 1000)
        self.progress.setValue(round(1000 * entry.share))
        self.progress.setToolTip(entry.doing)

    def _open(self) -> None:
        entry = self._queue.entry(self._number)
        if entry is not None and entry.page is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(entry.page)))


# What the list says of a run, without Qt.

_MINUTE, _HOUR = 60, 3600


def duration(seconds: float) -> str:
    """A time in words, as exact as one can use: ``0.8 s``, ``45 s``, ``3 min``, ``2 h 10 min``."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    if seconds < _MINUTE:
        return f"{math.ceil(seconds)} s"
    if seconds < _HOUR:
        return f"{math.ceil(seconds / _MINUTE)} min"
    hours, minutes = divmod(math.ceil(seconds / _MINUTE), 60)
    return f"{hours} h {minutes} min" if minutes else f"{hours} h"


def state_text(entry: Entry, now: float) -> str:
    if entry.state == "running":
        parts = [f"{100 * entry.share:.0f} %"]
        left = entry.left_s(now)
        if left is not None:
            parts.append(f"{duration(max(1.0, round(left)))} left")
        return " · ".join([*parts, *filter(None, [entry.doing])])
    if entry.state == "failed":
        return f"failed: {entry.text}"
    if entry.state == "done":
        return " · ".join(filter(None, ["done", duration(entry.seconds), failures_text(entry)]))
    return entry.state


def failures_text(entry: Entry) -> str:
    """How many of several runs could not be made, and why the first of them; empty where all."""
    result = entry.result
    if result is None or not result.failures:
        return ""
    name, why = result.failures[0]
    return f"{len(result.failures)} of {result.runs} failed: {name}: {why}"


def whole_text(entry: Entry, now: float) -> str:
    lines = [entry.title, state_text(entry, now), f"Output: {entry.job.output}"]
    if entry.result is not None:
        lines += [f"{name}: {why}" for name, why in entry.result.failures[1:10]]
        lines += entry.result.warnings[:10]
    return "\n".join(lines)
