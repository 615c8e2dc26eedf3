"""Notices: information grey, warnings amber, errors red, each with a mark and a way to close it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Literal, get_args

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from app.editor.theme import CHANGED, ERROR, FAINT
from app.editor.widgets import ElidedLabel, filled, labelled, plain_label, tool_button

Severity = Literal["information", "warning", "error"]
ROLES = {"information": FAINT, "warning": CHANGED, "error": ERROR}
_GRAVEST_FIRST = tuple(reversed(get_args(Severity)))
_MOST = 2  # notices in sight

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
    """A mark, a text in its colour, elided if `one_line`, and a button; hidden without a text."""

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
        row = filled(QHBoxLayout(self), spacing=5)
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


class NoticeList(QWidget):
    """Notices below one another, the gravest first; of many, the others by a button."""

    def __init__(self, name: str, words: str, parent: QWidget) -> None:
        super().__init__(parent)
        labelled(self, name, words)
        self.left: list[tuple[Severity, str]] = []  # those that have not been closed
        self._notices: list[Notice] = []
        self.more = tool_button(f"{name}.more", "", "Show all messages, or the gravest", self)
        self.more.setCheckable(True)
        self.more.toggled.connect(self._show)
        self._rows = filled(QVBoxLayout(self), self.more, margins=(6, 2, 6, 2), spacing=2)
        self.hide()

    def show_notices(self, said: Iterable[tuple[Severity, str]]) -> None:
        """Show these in place of those before, the ones that were closed among them."""
        self.left = sorted(said, key=lambda one: _GRAVEST_FIRST.index(one[0]))
        for row in range(len(self._notices), len(self.left)):
            notice = Notice(f"{self.objectName()}.{row}", self)
            notice.closed.connect(partial(self._close, row))
            self._notices.append(notice)
            self._rows.insertWidget(row, notice)
        self._show()

    def _show(self, *_: object) -> None:
        shown = self.left if self.more.isChecked() else self.left[:_MOST]
        for row, notice in enumerate(self._notices):
            severity, text = shown[row] if row < len(shown) else ("information", "")
            notice.show_text(text, severity)
        more = len(self.left) - _MOST
        self.more.setText("Fewer" if self.more.isChecked() else f"{more} More")
        self.more.setVisible(more > 0)
        self.setVisible(bool(self.left))

    def _close(self, row: int) -> None:
        self.show_notices([*self.left[:row], *self.left[row + 1 :]])
