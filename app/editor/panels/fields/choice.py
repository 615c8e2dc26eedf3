"""Fields for one of a few values: buttons for up to four, else a list."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QButtonGroup, QComboBox, QSizePolicy, QWidget

from app.editor.declared_text import choice_text
from app.editor.number_text import numbers_of, shown_numbers
from app.editor.panels.fields.field import Field, TypedField
from app.editor.widgets import Check, FlowLayout, Radio, filled, takes_wheel
from core.errors import ParameterError
from core.modules.parameters import Parameter

MOST_BUTTONS = 4
MOST_LETTERS = 16


def choices_of(parameter: Parameter) -> tuple[Any, ...]:
    """What can be chosen, nothing included where that is allowed."""
    return ((None,) if parameter.empty else ()) + parameter.choices


class ButtonsField(Field):
    """Radio buttons beside the name; those that do not fit there stand on lines below."""

    def build(self) -> None:
        self.choices = choices_of(self.parameter)
        flow = filled(FlowLayout(across=6, down=2), self.label)
        self.row.addLayout(flow, 1)
        self.row.addWidget(self.unit)
        self.unit.setVisible(bool(self.parameter.param.unit))
        self.group = QButtonGroup(self)
        self.buttons: list[Radio] = []
        for number, choice in enumerate(self.choices):
            button = Radio(choice_text(choice), self)
            button.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
            self.named(button, f": {choice_text(choice)}", f"choice.{choice}")
            self.group.addButton(button, number)
            self.buttons.append(button)
            flow.addWidget(button)
        self.label.setMinimumHeight(self.buttons[0].sizeHint().height())
        self._offered = self.choices
        self.group.idToggled.connect(self._toggled)

    def show_value(self, value: Any) -> None:
        if value in self.choices:
            button = self.buttons[self.choices.index(value)]
            self.group.blockSignals(True)
            button.setChecked(True)
            self.group.blockSignals(False)
        self._show_offered()

    def narrow(self, offered: tuple[Any, ...]) -> None:
        self._offered = offered
        self._show_offered()

    def _show_offered(self) -> None:
        for choice, button in zip(self.choices, self.buttons, strict=True):
            button.setVisible(choice in self._offered or choice == self.value)

    def _toggled(self, number: int, on: bool) -> None:
        if on:
            self.offer(self.choices[number])


class ChoiceBox(QComboBox):
    """A list that the wheel scrolls past, unless it has the focus."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        if takes_wheel(self):
            super().wheelEvent(event)
        else:
            event.ignore()


class ListField(Field):
    def build(self) -> None:
        self.choices = choices_of(self.parameter)
        self.box = ChoiceBox(self)
        self.box.addItems([choice_text(choice) for choice in self.choices])
        self.box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.box.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self.box.setSizeAdjustPolicy(
            QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon
        )
        longest = max(len(self.box.itemText(n)) for n in range(self.box.count()))
        self.box.setMinimumContentsLength(min(longest, MOST_LETTERS))
        self.box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.named(self.box)
        self.label.setBuddy(self.box)
        self.box.activated.connect(self._activated)
        self.row.addWidget(self.label)
        self.row.addWidget(self.box, 1)
        self.row.addWidget(self.unit)
        self.lines_up = bool(self.parameter.param.unit)
        self.unit.setVisible(self.lines_up)

    def show_value(self, value: Any) -> None:
        if value in self.choices:
            self.box.setCurrentIndex(self.choices.index(value))

    def _activated(self, number: int) -> None:
        self.offer(self.choices[number])


# A field for what is on or off.


class SwitchField(Field):
    """A check box."""

    def build(self) -> None:
        self.box = Check(self.title, self)
        self.box.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self.named(self.box)
        self.box.clicked.connect(self._clicked)
        self.label.hide()
        self.unit.hide()
        self.row.addWidget(self.box)
        self.row.addStretch()

    def marked_label(self) -> QWidget:
        """The box bears the parameter's name."""
        return self.box

    def show_value(self, value: Any) -> None:
        self.box.setChecked(bool(value))

    def _clicked(self) -> None:
        self.offer(self.box.isChecked())


# Fields for a text, and for a list of numbers.


class TextField(TypedField):
    def build(self) -> None:
        edit = self.build_edit()
        if self.parameter.empty:
            edit.setPlaceholderText("empty")
        self.row.addWidget(self.label)
        self.row.addWidget(edit, 1)
        self.row.addWidget(self.unit)

    def show_value(self, value: Any) -> None:
        self.edit.show_text("" if value is None else str(value))


class NumbersField(TypedField):
    """A list of numbers: ``0, 0.1``."""

    def build(self) -> None:
        edit = self.build_edit()
        edit.setPlaceholderText("none: type numbers, as in 0, 0.1")
        self.row.addWidget(self.label)
        self.row.addWidget(edit, 1)
        self.row.addWidget(self.unit)

    def show_value(self, value: Any) -> None:
        self.edit.show_text(shown_numbers(value or ()))

    def take(self, text: str) -> None:
        try:
            numbers = numbers_of(text, self.parameter)
        except ParameterError as error:
            self.refuse_typed(error)
            return
        self.offer(numbers)
