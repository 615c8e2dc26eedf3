"""A line of text that is cut off with dots where there is no room; and a hint in the middle."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QLabel, QSizePolicy, QWidget

from app.editor.widgets.steady_width import steady_width


class ElidedLabel(QLabel):
    """One line that may be narrower than its text.

    It keeps the text itself: a `QLabel` has the window laid out anew for each of its texts.
    """

    _line = ""
    _width = 0

    def __init__(self, name: str, description: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self.setAccessibleName(description)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)

    def text(self) -> str:
        """The whole text."""
        return self._line

    def show_text(self, text: str, about: str = "") -> None:
        """Show a text; line ends become spaces.

        Parameters
        ----------
        text : str
            What to show.
        about : str, optional
            The tooltip, if not the text itself.
        """
        line = " ".join(text.split(" ")).replace("\n", " ")
        if line != self._line:
            self._line = line
            self.setAccessibleDescription(line)
            self._fit(self._width)
            self.update()
        if (about or line) != self.toolTip():
            self.setToolTip(about or line)

    def sizeHint(self) -> QSize:
        """Room for the text."""
        margins = self.contentsMargins()
        return QSize(
            self._width + margins.left() + margins.right(),
            self.fontMetrics().height() + margins.top() + margins.bottom(),
        )

    def minimumSizeHint(self) -> QSize:
        """Room for a few letters."""
        hint = self.sizeHint()
        hint.setWidth(min(hint.width(), self.fontMetrics().averageCharWidth() * 4))
        return hint

    def changeEvent(self, event: QEvent) -> None:
        """Follow the font."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit(0)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the text, or what there is room for."""
        painter = QPainter(self)
        text = self.fontMetrics().elidedText(
            self._line, Qt.TextElideMode.ElideRight, self.contentsRect().width()
        )
        painter.setPen(self.palette().color(self.foregroundRole()))
        painter.drawText(self.contentsRect(), int(self.alignment()), text)
        painter.end()

    def _fit(self, had: int) -> None:
        width = steady_width(self._line, self.font(), had)
        if width != self._width:
            self._width = width
            self.updateGeometry()


def centred_hint(text: str, parent: QWidget) -> QLabel:
    """What to do, in the middle of where nothing is shown yet."""
    label = QLabel(text, parent)
    label.setAlignment(Qt.AlignmentFlag.AlignCenter)
    label.setWordWrap(True)
    return label
