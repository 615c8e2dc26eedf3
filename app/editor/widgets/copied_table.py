"""A table whose rows are copied as text."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtGui import QGuiApplication, QKeyEvent, QKeySequence, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableWidget, QWidget

from app.editor.widgets.left_open import require_defined


class CopiedTable(QTableWidget):
    """Ctrl+C copies the marked rows; lines are broken anew when its width changes."""

    def __init__(self, rows: int, columns: int, parent: QWidget | None = None) -> None:
        require_defined(type(self), CopiedTable, "cells")
        super().__init__(rows, columns, parent)

    def list_figures(self, heads: Sequence[str]) -> None:
        """Look as a list of figures that is only read: whole rows, the first column the widest."""
        self.setHorizontalHeaderLabels(list(heads))
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.setWordWrap(True)
        self.verticalHeader().hide()
        self.verticalHeader().setMinimumSectionSize(self.fontMetrics().height() + 4)
        head = self.horizontalHeader()
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        head.setHighlightSections(False)

    def cells(self, row: int) -> Sequence[str]:  # noqa: ARG002 - what a table has
        """The texts of a row that are copied; none of a heading."""
        return ()

    def copy(self) -> None:
        """Put the marked rows, or all, on the clipboard: cells between tabs."""
        marked = sorted({index.row() for index in self.selectedIndexes()})
        rows = [self.cells(row) for row in marked or range(self.rowCount())]
        QGuiApplication.clipboard().setText("\n".join("\t".join(row) for row in rows if row))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Copy."""
        if event.matches(QKeySequence.StandardKey.Copy):
            self.copy()
        else:
            super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Break the lines anew."""
        super().resizeEvent(event)
        self.resizeRowsToContents()
