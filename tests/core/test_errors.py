"""Values that are not allowed, and names that are near to one that is not there."""

import pytest

from core.errors import ParameterError, alike
from core.modules.parameters import coerce_all

KNOWN = ("gaussian_mtf", "jitter_mtf", "diffraction_mtf", "poisson_noise")


@pytest.mark.parametrize(
    ("name", "found"),
    [("jitter", "jitter_mtf"), ("gausian_mtf", "gaussian_mtf"), ("noise", "poisson_noise")],
)
def test_a_part_or_a_slip_finds_the_name(name, found):
    suggestion = alike(name, KNOWN)
    assert found in suggestion
    assert not [other for other in KNOWN if other != found and other in suggestion]


@pytest.mark.parametrize(
    ("allowed", "rule"),
    [
        ("at most 2", "must be at most 2"),
        ("text or empty", "must be text or empty"),
        ("(3,), the shape of mtf", "must be (3,), the shape of mtf"),
        ("must be empty", "must be empty"),
        ("a.tif has 3 bands", "a.tif has 3 bands"),
        ("the file a.tif has 3 bands", "the file a.tif has 3 bands"),
    ],
)
def test_a_range_is_what_a_value_must_be(allowed, rule):
    assert str(ParameterError("f", 3, allowed)) == f"f = 3 is not allowed: {rule}"


def test_a_clause_may_begin_as_a_range_does():
    with pytest.raises(ParameterError, match="not allowed: 3-D Noise has no such parameter"):
        coerce_all((), {"f": 3}, "3-D Noise")
