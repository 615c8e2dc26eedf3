"""What base classes of panels leave open is asked for when a widget is made."""

import inspect

import pytest

from app.editor.panels.fields.field import Field
from app.editor.panels.illustrations.illustration import Illustration


def nothing(*_):
    """Stands for a method that is there."""
    return ()


@pytest.mark.parametrize(
    ("base", "body", "missing"),
    [
        (Field, {}, "build"),
        (Field, {"build": nothing}, "show_value"),
        (Illustration, {}, "draw"),
        (Illustration, {"draw": nothing, "queries": nothing}, "take"),
    ],
)
def test_a_class_that_leaves_it_open_is_refused(base, body, missing):
    half = type("Half", (base,), body)
    arguments = list(inspect.signature(base).parameters)
    with pytest.raises(TypeError, match=f"Half does not define {missing}, which"):
        half(**dict.fromkeys(arguments))
