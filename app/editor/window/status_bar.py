"""The status bar: messages, and what is being computed."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QProgressBar, QPushButton, QStatusBar, QWidget

from app.editor.theme import CHANGED, ERROR

_ELIDE = Qt.TextElideMode.ElideRight
NOTE_MS = 8000


class StatusBar(QStatusBar):
    """Shows notes for a while and errors until another message, or until they no longer hold."""

    cancel_wanted = Signal()  # stop the computation

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._advises = False
        self._error = QLabel(self)
        self._error.setObjectName("status.error")
        self._error.setAccessibleName("Last error")
        self._error.setForegroundRole(ERROR)
        self._error.hide()
        self._where = QLabel(self)
        self._progress = QProgressBar(self)
        self._progress.setObjectName("status.progress")
        self._progress.setAccessibleName("Progress of the computation")
        self._progress.setTextVisible(False)
        self._progress.setFixedWidth(self.fontMetrics().averageCharWidth() * 20)
        self._cancel = QPushButton("Cancel", self)
        self._cancel.setObjectName("status.cancel")
        self._cancel.setToolTip("Stop the computation (Esc)")
        self._cancel.clicked.connect(self.cancel_wanted)
        self.addWidget(self._error, 1)
        self._behind = QLabel(
            "stopped: shows the earlier result; Ctrl+Enter computes it again", self
        )
        self._behind.setObjectName("status.behind")
        self._behind.setForegroundRole(CHANGED)
        self._behind.hide()
        for widget in (self._behind, self._where, self._progress, self._cancel):
            self.addPermanentWidget(widget)
        self.show_busy(None)

    @property
    def error(self) -> str:
        """The error that stands there; empty where there is none."""
        return self._error.toolTip()

    def report(self, kind: str, text: str) -> None:
        """Show a "note" or an "error"; "advice" is a note on what is selected."""
        self._advises = kind == "advice"
        if kind == "error":
            self.clearMessage()
            self._error.setToolTip(text)
            self._elide_error()
            self._error.show()
        else:
            self.forget_error()
            self.showMessage(text, NOTE_MS)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._elide_error()

    def _elide_error(self) -> None:
        width = max(self.width() - self.fontMetrics().averageCharWidth() * 40, 200)
        self._error.setText(self.fontMetrics().elidedText(self.error, _ELIDE, width))

    def forget(self) -> None:
        """Clear what was about a network that is no more."""
        self.clearMessage()
        self.forget_error()

    def forget_advice(self) -> None:
        """Clear what was about a selection that is no more."""
        if self._advises:
            self.clearMessage()

    def forget_error(self) -> None:
        if not self.error:
            return  # as with nearly every edit
        self._error.setText("")
        self._error.setToolTip("")
        self._error.hide()

    def show_busy(self, busy: Any) -> None:
        """Show how far a long computation is: a `Busy`; or None, that none runs."""
        for widget in (self._where, self._progress, self._cancel):
            widget.setVisible(busy is not None)
        if busy is not None:
            self._where.setText(f"{busy.node or 'computing'} · {busy.seconds:.1f} s")
            self._progress.setRange(0, max(busy.wanted, 1))
            self._progress.setValue(busy.done)

    def show_behind(self, behind: bool) -> None:
        """Say that what is shown is older than the network, or stop saying so."""
        self._behind.setVisible(behind)
