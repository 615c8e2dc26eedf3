"""The pages of the window: the first page, beside which there are no docks, and the network."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QByteArray, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QLabel,
    QMainWindow,
    QProgressBar,
    QPushButton,
    QStackedWidget,
    QStatusBar,
    QWidget,
)

from app.editor.gestures import SecondClick
from app.editor.theme import CHANGED, ERROR
from app.editor.window.docks.window_layout import LayoutName, WindowLayout


class Pages(QStackedWidget):
    """Shows one of both. The docks get their sizes with the network that is shown first."""

    def __init__(
        self, first: QWidget, work: QWidget, layout: WindowLayout, window: QMainWindow
    ) -> None:
        super().__init__(window)
        self._first, self._work = first, work
        self._layout = layout
        self._window = window
        self._docks: QByteArray | None = None  # as they were before the first page hid them
        self._second_click = SecondClick(self)
        self._sized = False
        self.sizes_remembered = False
        """Whether the docks have the sizes of the last window, to be kept."""
        self.addWidget(first)
        self.addWidget(work)

    @property
    def at_first(self) -> bool:
        return self.currentWidget() is self._first

    def show_first(self) -> None:
        self.setCurrentWidget(self._first)
        self._hide_docks()

    def show_work(self) -> None:
        if self.at_first:
            self._second_click.drop()
        self.setCurrentWidget(self._work)
        self.show_docks()
        if not self._sized:
            self._sized = True
            (self._layout.keep if self.sizes_remembered else self._layout.begin)()

    def show_docks(self) -> None:
        docks, self._docks = self._docks, None
        if docks is not None:
            with self._layout.placing():
                self._window.restoreState(docks)

    def _hide_docks(self) -> None:
        if self._docks is None:
            self._docks = self._window.saveState()
            for dock in self._window.findChildren(QDockWidget):
                if not dock.isFloating():
                    dock.hide()

    def choose_layout(self, name: LayoutName) -> None:
        """Place the docks by a named layout; beside the first page they stay hidden until later."""
        self.show_docks()
        self._layout.choose(name)
        if self.at_first:
            self._hide_docks()
            self.sizes_remembered = self._sized = False


# The status bar: messages, and what is being computed.

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
        self._behind = QLabel("stopped: shows what it had before; Ctrl+Enter computes it", self)
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
