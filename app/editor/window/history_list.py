"""The history as a list: what was done, where the document stands, and what can be done again."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QAbstractListModel, QModelIndex, QObject, QPointF, QSize, Qt
from PySide6.QtGui import (
    QFont,
    QGuiApplication,
    QIcon,
    QKeyEvent,
    QPainter,
    QPalette,
    QPixmap,
    QPolygonF,
    QShowEvent,
)
from PySide6.QtWidgets import QListView, QWidget

from app.editor.session import Session
from core.editing.document import History

_ROLE, _PALETTE = Qt.ItemDataRole, QPalette.ColorRole
_START = "Start"


class HistoryModel(QAbstractListModel):
    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._rows = self._history.last + 1  # as Qt has been notified

    @property
    def _history(self) -> History:
        return self._session.document.history

    def follow(self) -> None:
        rows, had = self._history.last + 1, self._rows
        self._rows = rows
        if rows > had:
            self.beginInsertRows(QModelIndex(), had, rows - 1)
            self.endInsertRows()
        elif rows < had:
            self.beginRemoveRows(QModelIndex(), rows, had - 1)
            self.endRemoveRows()
        self.dataChanged.emit(self.index(0), self.index(rows - 1), [])

    def rowCount(self, parent: Any = QModelIndex()) -> int:  # noqa: B008
        return 0 if parent.isValid() else self._rows

    def data(self, index: Any, role: int = _ROLE.DisplayRole) -> Any:
        history, row = self._history, index.row()
        if not 0 <= row <= history.last:  # changed, and not followed yet
            return None
        line = history.line(row) or _START
        present = row == history.position
        saved = row == history.saved and self._session.document.path is not None
        undone = row > history.position
        palette = QGuiApplication.palette()
        match role:
            case _ROLE.DisplayRole:
                return f"{line}  (saved)" if saved else line
            case _ROLE.ToolTipRole:
                return f"{line}\n{self._place(present=present, undone=undone, saved=saved)}"
            case _ROLE.AccessibleTextRole:
                return f"{line}. {self._place(present=present, undone=undone, saved=saved)}"
            case _ROLE.FontRole:
                font = QFont()
                font.setBold(present)
                font.setItalic(undone)
                return font
            case _ROLE.ForegroundRole:
                return palette.color(_PALETTE.PlaceholderText if undone else _PALETTE.Text)
            case _ROLE.DecorationRole:
                return _mark(palette, present=present)
        return None

    @staticmethod
    def _place(*, present: bool, undone: bool, saved: bool) -> str:
        if present:
            text = "The network as it is now"
        elif undone:
            text = "Undone: click or press Enter to redo it"
        else:
            text = "Click or press Enter to undo everything after it"
        return f"{text}; the saved state" if saved else text


class HistoryList(QListView):
    """The list of the history. A click or Enter goes there, as one step of the view."""

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("history")
        self.setAccessibleName("History")
        self.setToolTip(
            "Steps of this network; click one or press Enter to go back or forward to it"
        )
        self.setUniformItemSizes(True)
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        side = self.fontMetrics().height() * 2 // 3
        self.setIconSize(QSize(side, side))
        self._session = session
        self._shown_model = HistoryModel(session, self)
        self.setModel(self._shown_model)
        self.clicked.connect(self._go)
        session.opened.connect(self._follow)
        session.state_changed.connect(self._follow)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
        if enter and not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self._go(self.currentIndex())
            event.accept()
        else:
            super().keyPressEvent(event)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._follow()

    def sizeHint(self) -> QSize:
        unit = self.fontMetrics().averageCharWidth()
        return QSize(45 * unit, 40 * unit)

    def _go(self, index: QModelIndex) -> None:
        if index.isValid():
            self._session.go_to(index.row())

    def _follow(self) -> None:
        if not self.isVisible():
            return
        self._shown_model.follow()
        present = self._shown_model.index(self._session.document.history.position)
        self.setCurrentIndex(present)
        self.scrollTo(present)


def _mark(palette: QPalette, *, present: bool) -> QIcon:
    """A triangle that points at the present line; for others room as wide."""
    icon = QIcon()
    for mode, role in (
        (QIcon.Mode.Normal, _PALETTE.Highlight),
        (QIcon.Mode.Selected, _PALETTE.HighlightedText),
    ):
        pixmap = QPixmap(24, 24)
        pixmap.fill(Qt.GlobalColor.transparent)
        if present:
            painter = QPainter(pixmap)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(palette.color(role))
            painter.drawPolygon(QPolygonF([QPointF(5, 3), QPointF(21, 12), QPointF(5, 21)]))
            painter.end()
        icon.addPixmap(pixmap, mode)
    return icon
