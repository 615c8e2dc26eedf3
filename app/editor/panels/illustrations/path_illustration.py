"""Atmospheric Path: transmission over the band, and below it what the air adds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from app.editor.evaluation.queries import Query
from app.editor.panels.illustrations.illustration import DISABLED, Illustration
from app.editor.panels.illustrations.painting.axes import Axis
from app.editor.panels.illustrations.painting.chart import Chart, ordinate_ticks, room_for_ticks
from app.editor.panels.illustrations.painting.few_digits import brief
from app.editor.panels.illustrations.queries.path_query import AirOverBand, PathQuery

_ROOM = 1.2  # above a transmission of 1, whose tick the title would hide
_TITLE = "wavelength (µm)"


class PathIllustration(Illustration):
    """τ(λ), and the path radiance where there is any."""

    lines = 15.0

    def queries(self) -> Sequence[Query]:
        """The path over the band."""
        return (PathQuery(self.node),)

    def take(self, value: Any) -> str:
        """Keep it."""
        self._path: AirOverBand | None = value
        return in_words(value) if value is not None else DISABLED

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint one chart below the other, on the same wavelengths."""
        path = self._path
        if path is None or not len(path.wavelength_um):
            painter.setPen(QColor(self.theme.text))
            wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(area, int(wrapped), DISABLED if path is None else in_words(path))
            return
        metrics = QFontMetricsF(painter.font())
        emits = float(path.added.max()) > 0.0
        above, below = _halves(area, metrics.height()) if emits else (area, area)
        ends = float(path.wavelength_um[0]), float(path.wavelength_um[-1])
        passed = Axis(0.0, _ROOM, "transmission", reach=1.0)
        most = float(path.added.max()) or 1.0
        added = Axis(0.0, _ROOM * most, "path radiance (W/m²/sr/µm)")
        left = max(
            room_for_ticks(ordinate_ticks(axis, part.height(), metrics), metrics)
            for axis, part in ((passed, above), (added, below))
        )
        first, second = self.theme.curves[:2]
        across = Axis(*ends, "" if emits else _TITLE)
        chart = Chart(painter, above, across, passed, self.theme, left=left)
        chart.curve(path.wavelength_um, path.transmission, first)
        if emits:
            across = Axis(*ends, _TITLE)
            chart = Chart(painter, below, across, added, self.theme, left=left)
            chart.filled(path.wavelength_um, path.added, second)
            chart.curve(path.wavelength_um, path.added, second)


def _halves(area: QRectF, line: float) -> tuple[QRectF, QRectF]:
    """The upper one lower by the title of the wavelengths, which only the lower one has."""
    middle = area.top() + (area.height() - line) / 2
    above = QRectF(area.left(), area.top(), area.width(), middle - area.top())
    return above, QRectF(area.left(), middle, area.width(), area.bottom() - middle)


def in_words(path: AirOverBand) -> str:
    """The essential numbers."""
    parts = [f"mean transmission of the band {brief(path.mean)}"]
    if len(path.transmission):
        least, most = path.transmission.min(), path.transmission.max()
        if brief(least) != brief(most):
            parts.append(f"from {brief(least)} to {brief(most)} over wavelength")
    if path.added_in_band > 0.0:
        parts.append(f"the air adds {brief(path.added_in_band)} W/m²/sr")
    return "; ".join(parts)
