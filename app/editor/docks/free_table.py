"""The free parameters as a table: limits to type in, and what the fit gave."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QEvent, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHeaderView, QTableWidget, QTableWidgetItem, QWidget

from app.editor.declared_text import about, label_of, tip
from app.editor.docks.fit_job import FittedNumber
from app.editor.number_text import FreeNumber, shown_number
from app.editor.session import Session
from app.editor.theme import CHANGED
from app.editor.typed_number import typed_number
from core.errors import ParameterError
from core.modules.parameters import Parameter

_HEADS = ("Parameter", "Now", "Fitted", "±", "Unit", "Low", "High")
_FITTED, _UNIT, _LOW, _HIGH = 2, 4, 5, 6
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_UNDETERMINED = "not determined"


class FreeTable(QTableWidget):
    """Every free parameter in a row."""

    refused = Signal(str)  # (text): why a limit is not taken

    def __init__(self, session: Session, parent: QWidget) -> None:
        super().__init__(0, len(_HEADS), parent)
        self._session = session
        self._fitted: tuple[FittedNumber, ...] = ()
        self.setObjectName("fit.free")
        self.setAccessibleName("Free parameters with their limits and fitted values; Del fixes one")
        self.setToolTip(
            "The parameters that the fit determines. Limits can be typed in; they are not "
            "saved with the network"
        )
        self.setHorizontalHeaderLabels(list(_HEADS))
        self.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
        self.setSelectionMode(QTableWidget.SelectionMode.SingleSelection)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.verticalHeader().hide()
        head = self.horizontalHeader()
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        head.setHighlightSections(False)
        self.itemChanged.connect(self._typed)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.write()

    def show_fitted(self, fitted: tuple[FittedNumber, ...]) -> None:
        self._fitted = fitted
        self.write()

    def remove_marked(self) -> None:
        free = self._session.free.all
        if 0 <= self.currentRow() < len(free):
            self._session.free.fix(*free[self.currentRow()].place)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and not event.modifiers():
            self.remove_marked()
        else:
            super().keyPressEvent(event)

    def write(self) -> None:
        by_place = {one.number.place: one for one in self._fitted}
        free = self._session.free.all
        with QSignalBlocker(self):
            self.setRowCount(len(free))
            for row, number in enumerate(free):
                fitted = by_place.get(number.place)
                for column, text in enumerate(self._cells(number, fitted)):
                    self._put(row, column, text, number)
                value = self.item(row, _FITTED)
                if value is not None and fitted is not None and fitted.value is None:
                    value.setForeground(self.palette().color(CHANGED))

    def _put(self, row: int, column: int, text: str, number: FreeNumber) -> None:
        item = self.item(row, column)  # one that is being typed in has to stay
        if item is None:
            item = QTableWidgetItem()
            self.setItem(row, column, item)
        item.setText(text)
        item.setForeground(self.palette().text())
        parameter = self._parameter(number)
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        if column in (_LOW, _HIGH):
            item.setFlags(flags | Qt.ItemFlag.ItemIsEditable)
            end = "Low" if column == _LOW else "High"
            item.setToolTip(
                tip(f"{end} limit for the fit; empty: the limit of the parameter itself")
            )
        else:
            item.setFlags(flags)
            if parameter is not None:
                item.setToolTip(tip(f"{about(parameter)}\nIn network files: {number.port}"))
        if column not in (0, _UNIT):
            item.setTextAlignment(_RIGHT)

    def _cells(self, number: FreeNumber, fitted: FittedNumber | None) -> tuple[str, ...]:
        parameter = self._parameter(number)
        unit = parameter.param.unit if parameter is not None else ""
        low, high = ("" if v is None else shown_number(v) for v in (number.low, number.high))
        value = error = ""
        if fitted is not None:
            value = _UNDETERMINED if fitted.value is None else f"{fitted.value:.6g}"
            error = "" if fitted.sigma is None else f"{fitted.sigma:.2g}"
        name = f"{label_of(number.name)} of {number.node}"
        return name, self._now(number), value, error, unit, low, high

    def _now(self, number: FreeNumber) -> str:
        node, parameter = self._session.network.nodes.get(number.node), self._parameter(number)
        if node is None or parameter is None:
            return ""
        value = node.params.get(number.name, parameter.default)
        return f"{value:.6g}" if isinstance(value, int | float) else ""

    def _parameter(self, number: FreeNumber) -> Parameter | None:
        declared = self._session.declared(number.node)
        return declared.parameter(number.name) if declared is not None else None

    def _typed(self, item: QTableWidgetItem) -> None:
        row, column = item.row(), item.column()
        number = self._session.free.all[row]
        parameter, text = self._parameter(number), item.text().strip()
        if parameter is None or column not in (_LOW, _HIGH):
            return
        try:
            limit = None if not text else parameter.coerce(typed_number(text, parameter))
        except ParameterError as error:
            self.refused.emit(f"{number.port}: {error.message}")
            self.write()
            return
        end = None if limit is None else float(limit)
        changed = replace(number, low=end) if column == _LOW else replace(number, high=end)
        if changed.low is not None and changed.high is not None and changed.low >= changed.high:
            self.refused.emit(
                f"{number.port}: the low limit, {changed.low:g}, must lie below {changed.high:g}"
            )
            self.write()
            return
        self._session.free.put(changed)
