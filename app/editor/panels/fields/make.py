"""The field for a parameter."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from app.editor.panels.fields.choice import (
    MOST_BUTTONS,
    ButtonsField,
    ListField,
    NumbersField,
    SwitchField,
    TextField,
    choices_of,
)
from app.editor.panels.fields.field import Field
from app.editor.panels.fields.number import NumberField
from app.editor.panels.fields.path import PathField
from app.editor.session import Session
from app.editor.theme import Theme
from core.modules.parameters import Parameter


def field_for(
    parameter: Parameter,
    session: Session,
    theme: Theme,
    parent: QWidget,
    *,
    writes: bool = False,
    buttons: bool = False,
) -> Field:
    """Make the field of the parameter's kind.

    Parameters
    ----------
    parameter : Parameter
        As declared.
    session : Session
        For the folder that file names are relative to.
    theme : Theme
        Colours.
    parent : QWidget
        Its parent.
    writes : bool
        Whether a file name is of one to be written.
    buttons : bool
        Whether choices are buttons, however many there are.
    """
    match parameter.kind:
        case "number" | "integer":
            return NumberField(parameter, theme, parent)
        case "switch":
            return SwitchField(parameter, theme, parent)
        case "choice":
            few = len(choices_of(parameter)) <= MOST_BUTTONS
            return (ButtonsField if few or buttons else ListField)(parameter, theme, parent)
        case "path":
            return PathField(parameter, theme, parent, session=session, writes=writes)
        case "numbers":
            return NumbersField(parameter, theme, parent)
        case "text":
            return TextField(parameter, theme, parent)
