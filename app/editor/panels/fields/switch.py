"""A field for what is on or off."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from app.editor.panels.fields.field import Field
from app.editor.widgets import Check


class SwitchField(Field):
    """A check box."""

    def build(self) -> None:
        """Make the box, which bears the label."""
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
        """Show on or off; setting it does not count as a click."""
        self.box.setChecked(bool(value))

    def _clicked(self) -> None:
        self.offer(self.box.isChecked())
