"""The history as a list: what was done, where the document stands, and what can be done again."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QPointF,
    QSize,
    Qt,
)
from PySide6.QtGui import QColor, QFont, QIcon, QKeyEvent, QPainter, QPixmap, QPolygonF, QShowEvent
from PySide6.QtWidgets import QDockWidget, QListView, QWidget

from app.editor.session import Session
from app.editor.theme import DARK, Theme
from core.editing.history import History

_Index = QModelIndex | QPersistentModelIndex
_ROLE = Qt.ItemDataRole
_START = "Start"


class HistoryModel(QAbstractListModel):
    """The positions of the document's history; it reads them off the document when drawn.

    Parameters
    ----------
    session : Session
        The document.
    parent : QObject
        What owns it.
    """

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._theme: Theme = DARK
        self._rows = self._history.last + 1  # as Qt has been notified

    @property
    def _history(self) -> History:
        return self._session.document.history

    def follow(self) -> None:
        """Show the history as it is now."""
        rows, had = self._history.last + 1, self._rows
        self._rows = rows
        if rows > had:
            self.beginInsertRows(QModelIndex(), had, rows - 1)
            self.endInsertRows()
        elif rows < had:
            self.beginRemoveRows(QModelIndex(), rows, had - 1)
            self.endRemoveRows()
        self.dataChanged.emit(self.index(0), self.index(rows - 1), [])

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        self._theme = theme
        self.dataChanged.emit(self.index(0), self.index(self._rows - 1), [])

    def rowCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        """The start, and one for each step."""
        return 0 if parent.isValid() else self._rows

    def data(self, index: _Index, role: int = _ROLE.DisplayRole) -> Any:
        """A line, its mark and looks."""
        history, row = self._history, index.row()
        if not 0 <= row <= history.last:  # changed, and not followed yet
            return None
        line = history.line(row) or _START
        present = row == history.position
        saved = row == history.saved and self._session.document.path is not None
        undone = row > history.position
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
                return QColor(self._theme.faint_text if undone else self._theme.text)
            case _ROLE.DecorationRole:
                return _mark(self._theme, present=present)
        return None

    @staticmethod
    def _place(*, present: bool, undone: bool, saved: bool) -> str:
        if present:
            text = "The network as it stands"
        elif undone:
            text = "Undone: a click or Enter does it again"
        else:
            text = "A click or Enter undoes all after it"
        return f"{text}; as it was saved" if saved else text


class HistoryList(QListView):
    """The list of the history. A click or Enter goes there, as one step of the view.

    Parameters
    ----------
    session : Session
        The document.
    parent : QWidget, optional
        Its parent.
    """

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("history")
        self.setAccessibleName("History")
        self.setToolTip("What was done; a click or Enter goes back there, or forth")
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

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        self._shown_model.set_theme(theme)

    def toggle(self) -> None:
        """Show it with the focus, or put it away where it is in front."""
        dock = self._dock()
        if dock is None:
            return
        if self.isVisible():
            dock.hide()
            return
        dock.show()
        dock.raise_()
        self.setFocus(Qt.FocusReason.OtherFocusReason)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Enter goes to the line that the arrows have led to."""
        enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
        if enter and not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self._go(self.currentIndex())
            event.accept()
        else:
            super().keyPressEvent(event)

    def showEvent(self, event: QShowEvent) -> None:
        """Show what was done while it was away."""
        super().showEvent(event)
        self._follow()

    def sizeHint(self) -> QSize:
        """Room for a line with its values."""
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

    def _dock(self) -> QDockWidget | None:
        above = self.parentWidget()
        while above is not None and not isinstance(above, QDockWidget):
            above = above.parentWidget()
        return above


def _mark(theme: Theme, *, present: bool) -> QIcon:
    """A triangle that points at the present line; for others room as wide."""
    icon = QIcon()
    for mode, colour in (
        (QIcon.Mode.Normal, theme.accent),
        (QIcon.Mode.Selected, theme.accent_text),
    ):
        pixmap = QPixmap(24, 24)
        pixmap.fill(Qt.GlobalColor.transparent)
        if present:
            painter = QPainter(pixmap)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(colour))
            painter.drawPolygon(QPolygonF([QPointF(5, 3), QPointF(21, 12), QPointF(5, 21)]))
            painter.end()
        icon.addPixmap(pixmap, mode)
    return icon
