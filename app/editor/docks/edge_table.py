"""The edges of a measurement as a list, and its figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPalette, QPolygonF
from PySide6.QtWidgets import (
    QHeaderView,
    QTableWidgetItem,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.panels.chart import Chart, ChartWidget
from app.editor.theme import FAINT
from app.editor.widgets import CopiedTable, named
from app.measure.measurement_text import USED
from core.modules.preview import Axis

if TYPE_CHECKING:
    from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement
    from core.physics.measurement.edges.edge_mtf import MtfCurve


_PLACE = Qt.ItemDataRole.UserRole
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_SWITCH_KEYS = (Qt.Key.Key_Delete, Qt.Key.Key_Backspace, Qt.Key.Key_Space)
_FIGURE_HEADS = ("Figure", "Value", "Unit")


class EdgeTable(QTreeWidget):
    """Every edge with its MTF50, or why it is not used."""

    chosen = Signal(int)  # (place): the person marks an edge
    switched = Signal()  # a key removes the marked edge, or uses it again

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._measured: PictureMeasurement | None = None
        named(self, "measure.edges", "Edges; Del leaves the selected one out, or uses it again")
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
                item.setTextAlignment(column, _RIGHT)


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
        named(self, "measure.figures", "Figures of MTF and noise; Ctrl+C copies them")
        self.list_figures(_FIGURE_HEADS)
        self._rows: tuple[tuple[str, str, str], ...] = ()

    def cells(self, row: int) -> Sequence[str]:
        return self._rows[row]

    def show_rows(self, rows: Sequence[tuple[str, str, str, str]]) -> None:
        """Show name, value, unit and meaning of figures."""
        self._rows = tuple((meaning, value, unit) for _, value, unit, meaning in rows)
        self.setRowCount(len(self._rows))
        for row, texts in enumerate(self._rows):
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                if column == 1:
                    item.setTextAlignment(_RIGHT)
                item.setToolTip(rows[row][0])
                self.setItem(row, column, item)
        self.resizeRowsToContents()


# The pooled MTF with its error, and the chosen edge's, in one small chart.

_HIGHEST = 1.15
_NYQUIST = 0.5
_ERRORS = 2.0  # standard errors, of a band
_DASH = Qt.PenStyle.DashLine


class MtfChart(ChartWidget):
    """Draws MTF against cycles per sample, across in full, along dashed."""

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
