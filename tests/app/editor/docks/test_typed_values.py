"""Values of a sweep as a person types them."""

import pytest

from app.editor.window.background_runs import typed_values
from core.errors import ImagechainError
from core.modules.declaration import declaration
from nodes.library import standard_library


def parameter(module, name):
    return declaration(standard_library()[module]).parameter(name)


SIGMA = parameter("gaussian_mtf", "sigma_x_mrad")
WIDTH = parameter("test_scene", "width")


@pytest.mark.parametrize(
    ("text", "values", "log"),
    [
        ("0:1:5", (0.0, 0.25, 0.5, 0.75, 1.0), False),
        ("0.1 : 10 : 3 : log", (0.1, 1.0, 10.0), True),
        ("0.1, 0.3", (0.1, 0.3), False),
        ("600 urad, 2*0.3, .25", (0.6, 0.25), False),  # twice the same is once
        ("100 urad : 0.3 : 3", (0.1, 0.2, 0.3), False),
    ],
)
def test_ranges_and_lists(text, values, log):
    made, as_factors = typed_values(text, SIGMA)
    assert made == pytest.approx(values, rel=1e-12)
    assert as_factors is log


def test_whole_numbers_stay_whole():
    values, _ = typed_values("64:70:4", WIDTH)
    assert values == (64, 66, 68, 70)
    assert all(isinstance(value, int) for value in values)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no values"),
        ("0:1", "no range"),
        ("a:1:5", "'a' is no number"),
        ("0:1:1", "COUNT = 1 is not allowed: from 2 to 1000"),
        ("1:1:3", "two different numbers"),
        ("0:1:3:log", "above 0"),
        ("0.1, -2", "-2 mrad is not allowed: a number of at least 0"),
    ],
)
def test_what_does_not_fit_is_said_in_one_line(text, said):
    with pytest.raises(ImagechainError) as refused:
        typed_values(text, SIGMA)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
