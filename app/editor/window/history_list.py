"""The history as a list: what was done, where the document stands, and what can be done again."""

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QWidget

from app.editor.session import Session
from app.editor.widgets import labelled


class HistoryList(QListWidget):
    """The present step is bold, undone ones are italic; a click or Enter goes to a step."""

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        tip = "Edits of this network; click an edit or press Enter to go back or forward to it"
        labelled(self, "history", "History", tip)
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._session = session
        self.itemClicked.connect(self._go)
        self.itemActivated.connect(self._go)
        session.opened.connect(self._follow)
        session.state_changed.connect(self._follow)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._follow()

    def sizeHint(self) -> QSize:
        return QSize(45, 40) * self.fontMetrics().averageCharWidth()

    def _go(self, item: QListWidgetItem) -> None:
        self._session.go_to(self.row(item))

    def _follow(self) -> None:
        if not self.isVisible():
            return
        document = self._session.document
        font = self.font()
        self.clear()
        for row in range(document.last + 1):
            saved = row == document.saved and document.path is not None
            item = QListWidgetItem((document.line(row) or "Start") + ("  (saved)" if saved else ""))
            font.setBold(row == document.position)
            font.setItalic(row > document.position)
            item.setFont(font)
            self.addItem(item)
        self.setCurrentRow(document.position)
