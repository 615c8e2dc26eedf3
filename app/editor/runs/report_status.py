"""What the status line says of a report: how far it is, then a button that opens it."""

from __future__ import annotations

from PySide6.QtCore import QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QWidget,
)

from app.editor.runs.run_queue import Entry, RunQueue
from app.editor.widgets import tool_button


class ReportStatus(QWidget):
    """Follows the report that was begun last.

    Parameters
    ----------
    queue : RunQueue
        Carries it out.
    parent : QWidget
        The status bar.

    Signals
    -------
    message(kind, text)
        How it has ended, as `Session.message`.
    """

    message = Signal(str, str)

    def __init__(self, queue: RunQueue, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("report")
        self.setAccessibleName("Report")
        self._queue = queue
        self._number = 0
        self.label = QLabel(self)
        self.progress = QProgressBar(self)
        self.progress.setObjectName("report.progress")
        self.progress.setAccessibleName("Progress of the report")
        self.progress.setTextVisible(False)
        self.progress.setFixedWidth(self.fontMetrics().averageCharWidth() * 14)
        self.stop = QPushButton("Cancel", self)
        self.stop.setObjectName("report.cancel")
        self.stop.setAccessibleName("Cancel the report")
        self.stop.setToolTip("Stop the report; nothing is written then")
        self.open = QPushButton("Open", self)
        self.open.setObjectName("report.open")
        self.open.setAccessibleName("Open the report")
        self.open.setToolTip("Show the report in the browser")
        self.away = tool_button("report.away", "×", "Take this away; the report stays", self)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        for widget in (self.label, self.progress, self.stop, self.open, self.away):
            row.addWidget(widget)
        for part in (self, self.stop, self.open):  # no wider than their texts
            part.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        self.stop.clicked.connect(self.cancel)
        self.open.clicked.connect(self._open)
        self.away.clicked.connect(self.hide)
        queue.changed.connect(self._changed)
        self.hide()

    def follow(self, number: int) -> None:
        """Show this run of the queue, in place of another."""
        self._number = number
        entry = self._queue.entry(number)
        if entry is not None:
            self._show(entry)

    def cancel(self) -> None:
        """Stop the report that is shown."""
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
