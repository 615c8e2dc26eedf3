"""Init & Trans: the detectors on the samples of the scene, to scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen, QPolygonF

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.chart import brief, pair, round_step
from app.editor.panels.illustrations.illustration import Illustration, NodeQuery
from core.chain.engine import PlannedNode
from core.chain.wires import Context
from core.physics.sampling.detector_sampling import ifov_mrad

_NAMES: Mapping[str, str] = MappingProxyType(
    {"line": "line scanner", "push": "pushbroom", "array": "staring array"}
)
_PLACES: Mapping[str, tuple[tuple[int, int], ...]] = MappingProxyType(
    {
        "line": ((0, 0),),
        "push": ((-1, 0), (0, 0), (1, 0)),
        "array": tuple((x, y) for y in (-1, 0, 1) for x in (-1, 0, 1)),
    }
)
_PITCHES = 3.3  # across the sketch
_INTERVALS = 4.0  # at least
_CLOSEST = 4.0  # pixels between samples that are still drawn


@dataclass(frozen=True)
class Footprint:
    """A detector's pitch and sensitive area in mrad, across and along."""

    pitch: tuple[float, float]
    sensitive: tuple[float, float]


def context_of(planned: PlannedNode, _passing: Passing) -> Context | None:
    """The sensor's geometry, as its data structure."""
    return planned.outputs.get("context")


SamplingQuery = partial(NodeQuery, made=context_of, ports=("context",))


class InitTransIllustration(Illustration):
    """Sensitive areas at the detectors' pitch, the scene's samples as dots, and what moves."""

    lines = 10.5

    def queries(self) -> Sequence[Query]:
        return (SamplingQuery(self.node),)

    def keep(self, context: Context) -> str:
        self._context = context
        return ", ".join(facts(context))

    def draw(self, painter: QPainter, area: QRectF) -> None:
        context = self._context
        line = QFontMetricsF(painter.font()).height()
        width = min(area.width() * 0.46, area.height())
        box = QRectF(area.left(), area.top() + line * 0.2, width, area.height() - line * 1.4)
        self._sketch(painter, box, context)
        beside = area.adjusted(width + line * 0.6, line * 0.2, 0, 0)
        self.write(painter, beside, facts(context))

    def _sketch(self, painter: QPainter, box: QRectF, context: Context) -> None:
        grid, footprint = context.grid, footprint_of(context)
        wide = _INTERVALS * grid.interval_x_mrad
        high = _INTERVALS * grid.interval_y_mrad
        if footprint is not None:
            wide = max(wide, _PITCHES * footprint.pitch[0])
            high = max(high, _PITCHES * footprint.pitch[1])
        scale = min(box.width() / wide, box.height() / high)
        painter.save()
        painter.setClipRect(box)
        if footprint is not None:
            self._detectors(painter, box, context, footprint, scale)
        self._samples(painter, box, scale)
        if footprint is not None:
            self._arrow(painter, box, context, footprint, scale)
        painter.restore()
        painter.setPen(QPen(QColor(self.theme.line), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(box)
        self._ruler(painter, box, scale)

    def _detectors(
        self, painter: QPainter, box: QRectF, context: Context, footprint: Footprint, scale: float
    ) -> None:
        colour = QColor(self.theme.groups["Detector"])
        outline = QPen(QColor(self.theme.faint_text), 1.0, Qt.PenStyle.DotLine)
        centre = box.center()
        for column, row in _PLACES[context.platform]:
            middle = QPointF(
                centre.x() + column * footprint.pitch[0] * scale,
                centre.y() + row * footprint.pitch[1] * scale,
            )
            painter.setPen(QPen(QColor(self.theme.curves[3]), 1.2))
            painter.setBrush(colour)
            painter.drawRect(_around(middle, footprint.sensitive, scale))
            painter.setPen(outline)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(_around(middle, footprint.pitch, scale))

    def _samples(self, painter: QPainter, box: QRectF, scale: float) -> None:
        """The scene's samples; their lattice lies so that one is in the middle."""
        grid, centre = self._context.grid, box.center()
        steps = grid.interval_x_mrad * scale, grid.interval_y_mrad * scale
        if min(steps) < _CLOSEST:
            return
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self.theme.curves[0]))
        size = min(2.0, min(steps) * 0.22)
        across = np.arange(-(box.width() / 2 // steps[0]), box.width() / 2 / steps[0] + 1e-6)
        along = np.arange(-(box.height() / 2 // steps[1]), box.height() / 2 / steps[1] + 1e-6)
        for row in along:
            for column in across:
                at = QPointF(centre.x() + column * steps[0], centre.y() + row * steps[1])
                painter.drawEllipse(at, size, size)

    def _arrow(
        self, painter: QPainter, box: QRectF, context: Context, footprint: Footprint, scale: float
    ) -> None:
        """Where the scan of a line scanner, or the flight of a pushbroom, leads."""
        if context.platform == "array":
            return
        along = context.platform == "push"
        direction = QPointF(0, 1) if along else QPointF(1, 0)
        across = QPointF(direction.y(), direction.x())
        start = box.center() + direction * (footprint.pitch[along] * scale * 0.6)
        length = footprint.pitch[along] * scale * 0.85
        end = start + direction * length
        painter.setPen(QPen(QColor(self.theme.text), 2.0))
        painter.drawLine(start, end)
        painter.setBrush(QColor(self.theme.text))
        head = min(8.0, length / 2)
        side = across * (head * 0.6)
        back = end - direction * head
        painter.drawPolygon(QPolygonF([end, back + side, back - side]))

    def _ruler(self, painter: QPainter, box: QRectF, scale: float) -> None:
        """A length in mrad below the sketch."""
        line = QFontMetricsF(painter.font()).height()
        longest = box.width() * 0.5 / scale
        length = round_step(longest / 2.5)
        y = box.bottom() + line * 0.7
        end = QPointF(box.left() + length * scale, y)
        painter.setPen(QPen(QColor(self.theme.text), 1.4))
        painter.drawLine(QPointF(box.left(), y), end)
        for x in (box.left(), end.x()):
            painter.drawLine(QPointF(x, y - 3), QPointF(x, y + 3))
        text = QRectF(end.x() + line * 0.4, y - line / 2, box.width(), line)
        left = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        painter.drawText(text, left, f"{brief(length)} mrad")


def footprint_of(context: Context) -> Footprint | None:
    """The detector's footprint; None as long as pitch or focal length is missing."""
    focal_length, x, y = context.focal_length_mm, context.detector_x_um, context.detector_y_um
    if focal_length is None or x is None or y is None:
        return None
    pitch = tuple(ifov_mrad(pitch_um=um, focal_length_mm=focal_length) for um in (x, y))
    fills = (context.fill_x, context.fill_y)
    return Footprint((pitch[0], pitch[1]), (pitch[0] * fills[0], pitch[1] * fills[1]))


def facts(context: Context) -> list[str]:
    """What the sketch shows, in numbers."""
    grid, footprint = context.grid, footprint_of(context)
    texts = [
        f"{_NAMES[context.platform]}, {grid.columns} × {grid.rows}",
        f"interval {pair(grid.interval_x_mrad, grid.interval_y_mrad)} mrad",
        f"Nyquist {pair(grid.nyquist_x, grid.nyquist_y)} cyc/mrad",
    ]
    if footprint is None:
        return [*texts, "detector pitch or focal length is missing"]
    ratios = (footprint.pitch[0] / grid.interval_x_mrad, footprint.pitch[1] / grid.interval_y_mrad)
    texts += [
        f"IFOV {pair(*footprint.sensitive)} mrad",
        f"fill {pair(context.fill_x, context.fill_y)}",
        f"samples a pitch {pair(*ratios)}",
    ]
    if context.scan_velocity_mrad_per_s:
        texts.append(f"scan {brief(context.scan_velocity_mrad_per_s)} mrad/s")
    if context.velocity_m_per_s:
        texts.append(f"platform {brief(context.velocity_m_per_s)} m/s")
    return texts


def _around(centre: QPointF, size: tuple[float, float], scale: float) -> QRectF:
    wide, high = size[0] * scale, size[1] * scale
    return QRectF(centre.x() - wide / 2, centre.y() - high / 2, wide, high)
