"""Bars beside one another, each with its name before it and its value behind it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget

from app.editor.viewers.plot.plotted_lines import Drawing, Line, Vector

_NAMES = 0.45  # of the width, at most, for the names
_THICK = 1.5  # lines of text that a bar is high at most
_GAP = 6
_ROUNDED = 2  # dots that a text may be wider than the whole number Qt returns
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


class BarChart(QScrollArea):
    """Draws a `Drawing` of bars, from the top down; scrolls where they are many."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Bars")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._bars = _Bars(self)
        self.setWidget(self._bars)

    def show_drawing(
        self, drawing: Drawing, shown: Collection[str], pens: Mapping[str, QPen]
    ) -> None:
        self._bars.drawing = drawing
        self._bars.pens = pens
        self.show_entries(shown)

    def show_entries(self, shown: Collection[str]) -> None:
        self._bars.shown = frozenset(shown)
        self._bars.setMinimumHeight(self._bars.least_height())
        self._bars.update()
        self.setAccessibleDescription("; ".join(self._bars.descriptions()))


class _Bars(QWidget):
    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.drawing = Drawing("")
        self.shown: frozenset[str] = frozenset()
        self.pens: Mapping[str, QPen] = {}

    def descriptions(self) -> list[str]:
        """Each bar's name and values."""
        return [
            f"{name}: {', '.join(_text(line.y, place) for line in self._lines())}"
            for place, name in enumerate(self.drawing.bars)
        ]

    def least_height(self) -> int:
        """That leaves each bar a line of text."""
        line = self.fontMetrics().height()
        groups = len(self.drawing.bars) * (max(1, len(self._lines())) * line + _GAP)
        return groups + 2 * line

    def sizeHint(self) -> QSize:
        return QSize(60 * self.fontMetrics().averageCharWidth(), self.least_height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().base())
        lines, names = self._lines(), self.drawing.bars
        if not names or not self.drawing.panels:
            return
        metrics = self.fontMetrics()
        text = metrics.height()
        values = [_text(line.y, place) for line in lines for place in range(len(names))]
        before = min(
            max(metrics.horizontalAdvance(name) for name in names) + _ROUNDED,
            int(_NAMES * self.width()),
        )
        behind = max((metrics.horizontalAdvance(value) for value in values), default=0) + 2 * _GAP
        panel = self.drawing.panels[0]
        drawn = [panel.drawn(line.y) for line in lines]
        low, high, zero = _range(drawn, panel.log)
        left = before + 2 * _GAP + (behind if low < zero else 0)
        wide = max(self.width() - left - behind, 1)
        group_height = (self.height() - 2.0 * text) / len(names)
        alone = _each_alone([line.y for line in lines], len(names))
        beside = 1 if alone else max(1, len(lines))
        thick = min((group_height - _GAP) / beside, _THICK * text)

        def at(value: float) -> float:
            return left + wide * (value - low) / (high - low)

        for place, name in enumerate(names):
            top = place * group_height + (group_height - thick * beside) / 2
            group = QRectF(_GAP, place * group_height, before, group_height)
            painter.setPen(self.palette().text().color())
            shown = metrics.elidedText(name, Qt.TextElideMode.ElideMiddle, before)
            painter.drawText(group, _RIGHT, shown)
            pairs = list(zip(lines, drawn, strict=True))
            if alone:
                pairs = sorted(pairs, key=lambda pair: _at(pair[0].y, place) == 0.0)[:1]
            for number, (line, heights) in enumerate(pairs):
                box = QRectF(0, top + number * thick, self.width(), thick)
                value = _at(heights, place)
                end = at(min(max(value, low), high)) if math.isfinite(value) else at(zero)
                bar = QRectF(at(zero), box.top(), end - at(zero), thick).normalized()
                if math.isfinite(value):
                    painter.fillRect(bar.adjusted(0, 1, 0, -1), self.pens[line.name].color())
                label = _text(line.y, place)
                if end < at(zero):
                    box.setRight(bar.left() - _GAP)
                    painter.drawText(box, _RIGHT, label)
                else:
                    box.setLeft(bar.right() + _GAP)
                    painter.drawText(box, _LEFT, label)
        painter.setPen(self.palette().mid().color())
        painter.drawLine(round(at(zero)), 0, round(at(zero)), round(group_height * len(names)))
        painter.setPen(self.palette().text().color())
        foot = QRectF(0, self.height() - 1.6 * text, self.width(), 1.6 * text)
        foot.setLeft(min(left, self.width() - metrics.horizontalAdvance(panel.y_label) - _GAP))
        painter.drawText(foot, _LEFT, panel.y_label + (", logarithmic" if panel.log else ""))

    def _lines(self) -> list[Line]:
        return [
            line
            for panel in self.drawing.panels[:1]
            for line in panel.lines
            if line.name in self.shown
        ]


def _range(drawn: list[Vector], log: bool) -> tuple[float, float, float]:
    """Ends of the scale, and where bars begin: at 0, of logarithms at the decade below all."""
    finite = np.concatenate([values[np.isfinite(values)] for values in drawn] or [np.zeros(0)])
    if log:
        if not len(finite):
            return 0.0, 1.0, 0.0
        low = math.ceil(float(finite.min())) - 1.0
        return low, max(float(finite.max()), low + 1.0), low
    low, high = min(0.0, *finite, 0.0), max(0.0, *finite, 0.0)
    return (low, high, 0.0) if high > low else (0.0, 1.0, 0.0)


def _at(heights: Vector, place: int) -> float:
    return float(heights[place]) if place < len(heights) else math.nan


def _each_alone(lines: Sequence[Vector], count: int) -> bool:
    """Whether each bar belongs to one line, as of temporal and fixed noise a source makes one."""
    values = [[_at(line, place) for line in lines] for place in range(count)]
    return len(lines) > 1 and all(sum(value != 0.0 for value in group) <= 1 for group in values)


def _text(heights: Vector, place: int) -> str:
    """A value as people read it; of no value, a dash."""
    value = _at(heights, place)
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "\N{MINUS SIGN}∞"
    return f"{value:.4g}".replace("e-0", "e-").replace("-", "\N{MINUS SIGN}")
