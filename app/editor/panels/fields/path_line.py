"""A line for a file name: its folder is cut in the middle, the file's own name is always seen."""

from __future__ import annotations

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QFontMetrics, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QStyle, QStyleOptionFrame

from app.editor.panels.fields.type_in import TypeIn

_DOTS = "…"
_MARGIN = 2  # dots that QLineEdit leaves beside its text


class PathLine(TypeIn):
    """Draws as much of a name as there is room for; while it has the focus, all of it."""

    def shown_text(self) -> str:
        """The text as it is drawn now."""
        if self.hasFocus():
            return self.text()
        return elided_path(self.text(), self.fontMetrics(), self._room().width())

    def draw_line(self, event: QPaintEvent) -> None:
        """Draw the shortened text in place of the one that is edited."""
        text = self.shown_text()
        if text == self.text():
            super().draw_line(event)
            return
        painter, option = QPainter(self), QStyleOptionFrame()
        self.initStyleOption(option)
        style = self.style()
        style.drawPrimitive(QStyle.PrimitiveElement.PE_PanelLineEdit, option, painter, self)
        role = QPalette.ColorRole.Text
        style.drawItemText(
            painter, self._room(), int(_LEFT), self.palette(), self.isEnabled(), text, role
        )
        painter.end()

    def _room(self) -> QRect:
        option = QStyleOptionFrame()
        self.initStyleOption(option)
        part = QStyle.SubElement.SE_LineEditContents
        room = self.style().subElementRect(part, option, self).marginsRemoved(self.textMargins())
        return room.adjusted(_MARGIN, 0, -_MARGIN, 0)


def elided_path(path: str, metrics: QFontMetrics, width: int) -> str:
    """A path that fits the width: the middle of its folder is left out first.

    Only where the file's name alone is too wide is that cut, too, in its middle: its beginning and
    suffix stay.
    """
    if metrics.horizontalAdvance(path) <= width:
        return path
    folder, slash, name = path.rpartition("/")
    end = slash + name
    room = width - metrics.horizontalAdvance(end)
    if room >= metrics.horizontalAdvance(_DOTS):
        return metrics.elidedText(folder, Qt.TextElideMode.ElideMiddle, room) + end
    return metrics.elidedText(name, Qt.TextElideMode.ElideMiddle, width)


_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
