"""Figures of A and B side by side; differences have a colour, and an arrow or sign."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QColor
from PySide6.QtWidgets import (
    QTableWidgetItem,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.snapshots.all_figures import NodeFigure
from app.editor.snapshots.figure_differences import FigureDifference
from app.editor.theme import Theme
from app.editor.viewers.figures.figure_text import NONE
from app.editor.widgets.copied_table import CopiedTable

_HEADS = ("Figure", "A", "B", "", "Change")
_INDENT = "  "
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


class DifferenceTable(CopiedTable):
    """Rows of figure, value in A, value in B, and difference.

    Ctrl+C copies the rows that are marked, or all, with all digits.
    """

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(0, len(_HEADS), parent)
        self.setObjectName("snapshots.figures")
        self.setAccessibleName("Figures of A and B; Ctrl+C copies them")
        self.setToolTip("Figures of the snapshot, A, and of the network now, B")
        self.list_figures(_HEADS)
        self.horizontalHeader().setMinimumSectionSize(4 * self.fontMetrics().averageCharWidth())
        copy = QAction("&Copy", self)
        copy.setObjectName("snapshots.copy")
        copy.triggered.connect(self.copy)
        self.addAction(copy)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        self._lines: tuple[FigureDifference | str, ...] = ()
        self._old = False
        self._theme = theme

    def set_theme(self, theme: Theme) -> None:
        """Write in other colours."""
        self._theme = theme
        self._paint()

    def mark_old(self, old: bool) -> None:
        """Write what is older than the last edit faint: B and the differences."""
        if old != self._old:
            self._old = old
            self._paint()

    def show_rows(self, rows: Sequence[FigureDifference]) -> None:
        """Show these figures, those of a node below its name."""
        lines: list[FigureDifference | str] = []
        node = None
        for row in rows:
            if row.node != node:
                node = row.node
                lines.append(node)
            lines.append(row)
        self.clearSpans()
        self.setRowCount(len(lines))
        for number, line in enumerate(lines):
            if isinstance(line, str):
                self._show_node(number, line)
            else:
                self._show_row(number, line)
        self._lines = tuple(lines)
        self._paint()
        self.resizeRowsToContents()

    def _show_node(self, number: int, name: str) -> None:
        item = QTableWidgetItem(name)
        font = item.font()
        font.setBold(True)
        item.setFont(font)
        item.setToolTip(tip(name))
        item.setFlags(Qt.ItemFlag.ItemIsEnabled)
        self.setItem(number, 0, item)
        for column in range(1, len(_HEADS)):
            self.takeItem(number, column)
        self.setSpan(number, 0, 1, len(_HEADS))

    def _show_row(self, number: int, row: FigureDifference) -> None:
        texts = (_INDENT + row.caption, row.shown_a, row.shown_b, row.unit, row.text)
        about = f"{row.meaning}\nIn files: {row.node}.{row.name}"
        abouts = (about, _exact(row.a), _exact(row.b), row.unit, row.about)
        for column, (text, what) in enumerate(zip(texts, abouts, strict=True)):
            item = QTableWidgetItem(text)
            item.setTextAlignment(_LEFT if column in (0, 3) else _RIGHT)
            item.setToolTip(tip(what))
            self.setItem(number, column, item)

    def cells(self, row: int) -> Sequence[str]:
        """Node, figure, both values with all digits, and the difference in words."""
        line = self._lines[row]
        if isinstance(line, str):
            return ()
        return line.node, line.caption, _exact(line.a), _exact(line.b), line.text

    def keyboardSearch(self, search: str) -> None:
        """Letters are shortcuts here, and look nothing up."""

    def _paint(self) -> None:
        theme = self._theme
        ways = {"same": theme.faint_text, "up": theme.changed, "down": theme.accent}
        for number, row in enumerate(self._lines):
            inks = [theme.text] * (len(_HEADS) - 1)
            inks.append(ways.get("" if isinstance(row, str) else row.way, theme.error))
            if self._old:
                inks[2], inks[-1] = theme.faint_text, theme.faint_text
            for column, ink in enumerate(inks):
                item = self.item(number, column)
                if item is not None:
                    item.setForeground(QColor(ink))


def _exact(figure: NodeFigure | None) -> str:
    """The value with all its digits, and its unit."""
    if figure is None or figure.value is None:
        return NONE
    value = figure.value
    return f"{value if isinstance(value, str) else repr(value)} {figure.unit}".rstrip()
