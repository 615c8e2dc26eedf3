"""What lies over the canvas: lists of choices, the way to a macro, and the title that is edited."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRect, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFocusEvent,
    QKeyEvent,
    QKeySequence,
    QPainter,
    QPaintEvent,
    QPalette,
)
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.editor.canvas.canvas_view import GraphView
from app.editor.canvas.node_item import BackdropItem
from app.editor.declared_text import tip
from app.editor.gestures import without_argument
from app.editor.session import Level
from app.editor.theme import FAINT, RAISED
from app.editor.widgets import RIGHT, filled, labelled

_ROLE = Qt.ItemDataRole.UserRole
_ROWS = 9
_NARROW, _WIDE = 44, 76  # letters
_PADDING = 7


@dataclass(frozen=True)
class Choice:
    """An entry of the list: what is shown, and what is chosen by it.

    `detail` stands beside it, fainter; `words` it is also searched by, and `further` ones only if
    no choice matches without them; `colour` is that of the mark before it.
    """

    text: str
    value: Any
    detail: str = ""
    words: str = ""
    further: str = ""
    colour: str = ""
    tip: str = ""


def matching(choices: Sequence[Choice], typed: str) -> list[Choice]:
    """Choices with every word, first those that begin so; else those with the further words."""
    words = typed.casefold().split()
    matches = [choice for choice in choices if _matches(choice, words)]
    if not matches:
        return [choice for choice in choices if _matches(choice, words, choice.further)]
    first = words[0] if words else ""
    return sorted(matches, key=lambda choice: _rank(choice, first)) if first else matches


def _matches(choice: Choice, words: Sequence[str], further: str = "") -> bool:
    text = f"{choice.text} {choice.detail} {choice.words} {further}".casefold()
    return all(word in text for word in words)


def _rank(choice: Choice, word: str) -> int:
    text = choice.text.casefold()
    if text.startswith(word):
        return 0
    if any(part.startswith(word) for part in text.split()):
        return 1
    return 2 if word in text or word in choice.words.casefold() else 3


class ChoicePopup(QFrame):
    chosen = Signal(object)  # (value): an entry was chosen; the popup has closed
    abandoned = Signal()  # it was closed by Esc, or because the focus went elsewhere

    passed_on = QKeySequence("Ctrl+Q")
    """Keys that mean what they mean everywhere: whatever is searched, one can quit."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._ground = parent
        self.setObjectName("canvas.popup")
        self.setAutoFillBackground(True)
        self.setBackgroundRole(QPalette.ColorRole.Window)  # a view's children take its own
        self.title = labelled(QLabel(), "canvas.popup.title")
        self.field = labelled(QLineEdit(placeholderText="Type to search"), "canvas.popup.field")
        self.field.setClearButtonEnabled(True)
        self.list = labelled(QListWidget(), "canvas.popup.list")
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        # A click beside the field would otherwise give the focus to what lies below.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setFocusProxy(self.field)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setUniformItemSizes(True)
        self.list.setItemDelegate(_Row(self.list))
        parts, margins = (self.title, self.field, self.list), (_PADDING,) * 4
        self._layout = filled(QVBoxLayout(self), *parts, margins=margins, spacing=4)
        self._choices: tuple[Choice, ...] = ()
        self.is_open = False
        self.field.textChanged.connect(self._filter)
        self.field.installEventFilter(self)
        self.list.itemClicked.connect(self._choose_item)
        self.hide()

    def open_at(self, pos: QPoint, title: str, choices: Sequence[Choice]) -> None:
        """Show the choices near a point of the parent; another list that is open is abandoned."""
        self.abandon()
        self._choices = tuple(choices)
        self.is_open = True
        self.title.setText(title)
        self.field.setAccessibleName(title)
        self.list.setAccessibleName(title)
        self.field.clear()
        self._filter("")
        self.setGeometry(self._place(pos))
        self.show()
        self.raise_()
        self.field.setFocus(Qt.FocusReason.PopupFocusReason)

    def abandon(self) -> None:
        if self._close():
            self.abandoned.emit()

    def dismiss(self) -> None:
        """Close without a signal: what it was opened for is gone."""
        self._close()

    def choose(self) -> None:
        item = self.list.currentItem()
        if item is not None:
            self._choose_item(item)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self.field and self.is_open:
            if isinstance(event, QKeyEvent) and event.type() in _KEYS:
                if event.type() == QEvent.Type.ShortcutOverride:
                    if QKeySequence(event.keyCombination()) == self.passed_on:
                        return False
                    event.accept()  # the window's other shortcuts do not reach in here
                    return True
                return self._key(event)
            if isinstance(event, QFocusEvent) and event.type() == QEvent.Type.FocusOut:
                left = event.reason()
                if left not in (_WINDOW_LEFT, Qt.FocusReason.PopupFocusReason):
                    self.abandon()
        return bool(super().eventFilter(watched, event))

    def _key(self, event: QKeyEvent) -> bool:
        key = event.key()
        step = {Qt.Key.Key_Down: 1, Qt.Key.Key_Up: -1, Qt.Key.Key_Tab: 1, Qt.Key.Key_Backtab: -1}
        page = {Qt.Key.Key_PageDown: _ROWS, Qt.Key.Key_PageUp: -_ROWS}
        if key == Qt.Key.Key_Escape:
            self.abandon()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.choose()
        elif key in step or key in page:
            last = self.list.count() - 1
            row = self.list.currentRow() + (step.get(Qt.Key(key)) or page.get(Qt.Key(key), 0))
            self.list.setCurrentRow(min(max(row, 0), last))
        else:
            return False
        return True

    def _filter(self, typed: str) -> None:
        self.list.clear()
        for choice in matching(self._choices, typed):
            item = QListWidgetItem(choice.text)
            item.setData(_ROLE, choice)
            item.setToolTip(choice.tip)
            self.list.addItem(item)
        self.list.setCurrentRow(0)

    def _choose_item(self, item: QListWidgetItem) -> None:
        choice = item.data(_ROLE)
        if self._close():
            self.chosen.emit(choice.value)

    def _close(self) -> bool:
        was, self.is_open = self.is_open, False
        if was:
            held = self.field.hasFocus()
            self._choices = ()
            self.hide()
            if held:
                self._ground.setFocus(Qt.FocusReason.PopupFocusReason)
        return was

    def _place(self, pos: QPoint) -> QRect:
        room = self._ground.rect().adjusted(4, 4, -4, -4)
        row = max(self.list.sizeHintForRow(0), 1)
        others = self._layout.totalSizeHint().height() - self.list.height()
        spare = room.height() - others - 2 * self.list.frameWidth()
        rows = max(min(len(self._choices), _ROWS, spare // row), 1)
        self.list.setFixedHeight(rows * row + 2 * self.list.frameWidth())
        self._layout.activate()
        width = min(self._wide() + 2 * _PADDING, room.width())
        place = QRect(pos, QSize(width, self._layout.totalSizeHint().height()))
        place.moveRight(min(place.right(), room.right()))
        place.moveBottom(min(place.bottom(), room.bottom()))
        place.moveLeft(max(place.left(), room.left()))
        place.moveTop(max(place.top(), room.top()))
        return place

    def _wide(self) -> int:
        metrics = self.fontMetrics()
        letters = [len(choice.text) + len(choice.detail) + 8 for choice in self._choices]
        return min(max([_NARROW, *letters]), _WIDE) * metrics.averageCharWidth()

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        painter = QPainter(self)
        painter.setPen(self.palette().color(QPalette.ColorRole.Mid))
        painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()


class _Row(QStyledItemDelegate):
    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Any) -> None:
        choice: Choice = index.data(_ROLE)
        metrics = option.fontMetrics
        mark = metrics.height() // 2
        detail = metrics.horizontalAdvance(choice.detail)
        painter.save()
        palette = option.palette
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        if chosen:
            painter.fillRect(option.rect, palette.highlight())
        text_colour = palette.highlightedText() if chosen else palette.text()
        rect = option.rect.adjusted(6, 0, -6, 0)
        if choice.colour:
            box = QRect(rect.left(), rect.center().y() - mark // 2, mark, mark)
            painter.fillRect(box, QColor(choice.colour))
        painter.setPen(text_colour.color())
        left = rect.adjusted(mark + 6, 0, 0, 0)
        room = left.width() - (detail + 12 if detail < left.width() // 2 else 0)
        text = metrics.elidedText(choice.text, Qt.TextElideMode.ElideRight, room)
        painter.drawText(left, Qt.AlignmentFlag.AlignVCenter, text)
        if detail < left.width() // 2:
            faint = palette.placeholderText().color()
            painter.setPen(text_colour.color() if chosen else faint)
            painter.drawText(rect, RIGHT, choice.detail)
        painter.restore()

    def sizeHint(self, option: QStyleOptionViewItem, _index: Any) -> QSize:
        return QSize(0, option.fontMetrics.height() + 6)


_WINDOW_LEFT = Qt.FocusReason.ActiveWindowFocusReason
_KEYS = (QEvent.Type.KeyPress, QEvent.Type.ShortcutOverride)


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
            going = partial(self._level.go_to, path[:depth])
            button.clicked.connect(partial(without_argument, going))
            self.steps.append(button)
            self._put(button)
        for widget in (*self.steps, *self._others):
            widget.show()
        self._row.activate()
        self.resize(self.sizeHint())
        self.raise_()

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
