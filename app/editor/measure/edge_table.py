"""The edges of a measurement as a list, and its figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent
from PySide6.QtWidgets import (
    QHeaderView,
    QTableWidgetItem,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from app.editor.declared_text import tip
from app.editor.theme import Theme
from app.editor.widgets import CopiedTable

if TYPE_CHECKING:
    from app.measure.picture_measurement import MeasuredEdge, PictureMeasurement

_PLACE = Qt.ItemDataRole.UserRole
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_SWITCH_KEYS = (Qt.Key.Key_Delete, Qt.Key.Key_Backspace, Qt.Key.Key_Space)
_FIGURE_HEADS = ("Figure", "Value", "Unit")


class EdgeTable(QTreeWidget):
    """Every edge with its MTF50, or why it is not used.

    Signals
    -------
    chosen(place)
        The person marks an edge.
    switched
        A key removes the marked edge, or uses it again.
    """

    chosen = Signal(int)
    switched = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("measure.edges")
        self.setAccessibleName("Edges; Del removes the marked one, or uses it again")
        self.setHeaderLabels(["Edge", "Normal", "MTF50", "State"])
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setAllColumnsShowFocus(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setTextElideMode(Qt.TextElideMode.ElideRight)
        head = self.header()
        for column in range(3):
            head.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)
        head.setStretchLastSection(True)
        head.setMinimumSectionSize(3 * self.fontMetrics().averageCharWidth())
        self._theme = theme
        self._measured: PictureMeasurement | None = None
        self.currentItemChanged.connect(self._marked)

    def set_theme(self, theme: Theme) -> None:
        """Write in other colours."""
        self._theme = theme
        self._write()

    def show_measured(self, measured: PictureMeasurement | None) -> None:
        """List the edges of a measurement; the same number of them keep their rows."""
        many = 0 if measured is None else len(measured.edges)
        self._measured = measured
        if many != self.topLevelItemCount():
            with QSignalBlocker(self):
                self.clear()
                for place in range(many):
                    item = QTreeWidgetItem(self)
                    item.setData(0, _PLACE, place)
        self._write()

    def choose(self, place: int) -> None:
        """Mark an edge; -1 marks none."""
        with QSignalBlocker(self):
            item = self.topLevelItem(place) if place >= 0 else None
            self.setCurrentItem(item)  # type: ignore[arg-type] # None: no row
            if item is not None:
                self.scrollToItem(item)
            else:
                self.clearSelection()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Remove the marked edge, or use it again."""
        if event.key() in _SWITCH_KEYS and not event.modifiers():
            self.switched.emit()
        else:
            super().keyPressEvent(event)

    def _marked(self, item: QTreeWidgetItem | None, *_: object) -> None:
        if item is not None:
            self.chosen.emit(int(item.data(0, _PLACE)))

    def _write(self) -> None:
        for place, edge in enumerate(self._measured.edges if self._measured is not None else ()):
            item = self.topLevelItem(place)
            assert item is not None
            for column, text in enumerate(_cells(place, edge)):
                item.setText(column, text)
                item.setForeground(
                    column, QColor(self._theme.text if edge.used else self._theme.faint_text)
                )
                item.setToolTip(column, tip(edge.why_not or "used"))
            for column in (0, 1):
                item.setTextAlignment(column, _RIGHT)


def _cells(place: int, edge: MeasuredEdge) -> tuple[str, str, str, str]:
    half, error = "", None
    if edge.curve is not None and edge.curve.mtf50 is not None:
        half, error = f"{edge.curve.mtf50:.3f}", edge.mtf50_sigma
    angle = f"{edge.found.angle_deg:.1f}°".replace("-", "\N{MINUS SIGN}")
    return (
        str(place + 1),
        angle,
        f"{half} ± {error:.3f}" if error is not None else half,
        edge.why_not or "used",
    )


def edge_words(place: int, edge: MeasuredEdge) -> str:
    """An edge in a line: its MTF50, or why it is not used."""
    found = edge.found
    angle = f"{found.angle_deg:.1f}".replace("-", "\N{MINUS SIGN}")
    where = f"edge {place + 1}, normal at {angle}°, {found.length:.0f} samples long"
    if edge.curve is None:
        return f"{where}, not used: {edge.why_not}"
    half = "" if edge.curve.mtf50 is None else f", MTF50 {edge.curve.mtf50:.3f}"
    if edge.mtf50_sigma is not None:
        half += f" ± {edge.mtf50_sigma:.3f}"
    return where + half + ("" if edge.used else f", {edge.why_not}")


class FigureTable(CopiedTable):
    """Figures of a measurement; Ctrl+C copies them."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(0, len(_FIGURE_HEADS), parent)
        self.setObjectName("measure.figures")
        self.setAccessibleName("Figures of MTF and noise; Ctrl+C copies them")
        self.list_figures(_FIGURE_HEADS)
        self._theme = theme
        self._rows: tuple[tuple[str, str, str], ...] = ()

    def set_theme(self, theme: Theme) -> None:
        """Write in other colours."""
        self._theme = theme

    def cells(self, row: int) -> Sequence[str]:
        """The texts of a row that are copied."""
        return self._rows[row]

    def show_rows(self, rows: Sequence[tuple[str, str, str, str]], remarks: Sequence[str]) -> None:
        """Show name, value, unit and meaning of figures, and below them what is to be known."""
        self._rows = (*((meaning, value, unit) for _, value, unit, meaning in rows),
                      *((text, "", "") for text in remarks))  # fmt: skip
        self.clearSpans()
        self.setRowCount(len(self._rows))
        for row, texts in enumerate(self._rows):
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                if column == 1:
                    item.setTextAlignment(_RIGHT)
                if row < len(rows):
                    item.setToolTip(rows[row][0])
                self.setItem(row, column, item)
            if row >= len(rows):
                self.setSpan(row, 0, 1, len(_FIGURE_HEADS))
        self.resizeRowsToContents()
