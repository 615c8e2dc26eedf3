"""Fields for a text, and for a list of numbers."""

from __future__ import annotations

from typing import Any

from app.editor.number_text import numbers_of, shown_numbers
from app.editor.panels.fields.field import TypedField
from core.errors import ParameterError


class TextField(TypedField):
    """A line of text."""

    def build(self) -> None:
        """Make the line, as wide as there is room."""
        edit = self.build_edit()
        if self.parameter.empty:
            edit.setPlaceholderText("empty")
        self.row.addWidget(self.label, 2)
        self.row.addWidget(edit, 4)
        self.row.addWidget(self.unit)

    def show_value(self, value: Any) -> None:
        """Show the text."""
        self.edit.show_text("" if value is None else str(value))


class NumbersField(TypedField):
    """A list of numbers: ``0, 0.1``."""

    def build(self) -> None:
        """Make a line of its own below the label."""
        edit = self.build_edit()
        edit.setPlaceholderText("none: type numbers as 0, 0.1")
        self.row.addWidget(self.label, 1)
        self.row.addWidget(self.unit)
        self.column.addWidget(edit)

    def show_value(self, value: Any) -> None:
        """Show the numbers, all of each."""
        self.edit.show_text(shown_numbers(value or ()))

    def take(self, text: str) -> None:
        """Offer what was typed as numbers."""
        try:
            numbers = numbers_of(text, self.parameter)
        except ParameterError as error:
            self.refuse_typed(error)
            return
        self.offer(numbers)
