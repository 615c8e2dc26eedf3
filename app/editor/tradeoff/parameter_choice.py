"""The choice of a number of the network, by node."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QStandardItem
from PySide6.QtWidgets import QComboBox, QCompleter, QLineEdit, QWidget

from app.editor.declared_text import label_of, tip, titled
from app.editor.session import Session
from app.editor.viewers.node_choice import VALUE, NodeChoice, entry
from core.modules.parameters import Parameter
from core.network.network import MACRO

NUMERIC = ("number", "integer")
_NOTHING = "Choose a parameter"


class ParameterChoice(NodeChoice):
    """Every number of every node, under the names of the nodes.

    Signals
    -------
    chosen(node, parameter)
        The person has chosen one.
    """

    chosen = Signal(str, str)

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, _NOTHING, parent)
        self._field = QLineEdit(self)
        self.setMinimumContentsLength(16)
        self._make_searchable()
        self.fill()

    def _make_searchable(self) -> None:
        """What is typed lists the parameters in which it occurs, of any node."""
        self.setLineEdit(self._field)  # which makes it editable
        self.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        completer = QCompleter(self.entries, self)
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
            place = self.findData(text, VALUE)
        if place < 0 or not self.itemData(place, VALUE):
            self.setCurrentIndex(max(0, self.findData(self.value, VALUE)))
            self._field.setText(self.currentText())
        elif self.itemData(place, VALUE) != self.value:
            self.setCurrentIndex(place)
            self.take_at(place)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """All of the text is replaced by what is typed."""
        super().focusInEvent(event)
        QTimer.singleShot(0, self._select_all)

    def _select_all(self) -> None:
        """Backwards, so that the beginning of a long name stays in sight."""
        end = len(self._field.text())
        self._field.setSelection(end, -end)

    def show_value(self, value: str) -> None:
        """From its beginning, which is the parameter: the field would show the end."""
        super().show_value(value)
        self._field.setCursorPosition(0)

    def choose(self, node: str, parameter: str) -> None:
        """Show one as chosen, without a signal; empty names: none."""
        self.show_value(f"{node}.{parameter}" if node else "")

    def groups(self) -> Iterable[tuple[str, Sequence[QStandardItem]]]:
        """The numbers by node; a macro has none of its own."""
        for name in self.session.network.nodes:
            declared = self.session.declared(name)
            numbers = [p for p in declared.parameters if p.kind in NUMERIC] if declared else []
            if declared is not None and declared.key != MACRO and numbers:
                yield titled(name, declared.title), [_entry(name, number) for number in numbers]

    def take(self, value: str | None) -> None:
        """Signal the parameter; of what is none, go back to the one before."""
        if value:
            self.value = value
            node, _, parameter = value.rpartition(".")
            self.chosen.emit(node, parameter)
        else:
            self.setCurrentIndex(max(0, self.findData(self.value, VALUE)))


def _entry(node: str, parameter: Parameter) -> QStandardItem:
    unit = f" ({parameter.param.unit})" if parameter.param.unit else ""
    name = f"{node}.{parameter.name}"
    text = f"{label_of(parameter.name)} of {node}{unit}"
    return entry(text, name, tip(f"{parameter.param.text}\nIn network files: {name}"))
