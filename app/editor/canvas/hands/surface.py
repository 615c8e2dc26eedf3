"""What every gesture on the canvas works with."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QLabel, QWidget

from app.editor.canvas.items.content import Content
from app.editor.canvas.items.hits import Hit, hit
from app.editor.canvas.items.wire_item import LiveWire
from app.editor.canvas.view.canvas_view import GraphView
from app.editor.level import Level
from app.editor.session import Session
from app.editor.theme import Theme


class Hint(QLabel):
    """A text beside the pointer while something is dragged."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._ground = parent
        self.setObjectName("canvas.hint")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAutoFillBackground(True)
        self.setBackgroundRole(QPalette.ColorRole.Window)  # a view's children take its own
        self.setMargin(4)
        self.setFrameShape(QLabel.Shape.Box)
        self.hide()

    def show_at(self, text: str, pos: QPoint) -> None:
        """Show a text at a pixel of the view; hide for an empty one."""
        if not text:
            self.hide()
            return
        self.setText(text)
        self.adjustSize()
        room = self._ground.rect()
        x = min(pos.x() + 16, room.right() - self.width())
        y = pos.y() + 20 if pos.y() + 20 + self.height() < room.bottom() else pos.y() - 30
        self.move(max(x, 0), max(y, 0))
        self.show()
        self.raise_()

    def set_theme(self, theme: Theme) -> None:
        """Draw it in these colours."""
        palette = theme.palette()
        palette.setColor(QPalette.ColorRole.Window, QColor(theme.raised))
        self.setPalette(palette)


@dataclass(frozen=True)
class Surface:
    """The session of what is shown, the view, its items, and what is shown during a gesture."""

    session: Session | Level
    view: GraphView
    content: Content
    live: LiveWire
    hint: Hint

    def hit(self, point: QPointF) -> Hit:
        """What lies at a point of the scene."""
        return hit(self.content, point, self.view.zoom)
