"""A response over wavelength, drawn over the mean spectrum of the picture that it weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter

from app.assessment.response_over_band import DrawnResponse
from app.editor.evaluation.queries import Query
from app.editor.panels.illustrations.illustration import DISABLED, Illustration
from app.editor.panels.illustrations.painting.axes import Axis
from app.editor.panels.illustrations.painting.chart import Chart
from app.editor.panels.illustrations.painting.few_digits import brief
from app.editor.panels.illustrations.queries.response_query import (
    MeanSpectrum,
    ResponseOverSpectrum,
    ResponseQuery,
)
from app.editor.theme import Theme

_ROOM = 1.12  # above a response of 1 stands what the spectrum's peak is
_HIGHEST = 0.9  # share of the axis that the spectrum's peak takes
_WIDER = 0.03  # of the band, on both sides
_SOLID = Qt.PenStyle.SolidLine


class ResponseIllustration(Illustration):
    """What counts of every wavelength."""

    def queries(self) -> Sequence[Query]:
        """The response and the spectrum."""
        return (ResponseQuery(self.node),)

    def take(self, value: Any) -> str:
        """Keep them."""
        self._drawn: ResponseOverSpectrum = value
        return in_words(value) or DISABLED

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint the chart."""
        if self._drawn.response is None:
            painter.drawText(area, Qt.AlignmentFlag.AlignCenter, DISABLED)
        else:
            paint_response(painter, area, self._drawn, self.theme)


def paint_response(
    painter: QPainter, area: QRectF, drawn: ResponseOverSpectrum, theme: Theme
) -> None:
    """The response from 0 to 1, over the spectrum on a scale of its own."""
    response = drawn.response
    assert response is not None
    low, high = response.band_um
    beside = _WIDER * (high - low)
    across = Axis(low - beside, high + beside, "wavelength (µm)")
    along = Axis(0.0, _ROOM, response.name, reach=1.0)
    chart = Chart(painter, area, across, along, theme)
    first, second = theme.curves[:2]
    entries = [("response", first, _SOLID)]
    if drawn.spectrum is not None:
        _spectrum(chart, drawn.spectrum, second)
        entries.append(("scene", second, _SOLID))
    chart.curve(response.wavelength_um, response.values, first, width=2.0)
    chart.legend(entries)


def _spectrum(chart: Chart, spectrum: MeanSpectrum, colour: str) -> None:
    peak = spectrum.means.max()
    if not peak > 0.0:
        return
    heights = spectrum.means * (_HIGHEST / peak)
    chart.filled(spectrum.centres_um, heights, colour)
    chart.curve(spectrum.centres_um, heights, colour)
    where = int(spectrum.means.argmax())
    chart.point(spectrum.centres_um[where], _HIGHEST, colour)
    chart.text(
        chart.at(spectrum.centres_um[where], _HIGHEST), f"{brief(peak)} {spectrum.unit}".rstrip()
    )


def in_words(drawn: ResponseOverSpectrum) -> str:
    """The essential numbers; empty where there is no response."""
    if drawn.response is None:
        return ""
    parts = [_response_in_words(drawn.response)]
    if drawn.spectrum is not None:
        spectrum = drawn.spectrum
        where = int(spectrum.means.argmax())
        parts.append(
            f"mean spectrum of {len(spectrum.means)} bands, highest at "
            f"{brief(spectrum.centres_um[where])} µm: {brief(spectrum.means[where])} "
            f"{spectrum.unit}".rstrip()
        )
    return "; ".join(parts)


def _response_in_words(response: DrawnResponse) -> str:
    lit = response.wavelength_um[response.values > 0.0]
    if not len(lit):
        return f"{response.name} 0"
    ends = f"from {brief(lit[0])} to {brief(lit[-1])} µm"
    return f"{response.name} up to {brief(float(response.values.max()))} {ends}"
