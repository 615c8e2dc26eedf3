"""The example networks, grouped by what one wants to do: a card each, with its picture and chain.

Nothing is computed to draw a card: its picture or curves come with the program, and its chain is
drawn from the network's file.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
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
    QTransform,
)
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

import networks
from app.editor.canvas.items.canvas_style import NARROWEST
from app.editor.canvas.items.content import points_of
from app.editor.theme import theme_of
from app.library_index import declarations
from app.run.shipped import shipped_networks
from core.modules.declaration import Library
from core.network.file import read_network
from core.network.network import Network

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
    """The cards under their headings, in as many columns as there is room for."""

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
    """A network: what is special of it, its name and line, and its chain."""

    def __init__(self, name: str, file: Path, line: str, groups: Mapping[str, str]) -> None:
        super().__init__()
        network = read_network(file, library={})  # which loads no module
        self.name = name
        self.setObjectName(f"welcome.{name}")
        self.setAccessibleName(network.name)
        self.setAccessibleDescription(network.description)
        self.setToolTip(f"<p>{network.description}</p>")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.title, self.line = QLabel(network.name), QLabel(line)
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        right = QVBoxLayout()
        right.setSpacing(3)
        for label in (self.title, self.line):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            right.addWidget(label)
        right.addStretch(1)
        right.addWidget(ChainDrawing(network, groups))
        whole = self._whole = QHBoxLayout(self)
        whole.setContentsMargins(_MARGIN, _MARGIN, _MARGIN, _MARGIN)
        whole.setSpacing(10)
        whole.addWidget(SpecialDrawing(name, file.parent / "pictures"))
        whole.addLayout(right, 1)
        for child in self.findChildren(QWidget):
            child.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def sizeHint(self) -> QSize:
        return self._whole.totalSizeHint()

    def minimumSizeHint(self) -> QSize:
        return self._whole.totalMinimumSize()


class SpecialDrawing(QWidget):
    """A network's curves where it is about curves, else its picture."""

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
    """The nodes where the network has them, in the colours of the library's groups."""

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
    """A line in bold letters of so many times the usual size."""
    label = QLabel(text)
    font = label.font()
    font.setPointSizeF(font.pointSizeF() * size)
    font.setBold(True)
    label.setFont(font)
    return label
