"""The pooled MTF with its error, and the chosen edge's, in one small chart."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPolygonF
from PySide6.QtWidgets import QWidget

from app.editor.panels.illustrations.painting.axes import Axis
from app.editor.panels.illustrations.painting.chart import Chart
from app.editor.panels.illustrations.painting.chart_widget import ChartWidget
from app.editor.theme import Theme
from app.measure.edge_looks import USED

if TYPE_CHECKING:
    from app.measure.picture_measurement import MeasuredEdge, MtfCurve, PictureMeasurement

_HIGHEST = 1.15
_NYQUIST = 0.5
_ERRORS = 2.0  # standard errors, of a band
_DASH = Qt.PenStyle.DashLine


class MtfChart(ChartWidget):
    """Draws MTF against cycles per sample, across in full, along dashed.

    Signals
    -------
    read(text)
        What stands under the mouse; empty where nothing does.
    """

    read = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(theme, width=20, height=13, parent=parent)
        self.setObjectName("measure.mtf")
        self.setAccessibleName("MTF against frequency")
        self.setToolTip(
            "MTF pooled across (full) and along (dashed), with ± 2 standard errors, and that of "
            "the chosen edge along its normal"
        )
        self.setMouseTracking(True)
        self._measured: PictureMeasurement | None = None
        self._edge: MeasuredEdge | None = None
        self._frame = QRectF()

    def show_measured(self, measured: PictureMeasurement | None, edge: MeasuredEdge | None) -> None:
        """Draw the pooled curves of a measurement, and the curve of one of its edges."""
        self._measured, self._edge = measured, edge
        self.update()

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Draw the chart."""
        x = Axis(0.0, 1.0, "frequency (cycles/sample)")
        chart = Chart(painter, area, x, Axis(0.0, _HIGHEST, "MTF"), self._theme)
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
            painter.setPen(QColor(self._theme.faint_text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            inside = chart.frame.adjusted(6, 4, -6, -4).toRect()
            painter.drawText(inside, int(flags), "No edge could be used")

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Read the curves under the mouse."""
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
        """Read nothing any more."""
        super().leaveEvent(event)
        self.read.emit("")

    @property
    def _edge_colour(self) -> str:
        """That of its line on the picture, which is too light for a light ground."""
        return USED if self._theme.look == "dark" else "#9a6a00"

    def _curves(self, measured: PictureMeasurement) -> list[tuple[str, MtfCurve, str, Qt.PenStyle]]:
        colours, solid = self._theme.curves, Qt.PenStyle.SolidLine
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
