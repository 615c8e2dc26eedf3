"""MTF or PTF of a node along both axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter

from app.editor.evaluation.queries import Query
from app.editor.panels.illustrations.chart import Axis, Chart, brief, pair, round_step
from app.editor.panels.illustrations.illustration import Illustration
from app.editor.panels.illustrations.transfer_query import (
    LOWEST_SHARE,
    TransferLine,
    TransferLines,
    TransferQuery,
)
from core.transfer.factors import Part

_FLOORS = (0.999, 0.99, 0.9, 0.5)  # an MTF that stays above one of these is shown from there on
_HEADROOM = 0.22  # above the curves, for what is written there
_NOTHING = 1e-12
_SOLID, _DASHED = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine


class TransferIllustration(Illustration):
    """The curves up to the image's Nyquist frequency, or further, to where an aperture ends.

    Where an MTF is negative, its modulus is drawn dotted.
    """

    part: Part = "mtf"

    def queries(self) -> Sequence[Query]:
        return (TransferQuery(self.node, self.part),)

    def keep(self, lines: TransferLines) -> str:
        self._lines = lines
        return in_words(lines)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        lines = self._lines
        chart = Chart(painter, area, _across(lines), _up(lines), self.theme)
        first, second = self.theme.curves[:2]
        if lines.alike:
            chart.legend([("x = y", first, _SOLID)])
        else:
            chart.legend([("x", first, _SOLID), ("y", second, _DASHED)])
        if lines.part == "mtf":
            chart.level(0.5)
        self._marks(chart, lines)
        if not lines.alike:
            self._curve(chart, lines, lines.y, second, _DASHED)
        self._curve(chart, lines, lines.x, first, _SOLID)

    def _curve(
        self,
        chart: Chart,
        lines: TransferLines,
        line: TransferLine,
        colour: str,
        style: Qt.PenStyle,
    ) -> None:
        if lines.part == "mtf" and line.values.min() < 0:
            modulus = np.where(line.values < 0, -line.values, np.nan)
            chart.curve(line.frequency, modulus, colour, Qt.PenStyle.DotLine, 1.2)
        chart.curve(line.frequency, line.values, colour, style)
        if line.half is not None:
            chart.point(line.half, 0.5, colour)
            name = "" if lines.alike else f" ({'x' if line is lines.x else 'y'})"
            at = chart.at(line.half, 0.5)
            at.setY(at.y() + (0 if line is lines.x else self.fontMetrics().height()))
            chart.text(at, f"½ at {brief(line.half)}{name}")

    def _marks(self, chart: Chart, lines: TransferLines) -> None:
        x, y = lines.x, lines.y
        if brief(x.nyquist) == brief(y.nyquist):
            chart.upright(x.nyquist, f"Nyquist {brief(x.nyquist)}")
        else:
            chart.upright(x.nyquist, f"Nyquist x {brief(x.nyquist)}")
            chart.upright(y.nyquist, f"Nyquist y {brief(y.nyquist)}", 1)
        for number, line in enumerate((x, y)):
            if line.cutoff is None or (number and brief(line.cutoff) == brief(x.cutoff or 0.0)):
                continue
            which = "" if brief(x.cutoff or 0.0) == brief(y.cutoff or 0.0) else f" {'xy'[number]}"
            chart.upright(line.cutoff, f"cutoff{which} {brief(line.cutoff)}", 2 + number)


class PhaseIllustration(TransferIllustration):
    part: Part = "ptf"


def in_words(lines: TransferLines) -> str:
    """The essential numbers."""
    x, y = lines.x, lines.y
    unit = "" if lines.part == "mtf" else " rad"
    text = f"{lines.part.upper()} at the Nyquist frequency {pair(x.nyquist, y.nyquist)} cyc/mrad: "
    text += _both(x.at_nyquist, y.at_nyquist, unit)
    if x.half is not None or y.half is not None:
        text += f"; half contrast at {_both(x.half, y.half, ' cyc/mrad')}"
    if x.cutoff is not None and y.cutoff is not None:
        text += f"; cutoff {_both(x.cutoff, y.cutoff, ' cyc/mrad')}"
    return text


def _both(x: float | None, y: float | None, unit: str) -> str:
    across, along = ("none" if v is None else brief(_clean(v)) + unit for v in (x, y))
    return across if across == along else f"{across} across, {along} along"


def _clean(value: float) -> float:
    """Without what rounding leaves of 0."""
    return 0.0 if abs(value) < _NOTHING else value


def _across(lines: TransferLines) -> Axis:
    title = "spatial frequency (cyc/mrad)"
    end = max(line.frequency[-1] for line in (lines.x, lines.y))
    end = max(end, lines.x.nyquist, lines.y.nyquist)
    if lines.turn is None:
        return Axis(0.0, end * 1.03, title)
    return Axis(min(lines.turn, end) * LOWEST_SHARE**0.5, end * 1.2, title, log=True)


def _up(lines: TransferLines) -> Axis:
    values = np.concatenate([lines.x.values, lines.y.values])
    least, most = float(values.min()), float(values.max())
    if lines.part == "ptf":
        size = max(abs(least), abs(most))
        step = round_step(size / 2) if size > 0 else 0.5
        low = -2 * step if least < 0 else 0.0
        high = 2 * step if most > 0 or least == 0 else 0.0
        return Axis(low, high + _HEADROOM * (high - low), "PTF (rad)", reach=high)
    low = next((floor for floor in _FLOORS if least >= floor and least < 1), 0.0)
    if least < 0:
        low = -0.25 if least > -0.25 else -1.0
    high = max(1.0, most)
    return Axis(low, high + _HEADROOM * (high - low), "MTF", reach=high)
