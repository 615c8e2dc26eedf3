"""Focal Plane: how full the well is and of what, the noise by source, the response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen

from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.panels.illustrations.chart import Bar, brief, electrons, kelvin, paint_bars
from app.editor.panels.illustrations.illustration import Illustration, NodeQuery
from app.editor.panels.illustrations.response_illustration import (
    ResponseOverSpectrum,
    ResponseQuery,
    paint_response,
)
from app.editor.panels.illustrations.response_illustration import in_words as response_in_words
from core.chain.engine import PlannedNode

# The query of a focal plane's electrons and noises.


@dataclass(frozen=True)
class ElectronBudget:
    """Where a pixel's electrons come from, and its noise by source, at the picture's mean."""

    # sources_e, noises_e: electrons by their source; standard deviations by theirs
    sources_e: Mapping[str, float]
    noises_e: Mapping[str, float]
    temporal_e: float  # all noise that changes from frame to frame
    full_well_e: float | None  # None where none is given
    per_K: float | None  # electrons per kelvin of the scene, where it is warm
    netd_K: float | None  # netd_K, snr: where they mean something
    snr: float | None

    @property
    def total_e(self) -> float:
        return max(sum(self.sources_e.values()), 0.0)

    @property
    def fill(self) -> float | None:
        """Share of the well that is full; above 1 it overflows."""
        return self.total_e / self.full_well_e if self.full_well_e else None


def electrons_of(planned: PlannedNode, passing: Passing) -> ElectronBudget:
    figures: dict[str, Any] = passing.work.value(planned.outputs["table"].recipe).as_dict()
    module: Any = planned.module
    sources = ("scene", "signal_e"), ("optics", "optics_e"), ("housing", "housing_e")
    noises = (
        ("shot", "shot_noise_e"),
        ("read", "read_noise_e"),
        ("rounding", "quantization_noise_e"),
        ("fixed pattern", "fixed_pattern_e"),
    )
    return ElectronBudget(
        sources_e={name: figures[key] for name, key in (*sources, ("dark", "dark_e"))},
        noises_e={name: figures[key] for name, key in noises},
        temporal_e=figures["temporal_noise_e"],
        full_well_e=module.full_well_e,
        per_K=figures["responsivity_e_per_K"],
        netd_K=figures["netd_K"],
        snr=figures["snr"],
    )


ElectronsQuery = partial(NodeQuery, made=electrons_of, ports=("table",))

_LINES, _CHART = 12.5, 9.0  # of text: without a chart, and what that takes
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class FocalPlaneIllustration(Illustration):
    """The well as a bar, filled by what brings electrons, and below it a bar for every noise.

    Of a picture in bands, below that the quantum efficiency over their means.
    """

    lines = _LINES
    _budget: ElectronBudget | None = None
    _over: ResponseOverSpectrum | None = None

    def queries(self) -> Sequence[Query]:
        return ElectronsQuery(self.node), ResponseQuery(self.node)

    def take(self, answer: Answer) -> None:
        if answer.query == ResponseQuery(self.node) and answer.error is None:
            over = answer.value
            self._over = over if over is not None and over.spectrum is not None else None
            lines = _LINES + (_CHART if self._over is not None else 0.0)
            if lines != self.lines:
                self.lines = lines
                self.updateGeometry()
            if self._budget is not None and not self.problem:
                self.describe(self._in_words(self._budget))
                self.update()
        else:
            super().take(answer)

    def keep(self, budget: ElectronBudget) -> str:
        self._budget = budget
        return self._in_words(budget)

    def _in_words(self, budget: ElectronBudget) -> str:
        words = in_words(budget)
        return f"{words}; {response_in_words(self._over)}" if self._over is not None else words

    def draw(self, painter: QPainter, area: QRectF) -> None:
        if self._budget is None:
            return
        if self._over is not None:
            height = area.height() * _CHART / self.lines
            below = QRectF(area.left(), area.bottom() - height, area.width(), height)
            paint_response(painter, below, self._over, self.theme)
            area = area.adjusted(0, 0, 0, -height - QFontMetricsF(painter.font()).height() * 0.4)
        self._electrons(painter, area, self._budget)

    def _electrons(self, painter: QPainter, area: QRectF, budget: ElectronBudget) -> None:
        line = QFontMetricsF(painter.font()).height()
        self._well(painter, QRectF(area.left(), area.top(), area.width(), line * 2.5), budget)
        names = QRectF(area.left(), area.top() + line * 2.6, area.width(), line * 2.4)
        self._names(painter, names, budget)
        below = QRectF(area.left(), names.bottom() + line * 0.2, area.width(), 0.0)
        below.setBottom(area.bottom())
        paint_bars(painter, below, self._bars(budget), self.theme)

    def _well(self, painter: QPainter, area: QRectF, budget: ElectronBudget) -> None:
        """One bar of all electrons; the frame is the well."""
        theme, line = self.theme, QFontMetricsF(painter.font()).height()
        head = QRectF(area.left(), area.top(), area.width(), line * 1.2)
        overflows = budget.fill is not None and budget.fill > 1.0
        painter.setPen(QColor(theme.error if overflows else theme.text))
        painter.drawText(head, _LEFT, well_text(budget))
        painter.setPen(QColor(theme.text))
        painter.drawText(head, _RIGHT, merit_text(budget))
        well = QRectF(area.left(), head.bottom() + line * 0.2, area.width(), line * 1.1)
        whole = max(budget.full_well_e or 0.0, budget.total_e, 1e-300)
        left = well.left()
        for colour, size in zip(theme.curves, budget.sources_e.values(), strict=False):
            width = well.width() * max(size, 0.0) / whole
            painter.fillRect(QRectF(left, well.top(), width, well.height()), QColor(colour))
            left += width
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(theme.error if overflows else theme.line), 1.2))
        if budget.full_well_e:
            painter.drawRect(
                QRectF(
                    *(well.left(), well.top()),
                    *(well.width() * budget.full_well_e / whole, well.height()),
                )
            )

    def _names(self, painter: QPainter, area: QRectF, budget: ElectronBudget) -> None:
        """What the parts of the well are, those that bring electrons, two beside each other."""
        line = QFontMetricsF(painter.font()).height()
        box, half = line * 0.6, area.width() / 2
        parts = zip(self.theme.curves, budget.sources_e.items(), strict=False)
        named = [(colour, name, size) for colour, (name, size) in parts if size > 0.0]
        for number, (colour, name, size) in enumerate(named):
            left = area.left() + number % 2 * half
            top = area.top() + number // 2 * line * 1.2
            painter.fillRect(QRectF(left, top + (line - box) / 2, box, box), QColor(colour))
            painter.setPen(QColor(self.theme.text))
            text = QRectF(left + box * 1.4, top, half - box * 1.4, line)
            painter.drawText(text, _LEFT, f"{name} {electrons(size)}")

    def _bars(self, budget: ElectronBudget) -> list[Bar]:
        colours = self.theme.curves[len(budget.sources_e) :]
        parts = zip(colours, budget.noises_e.items(), strict=False)
        bars = [Bar(name, size, noise_text(size, budget), colour) for colour, (name, size) in parts]
        whole = budget.temporal_e
        return [*bars, Bar("temporal", whole, noise_text(whole, budget), self.theme.faint_text)]


def well_text(budget: ElectronBudget) -> str:
    total = electrons(budget.total_e)
    if budget.fill is None:
        return f"{total}, no full well given"
    return f"{total}: {brief(100 * budget.fill)} % of the well"


def merit_text(budget: ElectronBudget) -> str:
    """NETD of a warm scene, else the SNR."""
    if budget.netd_K is not None:
        return f"NETD {kelvin(budget.netd_K)}"
    return f"SNR {brief(budget.snr)}" if budget.snr is not None else ""


def noise_text(noise_e: float, budget: ElectronBudget) -> str:
    """A noise in electrons, and in kelvin where the scene is warm."""
    text = electrons(noise_e)
    return f"{text}, {kelvin(noise_e / budget.per_K)}" if budget.per_K else text


def in_words(budget: ElectronBudget) -> str:
    """The essential numbers."""
    noises = (*budget.noises_e.items(), ("all that is temporal", budget.temporal_e))
    parts = [
        well_text(budget),
        *(f"{name} noise {noise_text(noise, budget)}" for name, noise in noises),
    ]
    merit = merit_text(budget)
    return "; ".join([*parts, merit] if merit else parts)
