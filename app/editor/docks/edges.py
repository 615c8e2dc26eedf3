"""The edges of a measurement: on its picture, as a list, and as curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QHelpEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QPolygonF,
    QTransform,
    QWheelEvent,
)
from PySide6.QtWidgets import (
    QHeaderView,
    QTableWidgetItem,
    QToolTip,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.panels.chart import Chart, ChartWidget
from app.editor.theme import FAINT, theme_of
from app.editor.widgets import RIGHT, CopiedTable, labelled
from app.measure.measurement_text import REFUSED, REMOVED, USED
from core.modules.preview import Axis

if TYPE_CHECKING:
    from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement, Preview
    from core.physics.measurement.edges.edge_mtf import MtfCurve

_PLACE = Qt.ItemDataRole.UserRole
_SWITCH_KEYS = (Qt.Key.Key_Delete, Qt.Key.Key_Backspace, Qt.Key.Key_Space)
_FIGURE_HEADS = ("Figure", "Value", "Unit")


class EdgeTable(QTreeWidget):
    chosen = Signal(int)  # (place): the person marks an edge
    switched = Signal()  # a key removes the marked edge, or uses it again

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._measured: PictureMeasurement | None = None
        labelled(self, "measure.edges", "Edges; Del leaves the selected one out, or uses it again")
        self.setHeaderLabels(["Edge", "Normal", "MTF50", "State"])
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setAllColumnsShowFocus(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setTextElideMode(Qt.TextElideMode.ElideRight)
        head = self.header()
        for column in range(3):
            head.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)
        head.setStretchLastSection(True)
        head.setMinimumSectionSize(3 * self.fontMetrics().averageCharWidth())
        self.currentItemChanged.connect(self._marked)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._write()

    def show_measured(self, measured: PictureMeasurement | None) -> None:
        """List the edges of a measurement; the same number of them keep their rows."""
        many = 0 if measured is None else len(measured.edges)
        self._measured = measured
        if many != self.topLevelItemCount():
            with QSignalBlocker(self):
                self.clear()
                for place in range(many):
                    item = QTreeWidgetItem(self)
                    item.setData(0, _PLACE, place)
        self._write()

    def choose(self, place: int) -> None:
        with QSignalBlocker(self):
            item = self.topLevelItem(place) if place >= 0 else None
            self.setCurrentItem(item)  # type: ignore[arg-type] # None: no row
            if item is not None:
                self.scrollToItem(item)
            else:
                self.clearSelection()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in _SWITCH_KEYS and not event.modifiers():
            self.switched.emit()
        else:
            super().keyPressEvent(event)

    def _marked(self, item: QTreeWidgetItem | None, *_: object) -> None:
        if item is not None:
            self.chosen.emit(int(item.data(0, _PLACE)))

    def _write(self) -> None:
        for place, edge in enumerate(self._measured.edges if self._measured is not None else ()):
            item = self.topLevelItem(place)
            assert item is not None
            for column, text in enumerate(_cells(place, edge)):
                item.setText(column, text)
                role = QPalette.ColorRole.Text if edge.used else FAINT
                item.setForeground(column, self.palette().color(role))
                item.setToolTip(column, tip(edge.why_not or "used"))
            for column in (0, 1):
                item.setTextAlignment(column, RIGHT)


def _cells(place: int, edge: MeasuredEdge) -> tuple[str, str, str, str]:
    half, error = "", None
    if edge.curve is not None and edge.curve.mtf50 is not None:
        half, error = f"{edge.curve.mtf50:.3f}", edge.mtf50_sigma
    angle = f"{edge.found.angle_deg:.1f}°".replace("-", "\N{MINUS SIGN}")
    return (
        str(place + 1),
        angle,
        f"{half} ± {error:.3f}" if error is not None else half,
        edge.why_not or "used",
    )


def edge_words(place: int, edge: MeasuredEdge) -> str:
    found = edge.found
    angle = f"{found.angle_deg:.1f}".replace("-", "\N{MINUS SIGN}")
    where = f"edge {place + 1}, normal at {angle}°, {found.length:.0f} samples long"
    if edge.curve is None:
        return f"{where}, not used: {edge.why_not}"
    half = "" if edge.curve.mtf50 is None else f", MTF50 {edge.curve.mtf50:.3f}"
    if edge.mtf50_sigma is not None:
        half += f" ± {edge.mtf50_sigma:.3f}"
    return where + half + ("" if edge.used else f", {edge.why_not}")


class FigureTable(CopiedTable):
    def __init__(self, parent: QWidget) -> None:
        super().__init__(0, len(_FIGURE_HEADS), parent)
        labelled(self, "measure.figures", "Figures of MTF and noise; Ctrl+C copies them")
        self.list_figures(_FIGURE_HEADS)
        self._rows: tuple[tuple[str, str, str], ...] = ()

    def cells(self, row: int) -> Sequence[str]:
        return self._rows[row]

    def show_rows(self, rows: Sequence[tuple[str, str, str, str]]) -> None:
        self._rows = tuple((meaning, value, unit) for _, value, unit, meaning in rows)
        self.setRowCount(len(self._rows))
        for row, texts in enumerate(self._rows):
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                if column == 1:
                    item.setTextAlignment(RIGHT)
                item.setToolTip(rows[row][0])
                self.setItem(row, column, item)
        self.resizeRowsToContents()


# The pooled MTF with its error, and the chosen edge's, in one small chart.

_HIGHEST = 1.15
_NYQUIST = 0.5
_ERRORS = 2.0  # standard errors, of a band
_DASH = Qt.PenStyle.DashLine


class MtfChart(ChartWidget):
    read = Signal(str)  # (text): what stands under the mouse; empty where nothing does

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(width=20, height=13, parent=parent)
        self.setObjectName("measure.mtf")
        self.setAccessibleName("MTF against frequency")
        self.setToolTip(
            "Pooled MTF across (full) and along (dashed) with ± 2 standard errors, and the "
            "MTF of the selected edge along its normal"
        )
        self.setMouseTracking(True)
        self._measured: PictureMeasurement | None = None
        self._edge: MeasuredEdge | None = None
        self._frame = QRectF()

    def show_measured(self, measured: PictureMeasurement | None, edge: MeasuredEdge | None) -> None:
        self._measured, self._edge = measured, edge
        self.update()

    def draw(self, painter: QPainter, area: QRectF) -> None:
        x = Axis(0.0, 1.0, "frequency (cycles/sample)")
        chart = Chart(painter, area, x, Axis(0.0, _HIGHEST, "MTF"), self.theme)
        self._frame = chart.frame
        measured = self._measured
        if measured is None:
            return
        legend: list[tuple[str, str, Qt.PenStyle]] = []
        for name, curve, colour, style in self._curves(measured):
            self._band(painter, chart, curve, colour)
            chart.curve(curve.frequency, curve.mtf, colour, style, 2.0)
            legend.append((name, colour, style))
            if curve.mtf50 is not None:
                chart.point(curve.mtf50, 0.5, colour)
        edge = self._edge
        if edge is not None and edge.curve is not None:
            style = Qt.PenStyle.DashDotLine
            chart.curve(edge.curve.frequency, edge.curve.mtf, self._edge_colour, style, 1.6)
            legend.append(("edge", self._edge_colour, style))
        chart.legend(legend)
        if legend:
            chart.upright(_NYQUIST, "Nyquist")
        else:
            painter.setPen(QColor(self.theme.faint_text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            inside = chart.frame.adjusted(6, 4, -6, -4).toRect()
            painter.drawText(inside, int(flags), "No edge could be used")

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        frame, measured = self._frame, self._measured
        if measured is None or frame.width() <= 0 or not frame.contains(event.position()):
            self.read.emit("")
            return
        frequency = (event.position().x() - frame.left()) / frame.width()
        parts = [
            f"{name} {_value(curve, frequency)}" for name, curve, _, _ in self._curves(measured)
        ]
        self.read.emit(f"{frequency:.3f} cycles/sample: {', '.join(parts)}" if parts else "")

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.read.emit("")

    @property
    def _edge_colour(self) -> str:
        """That of its line on the picture, which is too light for a light ground."""
        return USED if self.theme.look == "dark" else "#9a6a00"

    def _curves(self, measured: PictureMeasurement) -> list[tuple[str, MtfCurve, str, Qt.PenStyle]]:
        colours, solid = self.theme.curves, Qt.PenStyle.SolidLine
        both = (
            ("across", measured.x, colours[0], solid),
            ("along", measured.y, colours[2], _DASH),
        )
        return [(name, curve, colour, s) for name, curve, colour, s in both if curve is not None]

    def _band(self, painter: QPainter, chart: Chart, curve: MtfCurve, colour: str) -> None:
        known = np.isfinite(curve.mtf) & np.isfinite(curve.sigma)
        x, y = curve.frequency[known], curve.mtf[known]
        wide = np.minimum(_ERRORS * curve.sigma[known], 2.0 * _HIGHEST)
        above = [chart.at(*p) for p in zip(x.tolist(), (y + wide).tolist(), strict=True)]
        below = [chart.at(*p) for p in zip(x.tolist(), (y - wide).tolist(), strict=True)]
        tint = QColor(colour)
        tint.setAlpha(60)
        painter.save()
        painter.setClipRect(chart.frame)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(tint)
        painter.drawPolygon(QPolygonF([QPointF(p) for p in (*above, *reversed(below))]))
        painter.restore()


def _value(curve: MtfCurve, frequency: float) -> str:
    if frequency > curve.frequency[-1]:
        return "–"
    value = float(np.interp(frequency, curve.frequency, curve.mtf))
    error = float(np.interp(frequency, curve.frequency, curve.sigma))
    return f"{value:.3f} ± {error:.3f}" if math.isfinite(error) else f"{value:.3f}"


_NEAR_PX = 12.0  # of a click from an edge
_MOST_ZOOM = 64.0
_HINT = (
    "Measure Viewer measures the picture in a viewer; Files… measures picture files; you can "
    "also drop files here. Imagechain finds the edges and measures the MTF across each one."
)


class EdgeCanvas(QWidget):
    # (place): an edge was clicked: its place among those of the measurement; -1 beside all
    chosen = Signal(int)
    stepped = Signal(int)  # (by): a key goes to the next edge, or the one before
    switched = Signal()  # a key removes the chosen edge, or uses it again

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("measure.picture")
        self.setAccessibleName("Picture with its edges; use the arrow keys to move between edges")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self._measured: PictureMeasurement | None = None
        self._preview: Preview | None = None
        self._image: QImage | None = None
        self._current = -1
        self._all = True
        self._zoom = 1.0
        self._middle: QPointF | None = None
        self._drag: tuple[QPointF, QPointF] | None = None

    def show_measured(self, measured: PictureMeasurement | None, picture: int = 0) -> None:
        preview = None
        if measured is not None and measured.previews:
            preview = measured.previews[min(picture, len(measured.previews) - 1)]
        if preview is not self._preview:
            self._image = None if preview is None else _grey_image(preview)
            self.fit()
        self._measured, self._preview = measured, preview
        self.setAccessibleDescription("" if preview is not None else _HINT)
        self.update()

    def show_unused(self, on: bool) -> None:
        self._all = on
        self.update()

    def choose(self, place: int) -> None:
        if place != self._current:
            self._current = place
            self._keep_in_sight()
            self.update()

    def fit(self) -> None:
        self._zoom, self._middle = 1.0, None
        self.update()

    def zoom_by(self, factor: float, about: QPointF | None = None) -> None:
        """Enlarge, about a point of the widget that stays where it is."""
        if self._preview is None:
            return
        about = QPointF(self.rect().center()) if about is None else about
        there = self._placed().inverted()[0].map(about)
        self._zoom = min(max(self._zoom * factor, 1.0), _MOST_ZOOM)
        if self._zoom == 1.0:
            self._middle = None
        else:
            scale = self._scale()
            away = about - QPointF(self.rect().center())
            self._middle = there - away / scale
        self.update()

    def point_of(self, place: int) -> QPointF:
        assert self._measured is not None
        found = self._measured.edges[place].found
        return self._point(found.x, found.y)

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(24 * line, 18 * line)

    def minimumSizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(8 * line, 6 * line)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme_of(self).surround))
        preview = self._preview
        if preview is None or self._image is None or self._measured is None:
            painter.setPen(self.palette().color(FAINT))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.rect().adjusted(12, 8, -12, -8), int(flags), _HINT)
            painter.end()
            return
        factor = preview.factor
        rows, columns = preview.samples.shape
        corner = self._point(-0.5, -0.5)
        far = self._point(columns * factor - 0.5, rows * factor - 0.5)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, self._scale() * factor < 1)
        painter.drawImage(QRectF(corner, far), self._image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        own = [
            (place, edge)
            for place, edge in enumerate(self._measured.edges)
            if edge.picture == preview.picture and self._is_shown(place)
        ]
        # What is in use, and the marked one, on top.
        for place, edge in sorted(own, key=lambda one: (one[0] == self._current, one[1].used)):
            self._paint_edge(painter, edge, place == self._current)
        painter.end()

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.ToolTip and isinstance(event, QHelpEvent):
            place = self._edge_at(QPointF(event.pos()))
            text = "" if place < 0 or self._measured is None else self._words(place)
            QToolTip.showText(event.globalPos(), text, self) if text else QToolTip.hideText()
            return True
        return super().event(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton and self._preview is not None:
            self._drag = event.position(), self._middle or self._whole_middle()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._drag is not None and self._zoom > 1.0:
            start, middle = self._drag
            self._middle = middle - (event.position() - start) / self._scale()
            self.update()
            return
        over = self._edge_at(event.position()) >= 0
        shape = Qt.CursorShape.PointingHandCursor if over else Qt.CursorShape.ArrowCursor
        self.setCursor(shape)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._drag is None or event.button() != Qt.MouseButton.LeftButton:
            return
        moved = QPointF(event.position() - self._drag[0]).manhattanLength()
        self._drag = None
        if moved < _NEAR_PX / 2:
            self.chosen.emit(self._edge_at(event.position()))

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:
        self.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        self.zoom_by(1.25 ** (event.angleDelta().y() / 120.0), event.position())
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Go through the edges by the arrows, remove one by Del; +, -, 0 and F as in a viewer."""
        key = Qt.Key(event.key())
        step = {
            Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1,
        }.get(key)  # fmt: skip
        if step is not None:
            self.stepped.emit(step)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.switched.emit()
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal):
            self.zoom_by(1.25)
        elif key == Qt.Key.Key_Minus:
            self.zoom_by(0.8)
        elif key in (Qt.Key.Key_0, Qt.Key.Key_F):
            self.fit()
        else:
            super().keyPressEvent(event)
            return
        event.accept()

    # --- places ------------------------------------------------------------------------------

    def _whole_middle(self) -> QPointF:
        assert self._preview is not None
        rows, columns = self._preview.samples.shape
        factor = self._preview.factor
        return QPointF((columns * factor - 1) / 2.0, (rows * factor - 1) / 2.0)

    def _scale(self) -> float:
        assert self._preview is not None
        rows, columns = (size * self._preview.factor for size in self._preview.samples.shape)
        whole = min(self.width() / columns, self.height() / rows)
        return float(max(whole, 1e-6) * self._zoom)

    def _placed(self) -> QTransform:
        scale, middle = self._scale(), self._middle or self._whole_middle()
        there = QTransform.fromTranslate(self.width() / 2.0, self.height() / 2.0)
        return there.scale(scale, scale).translate(-middle.x(), -middle.y())

    def _point(self, x: float, y: float) -> QPointF:
        return self._placed().map(QPointF(x, y))

    def _keep_in_sight(self) -> None:
        measured = self._measured
        if measured is None or self._preview is None or not self._current >= 0:
            return
        if self._zoom > 1.0 and not self.rect().contains(self.point_of(self._current).toPoint()):
            found = measured.edges[self._current].found
            self._middle = QPointF(found.x, found.y)

    def _edge_at(self, point: QPointF) -> int:
        """The edge nearest to a point of the widget, used ones first; -1 where none is near."""
        if self._measured is None or self._preview is None:
            return -1
        nearest = (math.inf, -1)
        for place, edge in enumerate(self._measured.edges):
            if edge.picture != self._preview.picture or not self._is_shown(place):
                continue
            start, end = (self._point(x, y) for x, y in edge.found.ends)
            far = _distance(point, start, end) + (0.0 if edge.used else 2.0)
            nearest = min(nearest, (far, place))
        return nearest[1] if nearest[0] <= _NEAR_PX else -1

    def _is_shown(self, place: int) -> bool:
        assert self._measured is not None
        return self._all or place == self._current or self._measured.edges[place].curve is not None

    def _words(self, place: int) -> str:
        assert self._measured is not None
        edge = self._measured.edges[place]
        curve = edge.curve
        if not edge.used:
            return f"Edge {place + 1}: not used: {edge.why_not}"
        if curve is None or curve.mtf50 is None:
            return f"Edge {place + 1}"
        return f"Edge {place + 1}: MTF50 {curve.mtf50:.3g} cycles/sample"

    def _paint_edge(self, painter: QPainter, edge: MeasuredEdge, current: bool) -> None:
        colour, style, width = edge_look(edge)
        points = [self._point(x, y) for x, y in edge.found.ends]
        if current:
            painter.setPen(_pen("#ffffff", width + 5.0, Qt.PenStyle.SolidLine))
            painter.drawLine(*points)
        dark = QColor(0, 0, 0, 170 if edge.used or current else 90)
        painter.setPen(QPen(dark, width + 1.6, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
        painter.drawLine(*points)
        painter.setPen(_pen(colour, width, style))
        painter.drawLine(*points)


def edge_look(edge: MeasuredEdge) -> tuple[str, Qt.PenStyle, float]:
    """Colour, style and width of an edge's line: full in use, dashed not, dotted by hand."""
    if edge.used:
        return USED, Qt.PenStyle.SolidLine, 2.6
    if edge.curve is not None:
        return REMOVED, Qt.PenStyle.DotLine, 2.0
    return REFUSED, Qt.PenStyle.DashLine, 1.3


def _pen(colour: str, width: float, style: Qt.PenStyle) -> QPen:
    return QPen(QColor(colour), width, style, Qt.PenCapStyle.FlatCap)


def _distance(point: QPointF, start: QPointF, end: QPointF) -> float:
    along, to = end - start, point - start
    square = QPointF.dotProduct(along, along)
    share = min(1.0, max(0.0, QPointF.dotProduct(to, along) / square)) if square else 0.0
    away = to - along * share
    return math.hypot(away.x(), away.y())


def _grey_image(preview: Preview) -> QImage:
    from app.run.saving import grey_levels, robust_limits

    low, high = robust_limits(preview.samples)
    grey = np.ascontiguousarray(grey_levels(low, high, preview.samples))
    rows, columns = grey.shape
    image = QImage(grey.data, columns, rows, columns, QImage.Format.Format_Grayscale8)
    return image.copy()  # it has no part in the array
