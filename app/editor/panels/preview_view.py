"""The preview of a node's module on top of its panel, which follows what is edited."""

import math
from collections.abc import Hashable, Sequence
from typing import Any, ClassVar

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike, NDArray
from PySide6 import QtGui
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, QSizeF, Qt
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.editor.declared_text import tip
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.panels.transfer_preview import TransferPreviewQuery
from app.editor.session import Session
from app.editor.theme import Theme
from app.editor.viewers.picture.picture_facts import grey_levels, shrunk
from app.editor.viewers.plot import plot_looks
from app.editor.viewers.plot.plot_export import have_plot_menu
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import LEFT, RIGHT
from core.chain.engine import Plan
from core.modules.declaration import Module, NodeContext, declaration
from core.modules.preview import (
    Axis,
    Bars,
    Colour,
    Curve,
    Part,
    Picture,
    Plot,
    Preview,
    Stack,
    brief,
    signed,
)
from core.records import dataclass, replace

NOTHING = "nothing to show"

_PENS = {
    "solid": Qt.PenStyle.SolidLine,
    "dashed": Qt.PenStyle.DashLine,
    "dotted": Qt.PenStyle.DotLine,
}
_LEAST_CHART = 4.0  # lines of text that a chart is high at least, its titles included
_ABOVE = 3  # dots of margin above and below
_SLACK = 0.1  # lines that rounding may take
_GAP = 0.2  # lines of text between two parts
_LEFT_SHARE = 0.54  # of the width, what stands left of lines of text
_MOST_SAMPLES = 320  # of a picture, across or along
_SIZES = (1.0, 0.9, 0.8, 0.7)
_WRAPPED = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)
_CENTRED = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)


@dataclass(frozen=True)
class PreviewQuery(Query):
    """The preview that a node's module declares, connected or not; None of a disabled node."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        planned = plan.node(self.node)
        wires = (*planned.inputs.values(), *planned.outputs.values())
        keys = tuple(getattr(wire, "key", None) for wire in wires)
        return keys, str(planned.error), planned.node

    def answer(self, passing: Passing) -> Preview | None:
        planned = passing.plan.node(self.node)
        if planned.node.disabled:
            return None
        module: Any = planned.module
        if module is None:
            module = passing.engine.library[planned.node.module].build(planned.node.params)
        if module.preview is None:  # another document has another module under that name
            return None
        here = NodeContext(self.node, folder=passing.plan.folder)
        preview: Preview | None = module.preview(planned, passing.work, here)
        return preview and replace(preview, parts=tuple(map(_made_small, preview.parts)))


def _made_small(part: Part) -> Part:
    picture = part.picture if isinstance(part, Plot) else part
    if not isinstance(picture, Picture):
        return part
    small = replace(picture, samples=shrunk(picture.samples, _MOST_SAMPLES))
    return replace(part, picture=small) if isinstance(part, Plot) else small


def preview_query(module: type[Module], node: str) -> Query | None:
    """What is asked for the preview of a node: its module's, else the curve of an MTF or PTF."""
    if module.preview is not None:
        return PreviewQuery(node)
    outputs = {port.name for port in declaration(module).outputs}
    if "mtf" in outputs:
        return TransferPreviewQuery(node, "mtf")
    return TransferPreviewQuery(node, "ptf") if "ptf" in outputs else None


class PreviewView(Viewer):
    """Draws the preview of a node; what is wrong with the node stands beside it."""

    def __init__(
        self, session: Session, evaluator: Evaluator, node: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(session, evaluator, f"panel.preview.{id(self):x}", parent)
        self.setObjectName("preview")
        self.node = node
        self.preview: Preview | None = None
        self.charts: list[PreviewChart] = []
        self._rooms: list[tuple[Part, QRectF]] = []
        self._words = ""
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._module = session.library[session.network.nodes[node].module]
        self.setAccessibleName(f"illustration of {node}: {self._module.title}")
        have_plot_menu(self, session.message.emit)

    def queries(self) -> Sequence[Query]:
        """The one query; none once the node is of another module."""
        query = preview_query(self._module, self.node)
        return () if query is None else (query,)

    def take(self, answer: Answer) -> None:
        self.preview = answer.value
        self._words = self.preview.words if self.preview is not None else NOTHING
        self.setAccessibleDescription(self._words)
        self.setToolTip(tip(self._words))
        self.updateGeometry()
        self._lay()

    def sizeHint(self) -> QSize:
        line, lines = self.fontMetrics().height(), self._module.preview_lines
        if self.preview is not None:
            lines = max(lines + self.preview.more_lines, _least_lines(self.preview))
        return QSize(line * 20, math.ceil(line * lines) + 2 * _ABOVE)

    def height_within(self, most: int) -> int:
        """Its height where it may be no higher: that of the first parts that can be read there."""
        hint, line = self.sizeHint().height(), self.fontMetrics().height()
        if hint <= most or self.preview is None:
            return min(hint, most)
        seen = _in_room(self.preview, (most - 2 * _ABOVE) / line)
        if any(isinstance(part, Plot) for part in seen.parts) or seen.facts:
            return most
        return min(math.ceil(line * _least_lines(seen)) + 2 * _ABOVE, most)

    def minimumSizeHint(self) -> QSize:
        return QSize(self.fontMetrics().height() * 14, 0)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._lay()

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        super().resizeEvent(event)
        self._lay()

    @property
    def _area(self) -> QRectF:
        return QRectF(self.rect()).adjusted(4, _ABOVE, -4, -_ABOVE)

    def _lay(self) -> None:
        """Find room for the parts: charts, which share what the others leave, are drawn in it."""
        line = self.fontMetrics().height()
        self._rooms = _rooms(self.preview, self._area, line) if self.preview is not None else []
        charts = [
            (_chart(part), room) for part, room in self._rooms if isinstance(part, Plot | Picture)
        ]
        while len(self.charts) < len(charts):
            self.charts.append(PreviewChart(self))
        for chart in self.charts[len(charts) :]:
            chart.hide()
        for chart, (plot, room) in zip(self.charts, charts, strict=False):
            chart.setGeometry(room.toRect())
            chart.show_plot(plot, self.theme, line)
            chart.show()
        self.update()

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        with QtGui.QPainter(self) as painter:
            painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
            painter.fillRect(self.rect(), QtGui.QColor(self.theme.base))
            if self.preview is None:
                painter.setPen(QtGui.QColor(self.theme.faint_text))
                painter.drawText(self.rect(), _CENTRED, self._words)
            elif self.preview.facts and self._rooms:
                _paint_facts(painter, self.preview, self._area, *self._rooms[0], self.theme)
            else:
                for part, room in self._rooms:
                    if isinstance(part, Bars):
                        _paint_bars(painter, room, part, self.theme)
                    elif isinstance(part, Stack):
                        _paint_stack(painter, room, part, self.theme)
                    elif isinstance(part, str):
                        ink = self.theme.faint_text if self.charts else self.theme.text
                        painter.setPen(QtGui.QColor(ink))
                        painter.drawText(room, _CENTRED, part)


def _chart(part: Plot | Picture) -> Plot:
    if isinstance(part, Plot):
        return part
    across, along = part.shape
    return Plot(Axis(0.0, across), Axis(along, 0.0), square=True, picture=part)


def _rooms(preview: Preview, area: QRectF, line: float) -> list[tuple[Part, QRectF]]:
    """Parts below one another, the last left out where it is low, at `line` dots of text."""
    if area.height() < line:  # what is wrong has its place
        return []
    preview = _in_room(preview, area.height() / line)
    if preview.facts:
        part = preview.parts[0]
        shape = part.shape if isinstance(part, Picture) else (1.0, 1.0)
        width = min(_LEFT_SHARE * area.width(), area.height() * shape[0] / shape[1])
        size = QSizeF(width, width * shape[1] / shape[0])
        return [(part, QRectF(area.topLeft(), size))]
    heights = [line * lines for lines in _lines(preview)]
    free = area.height() - sum(heights) - _GAP * line * (len(heights) - 1)
    grows = [isinstance(part, Plot) for part in preview.parts]
    rooms, top = [], area.top()
    for part, height, chart in zip(preview.parts, heights, grows, strict=True):
        high = height + free / sum(grows) if chart else height
        rooms.append((part, QRectF(area.left(), top, area.width(), high)))
        top += high + _GAP * line
    return rooms


def _lines(preview: Preview) -> list[float]:
    """How high the parts are in lines of text; of a chart, its title below alone."""
    # A chart with a title below is higher by it: so the frames are of one height.
    return [
        float(bool(part.x.title)) if isinstance(part, Plot) else getattr(part, "lines", 3.2)
        for part in preview.parts
    ]


def _in_room(preview: Preview, lines: float) -> Preview:
    """What of it can be read in so many lines: its first part in any case."""
    parts = preview.parts
    while len(parts) > 1 and not preview.facts and _least_lines(preview) > lines + _SLACK:
        parts = parts[:-1]
        preview = replace(preview, parts=parts)
    return preview


def _least_lines(preview: Preview) -> float:
    """The height in which nothing is drawn smaller than the panel's font."""
    if preview.facts:
        return float(len(preview.facts))
    charts = sum(isinstance(part, Plot) for part in preview.parts)
    heights = _lines(preview)
    return sum(heights) + _GAP * (len(heights) - 1) + _LEAST_CHART * charts


def _colour(theme: Theme, colour: Colour) -> str:
    return theme.curves[colour] if isinstance(colour, int) else str(getattr(theme, colour))


class PreviewChart(pg.PlotWidget):  # type: ignore[misc]
    """A chart, which is drawn anew with each answer."""

    def __init__(self, parent: QWidget) -> None:
        axes = {side: plot_looks.PlotAxis(side) for side in ("left", "bottom")}
        super().__init__(parent, axisItems=axes, enableMenu=False)
        axes["left"].setWidth(2.6 * self.fontMetrics().height())  # so that frames line up
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        plot_looks.bare(self.plotItem)
        self.showGrid(x=True, y=True, alpha=0.12)
        self.plotItem.layout.setVerticalSpacing(0)
        self._axes: tuple[object, ...] = ()

    def show_plot(self, plot: Plot, theme: Theme, line: int) -> None:
        """Draw a chart, with so many dots to a line of text."""
        self.clear()
        names = (
            plot_looks.coloured(c.name, _colour(theme, c.colour)) for c in plot.curves if c.name
        )
        title = " &nbsp; ".join(filter(None, (plot.y.title, *names)))
        across, along = (_drawn(axis, (axis.low, axis.high)) for axis in (plot.x, plot.y))
        if (axes := (theme.look, plot.x, plot.y, title)) != self._axes:  # to draw them takes long
            self._axes = axes
            self.setBackground(theme.base)
            plot_looks.paint_axes(self.plotItem, theme)
            self.setTitle(title or None, size=f"{self.font().pointSizeF()}pt", color=theme.text)
            self.plotItem.layout.setRowFixedHeight(0, line if title else 0)
            self.setLabel("bottom", plot.x.title)
            for side, axis in (("left", plot.y), ("bottom", plot.x)):
                self.showAxis(side, bool(title or plot.x.title))
                self.getAxis(side).setLogMode(axis.log, axis.log)
                self.getAxis(side).end_at(axis.low, axis.high if axis.reach is None else axis.reach)
            self.invertY(bool(along[0] > along[1]))
            self.setAspectLocked(plot.square)
            self.setRange(xRange=sorted(across), yRange=sorted(along), padding=0.0)
        if plot.picture is not None:
            image = pg.ImageItem(_pixels(plot.picture, theme), axisOrder="row-major", levels=None)
            image.setRect(QRectF(QPointF(across[0], along.min()), QPointF(across[1], along.max())))
            self.addItem(image)
        if plot.band is not None:
            band = _drawn(plot.x, plot.band)
            brush = plot_looks.see_through(theme.accent, 48)
            self.addItem(pg.LinearRegionItem(band, brush=brush, pen=pg.mkPen(None), movable=False))
        for level in plot.levels:
            self.addLine(y=level, pen=plot_looks.thick(theme.line, 1, Qt.PenStyle.DotLine))
        texts: Any = {"color": theme.text, "fill": plot_looks.see_through(theme.base, 200)}
        below = line / max(self.height() - 4 * line, line)  # a line of text, of the frame's height
        for upright in plot.uprights:
            self.addLine(
                x=float(_drawn(plot.x, upright.x)),
                pen=plot_looks.thick(theme.faint_text, 1, Qt.PenStyle.DashLine),
                label=upright.text,
                labelOpts={"position": 1.0 - (0.7 + upright.down) * below, **texts},
            )
        order = list(reversed(plot.curves))
        for curve in sorted(order, key=lambda curve: curve.style == "dashed"):
            self._add_curve(plot, curve, _colour(theme, curve.colour))
        for mark in plot.marks:
            x, y = float(_drawn(plot.x, mark.x)), float(_drawn(plot.y, mark.y))
            if mark.dot:
                dot = _colour(theme, mark.colour)
                self.addItem(pg.ScatterPlotItem([x], [y], size=7, pen=theme.base, brush=dot))
            beside = float(x > across.mean()), 0.5 - mark.down
            text = pg.TextItem(mark.text, anchor=beside, **texts)
            text.setPos(x, y)
            self.addItem(text)

    def _add_curve(self, plot: Plot, curve: Curve, colour: str) -> None:
        x, y = _drawn(plot.x, curve.x), _drawn(plot.y, curve.y)
        if curve.style == "dots":
            size = 2 * curve.width
            self.addItem(pg.ScatterPlotItem(x, y, size=size, pen=None, brush=colour))
            return
        pen = pg.mkPen(colour, width=curve.width, style=_PENS[curve.style])
        drawn = pg.PlotCurveItem(x, y, pen=pen, connect="finite", antialias=True)
        if curve.fill:
            drawn.setBrush(plot_looks.see_through(colour, 60))
            drawn.setFillLevel("enclosed" if curve.fill == "inside" else plot.y.low)
        self.addItem(drawn)


def _drawn(axis: Axis, values: ArrayLike) -> NDArray[np.float64]:
    """Values as they are drawn: on a logarithmic axis their logarithms."""
    there = np.asarray(values, np.float64)
    return np.log10(np.maximum(there, axis.low * 1e-30)) if axis.log else there


def _paint_facts(
    painter: QtGui.QPainter, preview: Preview, area: QRectF, part: Part, room: QRectF, theme: Theme
) -> None:
    """Lines of text right of a picture or square chart, and below them its colours."""
    line = QtGui.QFontMetricsF(painter.font()).height()
    picture = part.picture if isinstance(part, Plot) else part
    beside = area.adjusted(room.right() + line * 0.8 - area.left(), line * 0.2, 0, 0)
    if isinstance(picture, Picture) and picture.signed and picture.high > 0.0:
        beside.setBottom(beside.bottom() - line * 2.4)
        _paint_scale(painter, QRectF(beside.bottomLeft(), area.bottomRight()), picture, theme)
    _write(painter, beside, preview.facts, theme)


def _write(painter: QtGui.QPainter, area: QRectF, lines: Sequence[str], theme: Theme) -> None:
    """Write lines from the top left, smaller where they would not all be seen."""
    text, font = "\n".join(lines), painter.font()
    size = QtGui.QFontInfo(font).pointSizeF()  # of the font itself, it may be unknown
    painter.save()
    for share in _SIZES:
        font.setPointSizeF(size * share)
        painter.setFont(font)
        if painter.boundingRect(area, _WRAPPED, text).height() <= area.height():
            break
    painter.setPen(QtGui.QColor(theme.text))
    painter.drawText(area, _WRAPPED, text)
    painter.restore()


def _signed_colours(theme: Theme) -> tuple[list[str], str]:
    """The theme's colours from −1 over 0 to 1, and that of what is not known."""
    dark, light = sorted((theme.base, theme.text), key=lambda name: QtGui.QColor(name).lightness())
    return [theme.curves[0], light, theme.curves[3]], dark


def _pixels(picture: Picture, theme: Theme) -> NDArray[np.uint8]:
    """Levels of grey; of a signed picture red, green and blue in a third axis."""
    if not picture.signed:
        return grey_levels(picture.samples, picture.low, picture.high)
    names, unknown = _signed_colours(theme)
    shares = picture.samples / (2 * picture.high or 1.0) + 0.5
    colours = pg.ColorMap((0.0, 0.5, 1.0), [QtGui.QColor(name).getRgb() for name in names])
    pixels: NDArray[np.uint8] = colours.map(np.nan_to_num(shares), mode="byte")[..., :3]
    pixels[np.isnan(shares)] = QtGui.QColor(unknown).getRgb()[:3]
    return pixels


def _paint_scale(painter: QtGui.QPainter, area: QRectF, picture: Picture, theme: Theme) -> None:
    metrics = QtGui.QFontMetricsF(painter.font())
    line = metrics.height()
    bar = QRectF(area.left(), area.top(), area.width() - line / 2, line * 0.7)
    colours = QtGui.QLinearGradient(bar.topLeft(), bar.topRight())
    for share, end in zip((0.0, 0.5, 1.0), _signed_colours(theme)[0], strict=True):
        colours.setColorAt(share, QtGui.QColor(end))
    painter.fillRect(bar, colours)
    text = bar.translated(0, line * 0.85)
    text.setHeight(line)
    painter.setPen(QtGui.QColor(theme.text))
    written, middle = brief(picture.high, 2), f" {picture.unit} "
    painter.drawText(text, Qt.AlignmentFlag.AlignLeft, signed(f"-{written}"))
    if metrics.horizontalAdvance(written + middle + written) + line * 2 < text.width():
        painter.drawText(text, Qt.AlignmentFlag.AlignHCenter, picture.unit)
    painter.drawText(text, Qt.AlignmentFlag.AlignRight, f"+{written}")


def _paint_bars(painter: QtGui.QPainter, area: QRectF, bars: Bars, theme: Theme) -> None:
    metrics = QtGui.QFontMetricsF(painter.font())
    height = area.height() / len(bars.bars)
    named = max(metrics.horizontalAdvance(bar.name) for bar in bars.bars) + height * 0.5
    valued = max(metrics.horizontalAdvance(bar.value) for bar in bars.bars) + height * 0.5
    most = max(*(bar.size for bar in bars.bars), 1e-300)
    room = max(0.0, area.width() - named - valued)
    for number, bar in enumerate(bars.bars):
        top = area.top() + number * height
        painter.setPen(QtGui.QColor(theme.text))
        painter.drawText(QRectF(area.left(), top, named - height * 0.4, height), RIGHT, bar.name)
        length = room * min(1.0, bar.size / most)
        filled = QRectF(area.left() + named, top + height * 0.22, length, height * 0.56)
        painter.fillRect(filled, QtGui.QColor(_colour(theme, bar.colour)))
        value = QRectF(filled.right() + height * 0.3, top, valued, height)
        painter.drawText(value, LEFT, bar.value)


def _paint_stack(painter: QtGui.QPainter, area: QRectF, stack: Stack, theme: Theme) -> None:
    line = QtGui.QFontMetricsF(painter.font()).height()
    head = QRectF(area.left(), area.top(), area.width(), line * 1.2)
    painter.setPen(QtGui.QColor(theme.error if stack.excess else theme.text))
    painter.drawText(head, LEFT, stack.left)
    painter.setPen(QtGui.QColor(theme.text))
    painter.drawText(head, RIGHT, stack.right)
    bar = QRectF(area.left(), head.bottom() + line * 0.2, area.width(), line * 1.1)
    parts = [part for part in stack.parts if part.size > 0.0]
    scale = bar.width() / max(stack.whole or 0.0, sum(part.size for part in parts), 1e-300)
    left = bar.left()
    for part in parts:
        width = part.size * scale
        painter.fillRect(
            QRectF(left, bar.top(), width, bar.height()), QtGui.QColor(_colour(theme, part.colour))
        )
        left += width
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QtGui.QPen(QtGui.QColor(theme.error if stack.excess else theme.line), 1.2))
    if stack.whole:
        painter.drawRect(QRectF(bar.topLeft(), QSizeF(stack.whole * scale, bar.height())))
    box, half = line * 0.6, area.width() / 2
    for number, part in enumerate(parts):
        place = QPointF(
            area.left() + number % 2 * half, bar.bottom() + line * (0.2 + number // 2 * 1.2)
        )
        painter.fillRect(
            QRectF(place.x(), place.y() + (line - box) / 2, box, box),
            QtGui.QColor(_colour(theme, part.colour)),
        )
        painter.setPen(QtGui.QColor(theme.text))
        text = QRectF(place.x() + box * 1.4, place.y(), half - box * 1.4, line)
        painter.drawText(text, LEFT, f"{part.name} {part.value}")
