"""What the first tour shows: a card with its sentence and buttons, and a frame round a part."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QRegion,
)
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

_WIDE = 44  # letters of a line
_MARGIN = 12
_THICK = 4


class TourCard(QFrame):
    """A card in a corner of the window; it never takes the focus by itself.

    Signals
    -------
    back, next, left
        A button was pressed.
    """

    back = Signal()
    next = Signal()
    left = Signal()

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self.setObjectName("tour")
        self.setAccessibleName("First tour")
        self.setFrameShape(QFrame.Shape.Box)
        self.setAutoFillBackground(True)
        self.setBackgroundRole(QPalette.ColorRole.AlternateBase)
        self.place = QLabel(self)
        self.place.setObjectName("tour.place")
        self.text = QLabel(self)
        self.text.setObjectName("tour.text")
        self.text.setWordWrap(True)
        font = self.place.font()
        font.setBold(True)
        self.place.setFont(font)
        row = QHBoxLayout()
        self.buttons = {
            name: self._button(name, text, tip, row)
            for name, text, tip in (
                ("back", "Back", "Show the step before"),
                ("next", "Next", "Do this step for me, where it is not done, and go on"),
                ("leave", "Leave", "End the tour (Esc)"),
            )
        }
        self.buttons["back"].clicked.connect(self.back)
        self.buttons["next"].clicked.connect(self.next)
        self.buttons["leave"].clicked.connect(self.left)
        column = self._column = QVBoxLayout(self)
        column.addWidget(self.place)
        column.addWidget(self.text)
        column.addLayout(row)
        self.hide()

    def show_step(self, place: str, text: str, *, first: bool, last: bool) -> None:
        """Show a sentence; screen readers hear of it."""
        self.place.setText(place)
        self.text.setText(text)
        self.setAccessibleDescription(f"{place}: {text}")
        self.buttons["back"].setEnabled(not first)
        self.buttons["next"].setVisible(not last)
        self.setFocusProxy(self.buttons["leave" if last else "next"])
        self.buttons["leave"].setText("Close" if last else "Leave")
        width = _WIDE * self.fontMetrics().averageCharWidth()
        self.setFixedWidth(width)
        self.setFixedHeight(self._column.totalHeightForWidth(width))
        self.show()
        self.raise_()
        QAccessible.updateAccessibility(QAccessibleEvent(self, QAccessible.Event.Alert))

    def stand_in(self, corner: QRect) -> None:
        """Stand at the left foot of a rectangle of the window, wholly within the window."""
        room = self._window.rect()
        at = QPoint(corner.left() + _MARGIN, corner.bottom() - self.height() - _MARGIN)
        at.setX(max(0, min(at.x(), room.right() - self.width())))
        at.setY(max(0, min(at.y(), room.bottom() - self.height())))
        self.move(at)

    def _button(self, name: str, text: str, tip: str, row: QHBoxLayout) -> QPushButton:
        button = QPushButton(text, self)
        button.setObjectName(f"tour.{name}")
        button.setToolTip(tip)
        button.setAccessibleDescription(tip)
        row.addWidget(button)
        return button


class PartFrame(QWidget):
    """A frame round a part of the window, through which the mouse reaches it."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("tour.frame")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._part: QWidget | None = None
        self.hide()

    @property
    def part(self) -> QWidget | None:
        """What it is round; None where it is hidden."""
        return self._part

    def surround(self, part: QWidget | None) -> None:
        """Be round that part, wherever it goes; None: be hidden."""
        if self._part is not None:
            self._part.removeEventFilter(self)
        self._part = part
        if part is not None:
            part.installEventFilter(self)
        self._follow()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Follow it."""
        if event.type() in _MOVES:
            self._follow()
        return False

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the frame."""
        painter = QPainter(self)
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Highlight), 2 * _THICK))
        painter.drawRect(self.rect())
        painter.end()

    def _follow(self) -> None:
        part, window = self._part, self.parentWidget()
        if part is None or not part.isVisible() or part.window() is not window:
            self.hide()
            return
        self.setGeometry(QRect(part.mapTo(window, QPoint()), part.size()))
        inside = self.rect().adjusted(_THICK, _THICK, -_THICK, -_THICK)
        self.setMask(QRegion(self.rect()) - QRegion(inside))
        self.show()
        self.raise_()


_MOVES = (QEvent.Type.Move, QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.Hide)
