"""Numbers on panels: shown without loss, read as they are meant, placed on sliders."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.editor.declared_text import (
    number_of,
    numbers_of,
    shown_figure,
    shown_number,
    typed_number,
)
from app.editor.panels.fields.number import Scale, scale_of
from core.errors import ParameterError
from core.modules.declaration import declaration
from core.modules.parameters import Param, Parameter
from panel_hands import LIBRARY, NUMBERS, drop, field_of, panel_area, type_in

ANY = Parameter("x", "number", 0.0, (), False, Param("any number", unit="m"))
FINITE = st.floats(allow_nan=False, allow_infinity=False)


@given(FINITE)
def test_a_number_is_read_as_it_was_shown(value):
    again = ANY.coerce(number_of(shown_number(value), ANY))
    assert again == value
    assert len(shown_number(value)) <= 24


@given(st.integers(-9_999_999_999, 9_999_999_999), st.integers(-12, 12))
def test_ten_digits_are_shown_as_they_are(digits, power):
    """No more digits are shown than a person would have typed."""
    value = float(f"{digits}e{power}")
    shown = shown_number(value).lstrip("-").split("e")[0].replace(".", "").strip("0")
    assert shown == str(abs(digits)).strip("0")


def test_friendly_spellings_are_understood():
    for text, number in (
        ("1,5", 1.5),
        ("\N{MINUS SIGN}3", -3),
        ("0,125", 0.125),
        ("9223372036854775807", 2**63 - 1),
        ("", None),
    ):
        assert number_of(text, ANY) == number, text
    for text, numbers in (
        ("0, 0.1", [0, 0.1]),
        ("0,1; 0,5", [0.1, 0.5]),
        ("1 2.5", [1, 2.5]),
        ("", []),
    ):
        assert numbers_of(text, ANY) == numbers, text


@pytest.mark.parametrize("text", ["1,000", "abc", "nan", "1e999", "1_000", "1 2"])
def test_senseless_texts_are_refused(text):
    with pytest.raises(ParameterError, match=r"x = .* m is not allowed"):
        ANY.coerce(number_of(text, ANY))


@pytest.mark.parametrize(
    ("text", "why"),
    [("(2 m) m", "a number has two units; the second is m"), ("3/0", "3 / 0 divides by zero")],
)
def test_an_expressions_fault_is_told_as_it_is(text, why):
    with pytest.raises(ParameterError, match=f"is not allowed: {why}"):
        typed_number(text, ANY)


def test_figures_are_brief():
    for value, text in ((None, "—"), (True, "yes"), (0.96836766, "0.96837"), (3e13, "3e13")):
        assert shown_figure(value) == text


@pytest.mark.parametrize("key", dict(NUMBERS))
def test_all_positions_of_a_slider_are_allowed_and_in_order(key):
    for name in (name for owner, name in NUMBERS if owner == key):
        parameter = declaration(LIBRARY[key]).parameter(name)
        scale = scale_of(parameter)
        values = [
            scale.value_at(position / scale.positions) for position in range(scale.positions + 1)
        ]
        for value in values:
            parameter.coerce(value)
        assert values == sorted(values), name
        assert len(set(values)) > min(len(values), 200) / 4, name
        if parameter.param.slider is not None and parameter.param.slider[1] <= 1e6:
            low, high = parameter.param.slider
            assert values[-1] == high, name
            least = values[0]
            assert least in (low, 0) or math.isclose(least, low, abs_tol=high / 500), name


def test_a_step_of_a_logarithmic_slider_is_a_tenth_of_the_decade():
    for value, steps, stepped in (
        (340.0, 1, 350.0),
        (1.0, 1, 1.1),
        (100.0, -1, 99.0),  # downwards the decade below begins at once
        (999.9999999999, 1, 1100.0),  # as good as 1000
        (1.2e5, 3, 1.5e5),
        (340.0, -100, 34.0),  # never below a tenth, however many at once
    ):
        found = Scale(1.0, 1e6, log=True, zero=True).stepped(value, steps)
        assert found == pytest.approx(stepped, rel=1e-10), value


@pytest.mark.parametrize("text", ["1.23456789012345678", "1e-7"])
def test_the_slider_never_rounds_what_was_typed(qtbot, session, text):
    area = panel_area(qtbot, session)
    drop(session, "gaussian_mtf")
    field = field_of(area, session, "sigma_x_mrad")
    type_in(field.edit, text)
    assert session.network.nodes["node"].params["sigma_x_mrad"] == float(text)
    before, position = session.document.text(), session.document.position
    for widget in (field.slider, field.edit, field.slider):
        widget.setFocus()
    type_in(area.panels["node"].body.sections.field("sigma_y_mrad").edit, "2")
    assert session.document.position == position + 1
    session.undo()
    assert session.document.text() == before
    assert float(field.edit.text()) == float(text)


def test_a_number_typed_on_a_slider_goes_into_its_field(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "detector_mtf")
    sections = area.panels["node"].body.sections
    first, second = (sections.field(f"detector_{axis}_um") for axis in "xy")
    QTest.keyClicks(first.edit, "30")
    QTest.keyClick(first.edit, Qt.Key.Key_Return)
    QTest.keyClicks(second.slider, "2")  # where Tab leads from the field above
    assert second.edit.text() == "2"
    QTest.keyClicks(second.edit, "0")
    QTest.keyClick(second.edit, Qt.Key.Key_Return)
    params = session.network.nodes["node"].params
    assert (params["detector_x_um"], params["detector_y_um"]) == (30.0, 20.0)
