"""The list of all shortcuts, made from the actions themselves."""

from __future__ import annotations

from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from app.editor.window.actions.menu_actions import Actions

# What the mouse does has no action to be read from.
MOUSE = (
    ("Mouse", "Pan", "middle button", "Drag the canvas"),
    ("Mouse", "Zoom", "wheel", "Enlarge or shrink at the pointer"),
    ("Mouse", "Add", "double-click", "Search a module and add it there"),
    ("Mouse", "Wire", "drag from a port", "On empty canvas: the modules that fit"),
    ("Mouse", "Insert", "drop a node on a wire", "Lead the wire through the node"),
    ("Mouse", "Cut wires", "Alt+Shift and drag", "Disconnect what the line crosses"),
    ("Mouse", "Open", "drop a file", "A picture becomes Read Image, a network is opened"),
    ("Mouse", "Region", "⬚, or R on a picture", "Draw the region of the selected module"),
    ("Mouse", "Move a region", "drag, or arrow keys", "Shift: by 10; Ctrl: its last edges; Esc"),
    ("Mouse", "Move a wipe", "drag, or Ctrl+arrow", "Of A and B, or two wires; Shift: by more"),
    ("Mouse", "Default", "right-click on a value", "Reset it to its default"),
)


class ShortcutList(QDialog):
    """A window with every shortcut."""

    def __init__(self, actions: Actions, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("shortcuts")
        self.setWindowTitle("Shortcuts")
        rows = [*actions.listed(), *MOUSE]
        table = QTableWidget(len(rows), 4, self)
        table.setObjectName("shortcuts.table")
        table.setAccessibleName("Shortcuts")
        table.setHorizontalHeaderLabels(["", "Action", "Keys", "What it does"])
        table.verticalHeader().hide()
        table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        table.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        before = ""
        for number, row in enumerate(rows):
            shown = (row[0] if row[0] != before else "", *row[1:])
            before = row[0]
            for column, text in enumerate(shown):
                table.setItem(number, column, QTableWidgetItem(text))
        table.resizeColumnsToContents()
        table.horizontalHeader().setSectionResizeMode(3, QHeaderView.ResizeMode.Stretch)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(table)
        layout.addWidget(buttons)
        metrics = self.fontMetrics()
        self.resize(metrics.averageCharWidth() * 110, metrics.height() * 28)
