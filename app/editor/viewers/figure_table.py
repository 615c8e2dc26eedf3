"""Named figures as a table."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QTableWidget,
    QTableWidgetItem,
    QWidget,
)

from app.tables import number_text
from core.data import TableData

_HEADS = ("Name", "Value", "Unit", "Meaning")


class FigureTable(QTableWidget):
    """Rows of name, value, unit and meaning; the tooltip of a value has all its digits."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(0, len(_HEADS), parent)
        self.setAccessibleName("Figures")
        self.setHorizontalHeaderLabels(list(_HEADS))
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        head = self.horizontalHeader()
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setStretchLastSection(True)

    def show_table(self, table: TableData) -> None:
        """Show these figures."""
        self.setRowCount(len(table.rows))
        for row, figure in enumerate(table.rows):
            shown = number_text(figure.value).replace("-", "\N{MINUS SIGN}")
            if figure.value is None:
                shown = "—"
            elif isinstance(figure.value, str):
                shown = figure.value
            for column, text in enumerate((figure.name, shown, figure.unit, figure.meaning)):
                item = QTableWidgetItem(text)
                item.setToolTip(repr(figure.value) if column == 1 else text)
                if column == 1:
                    item.setTextAlignment(
                        Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
                    )
                self.setItem(row, column, item)
