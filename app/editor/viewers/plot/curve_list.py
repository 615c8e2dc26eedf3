"""The legend of a plot: each curve with its pen, to be switched on and off."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QWidget

from app.editor.declared_text import tip
from app.editor.viewers.plot.plotted_lines import Entry
from app.editor.widgets import OutlinedItems

_NAME = Qt.ItemDataRole.UserRole
_CHECKED = Qt.CheckState.Checked
_UNCHECKED = Qt.CheckState.Unchecked


class CurveList(QListWidget):
    toggled = Signal(str, bool)  # name, shown: the person has ticked one, or the other way round

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Curves to show")
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

    def set_across(self, on: bool) -> None:
        """List the entries from left to right, on as many lines as they need."""
        self.setFlow(QListWidget.Flow.LeftToRight if on else QListWidget.Flow.TopToBottom)
        self.setWrapping(on)
        self.setResizeMode(QListWidget.ResizeMode.Adjust if on else QListWidget.ResizeMode.Fixed)

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
