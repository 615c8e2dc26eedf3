"""A widget that is one small chart."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from app.editor.theme import Theme
from app.editor.widgets import require_defined


class ChartWidget(QWidget):
    """Draws on the ground of its theme; what it draws is left to its kinds.

    Parameters
    ----------
    theme : Theme
        Its colours.
    width, height : float
        Of the room it likes to have, in lines of text.
    parent : QWidget, optional
        Qt's owner.
    """

    def __init__(
        self, theme: Theme, *, width: float, height: float, parent: QWidget | None = None
    ) -> None:
        require_defined(type(self), ChartWidget, "draw")
        super().__init__(parent)
        self._theme = theme
        self._lines = width, height

    def set_theme(self, theme: Theme) -> None:
        """Draw in other colours."""
        self._theme = theme
        self.update()

    def sizeHint(self) -> QSize:
        """Room for a chart."""
        line = self.fontMetrics().height()
        return QSize(round(self._lines[0] * line), round(self._lines[1] * line))

    def minimumSizeHint(self) -> QSize:
        """Room for a small one."""
        line = self.fontMetrics().height()
        return QSize(10 * line, 7 * line)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Draw the chart in this part of the widget."""

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the ground, and the chart in smaller letters."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.base))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        font = painter.font()
        font.setPointSizeF(0.9 * font.pointSizeF())
        painter.setFont(font)
        self.draw(painter, QRectF(self.rect()).adjusted(4, 2, -4, -2))
        painter.end()
