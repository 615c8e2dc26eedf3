"""What several parts of the window share: buttons, labels, layouts, tables, drops."""

import math
import time
from collections.abc import Callable, Collection, Sequence
from typing import Any, TypeVar

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QEvent, QMimeData, QPoint, QRect, QSize, Qt, Signal

LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
W = TypeVar("W", bound=QtWidgets.QWidget)
L = TypeVar("L", bound=QtWidgets.QLayout)
B = TypeVar("B", bound=QtWidgets.QToolButton)
Act = Callable[[], object]


class Toggle(QtWidgets.QToolButton):
    def initStyleOption(self, option: QtWidgets.QStyleOptionToolButton) -> None:
        super().initStyleOption(option)
        if self.isChecked():
            palette, role = QtGui.QPalette(option.palette), QtGui.QPalette.ColorRole
            palette.setColor(role.Button, palette.color(role.Highlight))
            palette.setColor(role.ButtonText, palette.color(role.HighlightedText))
            option.palette = palette


class Radio(QtWidgets.QRadioButton):
    def paintEvent(self, event: QtGui.QPaintEvent) -> None:
        super().paintEvent(event)
        _outline(self, QtWidgets.QStyle.SubElement.SE_RadioButtonIndicator, round_=True)


class Check(QtWidgets.QCheckBox):
    """A check box with a frame round its indicator, its text in the foreground's role."""

    def initStyleOption(self, option: QtWidgets.QStyleOptionButton) -> None:
        super().initStyleOption(option)
        palette = QtGui.QPalette(option.palette)
        ink = palette.color(self.foregroundRole())
        palette.setColor(QtGui.QPalette.ColorRole.WindowText, ink)
        option.palette = palette

    def paintEvent(self, event: QtGui.QPaintEvent) -> None:
        super().paintEvent(event)
        _outline(self, QtWidgets.QStyle.SubElement.SE_CheckBoxIndicator, round_=False)


class OutlinedItems(QtWidgets.QStyledItemDelegate):
    """Items of a list with a frame round the box to tick."""

    def paint(
        self, painter: QtGui.QPainter, option: QtWidgets.QStyleOptionViewItem, index: Any
    ) -> None:
        super().paint(painter, option, index)
        item = QtWidgets.QStyleOptionViewItem(option)
        self.initStyleOption(item, index)
        widget: QtWidgets.QWidget = item.widget
        box = QtWidgets.QStyle.SubElement.SE_ItemViewItemCheckIndicator
        rect = widget.style().subElementRect(box, item, widget)
        painter.save()
        painter.setPen(
            QtGui.QPen(widget.palette().color(QtGui.QPalette.ColorRole.PlaceholderText), 1)
        )
        painter.drawRect(rect.adjusted(0, 0, -1, -1))
        painter.restore()


def _outline(
    button: QtWidgets.QAbstractButton, element: QtWidgets.QStyle.SubElement, *, round_: bool
) -> None:
    option = QtWidgets.QStyleOptionButton()
    option.initFrom(button)
    rect = button.style().subElementRect(element, option, button)
    painter = QtGui.QPainter(button)
    painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
    painter.setPen(QtGui.QPen(button.palette().color(QtGui.QPalette.ColorRole.PlaceholderText), 1))
    if round_:
        painter.drawEllipse(rect.adjusted(1, 1, -1, -1))
    else:
        painter.drawRect(rect.adjusted(0, 0, -1, -1))
    painter.end()


def labelled(widget: W, name: str, about: str = "", tip: str = "") -> W:
    """Give a widget the name that tests find, and its words for screen readers and the tooltip."""
    widget.setObjectName(name)
    if about:  # else it keeps what it calls itself
        widget.setAccessibleName(about)
    if tip:
        widget.setToolTip(tip)
    return widget


def filled(
    layout: L,
    *parts: QtWidgets.QWidget
    | QtWidgets.QLayout
    | tuple[QtWidgets.QWidget | QtWidgets.QLayout, int]
    | None,
    margins: tuple[int, int, int, int] | None = (0, 0, 0, 0),
    spacing: int | None = None,
) -> L:
    """Put parts into a layout: a part with its stretch for one that grows, None for free room."""
    box: Any = layout
    if margins is not None:
        box.setContentsMargins(*margins)
    if spacing is not None:
        box.setSpacing(spacing)
    for part in parts:
        one, *stretch = part if isinstance(part, tuple) else (part,)
        if one is None:
            box.addStretch(1)
        elif isinstance(one, QtWidgets.QWidget):
            box.addWidget(one, *stretch)
        else:
            box.addLayout(one, *stretch)
    return layout


def tool_button(
    name: str, text: str, description: str, parent: QtWidgets.QWidget, act: Act | None = None
) -> QtWidgets.QToolButton:
    """A button that the keyboard reaches."""
    return _worded(QtWidgets.QToolButton(parent), name, text, description, act)


def toggle_button(name: str, text: str, description: str, parent: QtWidgets.QWidget) -> Toggle:
    return _worded(Toggle(parent, checkable=True), name, text, description, None)


def _worded(button: B, name: str, text: str, description: str, act: Act | None) -> B:
    button.setText(text)
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    if act is not None:
        button.clicked.connect(lambda *_: act())  # without whether it is checked
    return labelled(button, name, description, description)


def search_field(
    name: str, about: str, hint: str, parent: QtWidgets.QWidget | None = None
) -> QtWidgets.QLineEdit:
    """A line to search by, with a button that clears it."""
    field = QtWidgets.QLineEdit(parent, placeholderText=hint, clearButtonEnabled=True)
    return labelled(field, name, about)


_TYPING = Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.KeypadModifier


class Menu(QtWidgets.QMenu):
    """A menu that has all letters while it is open, those that are shortcuts elsewhere too."""

    def event(self, event: QEvent) -> bool:
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QtGui.QKeyEvent)
            and not event.modifiers() & ~_TYPING  # Ctrl+Q still quits
        ):
            event.accept()
            return True
        return super().event(event)


def menu_button(
    name: str, text: str, description: str, parent: QtWidgets.QWidget
) -> QtWidgets.QToolButton:
    button = tool_button(name, text, description, parent)
    button.setPopupMode(QtWidgets.QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setMenu(Menu(button))
    return button


def offer(
    menu: QtWidgets.QWidget, name: str, text: str, act: Act, *, about: str = ""
) -> QtGui.QAction:
    """An entry of a menu, or of a widget whose actions are its menu."""
    action = menu.addAction(text.replace("&", "&&"))
    action.setObjectName(name)
    if about:
        action.setToolTip(about)
    action.triggered.connect(lambda *_: act())  # without whether it is checked
    return action


def line_in_menu(
    menu: QtWidgets.QMenu, text: str, name: str
) -> tuple[QtWidgets.QLineEdit, QtWidgets.QWidgetAction]:
    """A line to type in that can be added to a menu, with a label of that text before it."""
    line = QtWidgets.QWidget(menu)
    label, edit = QtWidgets.QLabel(text, line), QtWidgets.QLineEdit(line)
    edit.setObjectName(name)
    label.setBuddy(edit)
    filled(QtWidgets.QHBoxLayout(line), label, (edit, 1), margins=(12, 2, 12, 2))
    line.setFocusProxy(edit)
    action = QtWidgets.QWidgetAction(menu)
    action.setDefaultWidget(line)
    return edit, action


class FlowLayout(QtWidgets.QLayout):
    """Places its widgets from left to right, and continues below where the line ends."""

    def __init__(
        self, parent: QtWidgets.QWidget | None = None, *, across: int = 6, down: int = 4
    ) -> None:
        super().__init__(parent)
        self._items: list[QtWidgets.QLayoutItem] = []
        self._across, self._down = across, down

    def addItem(self, item: QtWidgets.QLayoutItem) -> None:
        self._items.append(item)

    def count(self) -> int:
        return len(self._items)

    def itemAt(self, index: int) -> QtWidgets.QLayoutItem | None:
        return self._items[index] if 0 <= index < len(self._items) else None

    def takeAt(self, index: int) -> QtWidgets.QLayoutItem | None:
        return self._items.pop(index) if 0 <= index < len(self._items) else None

    def expandingDirections(self) -> Qt.Orientation:
        return Qt.Orientation(0)

    def hasHeightForWidth(self) -> bool:
        return True

    def heightForWidth(self, width: int) -> int:
        return self._place(QRect(0, 0, width, 0), really=False)

    def setGeometry(self, rect: QRect) -> None:
        super().setGeometry(rect)
        self._place(rect, really=True)

    def sizeHint(self) -> QSize:
        shown = [item for item in self._items if not item.isEmpty()]
        width = sum(item.sizeHint().width() for item in shown)
        width += self._across * max(0, len(shown) - 1)
        height = max((item.sizeHint().height() for item in shown), default=0)
        return QSize(width, height).grownBy(self.contentsMargins())

    def minimumSize(self) -> QSize:
        size = QSize()
        for item in self._items:
            size = size.expandedTo(item.minimumSize())
        return size.grownBy(self.contentsMargins())

    def _place(self, rect: QRect, *, really: bool) -> int:
        margins = self.contentsMargins()
        inside = rect.marginsRemoved(margins)
        x, y, line = inside.x(), inside.y(), 0
        for item in self._items:
            if item.isEmpty():
                continue
            size = item.sizeHint()
            if x > inside.x() and x + size.width() > inside.x() + inside.width():
                x, y, line = inside.x(), y + line + self._down, 0
            if really:
                item.setGeometry(QRect(QPoint(x, y), size))
            x += size.width() + self._across
            line = max(line, size.height())
        return y + line - rect.y() + margins.bottom()


class PageTabs(QtWidgets.QWidget):
    turned = Signal()  # another page is to be shown

    def __init__(self, pages: tuple[str, ...], parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "pages", "pages of the panel")
        self._pages = pages
        self._group = QtWidgets.QButtonGroup(self)
        self.buttons: list[Toggle] = []
        flow = FlowLayout(self, across=2, down=2)
        flow.setContentsMargins(0, 4, 0, 0)
        for number, page in enumerate(pages):
            button = labelled(Toggle(self, checkable=True), f"page.{page}")
            button.setText(page)
            button.setAccessibleName(f"page {page}")
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            self._group.addButton(button, number)
            self.buttons.append(button)
            flow.addWidget(button)
        if self.buttons:
            self.buttons[0].setChecked(True)
        self._group.idToggled.connect(self._toggled)

    @property
    def page(self) -> str:
        return self._pages[self._group.checkedId()] if self._pages else ""

    def offer(self, pages: Collection[str]) -> None:
        for page, button in zip(self._pages, self.buttons, strict=True):
            button.setVisible(page in pages)

    def _toggled(self, _number: int, on: bool) -> None:
        if on:
            self.turned.emit()


class ElidedLabel(QtWidgets.QLabel):
    """One line that may be narrower than its text.

    It keeps the text itself: a `QLabel` has the window laid out anew for each of its texts.
    """

    _line = ""
    _width = 0

    def __init__(
        self, name: str, description: str, parent: QtWidgets.QWidget | None = None
    ) -> None:
        super().__init__(parent)
        labelled(self, name, description)
        self.setSizePolicy(
            QtWidgets.QSizePolicy.Policy.Preferred, QtWidgets.QSizePolicy.Policy.Fixed
        )

    def text(self) -> str:
        return self._line

    def show_text(self, text: str, about: str = "") -> None:
        line = " ".join(text.split(" ")).replace("\n", " ")
        if line != self._line:
            self._line = line
            self.setAccessibleDescription(line)
            self._fit(self._width)
            self.update()
        if (about or line) != self.toolTip():
            self.setToolTip(about or line)

    def sizeHint(self) -> QSize:
        return QSize(self._width, self.fontMetrics().height()).grownBy(self.contentsMargins())

    def minimumSizeHint(self) -> QSize:
        hint = self.sizeHint()
        hint.setWidth(min(hint.width(), self.fontMetrics().averageCharWidth() * 4))
        return hint

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit(0)

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        painter = QtGui.QPainter(self)
        text = self.fontMetrics().elidedText(
            self._line, Qt.TextElideMode.ElideRight, self.contentsRect().width()
        )
        painter.setPen(self.palette().color(self.foregroundRole()))
        painter.drawText(self.contentsRect(), int(self.alignment()), text)
        painter.end()

    def _fit(self, had: int) -> None:
        """Keep the width there was, unless the text needs more, or less than half of it.

        After a change of a widget's size hint all around it is laid out anew, up to the window:
        2.5 ms for each answer of a drag.
        """
        needed = math.ceil(QtGui.QFontMetricsF(self.font()).horizontalAdvance(self._line))
        width = had if had // 2 <= needed <= had else needed
        if width != self._width:
            self._width = width
            self.updateGeometry()


def plain_label(
    name: str,
    parent: QtWidgets.QWidget,
    text: str = "",
    *,
    role: QtGui.QPalette.ColorRole = QtGui.QPalette.ColorRole.WindowText,
    bold: bool = False,
) -> QtWidgets.QLabel:
    """A text that is no markup and is broken into lines, in a colour of the palette."""
    label = labelled(
        QtWidgets.QLabel(text, parent, textFormat=Qt.TextFormat.PlainText, wordWrap=True), name
    )
    label.setForegroundRole(role)
    if bold:
        make_bold(label)
    return label


def set_role(widget: QtWidgets.QWidget, role: QtGui.QPalette.ColorRole) -> None:
    """Its colour; Qt would also lay it out and paint it anew where that is the one it has."""
    if widget.foregroundRole() != role:
        widget.setForegroundRole(role)


def make_bold(widget: QtWidgets.QWidget) -> None:
    font = widget.font()
    font.setBold(True)
    widget.setFont(font)


def show_or_hide(label: QtWidgets.QLabel, text: str) -> None:
    label.setText(text)
    label.setVisible(bool(text))


_HINT_LETTERS, _BESIDE = 72, 4  # of a line of a hint at most, and free beside it at least


class Hint(QtWidgets.QLabel):
    """What to do, in the middle of where nothing is shown yet, in lines that are easy to read."""

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        painter, letter = QtGui.QPainter(self), self.fontMetrics().averageCharWidth()
        side = max(_BESIDE * letter, (self.width() - _HINT_LETTERS * letter) // 2)
        painter.setPen(self.palette().color(self.foregroundRole()))
        flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
        painter.drawText(self.rect().adjusted(side, 0, -side, 0), flags, self.text())
        painter.end()


def centred_hint(text: str, parent: QtWidgets.QWidget) -> Hint:
    return Hint(text, parent, wordWrap=True)


class CopiedTable(QtWidgets.QTableWidget):
    """Whole rows that are only read, one column the widest; Ctrl+C copies the marked ones.

    Lines are broken anew when its width changes.
    """

    def __init__(
        self, heads: Sequence[str], parent: QtWidgets.QWidget | None = None, *, widest: int = 0
    ) -> None:
        super().__init__(0, len(heads), parent)
        self.setHorizontalHeaderLabels(list(heads))
        self.setEditTriggers(QtWidgets.QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QtWidgets.QAbstractItemView.SelectionBehavior.SelectRows)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.setWordWrap(True)
        self.verticalHeader().hide()
        self.verticalHeader().setMinimumSectionSize(self.fontMetrics().height() + 4)
        head = self.horizontalHeader()
        head.setSectionResizeMode(QtWidgets.QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(widest, QtWidgets.QHeaderView.ResizeMode.Stretch)
        head.setHighlightSections(False)

    def show_rows(self, rows: Sequence[Sequence[tuple[str, str]]], right: int = -1) -> None:
        """Rows of texts with their tooltips; one column's stand at its right end."""
        self.setRowCount(len(rows))
        for row, cells in enumerate(rows):
            for column, (text, about) in enumerate(cells):
                item = QtWidgets.QTableWidgetItem(text)
                item.setToolTip(about)
                item.setTextAlignment(RIGHT if column == right else LEFT)
                self.setItem(row, column, item)
        self.resizeRowsToContents()

    def cells(self, row: int) -> Sequence[str]:
        """The texts of a row that are copied; none of a heading."""
        items = (self.item(row, column) for column in range(self.columnCount()))
        return [item.text() for item in items if item is not None]

    def copy(self) -> None:
        marked = sorted({index.row() for index in self.selectedIndexes()})
        rows = [self.cells(row) for row in marked or range(self.rowCount())]
        QtGui.QGuiApplication.clipboard().setText("\n".join("\t".join(row) for row in rows if row))

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        if event.matches(QtGui.QKeySequence.StandardKey.Copy):
            self.copy()
        else:
            super().keyPressEvent(event)

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        super().resizeEvent(event)
        self.resizeRowsToContents()


PAUSE_S = 0.5
"""Turns of the wheel no further apart are one."""


class WheelScrollArea(QtWidgets.QScrollArea):
    """A scroll area in which a turn of the wheel that began as scrolling goes on as scrolling.

    A control that slides under the mouse meanwhile lets it pass, also if it has the focus.
    """

    _scrolled_at = float("-inf")

    @property
    def is_scrolling(self) -> bool:
        return time.monotonic() - self._scrolled_at < PAUSE_S

    def wheelEvent(self, event: QtGui.QWheelEvent) -> None:
        self._scrolled_at = time.monotonic()
        super().wheelEvent(event)


def takes_wheel(control: QtWidgets.QWidget) -> bool:
    """Whether the wheel is meant for a control: it has the focus, and nothing is scrolling."""
    if not control.hasFocus():
        return False
    above = control.parentWidget()
    while above is not None:
        if isinstance(above, WheelScrollArea) and above.is_scrolling:
            return False
        above = above.parentWidget()
    return True


_ACTIONS = (Qt.DropAction.CopyAction, Qt.DropAction.LinkAction)


def accept_copy(event: QtGui.QDropEvent) -> None:
    """Accept it as a copy, or a link; refuse what can only be moved.

    What is proposed is a move where a file manager would move on the same disk, and who proposes
    it may delete the file once it is taken.
    """
    for action in _ACTIONS:
        if event.possibleActions() & action:
            event.setDropAction(action)
            event.accept()
            return
    event.ignore()


def is_escape(event: QEvent) -> bool:
    """Whether Esc is pressed and may be kept from shortcuts: whoever accepts the event has it."""
    override = event.type() == QEvent.Type.ShortcutOverride
    return override and isinstance(event, QtGui.QKeyEvent) and event.key() == Qt.Key.Key_Escape


def local_files(data: QMimeData) -> list[str]:
    """Paths of the files of this machine that are dragged; none where other things are."""
    return [url.toLocalFile() for url in data.urls() if url.isLocalFile()]
