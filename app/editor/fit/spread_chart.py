"""The samples of an edge and the chain's spread of it, in one small chart."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from app.editor.fit.fit_job import DrawnEdge
from app.editor.panels.illustrations.painting.axes import Axis
from app.editor.panels.illustrations.painting.chart import Chart
from app.editor.panels.illustrations.painting.chart_widget import ChartWidget
from app.editor.theme import Theme

_MOST = 3000  # samples that are drawn
_LOW, _HIGH = -0.2, 1.2  # of the step
_DOT = 2.0  # pixels


class SpreadChart(ChartWidget):
    """Draws samples as dots and the chain's spread as a line, over the distance from the edge."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(theme, width=24, height=14, parent=parent)
        self.setObjectName("fit.spread")
        self.setAccessibleName("Samples of the edge and the chain's spread")
        self.setToolTip(
            "Samples of the picture across the edge, from its dark level 0 to its bright one 1, "
            "and what the chain gives there"
        )
        self.edge: DrawnEdge | None = None
        self._why_none = ""

    def show_edge(self, edge: DrawnEdge | None, why_none: str = "") -> None:
        """Draw an edge; None draws an empty chart, with the reason if there is one."""
        self.edge, self._why_none = edge, why_none
        self.update()

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Draw the chart."""
        edge = self.edge
        reach = 8.0 if edge is None else max(1.0, float(np.abs(edge.distance).max(initial=0.0)))
        x = Axis(-reach, reach, "distance from the edge (samples)")
        y = Axis(_LOW, _HIGH, "share of the step")
        chart = Chart(painter, area, x, y, self._theme)
        if edge is not None:
            self._paint(painter, chart, edge, x, y)
        elif self._why_none:
            painter.setPen(QColor(self._theme.faint_text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(
                chart.frame.adjusted(6, 4, -6, -4).toRect(), int(flags), self._why_none
            )

    def _paint(self, painter: QPainter, chart: Chart, edge: DrawnEdge, x: Axis, y: Axis) -> None:
        samples, line = self._theme.faint_text, self._theme.curves[0]
        order = np.argsort(edge.distance, kind="stable")
        if len(order) > _MOST:
            order = order[np.linspace(0, len(order) - 1, _MOST).astype(np.intp)]
        distance, sample = edge.distance[order], edge.sample[order]
        frame = chart.frame
        across = frame.left() + x.share(distance) * frame.width()
        along = frame.bottom() - y.share(sample) * frame.height()
        good = np.isfinite(along)
        points = map(QPointF, across[good].tolist(), along[good].tolist())
        painter.save()
        painter.setClipRect(frame)
        pen = QPen(QColor(samples), _DOT)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawPoints(QPolygonF(list(points)))
        painter.restore()
        chart.curve(distance, edge.spread[order], line, width=2.0)
        solid = Qt.PenStyle.SolidLine
        chart.legend([("picture", samples, Qt.PenStyle.DotLine), ("chain", line, solid)])
