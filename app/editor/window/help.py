"""Shortcuts, the handbook, about, and writing what a viewer shows."""

from functools import partial
from pathlib import Path

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QObject, QProcess, Qt, QUrl

from app.editor.docks.runs import python_environment
from app.editor.docks.tradeoff_view import TradeOffView
from app.editor.messages import SaveDialog, show_beside, told
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.widgets import CopiedTable, filled, labelled, search_field
from app.editor.window.actions import ACTIONS, Actions
from app.editor.window.viewer_docks import ViewerDocks
from app.run.terminal import command, version
from core.errors import in_line

Exported = ImageViewer | PlotViewer | TradeOffView
_MACROS = "network_files"  # the handbook's page on them
_CLOSING_MS = 3_000


class Help(QObject):
    def __init__(self, session: Session, viewers: ViewerDocks, window: QtWidgets.QWidget) -> None:
        super().__init__(window)
        self._session = session
        self._viewers = viewers
        self._window = window
        self._process = QProcess(self)  # it finds pages of the handbook, and writes them at first
        self._process.finished.connect(self._found)
        self._wanted = self._sought = ""

    def shortcuts(self, actions: Actions) -> None:
        show_beside(self._window, shortcut_list(actions, self._window))

    def module(self) -> None:
        self.handbook_of(("", *self._session.selection)[-1])

    def handbook_of(self, name: str) -> None:
        declared = self._session.declared(name)
        if declared is None:
            self._session.message.emit("note", "select a node to read about its module")
        else:
            self.open_handbook(declared.key if declared.key in self._session.library else _MACROS)

    def open_handbook(self, word: str = "") -> None:
        """Open the page of a module in the browser, or the first."""
        self._session.message.emit("note", "opening the handbook")
        self._wanted = word  # by the time the page before it is found, another may be
        if self._process.state() == QProcess.ProcessState.NotRunning:
            self._sought = word
            program, *words = command("app.command.cli", "handbook", "--path", word)
            self._process.setProcessEnvironment(python_environment())
            self._process.start(program, [one for one in words if one])

    def close(self) -> None:
        self._process.finished.disconnect(self._found)
        self._process.terminate()
        if not self._process.waitForFinished(_CLOSING_MS):
            self._process.kill()

    def _found(self, code: int) -> None:
        if self._wanted != self._sought:
            self.open_handbook(self._wanted)
            return
        printed = bytes(self._process.readAllStandardOutput().data()).decode().strip()
        errors = bytes(self._process.readAllStandardError().data()).decode("utf-8", "replace")
        if code or not printed:
            reason = in_line(errors.strip().removeprefix("imagechain: ")).partition("; --")[0]
            self._session.message.emit("error", f"the handbook could not be opened: {reason}")
        elif QtGui.QDesktopServices.openUrl(QUrl.fromLocalFile(printed)):
            self._session.message.emit("note", f"the handbook was opened in the browser: {printed}")
        else:
            self._session.message.emit("error", f"no browser could open {printed}")

    def about(self) -> None:
        box = labelled(QtWidgets.QMessageBox(self._window), "message")
        box.setWindowTitle("Imagechain")
        box.setText(
            f"Version {version()}\n\nSimulates electro-optical and infrared sensors as a chain of "
            "transfer functions and noise.\n\nBased on D. C. Tantalo, Modeling the MTF and noise "
            "characteristics of an image chain for a synthetic image generation system, RIT 1996."
        )
        show_beside(self._window, box)

    def export(self) -> None:
        """Write the viewer that has the keyboard; else the first picture."""
        focus, viewers = QtWidgets.QApplication.focusWidget(), self._viewers
        others: tuple[Exported, ...] = (viewers.plot, viewers.tradeoff, *viewers.images.values())
        used = (one for one in others if focus is not None and one.isAncestorOf(focus))
        viewer = next(used, viewers.images[1])
        name, taken = "export_dialog", partial(self._export_to, viewer)
        show_beside(
            self._window, SaveDialog(self._window, name, "Export", viewer.export_kinds, taken)
        )

    def _export_to(self, viewer: Exported, path: Path) -> None:
        with told(self._session.message.emit, "not exported: "):
            viewer.export(path)
            self._session.message.emit("note", f"wrote {path}")


# The list of shortcuts.

# What keys and the mouse do without being an action: where, what, how, and more of it.
# fmt: off
BESIDE_ACTIONS = (
    ("Canvas", "Move the selection", "arrow keys",
     "Shift: move by one canvas unit, or resize a backdrop selected alone"),
    ("Canvas", "Go to the next node", "Ctrl with arrow keys",
     "Shift: add the node to the selection"),
    ("Canvas", "Open", "Return", "The panel of the selected node, or a backdrop's title"),
    ("Mouse", "Pan", "middle button", "Drag the canvas"),
    ("Mouse", "Zoom", "wheel", "Zoom at the pointer"),
    ("Mouse", "Add", "double-click", "Search for a module and add it there"),
    ("Mouse", "Wire", "drag from a port", "Dropped on empty canvas: list the modules that fit"),
    ("Mouse", "View", "Ctrl+Shift+click", "Show the node in viewer 1"),
    ("Mouse", "Insert", "drop a node on a wire", "Insert the node into the wire"),
    ("Mouse", "Bend a wire", "double-click on the wire",
     "Add a dot; drag to move it, Del to delete it"),
    ("Mouse", "Cut wires", "Alt+Shift+drag", "Disconnect the wires that the line crosses"),
    ("Mouse", "Open", "drop a file", "A picture becomes a Read Image node; a network is opened"),
    ("Mouse", "Region", "⬚, or R on a picture", "Show the region of the selected module"),
    ("Mouse", "Move a region", "drag the region or a corner", "Esc cancels the drag"),
    ("Mouse", "Move a wipe", "drag, or Ctrl+arrow",
     "The divider between A and B, or between two wires; Shift: larger steps"),
    ("Mouse", "Show another band", "drag the band's line, or PgUp",
     "In a picture with bands; PgDown goes back"),
    ("Mouse", "Default", "right-click on a value", "Choose Reset to default in the menu"),
)
# fmt: on
OR = "  or  "


def shortcut_list(actions: Actions, parent: QtWidgets.QWidget) -> QtWidgets.QDialog:
    """All shortcuts, read from the actions themselves, with a field that filters them."""
    dialog = QtWidgets.QDialog(parent, objectName="shortcuts", windowTitle="Shortcuts")
    hint = "Name of an action, or its keys"
    search = search_field("shortcuts.search", "Search the shortcuts", hint, dialog)
    rows = (*shortcuts_of(actions), *BESIDE_ACTIONS)
    table = CopiedTable(("Menu", "Action", "Keys", "What it does"), dialog, widest=3)
    labelled(table, "shortcuts.table", "Shortcuts")
    table.show_rows([[(text, "") for text in row] for row in rows])
    filled(QtWidgets.QVBoxLayout(dialog), search, (table, 1), margins=None)
    metrics = dialog.fontMetrics()
    dialog.resize(metrics.averageCharWidth() * 110, metrics.height() * 28)

    def narrow(typed: str) -> None:
        for number, row in enumerate(rows):
            known = " ".join(row).casefold()
            table.setRowHidden(number, not all(w in known for w in typed.casefold().split()))

    search.textChanged.connect(narrow)
    search.setFocus(Qt.FocusReason.OtherFocusReason)
    return dialog


def shortcuts_of(actions: Actions) -> list[tuple[str, str, str, str]]:
    """Menu, name, keys and tip of every action."""
    native = QtGui.QKeySequence.SequenceFormat.NativeText
    rows = []
    for spec in ACTIONS:
        action = actions[spec.name]
        keys = OR.join(key.toString(native) for key in action.shortcuts())
        text, menu = action.text().replace("&", "").rstrip("…"), spec.menu.replace("&", "")
        rows.append((menu, text, keys, action.toolTip()))
    return rows
