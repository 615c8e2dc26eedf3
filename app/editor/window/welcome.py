"""The first page: the example networks, recent files, work to recover."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from functools import partial
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from app.editor.gestures import without_argument
from app.editor.recovery_files import Recovered
from app.editor.theme import FAINT
from app.editor.window.gallery import Gallery, heading
from app.editor.window.recent_files import folder_text
from core.modules.declaration import Library


class WelcomePage(QScrollArea):
    chosen = Signal(str)  # (text): open this path or shipped network
    new_wanted = Signal()  # begin an empty network
    open_wanted = Signal()
    back_wanted = Signal()  # show the network again
    recovered = Signal(object)  # (work): open work that a crash left behind: a `Recovered`

    def __init__(self, library: Library, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("welcome")
        self.setAccessibleName("Welcome page")
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self._library = library
        self._lists = QVBoxLayout()
        self._right = right = QVBoxLayout()
        self.gallery: Gallery | None = None
        page = QWidget()
        whole = QHBoxLayout(page)
        whole.setContentsMargins(24, 18, 24, 18)
        whole.setSpacing(28)
        left = QVBoxLayout()
        left.addWidget(heading("Imagechain", 1.9))
        about = QLabel("Simulate electro-optical and infrared sensors, stage by stage.")
        about.setWordWrap(True)
        about.setForegroundRole(FAINT)
        left.addWidget(about)
        left.addWidget(self._buttons())
        left.addLayout(self._lists)
        left.addStretch()
        whole.addLayout(left, 1)
        right.addWidget(heading("New from an example", 1.5))
        whole.addLayout(right, 4)
        self.setWidget(page)

    def showEvent(self, event: QShowEvent) -> None:
        """Read the example networks only if the page is ever shown."""
        super().showEvent(event)
        if self.gallery is None:
            self.gallery = Gallery(self._library)
            self.gallery.chosen.connect(self.chosen)
            self._right.addWidget(self.gallery)
            self._right.addStretch(1)
            self.gallery.show()  # at once, with the page

    def show_lists(self, recent: Sequence[Path], recovered: Sequence[Recovered]) -> None:
        _clear(self._lists)
        if recovered:
            self._lists.addWidget(heading("Recovered work", 1.25))
            for work in recovered:
                self._lists.addWidget(self._recovered_row(work))
        if recent:
            self._lists.addWidget(heading("Recent files", 1.25))
            for path in recent:
                self._lists.addWidget(self._recent_row(path))

    def _buttons(self) -> QWidget:
        row = QWidget()
        layout = QHBoxLayout(row)
        layout.setContentsMargins(0, 8, 0, 8)
        for text, name, signal in (
            ("New network", "welcome.new", self.new_wanted),
            ("Open…", "welcome.open", self.open_wanted),
            ("Back", "welcome.back", self.back_wanted),
        ):
            self.back = button = QPushButton(text)
            button.setObjectName(name)
            button.clicked.connect(signal)
            layout.addWidget(button)
        layout.addStretch()
        self.back.hide()
        return row

    def offer_back(self, network: str) -> None:
        """Let the person return to the network that is open; none is for an empty name."""
        self.back.setVisible(bool(network))
        self.back.setText(f"Back to {network}".replace("&", "&&"))

    def _recent_row(self, path: Path) -> QPushButton:
        row = QPushButton(f"{path.stem}\n{folder_text(path.parent)}")
        row.setObjectName(f"welcome.recent.{path.name}")
        row.setFlat(True)
        row.setStyleSheet("text-align: left; padding: 4px;")
        row.setToolTip(str(path))
        row.setAccessibleName(f"Open {path}")
        row.clicked.connect(partial(self.chosen.emit, str(path)))
        return row

    def _recovered_row(self, work: Recovered) -> QWidget:
        row = QWidget()
        layout = QHBoxLayout(row)
        layout.setContentsMargins(0, 0, 0, 0)
        name = work.original.name if work.original is not None else "never saved"
        when = datetime.fromtimestamp(work.time).strftime("%Y-%m-%d %H:%M")
        about = QLabel(f"{name}, {when}" + (f": {work.problem}" if work.problem else ""))
        about.setWordWrap(True)
        layout.addWidget(about, 1)
        if not work.problem:
            recover = self._choice("recover", f"{name} of {when}", layout)
            recover.clicked.connect(partial(self.recovered.emit, work))
        discard = self._choice("discard", f"{name} of {when}", layout)
        discard.clicked.connect(partial(without_argument, work.discard))
        # It stays where it is: a second click must not throw away the work that moves up.
        discard.clicked.connect(lambda: row.setDisabled(True))
        discard.clicked.connect(lambda: about.setText(f"{name}, {when}: discarded"))
        return row

    def _choice(self, key: str, what: str, layout: QHBoxLayout) -> QPushButton:
        button = QPushButton(key.capitalize())
        button.setObjectName(f"welcome.{key}")
        button.setAccessibleName(f"{button.text()} {what}")
        layout.addWidget(button)
        return button


def _clear(layout: QVBoxLayout) -> None:
    while (item := layout.takeAt(0)) is not None:
        widget = item.widget()
        if widget is not None:
            widget.deleteLater()
