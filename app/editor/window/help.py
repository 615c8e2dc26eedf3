"""Shortcuts, modules' texts, about, and writing what a viewer shows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from PySide6.QtCore import (
    QByteArray,
    QEvent,
    QKeyCombination,
    QObject,
    QProcess,
    QSize,
    Qt,
    QTimer,
    QUrl,
    Signal,
)
from PySide6.QtGui import QDesktopServices, QHideEvent, QKeyEvent, QKeySequence, QTextDocument
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QHeaderView,
    QLineEdit,
    QMessageBox,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import flowing, label_of
from app.editor.dialogs import SaveDialog, show_beside
from app.editor.docks.background_work import MeasureWorker
from app.editor.docks.run_queue import python_environment
from app.editor.docks.tradeoff_view import TradeOffView
from app.editor.session import Session
from app.editor.theme import TEXT
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot import plot_export
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.widgets import centred_hint, filled, labelled
from app.editor.window.actions import ACTIONS, Actions, default_keys
from app.editor.window.recent_files import Settings
from app.editor.window.viewer_docks import ViewerDocks
from app.run.process import version
from app.run.shipped import command
from core.errors import ImagechainError
from core.modules.declaration import Declaration
from core.names import in_line
from nodes.files.common.file_format import CSV, dialog_filter
from nodes.files.formats import WRITTEN

Exported = ImageViewer | PlotViewer | TradeOffView
_MACROS = "network_files"  # the handbook's page on them
_PICTURES = ";;".join(
    (
        dialog_filter("Pictures", *(one for one in WRITTEN if not one.plain)),
        dialog_filter("Samples", *(one for one in WRITTEN if one.plain), CSV),
    )
)


class Help(QObject):
    def __init__(
        self,
        session: Session,
        viewers: ViewerDocks,
        actions: Callable[[], Actions],
        settings: Settings,
        window: QWidget,
    ) -> None:
        super().__init__(window)
        self._session = session
        self._viewers = viewers
        self._actions = actions
        self._settings = settings
        self._window = window
        self.handbook = HandbookOpening(session, self)

    def shortcuts(self) -> None:
        page = ShortcutList(self._actions(), self._window)
        page.changed.connect(partial(setattr, self._settings, "keys"))
        show_beside(self._window, page)

    def module(self) -> None:
        name = self._session.selection[-1] if self._session.selection else ""
        declared = self._session.declared(name)
        if declared is None:
            self._session.message.emit("advice", "select a node to read what its module does")
        else:
            text = ModuleText(declared, self._window)
            text.more_wanted.connect(self._open_page)
            show_beside(self._window, text)

    def handbook_of(self, name: str) -> None:
        declared = self._session.declared(name)
        if declared is not None:
            self._open_page(declared.key)

    def _open_page(self, key: str) -> None:
        self.handbook.open(key if key in self._session.library else _MACROS)

    def about(self) -> None:
        box = labelled(QMessageBox(self._window), "message")
        box.setWindowTitle("Imagechain")
        box.setText(
            f"Version {version()}\n\nSimulates electro-optical and infrared sensors as a chain of "
            "transfer functions and noise.\n\nAfter D. C. Tantalo, Modeling the MTF and noise "
            "characteristics of an image chain for a synthetic image generation system, RIT 1996."
        )
        show_beside(self._window, box)

    def export(self) -> None:
        self._export_of(self._viewer())

    def _export_of(self, viewer: Exported) -> None:
        kinds = _PICTURES if isinstance(viewer, ImageViewer) else plot_export.KINDS
        taken = partial(self._export_to, viewer)
        show_beside(self._window, SaveDialog(self._window, "export_dialog", "Export", kinds, taken))

    def _export_to(self, viewer: Exported, path: Path) -> None:
        try:
            if isinstance(viewer, ImageViewer):
                viewer.save_as(path)
            else:
                viewer.export(path)
        except ImagechainError as error:
            self._session.message.emit("error", f"not exported: {error}")
        else:
            self._session.message.emit("note", f"wrote {path}")

    def _viewer(self) -> Exported:
        focus = QApplication.focusWidget()
        viewers = self._viewers
        others: list[Exported] = [viewers.plot, viewers.tradeoff]
        for viewer in (*others, *viewers.images.values()):
            if focus is not None and viewer.isAncestorOf(focus):
                return viewer
        return viewers.images[1]


# Opening a page of the handbook in the browser; its pages are made where there are none yet.

_PATIENCE_MS = 2_500  # pages that are there already take less
_CLOSING_MS = 3_000


class HandbookOpening(QObject):
    """Has a process of its own find a page, and write the pages first if need be."""

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._process = QProcess(self)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)
        self._long = QTimer(self, singleShot=True)
        preparing = partial(session.message.emit, "note", "preparing the handbook's pages, once")
        self._long.timeout.connect(preparing)
        self._closed = False

    def open(self, word: str = "") -> None:
        """Open the page of a module, or the first; at once the one that was wanted last."""
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._session.message.emit("note", "opening the handbook")
            return
        self._process.setProcessEnvironment(python_environment())
        program, *words = command("app.command.cli", "handbook", "--path", *filter(None, [word]))
        self._process.start(program, words)
        self._long.start(_PATIENCE_MS)

    def close(self) -> None:
        self._closed = True
        self._long.stop()
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._process.terminate()
            if not self._process.waitForFinished(_CLOSING_MS):
                self._process.kill()
                self._process.waitForFinished(_CLOSING_MS)

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._long.stop()
        printed = bytes(self._process.readAllStandardOutput().data()).decode().strip()
        errors = bytes(self._process.readAllStandardError().data()).decode("utf-8", "replace")
        if self._closed:
            return
        if code or status == QProcess.ExitStatus.CrashExit or not printed:
            reason = (
                in_line(errors.strip().removeprefix("imagechain: ")).partition("; --")[0]
                or "its process was stopped"
            )
            self._session.message.emit("error", f"the handbook is not opened: {reason}")
        elif QDesktopServices.openUrl(QUrl.fromLocalFile(str(Path(printed)))):
            self._session.message.emit("note", f"the handbook is in the browser: {printed}")
        else:
            self._session.message.emit("error", f"no browser opens {printed}")

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._long.stop()
            reason = self._process.errorString()
            self._session.message.emit("error", f"Python cannot be started: {reason}")


# The text of a module, to be read at leisure.

_WIDE, _HIGH = 120, 36  # letters, lines
_IMAGE = int(QTextDocument.ResourceType.ImageResource.value)


class ModuleText(QDialog):
    more_wanted = Signal(str)  # (key): the module's page in the handbook is to be opened

    def __init__(self, declared: Declaration, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("module_help")
        self.setWindowTitle(declared.title)
        self.text = QTextBrowser(self)
        self.text.setPlainText(flowing(declared.text))  # until the formulas are typeset
        self.text.setOpenLinks(False)
        labelled(self.text, "module_help.text", f"What {declared.title} does")
        self.text.setTabChangesFocus(True)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        self.more = buttons.addButton(
            "More in the &Handbook", QDialogButtonBox.ButtonRole.ActionRole
        )
        self.more.setObjectName("module_help.more")
        self.more.setToolTip("Curves and an example, in the browser (F1)")
        self.more.setShortcut("F1")
        self.more.clicked.connect(lambda *_: self.more_wanted.emit(declared.key))
        buttons.rejected.connect(self.reject)
        filled(QVBoxLayout(self), self.text, buttons, margins=None)
        metrics = self.fontMetrics()
        self.resize(metrics.averageCharWidth() * _WIDE, metrics.height() * _HIGH)
        self._declared = declared
        self._typesetting = MeasureWorker(self)
        self._typesetting.done.connect(self._show)
        self._typeset()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_typesetting"):
            self._typeset()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._typesetting.drop()

    def _typeset(self) -> None:
        ink, em = self.palette().color(TEXT).name(), float(self.fontMetrics().height())
        self._typesetting.start(
            # Imported where it is used: typesetting takes a second to load.
            lambda _check, _report: import_module("app.handbook.module_help").module_help(
                self._declared, label=label_of, em=em, ink=ink
            )
        )

    def _show(self, made: Any) -> None:
        for address, svg in made.drawings.items():
            self.text.document().addResource(_IMAGE, QUrl(address), QByteArray(svg))
        self.text.setHtml(made.text)


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
    name: str = ""  # of the action; empty where its keys cannot be changed

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
    ("Region", "⬚, or R on a picture", "Show the region of the selected module"),
    ("Move a region", "drag it, or a corner", "A right click while you drag undoes it"),
    ("Move a wipe", "drag, or Ctrl+arrow", "Between A and B, or two wires; Shift: larger steps"),
    ("Show another band", "drag its line, or PgUp", "In a picture with bands; PgDown: back"),
    ("Default", "right-click on a value", "Reset it to its default"),
)


class ShortcutList(QDialog):
    changed = Signal(dict)  # (keys): the keys changed by the user, by the action's name

    def __init__(self, actions: Actions, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("shortcuts")
        self.setWindowTitle("Shortcuts")
        self._actions = actions
        self._rows = _all_rows(actions)
        self.search = labelled(QLineEdit(self), "shortcuts.search", "Search the shortcuts")
        self.search.setPlaceholderText("Name of an action, or its keys")
        self.search.setToolTip("Name of an action, or its keys; Down goes to the list")
        self.search.setClearButtonEnabled(True)
        self.catcher = KeyCatcher(
            self,
            "press",
            "Press a &Key",
            "Then press a key combination: the list shows what it does",
        )
        self.changer = KeyCatcher(
            self, "change", "&Change", "Then press new keys for the selected action"
        )
        self.without = _button(self, "none_at_all", "&Remove", "Leave the selected action no keys")
        self.default = _button(
            self, "default", "&Default", "Give the selected action the keys it had at first"
        )
        self.table = _table(self)
        self.none = labelled(centred_hint("", self), "shortcuts.none")
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        for button in buttons.buttons():
            if isinstance(button, QPushButton):
                button.setAutoDefault(False)  # Enter in the search closes nothing
                button.setDefault(False)
        self.said = labelled(centred_hint("", self), "shortcuts.said", "What became of the keys")
        above = filled(QHBoxLayout(), (self.search, 1), self.catcher, margins=None)
        changes = (self.changer, self.without, self.default)
        below = filled(QHBoxLayout(), *changes, (self.said, 1), buttons, margins=None)
        filled(QVBoxLayout(self), above, (self.table, 1), (self.none, 1), below, margins=None)
        self.changer.pressed_keys.connect(self._change)
        self.without.clicked.connect(lambda *_: self._give([]))
        self.default.clicked.connect(lambda *_: self._give(None))
        self.table.itemSelectionChanged.connect(self._follow_selection)
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

    def _selected(self) -> ShortcutRow | None:
        chosen = self.table.selectionModel().selectedRows()
        row = self._shown[chosen[0].row()] if chosen else None
        return row if row is not None and row.name else None

    def _follow_selection(self) -> None:
        row = self._selected()
        for button in (self.changer, self.without, self.default):
            button.setEnabled(row is not None)
        self.said.setText("")

    def _change(self, pressed: tuple[str, ...]) -> None:
        self._give([pressed[0]], pressed)

    def _give(self, keys: list[str] | None, pressed: tuple[str, ...] = ()) -> None:
        """Give the selected action these keys, or its first ones, unless another has them."""
        row = self._selected()
        if row is None:
            return
        if keys is None:
            keys = next(default_keys(spec) for spec in ACTIONS if spec.name == row.name)
        wanted = pressed or tuple(keys)
        taken = [one for one in rows_of_keys(self._rows, wanted) if one.name != row.name]
        if taken:
            native = QKeySequence(keys[0]).toString(_NATIVE)
            self.said.setText(f"{native} belongs to {taken[0].action}: change or remove that first")
            return
        self._actions[row.name].setShortcuts([QKeySequence(key) for key in keys])
        self.changed.emit(self._actions.own_keys())
        self._rows = _all_rows(self._actions)
        known = {one.name: one for one in self._rows if one.name}
        at = self._shown.index(row)
        self._show([known.get(one.name, one) for one in self._shown], "")
        self.table.selectRow(at)

    def _show(self, rows: list[ShortcutRow], none: str) -> None:
        self._shown = rows
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
        self._follow_selection()


class KeyCatcher(QPushButton):
    """A button after which the next key combination is taken as such: it does nothing else."""

    # (sequences): A tuple of texts: the combination, and what it is called where Shift
    # belongs to the letter
    pressed_keys = Signal(tuple)

    def __init__(self, parent: QWidget, name: str, text: str, tip: str) -> None:
        super().__init__(text, parent)
        labelled(self, f"shortcuts.{name}", tip, tip)
        self._text = text
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
        self.setText("Now press the keys…" if on else self._text)
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
        native = OR.join(key.toString(_NATIVE) for key in keys)
        sequences = tuple(key.toString(_PORTABLE) for key in keys)
        text, menu = action.text().replace("&", "").rstrip("…"), spec.menu.replace("&", "")
        rows.append(ShortcutRow(menu, text, native, action.toolTip(), sequences, spec.name))
    return rows


def _all_rows(actions: Actions) -> list[ShortcutRow]:
    return [*shortcuts_of(actions), *CANVAS, *(ShortcutRow("Mouse", *row) for row in MOUSE)]


def _button(parent: QWidget, name: str, text: str, tip: str) -> QPushButton:
    made = labelled(QPushButton(text, parent), f"shortcuts.{name}", tip, tip)
    made.setAutoDefault(False)
    return made


def _table(parent: QWidget) -> QTableWidget:
    table = labelled(QTableWidget(0, 4, parent), "shortcuts.table", "Shortcuts")
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
