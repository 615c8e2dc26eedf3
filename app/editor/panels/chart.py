"""Painting a small chart: frame, ticks, curves and marks."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from app.editor.theme import Theme, theme_of
from app.editor.widgets import LEFT
from core.modules.preview import Axis, Tick

_FURTHEST = 1e4  # shares of the frame; what lies further out is cut there


class Chart:
    """Axes in a rectangle, painted at once, and what is painted in them.

    The titles of the axes stand below and above. `square`: a unit across is as long as one along;
    `left`: least room for the ticks of the ordinate, so that charts below one another line up.
    """

    def __init__(
        self,
        painter: QPainter,
        area: QRectF,
        x: Axis,
        y: Axis,
        theme: Theme,
        *,
        square: bool = False,
        left: float = 0.0,
    ) -> None:
        self._painter, self._theme = painter, theme
        self._x, self._y = x, y
        self._area = area
        self._metrics = QFontMetricsF(painter.font())
        line = self._metrics.height()
        rows = ordinate_ticks(y, area.height(), self._metrics)
        left = max(left, room_for_ticks(rows, self._metrics))
        top = line * (1.15 if y.title else 0.5)
        bottom = line * (2.1 if x.title else 1.1)
        self.frame = area.adjusted(left, top, -line * 0.5, -bottom)
        if square:
            self._make_square()
        columns = x.ticks(int(self.frame.width() / line / 2.4))
        self._paint_axes(columns, rows)

    def at(self, x: float, y: float) -> QPointF:
        frame = self.frame
        across, along = float(self._x.share(x)), float(self._y.share(y))
        return QPointF(
            frame.left() + across * frame.width(), frame.bottom() - along * frame.height()
        )

    def _points(self, x: ArrayLike, y: ArrayLike) -> list[QPointF]:
        frame = self.frame
        across = frame.left() + self._x.share(x) * frame.width()
        shares = np.clip(self._y.share(y), -_FURTHEST, _FURTHEST)
        return list(map(QPointF, across, frame.bottom() - shares * frame.height()))

    def curve(
        self,
        x: ArrayLike,
        y: ArrayLike,
        colour: str,
        style: Qt.PenStyle = Qt.PenStyle.SolidLine,
        width: float = 1.6,
    ) -> None:
        """Broken where a value is NaN."""
        points, painter = self._points(x, y), self._painter
        painter.save()
        painter.setClipRect(self.frame.adjusted(0, -1, 1, 1))
        painter.setPen(_pen(colour, width, style))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for run in _runs(np.isfinite([point.y() for point in points])):
            painter.drawPolyline(QPolygonF(points[run]))
        painter.restore()

    def filled(self, x: ArrayLike, y: ArrayLike, colour: str, *, closed: bool = False) -> None:
        """Tint what lies below points, which are all finite, or inside a closed line of them."""
        points, bottom = self._points(x, y), self.frame.bottom()
        if not closed:
            points += [QPointF(points[-1].x(), bottom), QPointF(points[0].x(), bottom)]
        self._painter.save()
        self._painter.setClipRect(self.frame)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(_tint(colour, 60))
        self._painter.drawPolygon(QPolygonF(points))
        self._painter.restore()

    def dots(self, x: ArrayLike, y: ArrayLike, colour: str, radius: float) -> None:
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(QColor(colour))
        for point in self._points(x, y):
            self._painter.drawEllipse(point, radius, radius)

    def upright(self, x: float, text: str, line: int = 0) -> None:
        """A dashed line at a place across, with a text at its top, so many lines down."""
        point = self.at(x, self._y.high)
        self._painter.setPen(_pen(self._theme.faint_text, 1.0, Qt.PenStyle.DashLine))
        self._painter.drawLine(point, QPointF(point.x(), self.frame.bottom()))
        height = self._metrics.height()
        self.text(QPointF(point.x(), point.y() + (line + 0.6) * height), text)

    def level(self, y: float) -> None:
        self._painter.setPen(_pen(self._theme.line, 1.0, Qt.PenStyle.DotLine))
        self._painter.drawLine(self.at(self._x.low, y), self.at(self._x.high, y))

    def band(self, low: float, high: float, colour: str) -> None:
        left, right = self.at(low, self._y.low).x(), self.at(high, self._y.low).x()
        frame = self.frame
        shaded = QRectF(left, frame.top(), right - left, frame.height()).intersected(frame)
        self._painter.fillRect(shaded, _tint(colour, 48))

    def point(self, x: float, y: float, colour: str) -> None:
        self._painter.setPen(_pen(self._theme.base, 1.0))
        self._painter.setBrush(QColor(colour))
        self._painter.drawEllipse(self.at(x, y), 3.5, 3.5)

    def text(self, beside: QPointF, text: str, colour: str = "") -> None:
        """Write right of a point, or left of it where there is no room, on a ground of its own."""
        line = self._metrics.height()
        width = self._width(text) + line * 0.3
        left = beside.x() + line * 0.25
        if left + width > self.frame.right():
            left = max(self.frame.left(), beside.x() - line * 0.25 - width)
        box = QRectF(left, beside.y() - line / 2, width, line)
        self._painter.fillRect(box, _tint(self._theme.base, 200))
        self._write(text, left + line * 0.15, box.top(), colour or self._theme.text)

    def _write(self, text: str, left: float, top: float, colour: str) -> None:
        box = QRectF(left, top, self._width(text), self._metrics.height())
        self._painter.setPen(QColor(colour))
        self._painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def legend(self, entries: Sequence[tuple[str, str, Qt.PenStyle]]) -> None:
        """Names, colours and styles of curves, above the frame at the right."""
        line = self._metrics.height()
        right = self.frame.right()
        middle = self.frame.top() - line * 0.62
        for text, colour, style in reversed(entries):
            left = right - self._width(text)
            self._write(text, left, middle - line / 2, self._theme.text)
            self._painter.setPen(_pen(colour, 1.6, style))
            start = left - line * 1.9
            self._painter.drawLine(QPointF(start, middle), QPointF(start + line * 1.6, middle))
            right = start - line * 0.6

    def _make_square(self) -> None:
        frame = self.frame
        wide, high = self._x.high - self._x.low, self._y.high - self._y.low
        scale = min(frame.width() / abs(wide), frame.height() / abs(high))
        self.frame = QRectF(frame.left(), frame.top(), abs(wide) * scale, abs(high) * scale)

    def _paint_axes(self, columns: Sequence[Tick], rows: Sequence[Tick]) -> None:
        painter, frame, theme = self._painter, self.frame, self._theme
        line = self._metrics.height()
        for value, text in rows:
            y = self.at(self._x.low, value).y()
            painter.setPen(_pen(theme.grid, 1.0))
            painter.drawLine(QPointF(frame.left(), y), QPointF(frame.right(), y))
            if not self._y.title or y >= frame.top() + line * 0.3:  # else the title stands there
                left = frame.left() - self._width(text) - line * 0.3
                self._write(text, left, y - line / 2, theme.faint_text)
        free = -1e9
        for value, text in columns:
            x = self.at(value, self._y.low).x()
            painter.setPen(_pen(theme.grid, 1.0))
            painter.drawLine(QPointF(x, frame.top()), QPointF(x, frame.bottom()))
            width = self._width(text)
            left = min(x - width / 2, frame.right() + line * 0.5 - width)
            if left >= free:
                free = left + width + line * 0.4
                self._write(text, left, frame.bottom() + line * 0.08, theme.faint_text)
        painter.setPen(_pen(theme.line, 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(frame)
        painter.setPen(QColor(theme.text))
        if self._y.title:
            box = QRectF(0, frame.top() - line * 1.12, frame.right(), line)
            painter.drawText(box.adjusted(line * 0.3, 0, 0, 0), LEFT, self._y.title)
        if self._x.title:
            # Below the frame's middle, but farther left where it is wider than the frame.
            area, width = self._area, self._width(self._x.title)
            left = min(frame.center().x() - width / 2, area.right() - width)
            box = QRectF(max(left, area.left()), frame.bottom() + line * 1.05, area.width(), line)
            title = self._metrics.elidedText(
                self._x.title, Qt.TextElideMode.ElideRight, area.width()
            )
            painter.drawText(box, LEFT, title)

    def _width(self, text: str) -> float:
        return self._metrics.horizontalAdvance(text)


def ordinate_ticks(y: Axis, height: float, metrics: QFontMetricsF) -> tuple[Tick, ...]:
    return y.ticks(int(height / metrics.height() / 2))


def room_for_ticks(ticks: Sequence[Tick], metrics: QFontMetricsF) -> float:
    widest = max((metrics.horizontalAdvance(text) for _, text in ticks), default=0.0)
    return widest + metrics.height() * 0.4


def _pen(colour: str, width: float, style: Qt.PenStyle = Qt.PenStyle.SolidLine) -> QPen:
    pen = QPen(QColor(colour), width, style)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    return pen


def _tint(colour: str, alpha: int) -> QColor:
    tint = QColor(colour)
    tint.setAlpha(alpha)
    return tint


def _runs(good: np.ndarray) -> list[slice]:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], good.astype(np.int8), [0]))))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


class ChartWidget(QWidget):
    """Draws on the ground of its theme; the room it likes to have is in lines of text."""

    def __init__(self, *, width: float, height: float, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._lines = width, height

    @property
    def theme(self) -> Theme:
        return theme_of(self)

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(round(self._lines[0] * line), round(self._lines[1] * line))

    def minimumSizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(10 * line, 7 * line)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        raise NotImplementedError

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self.theme.base))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self.draw(painter, QRectF(self.rect()).adjusted(4, 2, -4, -2))
        painter.end()
