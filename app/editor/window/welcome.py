"""The first page: the example networks, recent files, work to recover."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import cache, partial, reduce
from pathlib import Path
from typing import Any

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QIcon,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
    QResizeEvent,
    QShowEvent,
    QTransform,
)
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

import networks
from app.editor.canvas.canvas_style import NARROWEST
from app.editor.canvas.content import points_of
from app.editor.gestures import without_argument
from app.editor.recovery_files import Recovered
from app.editor.theme import FAINT, theme_of
from app.editor.widgets import filled, labelled, make_bold
from app.editor.window.recent_files import folder_text
from app.library_index import declarations
from app.run.shipped import shipped_networks
from core.modules.declaration import Library
from core.network.file import read_network
from core.network.network import Network


class WelcomePage(QScrollArea):
    chosen = Signal(str)  # (text): open this path or shipped network
    new_wanted = Signal()  # begin an empty network
    open_wanted = Signal()
    back_wanted = Signal()  # show the network again
    recovered = Signal(object)  # (work): open work that a crash left behind: a `Recovered`

    def __init__(self, library: Library, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "welcome", "Welcome page")
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self._library = library
        self._lists = QVBoxLayout()
        self._right = right = QVBoxLayout()
        self.gallery: Gallery | None = None
        page = QWidget()
        about = QLabel("Simulate electro-optical and infrared sensors, stage by stage.")
        about.setWordWrap(True)
        about.setForegroundRole(FAINT)
        parts = (heading("Imagechain", 1.9), about, self._buttons(), self._lists)
        left = filled(QVBoxLayout(), *parts, None, margins=None)
        right.addWidget(heading("New from an example", 1.5))
        filled(QHBoxLayout(page), (left, 1), (right, 4), margins=(24, 18, 24, 18), spacing=28)
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
        layout = filled(QHBoxLayout(row), margins=(0, 8, 0, 8))
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
        name = work.original.name if work.original is not None else "never saved"
        when = datetime.fromtimestamp(work.time).strftime("%Y-%m-%d %H:%M")
        about = QLabel(f"{name}, {when}" + (f": {work.problem}" if work.problem else ""))
        about.setWordWrap(True)
        layout = filled(QHBoxLayout(row), (about, 1))
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


# The example networks, grouped by what one wants to do: a card each, with its picture and chain.
#
# Nothing is computed to draw a card: its picture or curves come with the program, and its chain is
# drawn from the network's file.

GROUPS, CURVES = "pictures/gallery.json", "pictures/gallery_curves.json"
_PICTURE = QSize(7, 5)  # in lines of text
_NARROWEST = 54  # letters that a card is wide at least
_MOST_COLUMNS = 4
_STRETCH = 3.0  # at most, of one side of a chain over the other
_CHAIN = 2.6  # lines of text that the chain is high
_MARGIN = 8
_NODE = 70.0  # height of a node on the drawing, in units of the canvas
_LIGHTER = {"dark": 150, "light": 90}  # %, that nodes stand out from the card
_BAR = 4  # points of a bar's outline; every curve has more

Line = tuple[int, list[tuple[int, int]]]  # of which colour; its points in thousandths, y upwards


class Gallery(QWidget):
    chosen = Signal(str)  # (name): open this network

    def __init__(self, library: Library, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setSpacing(10)
        self._columns = 0
        self._groups: list[tuple[QLabel, list[NetworkCard]]] = []
        groups = {key: declared.group for key, declared in declarations(library).items()}
        files = shipped_networks()
        for title, names in read_data(GROUPS).items():
            cards = [NetworkCard(name, files[name], line, groups) for name, line in names.items()]
            for card in cards:
                card.clicked.connect(partial(self.chosen.emit, card.name))
            self._groups.append((heading(title, 1.15), cards))
        self._lay()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._lay()

    def _lay(self) -> None:
        narrowest = _NARROWEST * self.fontMetrics().averageCharWidth()
        columns = min(max(1, self.width() // narrowest), _MOST_COLUMNS)
        if columns == self._columns:
            return
        for column in range(max(columns, self._columns)):
            self._grid.setColumnStretch(column, 1 if column < columns else 0)
        row = 0
        for title, cards in self._groups:
            self._grid.addWidget(title, row, 0, 1, columns)
            for number, card in enumerate(cards):
                self._grid.addWidget(card, row + 1 + number // columns, number % columns)
            row += 1 + math.ceil(len(cards) / columns)
        self._columns = columns


class NetworkCard(QToolButton):
    def __init__(self, name: str, file: Path, line: str, groups: Mapping[str, str]) -> None:
        super().__init__()
        network = read_network(file, library={})  # which loads no module
        self.name = name
        labelled(self, f"welcome.{name}", network.name)
        self.setAccessibleDescription(network.description)
        self.setToolTip(f"<p>{network.description}</p>")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.setMinimumWidth(1)  # else a long name widens its column
        self.title, self.line = QLabel(network.name), QLabel(line)
        make_bold(self.title)
        for label in (self.title, self.line):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
        parts = (self.title, self.line, None, ChainDrawing(network, groups))
        right = filled(QVBoxLayout(), *parts, margins=None, spacing=3)
        special, margins = SpecialDrawing(name, file.parent / "pictures"), (_MARGIN,) * 4
        self._whole = filled(QHBoxLayout(self), special, (right, 1), margins=margins, spacing=10)
        for child in self.findChildren(QWidget):
            child.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def sizeHint(self) -> QSize:
        return self._whole.totalSizeHint()


class SpecialDrawing(QWidget):
    def __init__(self, name: str, pictures: Path) -> None:
        super().__init__()
        self.curves: Sequence[Line] = read_data(CURVES).get(name, ())
        self._picture = QIcon(str(pictures / f"thumbnail_{name}.png"))
        self.setFixedSize(_PICTURE * self.fontMetrics().height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme, box = theme_of(self), self.rect()
        with QPainter(self) as painter:
            if not self.curves:
                self._picture.paint(painter, box)
                return
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.fillRect(box, QColor(theme.base))
            painter.translate(6, box.height() - 6)
            across, up = (box.width() - 12) / 1000, (12 - box.height()) / 1000
            for number, line in self.curves:
                painter.setPen(QPen(QColor(theme.curves[number % len(theme.curves)]), 1.5))
                points = QPolygonF([QPointF(x * across, y * up) for x, y in line])
                if len(line) == _BAR:
                    painter.setBrush(painter.pen().color())
                    painter.drawRect(points.boundingRect())
                painter.drawPolyline(points)


class ChainDrawing(QWidget):
    def __init__(self, network: Network, groups: Mapping[str, str]) -> None:
        super().__init__()
        self._boxes = {n: QRectF(*at, NARROWEST, _NODE) for n, at in points_of(network).items()}
        self._groups = {name: groups.get(node.module, "") for name, node in network.nodes.items()}
        self._links = {(link.source, link.target) for link in network.links}
        self.setFixedHeight(round(_CHAIN * self.fontMetrics().height()))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme, whole = theme_of(self), reduce(QRectF.united, self._boxes.values(), QRectF())
        across, down = self.width() / max(whole.width(), 1), self.height() / max(whole.height(), 1)
        # A chain of one row does not become a row of towers, nor a column a pile of planks.
        across, down = min(across, _STRETCH * down), min(down, _STRETCH * across)
        place = QTransform.fromScale(across, down).translate(-whole.left(), -whole.top())
        boxes = {name: place.mapRect(box) for name, box in self._boxes.items()}
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(QPen(QColor(theme.faint_text), 1))
            for source, target in self._links:
                painter.drawLine(boxes[source].center(), boxes[target].center())
            painter.setPen(Qt.PenStyle.NoPen)
            for name, box in boxes.items():
                colour = QColor(theme.groups.get(self._groups[name], theme.raised))
                painter.setBrush(colour.lighter(_LIGHTER[theme.look]))
                painter.drawRoundedRect(box, 1.5, 1.5)


@cache
def read_data(name: str) -> Any:
    file = Path(networks.__path__[0]) / name
    return json.loads(file.read_text(encoding="utf-8"))


def heading(text: str, size: float) -> QLabel:
    label = QLabel(text)
    font = label.font()
    font.setPointSizeF(font.pointSizeF() * size)
    font.setBold(True)
    label.setFont(font)
    return label
