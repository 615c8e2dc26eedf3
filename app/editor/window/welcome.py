"""The first page: shipped networks with a picture each, recent files, work to recover."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from functools import partial
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QPixmap, QPixmapCache, QResizeEvent, QShowEvent
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.editor.gestures import without_argument
from app.editor.recovery_files import Recovered
from app.editor.window.recent_files import folder_text
from app.run.shipped import shipped_networks
from core.errors import ImagechainError
from core.modules.declaration import Library
from core.network.file import read_unchanged

COLUMNS = 3
FIRST = "first_steps"  # stands before the others


class WelcomePage(QScrollArea):
    chosen = Signal(str)  # (text): open this path or shipped network
    new_wanted = Signal()  # begin an empty network
    open_wanted = Signal()
    recovered = Signal(object)  # (work): open work that a crash left behind: a `Recovered`

    def __init__(self, library: Library, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("welcome")
        self.setAccessibleName("Welcome page")
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self._library = library
        self._lists = QVBoxLayout()
        self._beside = right = QVBoxLayout()
        self._cards: QWidget | None = None
        page = QWidget()
        whole = QHBoxLayout(page)
        whole.setContentsMargins(24, 18, 24, 18)
        whole.setSpacing(28)
        left = QVBoxLayout()
        left.addWidget(_heading("Imagechain", 1.9))
        left.addWidget(_faint("Simulate electro-optical and infrared sensors, stage by stage."))
        left.addWidget(self._buttons())
        left.addLayout(self._lists)
        left.addStretch()
        whole.addLayout(left, 1)
        right.addWidget(_heading("Networks to start with", 1.25))
        whole.addLayout(right, 2)
        self.setWidget(page)

    def showEvent(self, event: QShowEvent) -> None:
        """Read the shipped networks, which load their modules, only if the page is ever shown."""
        super().showEvent(event)
        if self._cards is None:
            self._cards = self._shipped()
            self._beside.addWidget(self._cards)
            self._beside.addStretch()
            self._cards.show()  # at once, with the page

    def show_lists(self, recent: Sequence[Path], recovered: Sequence[Recovered]) -> None:
        _clear(self._lists)
        if recovered:
            self._lists.addWidget(_heading("Recovered work", 1.25))
            for work in recovered:
                self._lists.addWidget(self._recovered_row(work))
        if recent:
            self._lists.addWidget(_heading("Recent files", 1.25))
            for path in recent:
                self._lists.addWidget(self._recent_row(path))

    def _buttons(self) -> QWidget:
        row = QWidget()
        layout = QHBoxLayout(row)
        layout.setContentsMargins(0, 8, 0, 8)
        for text, name, signal in (
            ("New network", "welcome.new", self.new_wanted),
            ("Open…", "welcome.open", self.open_wanted),
        ):
            button = QPushButton(text)
            button.setObjectName(name)
            button.clicked.connect(signal)
            layout.addWidget(button)
        layout.addStretch()
        return row

    def _shipped(self) -> QWidget:
        cards = QWidget()
        grid = QGridLayout(cards)
        grid.setContentsMargins(0, 6, 0, 0)
        grid.setSpacing(12)
        shipped = shipped_networks()
        for number, name in enumerate(sorted(shipped, key=lambda name: name != FIRST)):
            card = self._card(name, shipped[name])
            grid.addWidget(card, number // COLUMNS, number % COLUMNS)
        for column in range(COLUMNS):
            grid.setColumnStretch(column, 1)
        return cards

    def _card(self, name: str, path: Path) -> NetworkCard:
        title, about = name, ""
        try:
            network = read_unchanged(path, library=self._library)
        except ImagechainError as error:
            about = str(error)
        else:
            title, about = network.name or name, network.description
        card = NetworkCard(name, title, about, thumbnail_path(path))
        card.clicked.connect(partial(self.chosen.emit, name))
        return card

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


def thumbnail_path(network: Path) -> Path:
    return network.parent / "pictures" / f"thumbnail_{network.stem}.png"


def _heading(text: str, size: float) -> QLabel:
    label = QLabel(text)
    font = label.font()
    font.setPointSizeF(font.pointSizeF() * size)
    font.setBold(True)
    label.setFont(font)
    return label


def _faint(text: str) -> QLabel:
    label = QLabel(text)
    label.setWordWrap(True)
    label.setEnabled(False)
    return label


def _clear(layout: QVBoxLayout) -> None:
    while (item := layout.takeAt(0)) is not None:
        widget = item.widget()
        if widget is not None:
            widget.deleteLater()


# A shipped network on the first page: its picture, name and description, as one button.

_PICTURE = QSize(14, 9)  # in lines of text
_MARGIN = 8


class NetworkCard(QToolButton):
    """A button as high as its description needs at its width."""

    def __init__(
        self, name: str, title: str, about: str, picture: Path, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName(f"welcome.{name}")
        self.setAccessibleName(title)
        self.setAccessibleDescription(about)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.picture = QLabel(self)
        self.picture.setPixmap(self._scaled(picture))
        self.title = QLabel(title, self)
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.about = QLabel(about, self)
        column = self._column = QVBoxLayout(self)
        column.setContentsMargins(_MARGIN, _MARGIN, _MARGIN, _MARGIN)
        column.setSpacing(4)
        for label in (self.picture, self.title, self.about):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            label.setAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
            label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            column.addWidget(label)
        self.about.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop)
        column.addStretch(1)

    def sizeHint(self) -> QSize:
        """Wide enough for the picture; as high as all of it is at its present width."""
        line = self.fontMetrics().height()
        width = max(self.width(), _PICTURE.width() * line + 2 * _MARGIN)
        return QSize(_PICTURE.width() * line + 2 * _MARGIN, self._column.totalHeightForWidth(width))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self.updateGeometry()

    def _scaled(self, file: Path) -> QPixmap:
        """Sharp on screens of any scale; Qt holds it for the next window."""
        try:
            when = file.stat().st_mtime_ns
        except OSError:
            return QPixmap()
        ratio = self.devicePixelRatioF()
        line = self.fontMetrics().height()
        scaled = QPixmap()
        key = f"thumbnail {file} {when} {line} {ratio}"
        if QPixmapCache.find(key, scaled):
            return scaled
        picture = QPixmap(str(file))
        if picture.isNull():
            return picture
        room = _PICTURE * line * ratio
        keep, smooth = (
            Qt.AspectRatioMode.KeepAspectRatio,
            Qt.TransformationMode.SmoothTransformation,
        )
        scaled = picture.scaled(room, keep, smooth)
        scaled.setDevicePixelRatio(ratio)
        QPixmapCache.insert(key, scaled)
        return scaled
