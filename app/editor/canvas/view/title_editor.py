"""Editing a backdrop's title in its place."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPointF, QRect, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QLineEdit

from app.editor.canvas.items.backdrop_item import BackdropItem
from app.editor.canvas.view.canvas_view import GraphView

_NARROWEST = 160
_ENDS = (Qt.Key.Key_Escape, Qt.Key.Key_Return, Qt.Key.Key_Enter)


class TitleEditor(QLineEdit):
    """A field over the title; Enter and leaving it take the text, Esc does not.

    Signals
    -------
    edited(index, text)
        The backdrop of that place in the document's list gets this title.
    """

    edited = Signal(int, str)

    def __init__(self, view: GraphView) -> None:
        super().__init__(view.viewport())
        self.setObjectName("canvas.title")
        self.setAccessibleName("Title of the backdrop")
        self._view = view
        self._index: int | None = None
        self.hide()
        self.editingFinished.connect(self._take)
        self.installEventFilter(self)

    def edit(self, backdrop: BackdropItem) -> None:
        """Begin with this backdrop's title."""
        head = backdrop.head(self._view.zoom)
        corner = self._view.pixel(head.topLeft())
        far = self._view.pixel(QPointF(head.right(), head.bottom()))
        width = max(far.x() - corner.x(), _NARROWEST)
        line = self.sizeHint().height()
        height = line if backdrop.shown.note else max(far.y() - corner.y(), line)
        self.setGeometry(QRect(corner.x(), corner.y(), width, height))
        self._index = backdrop.index
        about = "Text of the note" if backdrop.shown.note else "Title of the backdrop"
        self.setAccessibleName(about)
        self.setText(backdrop.title)
        self.selectAll()
        self.show()
        self.raise_()
        self.setFocus(Qt.FocusReason.PopupFocusReason)

    def finish(self) -> None:
        """Take what has been typed so far, as before saving."""
        if self._index is not None:
            self._take()

    def dismiss(self) -> None:
        """Stop without taking anything."""
        self._index = None
        if self.isVisible():
            self.hide()
            self._view.setFocus(Qt.FocusReason.PopupFocusReason)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Esc and Enter are this field's before they are the window's and the canvas's."""
        if isinstance(event, QKeyEvent) and watched is self and event.key() in _ENDS:
            if event.type() == QEvent.Type.ShortcutOverride:
                event.accept()
                return True
            if event.type() == QEvent.Type.KeyPress:
                if event.key() == Qt.Key.Key_Escape:
                    self.dismiss()
                else:
                    self._take()
                return True
        return bool(super().eventFilter(watched, event))

    def _take(self) -> None:
        index = self._index
        self.dismiss()
        if index is not None:
            self.edited.emit(index, self.text().strip())
