"""Named figures as a table."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QTableWidgetItem,
    QWidget,
)

from app.editor.widgets import CopiedTable
from app.run.readout_tables import number_text
from core.chain.results import TableData, TableRow

_HEADS = ("Name", "Value", "Unit", "Meaning")
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


class FigureTable(CopiedTable):
    """Rows of name, value, unit and meaning; the tooltip of a value has all its digits.

    Ctrl+C copies the rows that are marked, or all, for a spreadsheet: with all digits.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(0, len(_HEADS), parent)
        self.setAccessibleName("Figures; Ctrl+C copies them")
        self.setHorizontalHeaderLabels(list(_HEADS))
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setWordWrap(True)
        self.verticalHeader().hide()
        self.verticalHeader().setMinimumSectionSize(self.fontMetrics().height() + 6)
        head = self.horizontalHeader()
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setStretchLastSection(True)
        head.setHighlightSections(False)
        copy = QAction("&Copy", self)
        copy.setObjectName("figures.copy")
        copy.triggered.connect(self.copy)
        self.addAction(copy)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        self._figures: tuple[TableRow, ...] = ()

    def show_table(self, table: TableData) -> None:
        """Show these figures."""
        self._figures = table.rows
        self.setRowCount(len(table.rows))
        for row, figure in enumerate(table.rows):
            shown = number_text(figure.value).replace("-", "\N{MINUS SIGN}")
            if figure.value is None:
                shown = "—"
            elif isinstance(figure.value, str):
                shown = figure.value
            for column, text in enumerate((figure.name, shown, figure.unit, figure.meaning)):
                item = QTableWidgetItem(text)
                item.setToolTip(_exact(figure) if column == 1 else text)
                item.setTextAlignment(_RIGHT if column == 1 else _LEFT)
                self.setItem(row, column, item)
        self.resizeRowsToContents()

    def cells(self, row: int) -> Sequence[str]:
        """Name, value with all digits, unit and meaning."""
        figure = self._figures[row]
        return figure.name, _exact(figure), figure.unit, figure.meaning


def _exact(figure: TableRow) -> str:
    """The value with all its digits; nothing where there is none."""
    if figure.value is None:
        return ""
    return figure.value if isinstance(figure.value, str) else repr(figure.value)
