"""The ports of a node on its panel, each with a button that shows it."""

from __future__ import annotations

from PySide6.QtCore import QObject, QPointF, QSize, Qt, Signal
from PySide6.QtGui import QAction, QBrush, QColor, QPainter, QPixmap
from PySide6.QtWidgets import QGridLayout, QLabel, QMenu, QToolButton, QWidget

from app.editor.declared_text import tip
from app.editor.theme import Theme
from app.editor.viewers.network_ports import PLOT_TYPES, VIEWER_NUMBERS
from core.modules.declaration import Declaration, Port
from core.network.network import Link, Network


class PortsView(QWidget):
    """Inputs and outputs; an input shows what its wire brings.

    Signals
    -------
    view_requested(node, port, viewer)
        Show that output in the viewer of that number.
    """

    view_requested = Signal(str, str, int)

    def __init__(
        self, declaration: Declaration, node: str, theme: Theme, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("ports")
        self._node = node
        self._rows: list[_PortRow] = []
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 2, 0, 2)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(1, 1)
        sides = (("input", declaration.inputs), ("output", declaration.outputs))
        for side, ports in sides:
            for port in ports:
                row = _PortRow(node, port, side, self)
                row.view_requested.connect(self.view_requested)
                line = len(self._rows)
                for column, widget in enumerate((row.mark, row.label, row.button)):
                    grid.addWidget(widget, line, column)
                self._rows.append(row)
        self.set_theme(theme)

    def follow(self, network: Network) -> None:
        """Show where the inputs' wires come from."""
        links = {link.input: link for link in network.links_into(self._node)}
        for row in self._rows:
            row.follow(links.get(row.port.name))

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        for row in self._rows:
            row.set_theme(theme)


class _PortRow(QObject):
    """The widgets of one port."""

    view_requested = Signal(str, str, int)

    def __init__(self, node: str, port: Port, side: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.port = port
        self._side = side
        self._source = (node, port.name) if side == "output" else None
        self.mark = QLabel(parent)
        self.label = QLabel(parent)
        self.label.setWordWrap(True)
        self.label.setTextFormat(Qt.TextFormat.PlainText)
        kinds = " or ".join(port.types)
        need = "" if port.required else ", may be left unconnected"
        self.label.setToolTip(tip(f"{side} {port.name}: {kinds}{need}"))
        self.button = QToolButton(parent)
        self.button.setObjectName(f"view.{side}.{port.name}")
        self.button.setText("View")
        self.button.setAccessibleName(f"view {side} {port.name}")
        self.button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        if set(port.types) <= set(PLOT_TYPES):
            self.button.setToolTip(tip("Show it in Curves"))
        else:
            self._offer_viewers()
        self.button.clicked.connect(self._clicked)
        self.follow(None)

    def _offer_viewers(self) -> None:
        tooltip = "Show it in viewer 1; the arrow (or Down key) offers the others"
        self.button.setToolTip(tip(tooltip))
        self.button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        menu = QMenu(self.button)
        for number in VIEWER_NUMBERS:
            menu.addAction(f"Viewer &{number}").setData(number)
        menu.triggered.connect(self._chosen)
        self.button.setMenu(menu)

    def follow(self, link: Link | None) -> None:
        """Show what is linked to an input."""
        text = self.port.name
        if self._side == "input":
            self._source = (link.source, link.output) if link is not None else None
            text += f" ← {link.source}.{link.output}" if link is not None else " ← not connected"
        self.label.setText(text)
        self.button.setEnabled(self._source is not None)

    def set_theme(self, theme: Theme) -> None:
        """Colour the mark by the port's type."""
        height = self.label.fontMetrics().height()
        colour = theme.ports.get(self.port.types[0], theme.faint_text)
        self.mark.setPixmap(_dot(height, colour, self.mark.devicePixelRatioF()))

    def _clicked(self) -> None:
        self._view(1)

    def _chosen(self, action: QAction) -> None:
        self._view(int(action.data()))

    def _view(self, number: int) -> None:
        if self._source is not None:
            self.view_requested.emit(*self._source, number)


def _dot(height: int, colour: str, ratio: float) -> QPixmap:
    pixmap = QPixmap(QSize(height, height) * ratio)
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QBrush(QColor(colour)))
    painter.drawEllipse(QPointF(height / 2, height / 2), height * 0.28, height * 0.28)
    painter.end()
    return pixmap
