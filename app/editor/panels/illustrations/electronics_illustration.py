"""Electronics & Noise: D* of the detector against wavelength, and its noise in kelvin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from app.editor.evaluation.queries import Query
from app.editor.panels.illustrations.illustration import Illustration
from app.editor.panels.illustrations.painting.axes import Axis
from app.editor.panels.illustrations.painting.bars import Bar, paint_bars
from app.editor.panels.illustrations.painting.chart import Chart
from app.editor.panels.illustrations.painting.few_digits import brief, kelvin
from app.editor.panels.illustrations.queries.detectivity_query import (
    Detectivity,
    DetectivityQuery,
    Noises,
)

_DECADES = 2.3  # below the highest D* that are shown
_SOLID, _DASHED = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine


class ElectronicsIllustration(Illustration):
    """The curve of the material, the band and the D* taken from it, and NETDs as bars."""

    lines = 15.5

    def queries(self) -> Sequence[Query]:
        """The curve and the figures."""
        return (DetectivityQuery(self.node),)

    def take(self, value: Any) -> str:
        """Keep them."""
        self._detectivity: Detectivity = value
        missing = self.missing_inputs()
        self._note = f"not connected yet: {', '.join(missing)}" if missing else value.problem
        return in_words(value, self._note)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint the chart, and the bars or why there are none below it."""
        line = QFontMetricsF(painter.font()).height()
        below = line * 3.4
        detectivity = self._detectivity
        self._chart(painter, area.adjusted(0, 0, 0, -below), detectivity)
        bars = QRectF(area.left(), area.bottom() - below + line * 0.2, area.width(), line * 3.2)
        if detectivity.noises is not None:
            self._bars(painter, bars, detectivity.noises)
        else:
            painter.setPen(QColor(self.theme.faint_text))
            wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(bars, int(wrapped), self._note)

    def _chart(self, painter: QPainter, area: QRectF, detectivity: Detectivity) -> None:
        theme = self.theme
        chart = Chart(painter, area, *axes(detectivity), theme)
        if detectivity.band_um is not None:
            chart.band(*detectivity.band_um, theme.accent)
        first, second = theme.curves[:2]
        line = self.fontMetrics().height()
        entries = []
        if detectivity.peak is not None:
            style = Qt.PenStyle.DotLine if detectivity.typed else _SOLID
            values = np.where(detectivity.values > 0, detectivity.values, 1e-3)
            chart.curve(detectivity.wavelength_um, values, first, style)
            chart.point(detectivity.peak.wavelength_um, detectivity.peak.d_star, first)
            at = chart.at(detectivity.peak.wavelength_um, detectivity.peak.d_star)
            at.setY(max(at.y() - line * 0.8, chart.frame.top() + line * 0.6))
            chart.text(
                at,
                f"{brief(detectivity.peak.d_star)} at {brief(detectivity.peak.wavelength_um)} µm",
            )
            entries.append((detectivity.material, first, style))
        if detectivity.band_d_star is not None:
            ends = detectivity.band_um or (chart_end(detectivity) * 0.02, chart_end(detectivity))
            chart.curve(ends, (detectivity.band_d_star,) * 2, second, _DASHED, 2.0)
            at = chart.at(ends[0], detectivity.band_d_star)
            at.setY(at.y() + line * 0.8)
            chart.text(at, brief(detectivity.band_d_star))
            entries.append(("typed in" if detectivity.typed else "band", second, _DASHED))
        chart.legend(entries)

    def _bars(self, painter: QPainter, area: QRectF, noises: Noises) -> None:
        """NETDs, as long as they are large."""
        colours = self.theme.curves
        rows = (
            ("NETD detector", noises.detector_K, colours[2]),
            ("amplifier", noises.amplifier_K, colours[3]),
            ("system", noises.system_K, colours[0]),
        )
        bars = [Bar(name, value, kelvin(value), colour) for name, value, colour in rows]
        paint_bars(painter, area, bars, self.theme)


def chart_end(detectivity: Detectivity) -> float:
    """The longest wavelength shown, µm."""
    ends = [*(detectivity.band_um or ()), *detectivity.wavelength_um[-1:]]
    return 1.08 * max(ends, default=14.0)


def axes(detectivity: Detectivity) -> tuple[Axis, Axis]:
    """Wavelength, and two decades of D*."""
    levels = [detectivity.peak.d_star] if detectivity.peak is not None else []
    if detectivity.band_d_star:
        levels.append(detectivity.band_d_star)
    high, low = max(levels, default=1e12), min(levels, default=1e12)
    across = Axis(0.0, chart_end(detectivity), f"wavelength (µm), {detectivity.conditions}")
    shown = max(10**_DECADES, 10 * high / low)
    return across, Axis(high / shown, high * 6.0, "D* (cm √Hz/W)", log=True)


def in_words(detectivity: Detectivity, note: str) -> str:
    """The essential numbers."""
    parts = []
    if detectivity.peak is not None:
        parts.append(
            f"D* of {detectivity.material}: peak {brief(detectivity.peak.d_star)} cm √Hz/W at "
            f"{brief(detectivity.peak.wavelength_um)} µm, seeing {detectivity.conditions}"
        )
    if detectivity.band_d_star is not None:
        where = "typed in" if detectivity.typed else "of the band"
        parts.append(f"D* {where} {brief(detectivity.band_d_star)} cm √Hz/W")
    if detectivity.noises is not None:
        noises = detectivity.noises
        parts.append(
            f"NETD detector {kelvin(noises.detector_K)}, amplifier {kelvin(noises.amplifier_K)}, "
            f"system {kelvin(noises.system_K)}"
        )
    elif note:
        parts.append(note)
    return "; ".join(parts)
