"""Notices: information grey, warnings amber, errors red, each with a mark and a way to close it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, get_args

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPaintEvent, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.editor.theme import CHANGED, ERROR, FAINT
from app.editor.widgets import ElidedLabel, WheelScrollArea, plain_label, tool_button

Severity = Literal["information", "warning", "error"]
ROLES = {"information": FAINT, "warning": CHANGED, "error": ERROR}
_GRAVEST_FIRST = tuple(reversed(get_args(Severity)))
_LINES = 6  # of notices that are seen without scrolling

# Shapes in a square from -1 to 1: they are told apart without their colours.
_TRIANGLE = ((0.0, -0.95), (1.0, 0.85), (-1.0, 0.85))
_OCTAGON = ((-0.4, -1), (0.4, -1), (1, -0.4), (1, 0.4), (0.4, 1), (-0.4, 1), (-1, 0.4), (-1, -0.4))
_SIGNS: dict[str, tuple[tuple[float, ...], ...]] = {  # lines; of no length, dots
    "information": ((0, -0.05, 0, 0.55), (0, -0.5, 0, -0.5)),
    "warning": ((0, -0.35, 0, 0.2), (0, 0.58, 0, 0.58)),
    "error": ((-0.4, -0.4, 0.4, 0.4), (-0.4, 0.4, 0.4, -0.4)),
}


def sentence(line: str) -> str:
    """A remark, which begins small and ends without a stop."""
    return f"{line[:1].upper()}{line[1:]}."


def draw_mark(
    painter: QPainter, room: QRectF, severity: Severity, ink: QColor, ground: QColor
) -> None:
    """The mark of a severity: an i in a disc, an ! in a triangle, or a cross in an octagon."""
    side = min(room.width(), room.height())
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.translate(room.center())
    painter.scale(0.46 * side, 0.46 * side)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(ink)
    if severity == "information":
        painter.drawEllipse(QPointF(), 1.0, 1.0)
    else:
        corners = _TRIANGLE if severity == "warning" else _OCTAGON
        painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in corners]))
    painter.setPen(QPen(ground, 0.27, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    for x, y, to_x, to_y in _SIGNS[severity]:
        painter.drawLine(QPointF(x, y), QPointF(to_x, to_y + 1e-3))
    painter.restore()


def mark_icon(severity: Severity, widget: QWidget) -> QIcon:
    """The mark for an item of a list, in the colours of its widget."""
    side, palette = 32, widget.palette()
    picture = QPixmap(side, side)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    ink, ground = palette.color(ROLES[severity]), palette.color(palette.ColorRole.Base)
    draw_mark(painter, QRectF(0, 0, side, side), severity, ink, ground)
    painter.end()
    return QIcon(picture)


class Mark(QWidget):
    """The mark of a severity, as high as a line of text."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.severity: Severity = "information"
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def show_severity(self, severity: Severity) -> None:
        self.severity = severity
        self.setAccessibleName(severity)
        self.update()

    def sizeHint(self) -> QSize:
        side = self.fontMetrics().height()
        return QSize(side, side)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter, palette = QPainter(self), self.palette()
        ink, ground = palette.color(ROLES[self.severity]), palette.color(palette.ColorRole.Window)
        draw_mark(painter, QRectF(self.rect()), self.severity, ink, ground)
        painter.end()


def close_button(name: str, parent: QWidget) -> QToolButton:
    """A cross that closes a message, no higher than a line of text."""
    button = tool_button(name, "×", "Close this message", parent)
    button.setAutoRaise(True)
    button.setMaximumHeight(parent.fontMetrics().height() + 2)
    return button


class Notice(QWidget):
    """A mark, a text in the same colour, and a button that closes both; hidden without a text.

    The text is broken into lines, or with `one_line` elided.
    """

    closed = Signal()  # the person has closed it

    def __init__(self, name: str, parent: QWidget, *, one_line: bool = False) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self.text = ""
        self.mark = Mark(self)
        self.label: QLabel = (
            ElidedLabel(f"{name}.text", "Message", self)
            if one_line
            else plain_label(f"{name}.text", self)
        )
        self.away = close_button(f"{name}.close", self)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(5)
        top = Qt.AlignmentFlag.AlignVCenter if one_line else Qt.AlignmentFlag.AlignTop
        row.addWidget(self.mark, 0, top)
        row.addWidget(self.label, 1)
        row.addWidget(self.away, 0, top)
        self.away.clicked.connect(self._close)
        self.hide()

    @property
    def severity(self) -> Severity:
        return self.mark.severity

    def show_text(self, text: str, severity: Severity = "information") -> None:
        self.text = text
        self.mark.show_severity(severity)
        self.label.setForegroundRole(ROLES[severity])
        if isinstance(self.label, ElidedLabel):
            self.label.show_text(text)
        else:
            self.label.setText(text)
        self.setVisible(bool(text))

    def _close(self) -> None:
        self.show_text("", self.severity)
        self.closed.emit()


class NoticeList(WheelScrollArea):
    """Notices below one another, the gravest first; no place is taken where there is none."""

    def __init__(self, name: str, words: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self.setAccessibleName(words)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._inside = QWidget(self)
        self._rows = QVBoxLayout(self._inside)
        self._rows.setContentsMargins(6, 2, 6, 2)
        self._rows.setSpacing(2)
        self.setWidget(self._inside)
        self.notices: list[Notice] = []
        self.hide()

    def show_notices(self, said: Iterable[tuple[Severity, str]]) -> None:
        """Show these in place of those before, the ones that were closed among them."""
        for old in self.notices:
            old.hide()  # it is deleted later
            old.deleteLater()
        self.notices = []
        for severity, text in sorted(said, key=lambda one: _GRAVEST_FIRST.index(one[0])):
            notice = Notice(f"{self.objectName()}.{len(self.notices)}", self._inside)
            notice.show_text(text, severity)
            notice.closed.connect(self._fit)
            self._rows.addWidget(notice)
            self.notices.append(notice)
        self._fit()

    @property
    def shown(self) -> list[tuple[Severity, str]]:
        return [(one.severity, one.text) for one in self.notices if one.text]

    def resizeEvent(self, event: object) -> None:
        super().resizeEvent(event)  # type: ignore[arg-type] # Qt's
        self._fit()

    def _fit(self) -> None:
        """As high as its texts at this width, within limits."""
        self.setVisible(bool(self.shown))
        needed = self._rows.heightForWidth(max(self.width(), 100))
        height = min(max(needed, 0), _LINES * self.fontMetrics().lineSpacing())
        if height != self.height():
            self.setFixedHeight(height)
