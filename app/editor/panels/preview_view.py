"""The preview of a node's module on top of its panel, which follows what is edited."""

import math
from collections.abc import Hashable, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, QSizeF, Qt
from PySide6.QtGui import QColor, QFontInfo, QFontMetricsF, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.editor.declared_text import tip
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.panels.chart import Chart, ordinate_ticks, room_for_ticks
from app.editor.panels.transfer_preview import TransferPreviewQuery
from app.editor.session import Session
from app.editor.theme import Theme
from app.editor.viewers.picture.picture_facts import grey_levels, shrunk
from app.editor.viewers.plot.plot_export import have_plot_menu
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import LEFT, RIGHT
from core.chain.engine import Plan
from core.modules.declaration import Module, NodeContext, declaration
from core.modules.preview import (
    Bars,
    Colour,
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
_SHADES = 64
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
        self,
        session: Session,
        evaluator: Evaluator,
        node: str,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, f"panel.preview.{id(self):x}", parent)
        self.setObjectName("preview")
        self.node = node
        self.preview: Preview | None = None
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
        self.update()

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

    def paintEvent(self, _event: QPaintEvent) -> None:
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            area = QRectF(self.rect())
            painter.fillRect(area, QColor(self.theme.base))
            if self.preview is not None:
                paint_preview(
                    painter, area.adjusted(4, _ABOVE, -4, -_ABOVE), self.preview, self.theme
                )
            else:
                painter.setPen(QColor(self.theme.faint_text))
                painter.drawText(area, _CENTRED, self._words)


def paint_preview(painter: QPainter, area: QRectF, preview: Preview, theme: Theme) -> None:
    """Parts below one another, the last left out where it is low; charts share what is left."""
    metrics = QFontMetricsF(painter.font())
    line = metrics.height()
    if area.height() < line:  # what is wrong has its place
        return
    preview = _in_room(preview, area.height() / line)
    if preview.facts:
        _paint_beside(painter, area, preview, theme)
        return
    plots = [part for part in preview.parts if isinstance(part, Plot)]
    heights = [line * lines for lines in _lines(preview)]
    fixed = sum(heights) + _GAP * line * (len(heights) - 1)
    scale = area.height() / max(area.height(), line * _least_lines(preview))
    painter.translate(area.topLeft())
    painter.scale(scale, scale)
    area = QRectF(QPointF(), area.size() / scale)
    free = (area.height() - fixed) / max(1, len(plots))
    left = 0.0
    if len(plots) > 1:
        ticks = (ordinate_ticks(plot.y, free + line, metrics) for plot in plots)
        left = max(room_for_ticks(rows, metrics) for rows in ticks)
    top = area.top()
    for part, height in zip(preview.parts, heights, strict=True):
        room = QRectF(area.left(), top, area.width(), height)
        if isinstance(part, Plot):
            room.setHeight(height + free)
            _paint_plot(painter, room, part, theme, left=left)
        elif isinstance(part, Bars):
            _paint_bars(painter, room, part, theme)
        elif isinstance(part, Stack):
            _paint_stack(painter, room, part, theme)
        else:
            painter.setPen(QColor(theme.faint_text if plots else theme.text))
            painter.drawText(room if plots else area, _CENTRED, str(part))
        top = room.bottom() + _GAP * line


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


def _paint_plot(
    painter: QPainter, area: QRectF, plot: Plot, theme: Theme, *, left: float = 0.0
) -> Chart:
    chart = Chart(painter, area, plot.x, plot.y, theme, square=plot.square, left=left)
    line = QFontMetricsF(painter.font()).height()
    if plot.picture is not None:
        _paint_picture(painter, chart.frame, plot.picture, theme)
    if plot.band is not None:
        chart.band(*plot.band, theme.accent)
    for level in plot.levels:
        chart.level(level)
    for upright in plot.uprights:
        chart.upright(*upright)
    order = list(reversed(plot.curves))
    for curve in sorted(order, key=lambda curve: curve.style == "dashed"):
        colour = _colour(theme, curve.colour)
        if curve.fill:
            chart.filled(curve.x, curve.y, colour, closed=curve.fill == "inside")
        if curve.style == "dots":
            chart.dots(curve.x, curve.y, colour, curve.width)
        else:
            chart.curve(curve.x, curve.y, colour, _PENS[curve.style], curve.width)
    for mark in plot.marks:
        if mark.dot:
            chart.point(mark.x, mark.y, _colour(theme, mark.colour))
        if mark.text:
            at = chart.at(mark.x, mark.y) + QPointF(0.0, mark.down * line)
            chart.text(QPointF(at.x(), max(at.y(), chart.frame.top() + 0.6 * line)), mark.text)
    chart.legend(
        [(c.name, _colour(theme, c.colour), _PENS[c.style]) for c in plot.curves if c.name]
    )
    return chart


def _paint_beside(painter: QPainter, area: QRectF, preview: Preview, theme: Theme) -> None:
    """A picture or square chart at the left, lines of text at the right, colours explained."""
    line = QFontMetricsF(painter.font()).height()
    part = preview.parts[0]
    room = QRectF(area.topLeft(), QSizeF(area.width() * _LEFT_SHARE, area.height()))
    if isinstance(part, Plot):
        room.setWidth(min(room.width(), room.height()))
        box = _paint_plot(painter, room, part, theme).frame
        picture = part.picture
    else:
        assert isinstance(part, Picture)
        picture = part
        scale = min(room.width() / part.shape[0], room.height() / part.shape[1])
        box = QRectF(room.topLeft(), QSizeF(*part.shape) * scale)
        _paint_picture(painter, box, part, theme)
        painter.setPen(QPen(QColor(theme.line), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(box)
    beside = area.adjusted(box.right() + line * 0.8 - area.left(), line * 0.2, 0, 0)
    if picture is not None and picture.signed and picture.high > 0.0:
        beside.setBottom(beside.bottom() - line * 2.4)
        _paint_scale(painter, QRectF(beside.bottomLeft(), area.bottomRight()), picture, theme)
    _write(painter, beside, preview.facts, theme)


def _write(painter: QPainter, area: QRectF, lines: Sequence[str], theme: Theme) -> None:
    """Write lines from the top left, smaller where they would not all be seen."""
    text, font = "\n".join(lines), painter.font()
    size = QFontInfo(font).pointSizeF()  # of the font itself, it may be unknown
    painter.save()
    for share in _SIZES:
        font.setPointSizeF(size * share)
        painter.setFont(font)
        if painter.boundingRect(area, _WRAPPED, text).height() <= area.height():
            break
    painter.setPen(QColor(theme.text))
    painter.drawText(area, _WRAPPED, text)
    painter.restore()


def _paint_picture(painter: QPainter, box: QRectF, picture: Picture, theme: Theme) -> None:
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    high, wide = picture.samples.shape
    if picture.signed:
        pixels = _coloured(picture.samples / (picture.high or 1.0), theme)
        image = QImage(pixels.data, wide, high, 4 * wide, QImage.Format.Format_RGB32)
    else:
        grey = grey_levels(picture.samples, picture.low, picture.high)
        image = QImage(grey.data, wide, high, wide, QImage.Format.Format_Grayscale8)
    painter.drawImage(box, image)


def _coloured(values: NDArray[np.float64], theme: Theme) -> NDArray[np.uint32]:
    """Values from −1 to 1 between the theme's colours, as 0xFFRRGGBB, C order; NaN dark."""
    dark, light = sorted((theme.base, theme.text), key=lambda name: QColor(name).lightness())
    names = (theme.curves[0], light, theme.curves[3])
    ends = np.array([QColor(name).getRgb()[:3] for name in names], np.float64)
    pixels = np.full(values.shape, 0xFF000000, np.uint32)
    known = np.nan_to_num(values)
    for channel, shift in enumerate((16, 8, 0)):
        level = np.interp(known, (-1.0, 0.0, 1.0), ends[:, channel])
        pixels |= np.rint(level).astype(np.uint32) << np.uint32(shift)
    pixels[np.isnan(values)] = QColor(dark).rgb()
    return pixels


def _paint_scale(painter: QPainter, area: QRectF, picture: Picture, theme: Theme) -> None:
    shades = _coloured(np.linspace(-1, 1, _SHADES)[np.newaxis], theme)
    image = QImage(shades.data, _SHADES, 1, 4 * _SHADES, QImage.Format.Format_RGB32)
    metrics = QFontMetricsF(painter.font())
    line = metrics.height()
    bar = QRectF(area.left(), area.top(), area.width() - line / 2, line * 0.7)
    painter.drawImage(bar, image)
    text = bar.translated(0, line * 0.85)
    text.setHeight(line)
    painter.setPen(QColor(theme.text))
    written, middle = brief(picture.high, 2), f" {picture.unit} "
    painter.drawText(text, Qt.AlignmentFlag.AlignLeft, signed(f"-{written}"))
    if metrics.horizontalAdvance(written + middle + written) + line * 2 < text.width():
        painter.drawText(text, Qt.AlignmentFlag.AlignHCenter, picture.unit)
    painter.drawText(text, Qt.AlignmentFlag.AlignRight, f"+{written}")


def _paint_bars(painter: QPainter, area: QRectF, bars: Bars, theme: Theme) -> None:
    metrics = QFontMetricsF(painter.font())
    height = area.height() / len(bars.bars)
    named = max(metrics.horizontalAdvance(bar.name) for bar in bars.bars) + height * 0.5
    valued = max(metrics.horizontalAdvance(bar.value) for bar in bars.bars) + height * 0.5
    most = max(*(bar.size for bar in bars.bars), 1e-300)
    room = max(0.0, area.width() - named - valued)
    for number, bar in enumerate(bars.bars):
        top = area.top() + number * height
        painter.setPen(QColor(theme.text))
        painter.drawText(QRectF(area.left(), top, named - height * 0.4, height), RIGHT, bar.name)
        length = room * min(1.0, bar.size / most)
        filled = QRectF(area.left() + named, top + height * 0.22, length, height * 0.56)
        painter.fillRect(filled, QColor(_colour(theme, bar.colour)))
        value = QRectF(filled.right() + height * 0.3, top, valued, height)
        painter.drawText(value, LEFT, bar.value)


def _paint_stack(painter: QPainter, area: QRectF, stack: Stack, theme: Theme) -> None:
    line = QFontMetricsF(painter.font()).height()
    head = QRectF(area.left(), area.top(), area.width(), line * 1.2)
    painter.setPen(QColor(theme.error if stack.excess else theme.text))
    painter.drawText(head, LEFT, stack.left)
    painter.setPen(QColor(theme.text))
    painter.drawText(head, RIGHT, stack.right)
    bar = QRectF(area.left(), head.bottom() + line * 0.2, area.width(), line * 1.1)
    parts = [part for part in stack.parts if part.size > 0.0]
    scale = bar.width() / max(stack.whole or 0.0, sum(part.size for part in parts), 1e-300)
    left = bar.left()
    for part in parts:
        width = part.size * scale
        painter.fillRect(
            QRectF(left, bar.top(), width, bar.height()), QColor(_colour(theme, part.colour))
        )
        left += width
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(theme.error if stack.excess else theme.line), 1.2))
    if stack.whole:
        painter.drawRect(QRectF(bar.topLeft(), QSizeF(stack.whole * scale, bar.height())))
    box, half = line * 0.6, area.width() / 2
    for number, part in enumerate(parts):
        place = QPointF(
            area.left() + number % 2 * half, bar.bottom() + line * (0.2 + number // 2 * 1.2)
        )
        painter.fillRect(
            QRectF(place.x(), place.y() + (line - box) / 2, box, box),
            QColor(_colour(theme, part.colour)),
        )
        painter.setPen(QColor(theme.text))
        text = QRectF(place.x() + box * 1.4, place.y(), half - box * 1.4, line)
        painter.drawText(text, LEFT, f"{part.name} {part.value}")
