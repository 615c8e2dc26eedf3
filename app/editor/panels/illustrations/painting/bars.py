"""Painting bars below one another, with their names and values beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from app.editor.theme import Theme

_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


@dataclass(frozen=True)
class Bar:
    """One bar: its name, how long it is beside the others, its value in words, its colour."""

    name: str
    size: float
    value: str
    colour: str


def paint_bars(painter: QPainter, area: QRectF, bars: Sequence[Bar], theme: Theme) -> None:
    """Paint bars as long as they are large; the longest has all the room there is."""
    metrics = QFontMetricsF(painter.font())
    height = area.height() / len(bars)
    named = max(metrics.horizontalAdvance(bar.name) for bar in bars) + height * 0.5
    valued = max(metrics.horizontalAdvance(bar.value) for bar in bars) + height * 0.5
    most = max(*(bar.size for bar in bars), 1e-300)
    room = max(0.0, area.width() - named - valued)
    for number, bar in enumerate(bars):
        top = area.top() + number * height
        painter.setPen(QColor(theme.text))
        painter.drawText(QRectF(area.left(), top, named - height * 0.4, height), _RIGHT, bar.name)
        length = room * min(1.0, bar.size / most)
        filled = QRectF(area.left() + named, top + height * 0.22, length, height * 0.56)
        painter.fillRect(filled, QColor(bar.colour))
        painter.drawText(
            QRectF(filled.right() + height * 0.3, top, valued, height), _LEFT, bar.value
        )
