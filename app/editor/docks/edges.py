"""The edges of a measurement or a fit: on their picture, as a list, and as curves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pyqtgraph as pg
from PySide6 import QtWidgets
from PySide6.QtCore import QEvent, QPointF, QRectF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPen

from app.editor.declared_text import tip
from app.editor.panels.chart import Chart, ChartWidget
from app.editor.theme import theme_of
from app.editor.widgets import centred_hint, filled, labelled
from app.measure.measurement_text import REFUSED, REMOVED, USED
from core.modules.preview import Axis, signed
from nodes.files.table_cells import csv_columns

if TYPE_CHECKING:
    from app.fit.edge_fit import EdgesAt, Patch
    from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement
    from core.physics.measurement.edge_mtf import MtfCurve

_DELETE_KEYS = (Qt.Key.Key_Delete, Qt.Key.Key_Backspace)


class EdgeTable(QtWidgets.QTreeWidget):
    chosen = Signal(int)  # (place): the person marks an edge
    switched = Signal()  # a key removes the marked edge, or uses it again

    def __init__(self, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent, rootIsDecorated=False)
        labelled(self, "measure.edges", "Edges; press Del to exclude or include the selected edge")
        self.setHeaderLabels(["Edge", "Normal", "MTF50", "State"])
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        for column in range(3):
            mode = QtWidgets.QHeaderView.ResizeMode.ResizeToContents
            self.header().setSectionResizeMode(column, mode)
        self.currentItemChanged.connect(self._marked)

    def show_measured(self, measured: PictureMeasurement | None) -> None:
        """List the edges of a measurement; the same number of them keep their rows."""
        edges = () if measured is None else measured.edges
        with QSignalBlocker(self):
            if len(edges) != self.topLevelItemCount():
                self.clear()
                self.addTopLevelItems([QtWidgets.QTreeWidgetItem() for _ in edges])
            for place, edge in enumerate(edges):
                item = self.topLevelItem(place)
                assert item is not None
                texts = str(place + 1), _angle(edge), _half(edge), edge.why_not or "used"
                for column, text in enumerate(texts):
                    item.setText(column, text)
                    item.setToolTip(column, tip(edge.why_not or "used"))

    def choose(self, place: int) -> None:
        with QSignalBlocker(self):
            item = self.topLevelItem(place) if place >= 0 else None
            self.setCurrentItem(item)  # type: ignore[arg-type] # None: no row

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (*_DELETE_KEYS, Qt.Key.Key_Space) and not event.modifiers():
            self.switched.emit()
        else:
            super().keyPressEvent(event)

    def _marked(self, item: QtWidgets.QTreeWidgetItem | None, *_: object) -> None:
        if item is not None:
            self.chosen.emit(self.indexOfTopLevelItem(item))


def _angle(edge: MeasuredEdge) -> str:
    return signed(f"{edge.found.angle_deg:.1f}°")


def _half(edge: MeasuredEdge) -> str:
    if edge.curve is None or edge.curve.mtf50 is None:
        return ""
    error = "" if edge.mtf50_sigma is None else f" ± {edge.mtf50_sigma:.3f}"
    return f"{edge.curve.mtf50:.3f}{error}"


def edge_words(place: int, edge: MeasuredEdge) -> str:
    length = edge.found.length
    where = f"edge {place + 1}, normal at {_angle(edge)}, {length:.0f} samples long"
    half = _half(edge) and f", MTF50 {_half(edge)}"
    why_not = "" if edge.used else f", not used: {edge.why_not}"
    return where + half + why_not


# The pooled MTF with its error, and the chosen edge's, in one small chart.

_HIGHEST = 1.15
_NYQUIST = 0.5
_ERRORS = 2.0  # standard errors, of a band
_SOLID, _DASH, _DOT = Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine


class MtfChart(ChartWidget):
    read = Signal(str)  # (text): what stands under the mouse; empty where nothing does

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(width=20, height=13, parent=parent)
        labelled(
            self, "measure.mtf", "MTF against frequency",
            "Pooled horizontal (solid) and vertical (dashed) MTF with ± 2 standard "
            "errors, and the MTF of the selected edge along its normal",
        )  # fmt: skip
        self.setMouseTracking(True)
        self._curves: list[tuple[str, Any, str, Qt.PenStyle]] = []
        self._edge: MeasuredEdge | None = None
        self._frame = QRectF()

    def show_measured(self, measured: PictureMeasurement | None, edge: MeasuredEdge | None) -> None:
        colours, pooled = self.theme.curves, (measured and measured.x, measured and measured.y)
        looks = (("horizontal", colours[0], _SOLID), ("vertical", colours[2], _DASH))
        self._curves = [
            (name, curve, colour, style)
            for (name, colour, style), curve in zip(looks, pooled, strict=True)
            if curve is not None
        ]
        self._edge = edge
        self.update()

    def draw(self, painter: QPainter, area: QRectF) -> None:
        x = Axis(0.0, 1.0, "frequency (cycles/sample)")
        chart = Chart(painter, area, x, Axis(0.0, _HIGHEST, "MTF"), self.theme)
        self._frame = chart.frame
        drawn = list(self._curves)
        for _, curve, colour, _ in drawn:
            known = np.isfinite(curve.mtf) & np.isfinite(curve.sigma)
            at, middle = curve.frequency[known], curve.mtf[known]
            wide = np.minimum(_ERRORS * curve.sigma[known], 2.0 * _HIGHEST)
            around = np.append(middle + wide, (middle - wide)[::-1])
            chart.filled(np.append(at, at[::-1]), around, colour, closed=True)
        if self._edge is not None and self._edge.curve is not None:
            # The colour of its line on the picture is too light for a light ground.
            colour = USED if self.theme.look == "dark" else "#9a6a00"
            drawn.append(("edge", self._edge.curve, colour, Qt.PenStyle.DashDotLine))
        for _, curve, colour, style in drawn:
            chart.curve(curve.frequency, curve.mtf, colour, style, 2.0)
            if curve.mtf50 is not None:
                chart.point(curve.mtf50, 0.5, colour)
        chart.legend([(name, colour, style) for name, _, colour, style in drawn])
        if drawn:
            chart.upright(_NYQUIST, "Nyquist")

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        frame, place = self._frame, event.position()
        share = (place.x() - frame.left()) / max(frame.width(), 1.0)
        parts = [f"{name} {_value(curve, share)}" for name, curve, _, _ in self._curves]
        inside = parts and frame.contains(place)
        self.read.emit(f"{share:.3f} cycles/sample: {', '.join(parts)}" if inside else "")

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.read.emit("")


def _value(curve: MtfCurve, frequency: float) -> str:
    if frequency > curve.frequency[-1]:
        return "–"
    value = float(np.interp(frequency, curve.frequency, curve.mtf))
    error = float(np.interp(frequency, curve.frequency, curve.sigma))
    return f"{value:.3f} ± {error:.3f}" if math.isfinite(error) else f"{value:.3f}"


_NEAR_PX = 12.0  # of a click from an edge
_HINT = (
    "Choose Measure Viewer to measure the picture in a viewer, or Files… to measure picture "
    "files; you can also drop files here. Imagechain finds the edges and measures the MTF across "
    "each one."
)
_FIT_HINT = (
    "Click Pictures… or drop pictures from your camera here. To let the fit change a number, "
    "right-click it on a panel and choose Free for a fit. Then click Fit."
)
_STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1}
_ZOOMS = {Qt.Key.Key_Plus: 0.8, Qt.Key.Key_Equal: 0.8, Qt.Key.Key_Minus: 1.25}


class EdgeCanvas(pg.PlotWidget):  # type: ignore[misc]
    # (place): an edge was clicked: its place among those of the measurement; -1 beside all
    chosen = Signal(int)
    stepped = Signal(int)  # (by): a key goes to the next edge, or the one before
    switched = Signal()  # a key removes the chosen edge, or uses it again

    def __init__(self, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent, enableMenu=False)
        about = "Picture with its edges; use the arrow keys to move between edges"
        labelled(self, "measure.picture", about)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.hideAxis("left")
        self.hideAxis("bottom")
        self.hideButtons()
        self.view: pg.ViewBox = self.getViewBox()
        self.view.invertY(True)
        self.view.setAspectLocked(True)
        self.view.disableAutoRange()
        self._image = pg.ImageItem(axisOrder="row-major")
        self.addItem(self._image)
        self._lines: list[pg.PlotCurveItem] = []
        self._measured: PictureMeasurement | None = None
        self._picture = 0
        self._preview: Any = None  # samples of that picture
        self._current = -1
        self._all = True
        self.hint = centred_hint(_HINT, self)
        filled(QtWidgets.QVBoxLayout(self), self.hint)
        self.scene().sigMouseClicked.connect(self._clicked)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.setBackground(theme_of(self).surround)

    def show_measured(self, measured: PictureMeasurement | None, picture: int = 0) -> None:
        from app.run.saving import grey_levels, robust_limits

        preview = None
        if measured is not None and measured.previews:
            picture = min(picture, len(measured.previews) - 1)
            preview = measured.previews[picture]
        self._measured, self._picture = measured, picture
        self.hint.setVisible(preview is None)
        self.setBackground(theme_of(self).surround)
        if preview is not self._preview:
            self._preview = preview
            self._image.clear()
            if measured is not None and preview is not None:
                low, high = robust_limits(preview)
                rows, columns = measured.preview_shape
                self._image.setImage(grey_levels(low, high, preview), levels=(0, 255))
                self._image.setRect(QRectF(-0.5, -0.5, columns, rows))
            self.fit()
        self._draw()

    def show_busy(self, busy: bool) -> None:
        self.hint.setText("Measuring …" if busy else _HINT)

    def show_unused(self, on: bool) -> None:
        self._all = on
        self._draw()

    def choose(self, place: int) -> None:
        self._current = place
        edges = self._measured.edges if self._measured is not None else ()
        if 0 <= place < len(edges):
            at = QPointF(edges[place].found.x, edges[place].found.y)
            if not self.view.viewRect().contains(at):
                self.view.translateBy(at - self.view.viewRect().center())
        self._draw()

    def fit(self) -> None:
        self.view.autoRange(padding=0.0, items=[self._image])

    def sizeHint(self) -> QSize:
        line = self.fontMetrics().height()
        return QSize(24 * line, 18 * line)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Go through the edges by the arrows, remove one by Del; +, -, 0 and F as in a viewer."""
        key = Qt.Key(event.key())
        if key in _STEPS:
            self.stepped.emit(_STEPS[key])
        elif key in _DELETE_KEYS:
            self.switched.emit()
        elif key in _ZOOMS:
            self.view.scaleBy((_ZOOMS[key], _ZOOMS[key]))
        elif key in (Qt.Key.Key_0, Qt.Key.Key_F):
            self.fit()
        else:
            super().keyPressEvent(event)

    def _shown(self) -> list[tuple[int, MeasuredEdge]]:
        """What is in use, and the marked one, on top."""
        edges = self._measured.edges if self._measured is not None else ()
        own = [
            (place, edge)
            for place, edge in enumerate(edges)
            if self._preview is not None
            and edge.picture == self._picture
            and (self._all or place == self._current or edge.curve is not None)
        ]
        return sorted(own, key=lambda one: (one[0] == self._current, one[1].used))

    def _draw(self) -> None:
        for line in self._lines:
            self.removeItem(line)
        self._lines = []
        for place, edge in self._shown():
            colour, style, width = edge_look(edge)
            current = place == self._current
            shadow = QColor("#ffffff") if current else QColor(0, 0, 0, 170 if edge.used else 90)
            around = QPen(shadow, width + (5.0 if current else 1.6))
            pen = QPen(QColor(colour), width, style, Qt.PenCapStyle.FlatCap)
            for each in (pen, around):
                each.setCosmetic(True)
            x, y = np.array(edge.found.ends).T
            line = pg.PlotCurveItem(x, y, pen=pen, shadowPen=around, antialias=True)
            self._lines.append(line)
            self.addItem(line)

    def _clicked(self, event: Any) -> None:
        if event.button() is Qt.MouseButton.LeftButton:
            if event.double():
                self.fit()
            else:
                self.chosen.emit(self._edge_at(self.view.mapSceneToView(event.scenePos())))

    def _edge_at(self, point: QPointF) -> int:
        """The edge nearest to a point of the picture; -1 where none is near."""
        near = [(_distance(point, *edge.found.ends), place) for place, edge in self._shown()]
        distance, place = min(near, default=(math.inf, -1))
        return place if distance <= _NEAR_PX * self.view.viewPixelSize()[0] else -1


def edge_look(edge: MeasuredEdge) -> tuple[str, Qt.PenStyle, float]:
    """Colour, style and width of an edge's line: full in use, dashed not, dotted by hand."""
    if edge.used:
        return USED, _SOLID, 2.6
    return (REFUSED, _DASH, 1.3) if edge.curve is None else (REMOVED, _DOT, 2.0)


def _distance(point: QPointF, start: tuple[float, float], end: tuple[float, float]) -> float:
    along, to = complex(*end) - complex(*start), complex(*point.toTuple()) - complex(*start)
    share = min(1.0, max(0.0, (to * along.conjugate()).real / abs(along) ** 2))
    return abs(to - share * along)


# The samples of a fitted edge and the chain's spread of it, in one small chart.

_MOST = 1000  # samples that are drawn


class DrawnEdge(NamedTuple):
    """An edge's samples by their distance from it, and the chain's spread there, from 0 to 1."""

    name: str
    distance: Any
    sample: Any
    spread: Any


def drawn_edges(patches: tuple[Patch, ...], edges: EdgesAt) -> tuple[DrawnEdge, ...]:
    drawn = []
    for row, patch in enumerate(patches):
        distance, spread, rest = edges.profile(row, patch)
        drawn.append(DrawnEdge(patch.name, distance.copy(), spread + rest, spread.copy()))
    return tuple(drawn)


class SpreadChart(ChartWidget):
    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(width=24, height=14, parent=parent)
        labelled(
            self, "fit.spread", "Measured and modelled edge profile",
            "Edge profile from dark (0) to bright (1): the picture's samples and the chain's "
            "edge spread function",
        )  # fmt: skip
        self.edge: DrawnEdge | None = None
        self.hint = centred_hint(_FIT_HINT, self)
        filled(QtWidgets.QVBoxLayout(self), self.hint)

    def show_edge(self, edge: DrawnEdge | None) -> None:
        self.edge = edge
        self.hint.setVisible(edge is None)
        self.update()

    def numbers(self) -> str:
        if (edge := self.edge) is None:
            return ""
        names = ("distance (samples)", "picture", "chain")
        parts = (part.tolist() for part in (edge.distance, edge.sample, edge.spread))
        return csv_columns(zip(names, parts, strict=True))

    def draw(self, painter: QPainter, area: QRectF) -> None:
        edge = self.edge
        if edge is None:
            return
        reach = max(1.0, float(np.abs(edge.distance).max(initial=0.0)))
        x = Axis(-reach, reach, "distance from the edge (samples)")
        chart = Chart(painter, area, x, Axis(-0.2, 1.2, "fraction of the step"), self.theme)
        samples, line = self.theme.faint_text, self.theme.curves[0]
        order = np.argsort(edge.distance, kind="stable")
        few = order[:: max(1, len(order) // _MOST)]
        few = few[np.isfinite(edge.sample[few])]
        painter.save()
        painter.setClipRect(chart.frame)
        chart.dots(edge.distance[few], edge.sample[few], samples, 1.0)
        painter.restore()
        chart.curve(edge.distance[order], edge.spread[order], line, width=2.0)
        chart.legend([("picture", samples, _DOT), ("chain", line, _SOLID)])
