"""The way to the macro that is shown: a bar on top of the canvas, only inside of macros.

It lies over the canvas, which stays where it is when the bar comes and goes.
"""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QEvent, QObject, QPointF, QRect, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QToolButton, QWidget

from app.editor.canvas.canvas_view import GraphView
from app.editor.canvas.items.node_item import BackdropItem
from app.editor.declared_text import tip
from app.editor.session import Level
from app.editor.theme import FAINT, RAISED
from app.editor.widgets import filled, labelled

_BETWEEN = "›"


class Crumbs(QWidget):
    """Buttons for the network and each macro on the way, and one that leads back by one."""

    def __init__(self, level: Level, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "crumbs", "path to the macro shown")
        self._level = level
        self._row = filled(QHBoxLayout(self), margins=(4, 2, 4, 2), spacing=2)
        self.up = self._button(
            "crumbs.up", "↑ Up", "Leave this macro and show the network around it (Alt+PgUp)"
        )
        self.up.clicked.connect(level.leave)
        self.steps: list[QToolButton] = []
        self._others: list[QLabel] = []
        self._row.addWidget(self.up)
        self._row.addStretch(1)
        level.opened.connect(self._fill)
        level.changed.connect(self._fill)
        level.session.state_changed.connect(self._fill)
        self._shown: tuple[str, ...] | None = None
        self.setBackgroundRole(RAISED)
        self.setAutoFillBackground(True)
        self._fill()

    def _fill(self, *_: object) -> None:
        document = self._level.session.document
        name = document.network.name or (document.path.stem if document.path else "network")
        path = self._level.path
        self.setVisible(bool(path))
        if self._shown == (name, *path):
            return
        self._shown = (name, *path)
        for widget in (*self.steps, *self._others):
            self._row.removeWidget(widget)
            widget.hide()
            widget.deleteLater()
        self.steps, self._others = [], []
        for depth, text in enumerate((name, *path)):
            if depth:
                self._put(self._label(_BETWEEN))
            button = self._button(f"crumb.{depth}", text, f"Show the nodes of {text}")
            button.setEnabled(depth < len(path))
            button.clicked.connect(partial(self._go, path[:depth]))
            self.steps.append(button)
            self._put(button)
        for widget in (*self.steps, *self._others):
            widget.show()
        self._row.activate()
        self.resize(self.sizeHint())
        self.raise_()

    def _go(self, path: tuple[str, ...], *_: object) -> None:
        self._level.go_to(path)

    def _put(self, widget: QWidget) -> None:
        self._row.insertWidget(self._row.count() - 1, widget)

    def _label(self, text: str) -> QLabel:
        label = QLabel(text, self)
        label.setForegroundRole(FAINT)
        self._others.append(label)
        return label

    def _button(self, name: str, text: str, about: str) -> QToolButton:
        button = labelled(QToolButton(self), name)
        button.setText(text.replace("&", "&&"))
        button.setAutoRaise(True)
        button.setAccessibleName(about)
        button.setToolTip(tip(about))
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        return button


# Editing a backdrop's title in its place.

_NARROWEST = 160
_ENDS = (Qt.Key.Key_Escape, Qt.Key.Key_Return, Qt.Key.Key_Enter)


class TitleEditor(QLineEdit):
    """A field over the title; Enter and leaving it take the text, Esc does not."""

    # (index, text): the backdrop of that place in the document's list gets this title
    edited = Signal(int, str)

    def __init__(self, view: GraphView) -> None:
        super().__init__(view.viewport())
        labelled(self, "canvas.title", "Title of the backdrop")
        self._view = view
        self._index: int | None = None
        self.hide()
        self.editingFinished.connect(self._take)
        self.installEventFilter(self)

    def edit(self, backdrop: BackdropItem) -> None:
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
        if self._index is not None:
            self._take()

    def dismiss(self) -> None:
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
