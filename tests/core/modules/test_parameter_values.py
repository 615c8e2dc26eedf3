"""Values a parameter refuses: one line with its name, the value, its unit and what is allowed."""

from typing import Annotated, Literal

import pytest

from core.errors import ParameterError, unit_of
from core.modules.declaration import Module, declaration
from core.modules.parameters import Param


class Lens(Module, key="lens_of_test", title="Lens", group="Test"):
    """Parameters of several kinds, each with a unit."""

    length_mm: Annotated[float, Param("length", unit="mm", low=0, above=True)] = 1.0
    range_m: Annotated[float | None, Param("range", unit="m", low=2, high=9, below=True)] = None
    count: Annotated[int, Param("count", unit="px", low=1, high=8)] = 1
    places: Annotated[tuple[float, ...], Param("places", unit="mrad")] = ()
    open: Annotated[bool, Param("open", unit="-")] = True
    side: Annotated[Literal["left", "right"], Param("side", unit="side")] = "left"
    words: Annotated[str, Param("words")] = ""

    def run(self) -> None:
        raise NotImplementedError


@pytest.mark.parametrize(
    ("name", "value", "line"),
    [
        ("length_mm", 0, "length_mm = 0 mm is not allowed: must be a number above 0"),
        ("length_mm", "x", "length_mm = 'x' mm is not allowed: must be a number above 0"),
        (
            "length_mm",
            "3 um",
            "length_mm = '3 um' is not allowed: must be a number above 0, in mm; to "
            "convert from another unit, begin with '=': '=3 um'",
        ),
        ("range_m", 9, "range_m = 9 m is not allowed: must be a number from 2 below 9 or empty"),
        ("count", 1.5, "count = 1.5 px is not allowed: must be a whole number from 1 to 8"),
        ("count", 9, "count = 9 px is not allowed: must be a whole number from 1 to 8"),
        ("places", 1, "places = 1 mrad is not allowed: must be a list of numbers"),
        ("open", 1, "open = 1 - is not allowed: must be true or false"),
        ("side", "top", "side = 'top' side is not allowed: must be one of left, right"),
        ("words", 1, "words = 1 is not allowed: must be text"),
        ("words", "a\0", "words = 'a\\x00' is not allowed: must be text"),
    ],
)
def test_a_refusal_names_value_unit_and_what_is_allowed(name, value, line):
    with pytest.raises(ParameterError) as caught:
        declaration(Lens).parameter(name).coerce(value)
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("sigma_mrad", "mrad"), ("velocity_m_per_s", "m/s"), ("extinction_per_km", "1/km"),
        ("gain_e_per_dn", "e-/DN"), ("detectors_per_line", ""), ("percent", ""), ("fill_x", ""),
    ],
)  # fmt: skip
def test_a_unit_follows_from_the_name_it_ends(name, unit):
    assert unit_of(name) == unit
