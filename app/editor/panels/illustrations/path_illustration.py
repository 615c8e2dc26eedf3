"""Atmospheric Path: transmission over the band, and below it what the air adds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.chart import Axis, Chart, brief, ordinate_ticks, room_for_ticks
from app.editor.panels.illustrations.illustration import Illustration, NodeQuery
from core.chain.engine import PlannedNode

_ROOM = 1.2  # above a transmission of 1, whose tick the title would hide
_TITLE = "wavelength (µm)"


class PathIllustration(Illustration):
    """τ(λ), and the path radiance where there is any."""

    lines = 15.0

    def queries(self) -> Sequence[Query]:
        return (PathQuery(self.node),)

    def keep(self, path: AirOverBand) -> str:
        self._path = path
        return in_words(path)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        path = self._path
        if not len(path.wavelength_um):
            painter.setPen(QColor(self.theme.text))
            wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(area, int(wrapped), in_words(path))
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


# The query of what the air does to every wavelength.

Vector = NDArray[np.float64]
_POINTS = 401


@dataclass(frozen=True, eq=False)
class AirOverBand:
    """Transmission and path radiance of a path over a band."""

    # wavelength_um, transmission, added: shape (points,): µm; from 0 to 1; W/m²/sr/µm. All are
    # empty where the picture has no band
    wavelength_um: Vector
    transmission: Vector
    added: Vector
    # mean, added_in_band: mean transmission of the band, by its light, and what is added in it,
    # W/m²/sr
    mean: float
    added_in_band: float


def air_of(planned: PlannedNode, passing: Passing) -> AirOverBand:
    """The path of a node over the band."""
    table: Any = planned.outputs["table"]
    figures = passing.work.value(table.recipe).as_dict()
    how = dict(table.recipe.parameters)
    air, band = how["air"], how["band_um"]
    places = np.empty(0) if band is None else _places(air.points, *band)
    return AirOverBand(
        places,
        np.exp(-air.depth(places)),
        air.added(places),
        figures["transmission"],
        figures["path_radiance"],
    )


PathQuery = partial(NodeQuery, made=air_of, ports=("table",))


def _places(points: tuple[tuple[float, float], ...], low: float, high: float) -> Vector:
    """Evenly over the band, and where a table has its points."""
    known = np.array([place for place, _ in points])
    inside = known[(known >= low) & (known <= high)]
    return np.unique(np.concatenate([np.linspace(low, high, _POINTS), inside]))
