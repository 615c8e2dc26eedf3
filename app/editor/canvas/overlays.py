"""What lies over the canvas: lists of choices, the way to a macro, and the title that is edited."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFocusEvent, QKeyEvent, QKeySequence, QPainter, QPalette
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
from app.editor.panels.fields.type_in import TypeIn
from app.editor.session import Level
from app.editor.theme import FAINT, RAISED
from app.editor.widgets import RIGHT, filled, labelled, plain_label, tool_button
from core.records import dataclass

_ROLE = Qt.ItemDataRole.UserRole
_ROWS = 9
_NARROW, _WIDE = 44, 76  # letters
_PADDING = 7


@dataclass(frozen=True)
class Choice:
    """An entry of the list: what is shown, and what is chosen by it.

    `detail` stands beside it, fainter; `words` it is also searched by, and `further` ones only if
    no choice matches without them; `colour` is that of the mark before it. A `remote` one is only
    offered if no other has the words.
    """

    text: str
    value: Any
    detail: str = ""
    words: str = ""
    further: str = ""
    colour: str = ""
    tip: str = ""
    remote: bool = False


def matching(choices: Sequence[Choice], typed: str) -> list[Choice]:
    """Choices with every word, first those that begin so; else remote ones, or by further words."""
    words = typed.casefold().split()

    def fits(choice: Choice, further: str = "") -> bool:
        text = f"{choice.text} {choice.detail} {choice.words} {further}".casefold()
        return all(word in text for word in words)

    def rank(choice: Choice) -> int:
        text, word = choice.text.casefold(), words[0]
        begins = text.startswith(word), any(part.startswith(word) for part in text.split())
        return next((n for n, met in enumerate((*begins, word in text)) if met), 3)

    near, remote = ([one for one in choices if one.remote == far] for far in (False, True))
    if not words:
        return near
    for group in (near, remote):
        if matches := [choice for choice in group if fits(choice)]:
            return sorted(matches, key=rank)
    return [choice for choice in near if fits(choice, choice.further)]


class ChoicePopup(QFrame):
    chosen = Signal(object)  # (value): an entry was chosen; the popup has closed
    abandoned = Signal()  # it was closed by Esc, or because the focus went elsewhere

    passed_on = QKeySequence("Ctrl+Q")
    """Keys that mean what they mean everywhere: whatever is searched, one can quit."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._ground = parent
        self.setObjectName("canvas.popup")
        self.setFrameShape(QFrame.Shape.StyledPanel)
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
        if self.dismiss():
            self.abandoned.emit()

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
        key = Qt.Key(event.key())
        if key == Qt.Key.Key_Escape:
            self.abandon()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.choose()
        elif key in _STEPS:
            row = self.list.currentRow() + _STEPS[key]
            self.list.setCurrentRow(min(max(row, 0), self.list.count() - 1))
        else:
            return False
        return True

    def _filter(self, typed: str) -> None:
        self.list.clear()
        for choice in matching(self._choices, typed):
            item = QListWidgetItem(choice.text)
            item.setData(_ROLE, choice)
            item.setToolTip(choice.tip)
            if choice.colour:
                item.setData(Qt.ItemDataRole.DecorationRole, QColor(choice.colour))
            self.list.addItem(item)
        self.list.setCurrentRow(0)

    def _choose_item(self, item: QListWidgetItem) -> None:
        choice = item.data(_ROLE)
        if self.dismiss():
            self.chosen.emit(choice.value)

    def dismiss(self) -> bool:
        """Close without a signal; whether it was open."""
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
        letters = [len(choice.text) + len(choice.detail) + 8 for choice in self._choices]
        wide = min(max([_NARROW, *letters]), _WIDE) * self.fontMetrics().averageCharWidth()
        size = QSize(wide + 2 * _PADDING, self._layout.totalSizeHint().height())
        place = QRect(pos, size.boundedTo(room.size()))
        place.moveRight(min(place.right(), room.right()))
        place.moveBottom(min(place.bottom(), room.bottom()))
        return place


class _Row(QStyledItemDelegate):
    """An entry with its detail at the right, if there is room."""

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Any) -> None:
        super().paint(painter, option, index)
        choice: Choice = index.data(_ROLE)
        room = option.rect.adjusted(0, 0, -6, 0)
        wide = option.fontMetrics.horizontalAdvance(f"MMM{choice.text}{choice.detail}")
        if wide < room.width():
            chosen = option.state & QStyle.StateFlag.State_Selected
            role = QPalette.ColorRole.HighlightedText if chosen else FAINT
            painter.setPen(option.palette.color(role))
            painter.drawText(room, RIGHT, choice.detail)


_WINDOW_LEFT = Qt.FocusReason.ActiveWindowFocusReason
_KEYS = (QEvent.Type.KeyPress, QEvent.Type.ShortcutOverride)
_STEPS = {
    Qt.Key.Key_Down: 1,
    Qt.Key.Key_Tab: 1,
    Qt.Key.Key_Up: -1,
    Qt.Key.Key_Backtab: -1,
    Qt.Key.Key_PageDown: _ROWS,
    Qt.Key.Key_PageUp: -_ROWS,
}


class Crumbs(QWidget):
    """Buttons for the network and each macro on the way, and one that leads back by one."""

    def __init__(self, level: Level, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "crumbs", "path to the open macro")
        self._level = level
        self._row = filled(QHBoxLayout(self), margins=(4, 2, 4, 2), spacing=2)
        about = "Leave this macro and show the network around it (Alt+PgUp)"
        self.up = self._button("crumbs.up", "↑ Up", about)
        self.up.clicked.connect(level.leave)
        self._row.addWidget(self.up)
        self.steps: list[QToolButton] = []
        self._shown: list[QWidget] = []
        self._names: tuple[str, ...] = ()
        for signal in (level.opened, level.changed, level.session.state_changed):
            signal.connect(self._fill)
        self.setBackgroundRole(RAISED)
        self.setAutoFillBackground(True)
        self._fill()

    def _fill(self, *_: object) -> None:
        document, path = self._level.session.document, self._level.path
        name = document.network.name or (document.path.stem if document.path else "network")
        self.setVisible(bool(path))
        if (name, *path) == self._names:  # as after most edits
            return
        self._names = (name, *path)
        for old in self._shown:
            self._row.removeWidget(old)
            old.hide()
            old.deleteLater()
        self._shown = []
        self.steps = []
        for depth, text in enumerate((name, *path)):
            if depth:
                self._shown.append(plain_label("", self, "›", role=FAINT))
            button = self._button(f"crumb.{depth}", text, f"Show the nodes of {text}")
            button.setEnabled(depth < len(path))
            going = partial(self._level.go_to, path[:depth])
            button.clicked.connect(partial(without_argument, going))
            self.steps.append(button)
            self._shown.append(button)
        for widget in self._shown:
            self._row.addWidget(widget)
            widget.show()
        self._row.activate()
        self.resize(self.sizeHint())
        self.raise_()

    def _button(self, name: str, text: str, about: str) -> QToolButton:
        button = tool_button(name, text.replace("&", "&&"), about, self)
        button.setAutoRaise(True)
        button.setToolTip(tip(about))
        return button


_NARROWEST = 160


class TitleEditor(TypeIn):
    """A field over a backdrop's title; Enter and leaving it take the text, Esc does not."""

    # (index, text): the backdrop of that place in the document's list gets this title
    edited = Signal(int, str)

    def __init__(self, view: GraphView) -> None:
        super().__init__(view.viewport())
        self._view = view
        self._index: int | None = None
        self.hide()
        self.editingFinished.connect(self.finish)
        self.given_up.connect(self.dismiss)

    def edit(self, backdrop: BackdropItem) -> None:
        head, view = backdrop.head(self._view.zoom), self._view
        place = QRect(view.pixel(head.topLeft()), view.pixel(head.bottomRight()))
        line = self.sizeHint().height()
        place.setWidth(max(place.width(), _NARROWEST))
        place.setHeight(line if backdrop.shown.note else max(place.height(), line))
        self.setGeometry(place)
        self._index = backdrop.index
        about = "Text of the note" if backdrop.shown.note else "Title of the backdrop"
        labelled(self, "canvas.title", about)
        self.show_text(backdrop.title)
        self.setModified(True)  # so that Esc is its own, and no shortcut
        self.selectAll()
        self.show()
        self.raise_()
        self.setFocus(Qt.FocusReason.PopupFocusReason)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        super().keyPressEvent(event)
        event.accept()  # no key is also the canvas's

    def finish(self) -> None:
        index = self._index
        self.dismiss()
        if index is not None:
            self.edited.emit(index, self.text().strip())

    def dismiss(self) -> None:
        self._index = None
        if self.isVisible():
            self.hide()
            self._view.setFocus(Qt.FocusReason.PopupFocusReason)
