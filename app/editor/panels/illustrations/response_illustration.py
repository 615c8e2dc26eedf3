"""A response over wavelength, drawn over the mean spectrum of the picture that it weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.chart import Axis, Chart, brief
from app.editor.panels.illustrations.illustration import Illustration, NodeQuery
from app.editor.theme import Theme
from app.report.spectra import DrawnResponse, response_over_band
from core.chain.engine import PlannedNode
from core.chain.wires import Image

_ROOM = 1.12  # above a response of 1 stands what the spectrum's peak is
_HIGHEST = 0.9  # share of the axis that the spectrum's peak takes
_WIDER = 0.03  # of the band, on both sides
_SOLID = Qt.PenStyle.SolidLine


class ResponseIllustration(Illustration):
    """What counts of every wavelength."""

    def queries(self) -> Sequence[Query]:
        return (ResponseQuery(self.node),)

    def keep(self, drawn: ResponseOverSpectrum) -> str:
        self._drawn = drawn
        return in_words(drawn)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        paint_response(painter, area, self._drawn, self.theme)


def paint_response(
    painter: QPainter, area: QRectF, drawn: ResponseOverSpectrum, theme: Theme
) -> None:
    """The response from 0 to 1, over the spectrum on a scale of its own."""
    response = drawn.response
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
    """The essential numbers."""
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


# The query of a response over wavelength, beside the mean spectrum of the picture it is for.

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeanSpectrum:
    """The mean of every band of a picture."""

    centres_um: Vector  # centres_um, means: shape (bands,): where the bands lie, and their means
    means: Vector
    unit: str  # of the means


@dataclass(frozen=True, eq=False)
class ResponseOverSpectrum:
    response: DrawnResponse
    spectrum: MeanSpectrum | None = None


def response_of(planned: PlannedNode, passing: Passing) -> ResponseOverSpectrum | None:
    """Of a Focal Plane or a Spectral Response, over the spectrum of the picture that comes in."""
    response = response_over_band(planned, passing.plan.folder)
    if response is None:
        return None
    return ResponseOverSpectrum(response, mean_spectrum(planned.inputs.get("image"), passing))


ResponseQuery = partial(NodeQuery, made=response_of, ports=("table", "image"))


def mean_spectrum(image: Image | None, passing: Passing) -> MeanSpectrum | None:
    """Of a picture with bands."""
    if image is None or image.bands is None:
        return None
    unit = f"{image.unit}/µm" if image.bands.density else image.unit
    means = np.asarray(passing.work.value(image.bands.means()), np.float64)
    return MeanSpectrum(np.array(image.bands.centres_um), means, unit)
