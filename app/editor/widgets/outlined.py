"""Buttons and boxes well seen in both looks: Fusion draws dark outlines on dark grounds."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QPersistentModelIndex
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import (
    QAbstractButton,
    QCheckBox,
    QRadioButton,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionButton,
    QStyleOptionViewItem,
    QToolButton,
    QWidget,
)

from app.editor.theme import Theme


class Toggle(QToolButton):
    """A button that stays down, in the accent colour."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setCheckable(True)
        self._theme: Theme | None = None
        self.toggled.connect(self._colour)

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        self._theme = theme
        self._colour(self.isChecked())

    def _colour(self, on: bool) -> None:
        if self._theme is None:
            return
        palette = QPalette(self._theme.palette())
        if on:
            palette.setColor(QPalette.ColorRole.Button, QColor(self._theme.accent))
            palette.setColor(QPalette.ColorRole.ButtonText, QColor(self._theme.accent_text))
        self.setPalette(palette)


class Radio(QRadioButton):
    """A radio button with a ring round its indicator."""

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the ring over Qt's own."""
        super().paintEvent(event)
        _outline(self, QStyle.SubElement.SE_RadioButtonIndicator, round_=True)


class Check(QCheckBox):
    """A check box with a frame round its indicator."""

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the frame over Qt's own."""
        super().paintEvent(event)
        _outline(self, QStyle.SubElement.SE_CheckBoxIndicator, round_=False)


class OutlinedItems(QStyledItemDelegate):
    """Items of a list with a frame round the box to tick."""

    def paint(
        self,
        painter: QPainter,
        option: QStyleOptionViewItem,
        index: QModelIndex | QPersistentModelIndex,
    ) -> None:
        """Draw the frame over Qt's own."""
        super().paint(painter, option, index)
        item = QStyleOptionViewItem(option)
        self.initStyleOption(item, index)
        widget: QWidget = item.widget
        box = QStyle.SubElement.SE_ItemViewItemCheckIndicator
        rect = widget.style().subElementRect(box, item, widget)
        painter.save()
        painter.setPen(QPen(widget.palette().color(QPalette.ColorRole.PlaceholderText), 1))
        painter.drawRect(rect.adjusted(0, 0, -1, -1))
        painter.restore()


def _outline(button: QAbstractButton, element: QStyle.SubElement, *, round_: bool) -> None:
    option = QStyleOptionButton()
    option.initFrom(button)
    rect = button.style().subElementRect(element, option, button)
    painter = QPainter(button)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(button.palette().color(QPalette.ColorRole.PlaceholderText), 1))
    if round_:
        painter.drawEllipse(rect.adjusted(1, 1, -1, -1))
    else:
        painter.drawRect(rect.adjusted(0, 0, -1, -1))
    painter.end()
