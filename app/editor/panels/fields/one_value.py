"""Copying and pasting the value of one field, as text with its unit."""

from __future__ import annotations

from functools import partial
from typing import Any, Protocol

from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QMenu

from app.editor.declared_text import choice_text, shown_value
from app.editor.gestures import without_argument
from app.editor.number_text import shown_number
from core.editing.clipboard import VALUES_FORMAT, read_values
from core.errors import ImagechainError, ParameterError
from core.modules.parameters import Parameter
from core.network.linked_values import expression_text
from core.network.network import EXPRESSION

_SWITCH = {"on": True, "true": True, "yes": True, "off": False, "false": False, "no": False}


class ValueField(Protocol):
    """What a field has for its value to be copied and pasted."""

    parameter: Parameter
    value: Any

    @property
    def link_text(self) -> str:
        """The expression it follows; empty for none."""

    def take(self, text: str) -> None:
        """Offer what is written."""

    def refuse_typed(self, error: ParameterError) -> None:
        """Show why it is not taken."""

    def discard_typing(self) -> None:
        """Forget what was typed and not taken yet."""


def add_value_actions(menu: QMenu, field: ValueField) -> None:
    """Offer to copy the field's value, and to paste one."""
    clipboard = QGuiApplication.clipboard()
    text = value_text(field)
    copying = menu.addAction("Copy value")
    copying.setObjectName("copy_value")
    copying.setToolTip("Put it on the clipboard with its unit; of a linked one the expression")
    copying.setEnabled(bool(text))
    copying.triggered.connect(partial(without_argument, partial(clipboard.setText, text)))
    pasting = menu.addAction("Paste value")
    pasting.setObjectName("paste_value")
    pasting.setToolTip("Take the clipboard's value, in any unit that fits")
    pasting.setEnabled(bool(clipboard.text().strip()))
    paste = partial(paste_value, field, clipboard.text())
    pasting.triggered.connect(partial(without_argument, paste))


def value_text(field: ValueField) -> str:
    """The value with its unit, the expression behind ``=``; empty for none."""
    if field.link_text:
        return f"= {field.link_text}"
    parameter = field.parameter
    return "" if field.value is None else _text(parameter, field.value, parameter.param.unit)


def paste_value(field: ValueField, text: str) -> None:
    """Give a field the value of a text, or the one of its parameter of a node that was copied."""
    field.discard_typing()
    parameter = field.parameter
    try:
        text = (_value_of_node(parameter, text) if VALUES_FORMAT in text else text).strip()
    except ParameterError as error:
        field.refuse_typed(error)
    except ImagechainError as error:
        field.refuse_typed(ParameterError(parameter.name, text[:40], error.message))
    else:
        # Not every unit is one that can be typed; its own need not be read.
        unit = parameter.param.unit
        is_number = parameter.kind in ("number", "integer") and not text.startswith("=")
        field.take(text.removesuffix(f" {unit}") if unit and is_number else text)


def chosen(parameter: Parameter, text: str) -> Any:
    """The choice, or the state of a switch, that a text names; the text where there is none."""
    if parameter.kind == "switch":
        return _SWITCH.get(text.lower(), text)
    options = (*parameter.choices, *((None,) if parameter.empty else ()))
    return next((one for one in options if text in (str(one), choice_text(one))), text)


def _value_of_node(parameter: Parameter, text: str) -> str:
    copied, name = read_values(text), parameter.name
    if name not in copied.values:
        raise ParameterError(name, None, "the clipboard's node has no such value")
    raw = copied.values[name]
    if isinstance(raw, dict) and EXPRESSION in raw:
        return f"= {expression_text(raw)}"
    return "" if raw is None else _text(parameter, raw, copied.units.get(name, ""))


def _text(parameter: Parameter, value: Any, unit: str) -> str:
    if parameter.kind in ("number", "integer") and type(value) in (int, float):
        return f"{shown_number(value)} {unit}".strip()
    return "" if value in ((), []) else shown_value(parameter, value)
