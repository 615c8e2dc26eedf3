"""Periodic Noise: its wave across and along the picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

from app.editor.evaluation.evaluator import Evaluator
from app.editor.panels.illustrations.chart import Axis, Chart, brief
from app.editor.panels.illustrations.illustration import Illustration
from app.editor.session import Session
from core.errors import ImagechainError
from core.names import thaw
from core.network.network import Node
from core.physics.noise.flicker_noise import periodic_pattern

_POINTS = 801
_PERIODS, _ENVELOPES = 6.0, 1.5
_MOST_PERIODS = 60.0  # more would be a grey area
_SOLID, _DASHED = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine
_NO_NOISE = "amplitude 0: no noise is added"


class PeriodicNoiseIllustration(Illustration):
    """The first periods of the pattern, from the first sample on; drawn from the document."""

    lines = 9.5

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        node: str,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, node, parent)
        self._seen: Node | None = None
        self._built: Any = None
        session.changed.connect(self._follow)
        self.prepare()

    def prepare(self) -> None:
        """Look at the node, if it has changed since."""
        node = self.present_node()
        if node is None or node is self._seen:
            return
        self._seen = node
        try:
            self._built = self.session.library[node.module].build(thaw(node.params))
        except ImagechainError as error:
            self.show_problem(error.message)
            return
        if self._built.amplitude == 0:
            self.show_problem(_NO_NOISE)
            return
        self.describe(self._in_words())
        self.show_problem("")

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint both waves."""
        end = self._end()
        places = np.linspace(0.0, end, _POINTS)
        across = self.pattern(places, np.zeros(1))
        along = self.pattern(np.zeros(1), places)
        size = abs(self._built.amplitude) * (1 + self._built.modulation)
        chart = Chart(
            painter,
            area,
            Axis(0.0, end, "from the first sample (mrad)"),
            Axis(-1.1 * size, 1.1 * size, "noise"),
            self.theme,
        )
        first, second = self.theme.curves[:2]
        chart.legend([("x", first, _SOLID), ("y", second, _DASHED)])
        chart.curve(places, along, second, _DASHED)
        chart.curve(places, across, first, _SOLID)

    def pattern(self, x_mrad: Any, y_mrad: Any) -> Any:
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

    def _follow(self, _before: object, _after: object) -> None:
        if self.session.resolved.node(self.node) is not self._seen:
            self.update()
