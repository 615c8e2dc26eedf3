"""The page of all shortcuts, made from the actions themselves, with a search."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from PySide6.QtCore import QEvent, QKeyCombination, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QHeaderView,
    QLineEdit,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.editor.widgets import centred_hint, filled, named
from app.editor.window.actions import ACTIONS, Actions

_KEY = Qt.Key
_NATIVE = QKeySequence.SequenceFormat.NativeText
_PORTABLE = QKeySequence.SequenceFormat.PortableText
_MODIFIERS = (_KEY.Key_Control, _KEY.Key_Shift, _KEY.Key_Alt, _KEY.Key_Meta, _KEY.Key_AltGr)
_ARROWS = ("Left", "Right", "Up", "Down")

OR = "  or  "


class ShortcutRow(NamedTuple):
    """A line of the list as shown, and its key combinations as ``Ctrl+S``; none of the mouse's."""

    menu: str
    action: str
    keys: str
    meaning: str
    sequences: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        return " ".join(self[:4]).casefold()


# What keys do on the canvas without being an action.
CANVAS = (
    ShortcutRow(
        "Canvas", "Move the selection", "arrow keys", "Shift: by one unit; backdrop: its size",
        (*_ARROWS, *(f"Shift+{arrow}" for arrow in _ARROWS)),
    ),
    ShortcutRow(
        "Canvas", "Go to the next node", "Ctrl with arrow keys", "Shift: add it to the selection",
        (*(f"Ctrl+{arrow}" for arrow in _ARROWS), *(f"Ctrl+Shift+{arrow}" for arrow in _ARROWS)),
    ),
    ShortcutRow(
        "Canvas", "Open", "Return", "The panel of the selected node, or a backdrop's title",
        ("Return", "Enter"),
    ),
)  # fmt: skip
# What the mouse does has no action to be read from.
MOUSE = (
    ("Pan", "middle button", "Drag the canvas"),
    ("Zoom", "wheel", "Zoom at the pointer"),
    ("Add", "double-click", "Search for a module and add it there"),
    ("Wire", "drag from a port", "On empty canvas: list the modules that fit"),
    ("View", "Ctrl+Shift and click", "Show the node in viewer 1"),
    ("Insert", "drop a node on a wire", "Insert the node into the wire"),
    ("Bend a wire", "double-click on it", "Add a dot; drag it, Del deletes it"),
    ("Cut wires", "Alt+Shift and drag", "Disconnect the wires that the line crosses"),
    ("Open", "drop a file", "A picture becomes a Read Image, a network is opened"),
    ("Region", "⬚, or R on a picture", "Draw the region of the selected module"),
    (
        "Move a region",
        "drag, or arrow keys",
        "Shift: by 10 samples; Ctrl: its last corner; Esc: undo",
    ),
    ("Move a wipe", "drag, or Ctrl+arrow", "Between A and B, or two wires; Shift: larger steps"),
    ("Show another band", "drag its line, or PgUp", "In a picture with bands; PgDown: back"),
    ("Default", "right-click on a value", "Reset it to its default"),
)


class ShortcutList(QDialog):
    def __init__(self, actions: Actions, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("shortcuts")
        self.setWindowTitle("Shortcuts")
        self._rows = [
            *shortcuts_of(actions),
            *CANVAS,
            *(ShortcutRow("Mouse", *row) for row in MOUSE),
        ]
        self.search = named(QLineEdit(self), "shortcuts.search", "Search the shortcuts")
        self.search.setPlaceholderText("Name of an action, or its keys")
        self.search.setToolTip("Name of an action, or its keys; Down goes to the list")
        self.search.setClearButtonEnabled(True)
        self.catcher = KeyCatcher(self)
        self.table = _table(self)
        self.none = named(centred_hint("", self), "shortcuts.none")
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        for button in buttons.buttons():
            if isinstance(button, QPushButton):
                button.setAutoDefault(False)  # Enter in the search closes nothing
                button.setDefault(False)
        above = filled(QHBoxLayout(), (self.search, 1), self.catcher, margins=None)
        filled(QVBoxLayout(self), above, (self.table, 1), (self.none, 1), buttons, margins=None)
        self.search.textEdited.connect(self._search)
        self.search.textChanged.connect(self._cleared)
        self.catcher.pressed_keys.connect(self._search_keys)
        metrics = self.fontMetrics()
        self.resize(metrics.averageCharWidth() * 110, metrics.height() * 28)
        self._show(self._rows, "")
        self.table.resizeColumnsToContents()
        self.table.horizontalHeader().setSectionResizeMode(3, QHeaderView.ResizeMode.Stretch)
        self.search.setFocus(Qt.FocusReason.OtherFocusReason)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == _KEY.Key_Down and self.search.hasFocus() and self.table.rowCount():
            self.table.setFocus(Qt.FocusReason.TabFocusReason)
            self.table.selectRow(0)
            event.accept()
        elif event.key() not in (_KEY.Key_Return, _KEY.Key_Enter):
            super().keyPressEvent(event)

    def _search(self, text: str) -> None:
        self._show(rows_for(self._rows, text), f"No shortcut has “{text}”")

    def _cleared(self, text: str) -> None:
        if not text:
            self._show(self._rows, "")

    def _search_keys(self, pressed: tuple[str, ...]) -> None:
        rows = rows_of_keys(self._rows, pressed)
        native = QKeySequence(pressed[0]).toString(_NATIVE)
        self.search.setText(native)
        self._show(rows, f"Nothing has the keys {native}")
        self.search.setFocus(Qt.FocusReason.OtherFocusReason)
        self.search.selectAll()

    def _show(self, rows: list[ShortcutRow], none: str) -> None:
        before = ""
        self.table.setRowCount(len(rows))
        for number, row in enumerate(rows):
            menu = row.menu if row.menu != before else ""
            before = row.menu
            for column, text in enumerate((menu, row.action, row.keys, row.meaning)):
                self.table.setItem(number, column, QTableWidgetItem(text))
        self.table.setVisible(bool(rows))
        self.none.setVisible(not rows)
        self.none.setText(none)


class KeyCatcher(QPushButton):
    """A button after which the next key combination is taken as such: it does nothing else."""

    # (sequences): A tuple of texts: the combination, and what it is called where Shift
    # belongs to the letter
    pressed_keys = Signal(tuple)

    def __init__(self, parent: QWidget) -> None:
        super().__init__("Press a &Key", parent)
        self.setObjectName("shortcuts.press")
        self.setAccessibleName("Press a key combination to see what it does")
        self.setToolTip("Then press a key combination: the list shows what it does")
        self.setAutoDefault(False)
        self.setCheckable(True)
        self.toggled.connect(self._say)

    def sizeHint(self) -> QSize:
        hint = super().sizeHint()
        return hint.expandedTo(QSize(self.fontMetrics().averageCharWidth() * 22, hint.height()))

    def event(self, event: QEvent) -> bool:
        """Take every key before shortcuts, and before Tab moves the focus."""
        if not self.isChecked() or not isinstance(event, QKeyEvent):
            if event.type() == QEvent.Type.FocusOut:
                self.setChecked(False)
            return super().event(event)
        if event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        if event.type() == QEvent.Type.KeyPress and event.key() not in _MODIFIERS:
            self.setChecked(False)
            self.pressed_keys.emit(_pressed(event))
        event.accept()
        return True

    def _say(self, on: bool) -> None:
        self.setText("Now press the keys…" if on else "Press a &Key")
        if on:
            self.setFocus(Qt.FocusReason.OtherFocusReason)


def _pressed(event: QKeyEvent) -> tuple[str, ...]:
    key, keys = _KEY(event.key()), event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
    shift = Qt.KeyboardModifier.ShiftModifier
    if key == _KEY.Key_Backtab:
        key, keys = _KEY.Key_Tab, keys | shift
    ways = [keys]
    text = event.text().strip()
    if keys & shift and text and text.isprintable() and not text.isalnum():
        ways.insert(0, keys & ~shift)  # of ? and + Shift is only how they are typed
    return tuple(QKeySequence(QKeyCombination(way, key)).toString(_PORTABLE) for way in ways)


def shortcuts_of(actions: Actions) -> list[ShortcutRow]:
    rows = []
    for spec in ACTIONS:
        action = actions[spec.name]
        keys = action.shortcuts()
        if keys:
            native = OR.join(key.toString(_NATIVE) for key in keys)
            sequences = tuple(key.toString(_PORTABLE) for key in keys)
            text, menu = action.text().replace("&", "").rstrip("…"), spec.menu.replace("&", "")
            rows.append(ShortcutRow(menu, text, native, action.toolTip(), sequences))
    return rows


def _table(parent: QWidget) -> QTableWidget:
    table = named(QTableWidget(0, 4, parent), "shortcuts.table", "Shortcuts")
    table.setHorizontalHeaderLabels(["", "Action", "Keys", "What it does"])
    table.verticalHeader().hide()
    table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
    table.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
    table.setSelectionMode(QTableWidget.SelectionMode.SingleSelection)
    table.setShowGrid(False)
    table.setAlternatingRowColors(True)
    table.setTabKeyNavigation(False)
    return table


# Which rows a search finds: by words of the action, by the text of keys, by keys pressed.


def rows_for(rows: Sequence[ShortcutRow], text: str) -> list[ShortcutRow]:
    """The rows that have every word of a text, first those whose keys or action it is."""
    whole, words = text.casefold().strip(), text.casefold().split()

    def rank(row: ShortcutRow) -> int:
        if "".join(words) in [one.casefold() for one in row.sequences]:
            return 0
        return 1 if row.action.casefold().startswith(whole) else 2

    having = [row for row in rows if all(word in row.text for word in words) or not rank(row)]
    return sorted(having, key=rank) if words else having


def rows_of_keys(rows: Sequence[ShortcutRow], pressed: Sequence[str]) -> list[ShortcutRow]:
    wanted = {one.casefold() for one in pressed}
    return [row for row in rows if wanted & {one.casefold() for one in row.sequences}]
