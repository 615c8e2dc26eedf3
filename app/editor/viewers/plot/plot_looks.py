"""How plots look: axes and pens of the theme, and the legend that switches curves on and off."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QIcon, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QGraphicsItem, QListWidget, QListWidgetItem, QWidget

from app.editor.declared_text import tip
from app.editor.theme import Theme
from app.editor.viewers.plot.plotted_lines import Entry
from app.editor.widgets import OutlinedItems
from core.modules.preview import round_step

_DASHES = (
    Qt.PenStyle.SolidLine,
    Qt.PenStyle.DashLine,
    Qt.PenStyle.DotLine,
    Qt.PenStyle.DashDotLine,
)
_PIECE = 9.0  # dots of a curve before what is beneath is seen
_KEPT = (5.0, 4.0)  # dots of a kept curve, and of its gaps
_STRONG = 3  # dots that the curve which is looked at is wide
_FAINT = 200  # of 255, the opacity of a limit
_APART = 3.2  # lines of text from one number to the next, across
_MOST_STEPS = 12
_PLAIN = range(-4, 5)  # powers of ten that are written out


class PlotAxis(pg.AxisItem):  # type: ignore[misc]
    """An axis that ends with what is shown, where the view shows more.

    Of a logarithmic one, only some values between powers of ten have a number.
    """

    ends: tuple[float, float] | None = None

    def end_at(self, low: float, high: float) -> None:
        if self.ends != (low, high):
            self.ends = low, high
            self.picture = None  # the drawing that pyqtgraph keeps
            self.update()

    def tickSpacing(self, minVal: float, maxVal: float, size: float) -> list[Any]:
        """Round steps whose numbers do not touch, of a linear axis that ends."""
        if self.ends is None:
            return list(super().tickSpacing(minVal, maxVal, size))
        line = QFontMetricsF(self.style["tickFont"] or QFont()).height()
        room = max(line * (_APART if self.orientation == "bottom" else 1.05), size / _MOST_STEPS)
        return [(round_step((maxVal - minVal) * min(room / max(size, 1.0), 1.0)), 0)]

    def tickValues(self, minVal: float, maxVal: float, size: float) -> list[Any]:
        levels: list[Any] = super().tickValues(minVal, maxVal, size)
        if self.ends is None or self.logMode:
            return levels
        low, high = sorted(self.ends)
        slack = 1e-6 * (high - low)
        return [
            (spacing, [value for value in values if low - slack <= value <= high + slack])
            for spacing, values in levels
        ]

    def logTickStrings(self, values: Sequence[float], scale: float, spacing: float) -> list[str]:
        """Text of ticks at these logarithms: of 2 to 9 between powers of ten, few have room."""
        texts: list[str] = super().logTickStrings(values, scale, spacing)
        decades = abs(self.range[1] - self.range[0])
        labelled = range(1, 10) if decades < 0.5 else (1, 2, 5) if decades < 2.5 else (1,)
        labels = []
        for value, text in zip(values, texts, strict=True):
            power = math.floor(value + 1e-9)
            first = round(10 ** (value - power))
            plain = f"{first * 10.0**power:.1g}" if power < 0 else str(first * 10**power)
            labels.append("" if first not in labelled else plain if power in _PLAIN else text)
        return labels


def bare(plot: pg.PlotItem) -> None:
    plot.setMenuEnabled(False)
    plot.hideButtons()
    for name in ("left", "bottom"):
        plot.getAxis(name).enableAutoSIPrefix(False)


def paint_axes(plot: pg.PlotItem, theme: Theme) -> None:
    for name in ("left", "bottom"):
        paint_axis(plot.getAxis(name), theme)


def paint_axis(axis: pg.AxisItem, theme: Theme) -> None:
    """One axis; drawn anew only when it changes, as its text and grid take long."""
    axis.setCacheMode(QGraphicsItem.CacheMode.DeviceCoordinateCache)
    axis.setPen(theme.line)
    axis.setTextPen(theme.text)


def thick(colour: str | QColor, width: int, style: Qt.PenStyle = Qt.PenStyle.SolidLine) -> QPen:
    pen: QPen = pg.mkPen(colour, width=width, style=style)
    return pen


def entry_pens(entries: Iterable[Entry], theme: Theme) -> dict[str, QPen]:
    """The pens of the legend's entries, by their names.

    Products have the text's colour, a limit that of the curve it is around; what lies on other
    curves is dashed, and so is a kept curve, in the colour of the present one.
    """
    pens: dict[str, QPen] = {}
    colours, curves, totals = theme.curves, 0, 0
    for entry in entries:
        if entry.of:
            pen = QPen(pens[entry.of])
            pen.setDashPattern([length / pen.widthF() for length in _KEPT])
        elif entry.total:
            pen = thick(theme.text, 2, _DASHES[min(totals, 1)])
            totals += 1
        elif entry.bound:
            colour = colours[max(curves - 1, 0) % len(colours)]
            pen = thick(see_through(colour, _FAINT), 1, Qt.PenStyle.DotLine)
        else:
            style = _DASHES[curves // len(colours) % len(_DASHES)]
            pen = thick(colours[curves % len(colours)], _STRONG if entry.strong else 1, style)
            if entry.over:  # three curves on one another are seen in turn
                pen.setDashPattern([_PIECE, 2 * _PIECE])
                pen.setDashOffset(_PIECE * entry.over)
            curves += 1
        pens[entry.name] = pen
    return pens


def coloured(text: str, colour: str) -> str:
    return f"<span style='color: {colour}'>{text}</span>"


def see_through(colour: str, alpha: int) -> QColor:
    mixed = QColor(colour)
    mixed.setAlpha(alpha)
    return mixed


_NAME = Qt.ItemDataRole.UserRole
_CHECKED = Qt.CheckState.Checked
_UNCHECKED = Qt.CheckState.Unchecked


class CurveList(QListWidget):
    toggled = Signal(str, bool)  # name, shown: the person has ticked one, or the other way round

    def __init__(self, parent: QWidget | None = None, *, across: bool = False) -> None:
        """With `across` from left to right, on as many lines as they need."""
        super().__init__(parent)
        self.setAccessibleName("Curves to show")
        if across:
            self.setFlow(QListWidget.Flow.LeftToRight)
            self.setWrapping(True)
            self.setResizeMode(QListWidget.ResizeMode.Adjust)
        width = self.fontMetrics().averageCharWidth()
        self.setIconSize(QSize(3 * width, self.fontMetrics().height()))
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setItemDelegate(OutlinedItems(self))
        self.itemChanged.connect(
            lambda item: self.toggled.emit(str(item.data(_NAME)), item.checkState() == _CHECKED)
        )

    def sizeHint(self) -> QSize:
        hint = super().sizeHint()
        width = self.sizeHintForColumn(0) + 2 * self.frameWidth() + 4
        most = 30 * self.fontMetrics().averageCharWidth()
        hint.setWidth(min(width, most))
        return hint

    def height_for(self, width: int) -> int:
        """What the entries need from left to right in that width."""
        self.resize(width, self.height())
        self.doItemsLayout()
        return self.contentsSize().height() + 2 * self.frameWidth()

    def fill(
        self,
        entries: Iterable[Entry],
        shown: Iterable[str],
        pens: Mapping[str, QPen],
        note: str = "",
    ) -> None:
        """Show these entries, products first, those `shown` ticked, below a note in lines."""
        ticked = set(shown)
        icons: dict[tuple[object, ...], QIcon] = {}
        self.blockSignals(True)
        row = self.currentRow()
        self.clear()
        for line in note.splitlines():
            heading = QListWidgetItem(line)
            heading.setToolTip(tip(line))
            heading.setFlags(Qt.ItemFlag.ItemIsEnabled)
            self.addItem(heading)
        for entry in sorted(entries, key=lambda entry: not entry.total):
            drawn = pens[entry.name]
            look = drawn.color().rgba(), drawn.widthF(), drawn.style(), *drawn.dashPattern()
            icon = icons.get(look) or icons.setdefault(look, self._icon(drawn))
            item = QListWidgetItem(icon, entry.title)
            item.setData(_NAME, entry.name)
            item.setToolTip(entry.title)
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            item.setCheckState(_CHECKED if entry.name in ticked else _UNCHECKED)
            self.addItem(item)
        self.setCurrentRow(min(row, self.count() - 1))
        self.blockSignals(False)
        self.updateGeometry()

    def scroll_to_ticked(self) -> None:
        for row in range(self.count()):
            if self.item(row).checkState() == _CHECKED:
                self.scrollToItem(self.item(row), QListWidget.ScrollHint.PositionAtTop)
                return

    def _icon(self, pen: QPen) -> QIcon:
        ratio = self.devicePixelRatioF()
        size = self.iconSize()
        picture = QPixmap(size * ratio)
        picture.setDevicePixelRatio(ratio)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        thick = QPen(pen)
        thick.setCosmetic(False)
        thick.setWidthF(max(2.0, pen.widthF()))
        if thick.style() == Qt.PenStyle.CustomDashLine:  # its gaps may be wider than the icon
            thick.setStyle(Qt.PenStyle.DashLine)
        painter.setPen(thick)
        painter.drawLine(0, size.height() // 2, size.width(), size.height() // 2)
        painter.end()
        return QIcon(picture)
