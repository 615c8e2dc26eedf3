"""The window's messages, and what is being computed: on the line of the menus, at its right.

No band of the window is kept for it, and nothing moves when a message comes or goes.
"""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, QObject, QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenuBar, QProgressBar, QPushButton, QWidget

from app.editor.notices import Notice, Severity
from app.editor.widgets import filled, labelled

NOTE_MS = 8000
_BEHIND = "stopped: shows the earlier result; Ctrl+Enter computes it again"


class StatusBar(QWidget):
    """Shows notes for a while, errors until the next message, or until they no longer hold.

    A warning stays below both until it is closed, or another network is open.
    """

    cancel_wanted = Signal()  # stop the computation

    def __init__(self, menus: QMenuBar) -> None:
        super().__init__(menus)
        self._menus = menus
        menus.setNativeMenuBar(False)  # a desktop's own bar of menus has no place for messages
        menus.installEventFilter(self)
        self._advises = False
        self._said: list[tuple[Severity, str]] = []  # the latest at the end
        self._notice = Notice("status.message", self, one_line=True)
        self._notice.closed.connect(self._close)
        self._behind = Notice("status.behind", self, one_line=True)
        self._where = QLabel(self)
        self._progress = labelled(
            QProgressBar(self), "status.progress", "Progress of the computation"
        )
        self._progress.setTextVisible(False)
        self._progress.setFixedWidth(self.fontMetrics().averageCharWidth() * 14)
        self._cancel = QPushButton("Cancel", self)
        self._cancel.setObjectName("status.cancel")
        self._cancel.setToolTip("Stop the computation (Esc)")
        self._cancel.clicked.connect(self.cancel_wanted)
        self._over = QTimer(self, singleShot=True, interval=NOTE_MS)
        self._over.timeout.connect(lambda: self._drop("information"))
        parts = (self._notice, self._behind, self._where, self._progress, self._cancel)
        self._row = filled(QHBoxLayout(self), None, *parts, margins=(8, 0, 4, 0))
        self.show_busy(None)

    @property
    def error(self) -> str:
        return self._of("error")

    @property
    def warning(self) -> str:
        return self._of("warning")

    @property
    def note(self) -> str:
        return self._of("information")

    def add(self, widget: QWidget) -> None:
        self._row.addWidget(widget)

    def report(self, kind: str, text: str) -> None:
        """Show a "note", "warning" or "error"; "advice" is a note on what is selected.

        An empty warning takes the last one back.
        """
        self._advises = kind == "advice"
        severity: Severity = kind if kind in ("error", "warning") else "information"  # type: ignore[assignment]
        self._drop("information", severity if severity == "warning" else "error")
        self._said += [(severity, text)] if text else []
        if severity == "information":
            self._over.start()
        self._show()

    def forget(self, *, closed: bool = False) -> None:
        """Clear what was about the network as it was; warnings too where it is closed."""
        self._drop("information", "error", *(["warning"] if closed else []))

    def forget_advice(self) -> None:
        """Clear what was about a selection that is no more."""
        if self._advises:
            self._drop("information")

    def show_busy(self, busy: Any) -> None:
        for widget in (self._where, self._progress, self._cancel):
            widget.setVisible(busy is not None)
        if busy is not None:
            self._where.setText(f"{busy.node or 'computing'} · {busy.seconds:.1f} s")
            self._progress.setRange(0, max(busy.wanted, 1))
            self._progress.setValue(busy.done)

    def show_behind(self, behind: bool) -> None:
        self._behind.show_text(_BEHIND if behind else "", "warning")

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep to the room that the menus leave."""
        if watched is self._menus and event.type() in (
            QEvent.Type.Resize, QEvent.Type.ActionAdded, QEvent.Type.Show, QEvent.Type.FontChange,
        ):  # fmt: skip
            QTimer.singleShot(0, self, self._place)
        return False

    def _place(self) -> None:
        actions = self._menus.actions()
        left = self._menus.actionGeometry(actions[-1]).right() + 1 if actions else 0
        self.setGeometry(left, 0, max(0, self._menus.width() - left), self._menus.height())

    def _of(self, severity: Severity) -> str:
        return dict(self._said).get(severity, "")

    def _drop(self, *severities: str) -> None:
        kept = [one for one in self._said if one[0] not in severities]
        if kept != self._said:  # not so with nearly every edit
            self._said = kept
            self._show()

    def _show(self) -> None:
        severity, text = self._said[-1] if self._said else ("information", "")
        self._notice.show_text(text, severity)

    def _close(self) -> None:
        """The message that is seen is closed; the one below it comes into sight."""
        self._drop(self._notice.severity)
