"""Periodic Noise: its wave across and along the picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter

from app.editor.panels.illustrations.chart import Axis, Chart, brief
from app.editor.panels.illustrations.illustration import DocumentIllustration
from core.names import thaw
from core.network.network import Node
from core.physics.noise.flicker_noise import periodic_pattern

_POINTS = 801
_PERIODS, _ENVELOPES = 6.0, 1.5
_MOST_PERIODS = 60.0  # more would be a grey area
_SOLID, _DASHED = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine
_NO_NOISE = "amplitude 0: no noise is added"


class PeriodicNoiseIllustration(DocumentIllustration):
    """The first periods of the pattern, from the first sample on."""

    lines = 9.5
    _built: Any

    def look(self, node: Node) -> None:
        """Keep the module of these parameters."""
        self._built = self.session.library[node.module].build(thaw(node.params))
        if self._built.amplitude != 0:
            self.describe(self._in_words())
        self.show_problem("" if self._built.amplitude != 0 else _NO_NOISE)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        end = self._end()
        places, start = np.linspace(0.0, end, _POINTS), np.zeros(1)
        size = 1.1 * abs(self._built.amplitude) * (1 + self._built.modulation)
        across = Axis(0.0, end, "from the first sample (mrad)")
        chart = Chart(painter, area, across, Axis(-size, size, "noise"), self.theme)
        first, second = self.theme.curves[:2]
        chart.legend([("x", first, _SOLID), ("y", second, _DASHED)])
        chart.curve(places, self._pattern(start, places), second, _DASHED)
        chart.curve(places, self._pattern(places, start), first, _SOLID)

    def _pattern(self, x_mrad: Any, y_mrad: Any) -> Any:
        """The noise at places from the first sample, in the picture's unit."""
        values = self._built.values()
        for name in ("phase", "modulation_phase"):
            values[f"{name}_rad"] = math.radians(values.pop(f"{name}_deg"))
        return periodic_pattern(x_mrad=x_mrad, y_mrad=y_mrad, **values)

    def _end(self) -> float:
        """How far it is drawn, mrad: some periods, or enough to see the modulation."""
        module = self._built
        highest = max(abs(module.xi), abs(module.eta))
        end = _PERIODS / highest if highest > 0 else 100.0
        slow = [f for f in (abs(module.modulation_xi), abs(module.modulation_eta)) if f > 0]
        if module.modulation > 0 and slow:
            end = max(end, _ENVELOPES / max(slow))
        return min(end, _MOST_PERIODS / highest) if highest > 0 else end

    def _in_words(self) -> str:
        module = self._built
        text = f"sinusoid of amplitude {brief(module.amplitude)} at {brief(module.xi)} cyc/mrad "
        text += f"across and {brief(module.eta)} along"
        if module.modulation > 0:
            text += f", modulated by {brief(100 * module.modulation)} %"
        return text
