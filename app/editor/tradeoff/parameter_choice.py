"""The choice of a number of the network, by node."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QStandardItem, QStandardItemModel
from PySide6.QtWidgets import QComboBox, QCompleter, QLineEdit, QWidget

from app.editor.declared_text import label_of, tip, titled
from app.editor.session import Session
from app.editor.viewers.network_ports import ports_depend_on
from core.modules.parameters import Parameter
from core.network.network import MACRO

NUMERIC = ("number", "integer")
_NOTHING = "Choose a parameter"
_NAME = Qt.ItemDataRole.UserRole


class ParameterChoice(QComboBox):
    """Every number of every node, under the names of the nodes.

    Signals
    -------
    chosen(node, parameter)
        The person has chosen one.
    """

    chosen = Signal(str, str)

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self._filled: Hashable = None
        self._name = ""
        self._list = QStandardItemModel(self)
        self._field = QLineEdit(self)
        self.setModel(self._list)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(16)
        self.setMaxVisibleItems(24)
        self._make_searchable()
        self.activated.connect(self._activated)
        session.changed.connect(self._changed)
        session.opened.connect(self._fill)
        self._fill()

    def _make_searchable(self) -> None:
        """What is typed lists the parameters in which it occurs, of any node."""
        self.setLineEdit(self._field)  # which makes it editable
        self.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        completer = QCompleter(self._list, self)
        self.setCompleter(completer)
        field = self._field
        field.setPlaceholderText(_NOTHING)
        field.setAccessibleName("search a parameter")
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        completer.setCompletionMode(QCompleter.CompletionMode.PopupCompletion)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        completer.setMaxVisibleItems(24)
        field.editingFinished.connect(self._finish_typing)

    def _finish_typing(self) -> None:
        """Take a parameter by its words or its name in files; else show the chosen one again."""
        text = self._field.text().strip()
        place = self.findText(text, Qt.MatchFlag.MatchFixedString)
        if place < 0 and text:
            place = self.findData(text, _NAME)
        if place < 0 or not self.itemData(place, _NAME):
            self.setCurrentIndex(max(0, self.findData(self._name, _NAME)))
            self._field.setText(self.currentText())
        elif self.itemData(place, _NAME) != self._name:
            self.setCurrentIndex(place)
            self._activated(place)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """All of the text is replaced by what is typed."""
        super().focusInEvent(event)
        QTimer.singleShot(0, self._field.selectAll)

    def choose(self, node: str, parameter: str) -> None:
        """Show one as chosen, without a signal; empty names: none."""
        self._name = f"{node}.{parameter}" if node else ""
        self.setCurrentIndex(max(0, self.findData(self._name, _NAME)))
        self.setToolTip(self._name or _NOTHING)

    def showPopup(self) -> None:
        """Make the list as wide as its longest line."""
        bar = self.view().verticalScrollBar().sizeHint().width()
        width = self.view().sizeHintForColumn(0) + bar
        self.view().setMinimumWidth(max(width, self.width()))
        super().showPopup()

    def _activated(self, index: int) -> None:
        name = self.itemData(index, _NAME)
        if name:
            self._name = name
            node, _, parameter = name.rpartition(".")
            self.chosen.emit(node, parameter)
        else:
            self.setCurrentIndex(max(0, self.findData(self._name, _NAME)))

    def _changed(self, _before: Any, after: Any) -> None:
        if ports_depend_on(after) != self._filled:
            self._fill()

    def _fill(self) -> None:
        network = self._session.network
        self._filled = ports_depend_on(network)
        model = self._list
        model.clear()
        nothing = QStandardItem(_NOTHING)
        nothing.setData("", _NAME)
        model.appendRow(nothing)
        for name in network.nodes:
            declared = self._session.declared(name)
            numbers = [p for p in declared.parameters if p.kind in NUMERIC] if declared else []
            if declared is None or declared.key == MACRO or not numbers:
                continue
            head = QStandardItem(titled(name, declared.title))
            head.setFlags(Qt.ItemFlag.NoItemFlags)
            model.appendRow(head)
            for parameter in numbers:
                model.appendRow(_item(name, parameter))
        node, _, chosen = self._name.rpartition(".")
        self.choose(node, chosen)


def _item(node: str, parameter: Parameter) -> QStandardItem:
    unit = f" ({parameter.param.unit})" if parameter.param.unit else ""
    item = QStandardItem(f"{label_of(parameter.name)} of {node}{unit}")
    item.setData(f"{node}.{parameter.name}", _NAME)
    item.setToolTip(tip(f"{parameter.param.text}\nIn network files: {node}.{parameter.name}"))
    return item
