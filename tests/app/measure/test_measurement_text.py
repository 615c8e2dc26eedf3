"""A measurement in words: figures to the digits of their errors, and what is missing."""

import pytest

from app.measure.measurement_text import with_error


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.187208, 0.000277855, "0.18721 ± 0.00028"),
        (1e-10, 0.0034, "0.0000 ± 0.0034"),
        (12345.6, 480.0, "12350 ± 480"),
        (3.2e-9, 1.1e-10, "3.2e-09 ± 1.1e-10"),
        (0.12345, None, "0.1235"),
        (None, 1.0, "–"),
    ],
)
def test_a_figure_has_the_digits_that_its_error_leaves(value, error, text):
    assert with_error(value, error) == text
