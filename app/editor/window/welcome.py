"""The first page: the example networks, recent files, work to recover."""

import json
from collections.abc import Sequence
from datetime import datetime
from functools import partial
from pathlib import Path

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QEvent, QSize, QSizeF, Qt, Signal

from app.editor.recovery_files import Recovered
from app.editor.theme import FAINT
from app.editor.widgets import FlowLayout, filled, labelled
from app.editor.window.recent_files import folder_text
from app.run.shipped import shipped_networks
from core.network.file import read_network

_PICTURE = QSizeF(6, 5)  # in lines of text
_CARD = 50  # letters that a card is wide at least
_LETTERS, _LARGEST = 230.0, 2.8  # a page wider than that has larger cards, at most this much


class WelcomePage(QtWidgets.QScrollArea):
    chosen = Signal(str)  # (text): open this path or shipped network
    new_wanted = Signal()  # begin an empty network
    open_wanted = Signal()
    back_wanted = Signal()  # show the network again
    recovered = Signal(object)  # (work): open work that a crash left behind: a `Recovered`

    def __init__(self) -> None:
        super().__init__(widgetResizable=True, frameShape=QtWidgets.QFrame.Shape.NoFrame)
        labelled(self, "welcome", "Welcome page")
        self._lists = QtWidgets.QVBoxLayout()
        self._gallery: QtWidgets.QWidget | None = None
        self._right = filled(
            QtWidgets.QVBoxLayout(), heading("New from an example", 1.5), margins=None
        )
        page = QtWidgets.QWidget()
        line = "Simulate electro-optical and infrared sensors, stage by stage."
        about = QtWidgets.QLabel(line, wordWrap=True)
        about.setForegroundRole(FAINT)
        parts = (heading("Imagechain", 1.9), about, self._buttons(), self._lists)
        left = filled(QtWidgets.QVBoxLayout(), *parts, None, margins=None)
        margins = (24, 18, 24, 18)
        filled(
            QtWidgets.QHBoxLayout(page), (left, 1), (self._right, 4), margins=margins, spacing=28
        )
        self.setWidget(page)

    def showEvent(self, event: QtGui.QShowEvent) -> None:
        """Read the example networks only if the page is ever shown."""
        super().showEvent(event)
        if self._gallery is not None:
            return
        self._gallery = QtWidgets.QWidget()
        layout, files = QtWidgets.QVBoxLayout(self._gallery), shipped_networks()
        for title, names in gallery().items():
            flow = FlowLayout(across=8, down=8)
            for name, line in names.items():
                flow.addWidget(self._card(files[name], line))
            filled(layout, heading(title, 1.15), flow)
        filled(self._right, self._gallery, None, margins=None)
        self._gallery.show()  # at once, with the page

    def _card(self, file: Path, line: str) -> QtWidgets.QWidget:
        network = read_network(file, library={})  # which loads no module
        pictures = file.parent / "pictures"
        curves = pictures / f"card_{file.stem}.png"
        picture = curves if curves.exists() else pictures / f"thumbnail_{file.stem}.png"
        letters = self.width() / self.fontMetrics().averageCharWidth()
        card = Card(network.name, line, picture, min(max(letters / _LETTERS, 1.0), _LARGEST))
        labelled(card, f"welcome.{file.stem}", network.name, f"<p>{network.description}</p>")
        card.setAccessibleDescription(network.description)
        card.clicked.connect(partial(self.chosen.emit, file.stem))
        return card

    def show_lists(self, recent: Sequence[Path], recovered: Sequence[Recovered]) -> None:
        while (item := self._lists.takeAt(0)) is not None and (row := item.widget()) is not None:
            row.deleteLater()
        if recovered:
            filled(self._lists, heading("Recovered work", 1.25), margins=None)
            filled(self._lists, *map(self._recovered_row, recovered), margins=None)
        if recent:
            filled(self._lists, heading("Recent files", 1.25), margins=None)
            filled(self._lists, *map(self._recent_row, recent), margins=None)

    def _buttons(self) -> QtWidgets.QWidget:
        row = QtWidgets.QWidget()
        layout = filled(QtWidgets.QHBoxLayout(row), margins=(0, 8, 0, 8))
        for text, name, signal in (
            ("New network", "welcome.new", self.new_wanted),
            ("Open…", "welcome.open", self.open_wanted),
            ("Back", "welcome.back", self.back_wanted),
        ):
            self.back = button = QtWidgets.QPushButton(text)
            button.setObjectName(name)
            button.clicked.connect(signal)
            layout.addWidget(button)
        layout.addStretch()
        self.back.hide()
        return row

    def offer_back(self, network: str) -> None:
        self.back.setVisible(bool(network))
        self.back.setText(f"Back to {network}".replace("&", "&&"))

    def _recent_row(self, path: Path) -> QtWidgets.QWidget:
        row = Card(path.stem, folder_text(path.parent))
        labelled(row, f"welcome.recent.{path.name}", f"Open {path}", str(path))
        row.clicked.connect(partial(self.chosen.emit, str(path)))
        return row

    def _recovered_row(self, work: Recovered) -> QtWidgets.QWidget:
        row = QtWidgets.QWidget()
        name = work.original.name if work.original is not None else "never saved"
        when = datetime.fromtimestamp(work.time).strftime("%Y-%m-%d %H:%M")
        line = f"{name}, {when}" + (f": {work.problem}" if work.problem else "")
        about = QtWidgets.QLabel(line, wordWrap=True)
        layout = filled(QtWidgets.QHBoxLayout(row), (about, 1))
        if not work.problem:
            recover = self._choice("recover", f"{name} of {when}", layout)
            recover.clicked.connect(partial(self.recovered.emit, work))
        discard = self._choice("discard", f"{name} of {when}", layout)
        discard.clicked.connect(lambda *_: work.discard())
        # It stays where it is: a second click must not throw away the work that moves up.
        discard.clicked.connect(lambda: row.setDisabled(True))
        discard.clicked.connect(lambda: about.setText(f"{name}, {when}: discarded"))
        return row

    def _choice(self, key: str, what: str, layout: QtWidgets.QHBoxLayout) -> QtWidgets.QPushButton:
        button = QtWidgets.QPushButton(key.capitalize())
        labelled(button, f"welcome.{key}", f"{button.text()} {what}")
        layout.addWidget(button)
        return button


class Card(QtWidgets.QPushButton):
    """A name, a line and a picture. QCommandLinkButton writes in 9 points, whatever the font is."""

    def __init__(
        self, name: str, line: str, picture: Path | None = None, larger: float = 1.0
    ) -> None:
        super().__init__()
        self.setFlat(True)
        shown, about = QtWidgets.QLabel(), QtWidgets.QLabel(line, wordWrap=True)
        title = heading(name, 1.0)
        words = filled(QtWidgets.QVBoxLayout(), title, about, None, spacing=0)
        metrics = self.fontMetrics()
        if picture is not None:
            size = (_PICTURE * metrics.height() * larger).toSize()
            shown.setPixmap(QtGui.QIcon(str(picture)).pixmap(size, self.devicePixelRatioF()))
        shown.setVisible(picture is not None)
        self._parts = layout = filled(
            QtWidgets.QHBoxLayout(self), shown, (words, 1), margins=(6, 6, 6, 6), spacing=8
        )
        layout.setAlignment(shown, Qt.AlignmentFlag.AlignTop)
        for label in (shown, title, about):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        if picture is not None:
            width = round(_CARD * larger * metrics.averageCharWidth())
            width = max(width, layout.minimumSize().width())
            self.setFixedSize(width, layout.heightForWidth(width))

    def sizeHint(self) -> QSize:
        return self._parts.sizeHint()

    def minimumSizeHint(self) -> QSize:
        return self._parts.minimumSize()

    def enterEvent(self, event: QtGui.QEnterEvent) -> None:
        super().enterEvent(event)
        self.setFlat(False)

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.setFlat(True)


def gallery() -> dict[str, dict[str, str]]:
    """What is special of each shipped network, by groups of what one wants to do."""
    file = shipped_networks()["first_steps"].parent / "pictures" / "gallery.json"
    return dict(json.loads(file.read_text(encoding="utf-8")))


def heading(text: str, size: float) -> QtWidgets.QLabel:
    label = QtWidgets.QLabel(text)
    font = label.font()
    font.setPointSizeF(font.pointSizeF() * size)
    font.setBold(True)
    label.setFont(font)
    return label
