"""Ranges of probabilities, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import ParameterError
from core.physics.numerics import range_for_probability

# The range of a probability, against plain bisection and in closed form.


def by_bisection(probability_at, wanted):
    """The logarithm of the range, halved until nothing is left to halve."""
    near, far = math.log(1e-3), math.log(1e9)
    while near < (middle := (near + far) / 2) < far:
        if probability_at(math.exp(middle)) >= wanted:
            near = middle
        else:
            far = middle
    return math.exp(near)


@given(
    st.floats(1e-2, 1e8), st.floats(0.05, 30), st.floats(0.01, 0.99), st.sampled_from([1, 7, 1000])
)
def test_same_as_bisection(half_m, steepness, wanted, levels):
    """1/(1 + (R/R50)^s), also in so many steps that it jumps."""

    def at(range_m):
        with np.errstate(over="ignore"):  # far away it is 0
            smooth = 1 / (1 + np.float64(range_m / half_m) ** steepness)
        return smooth if levels == 1 else np.floor(smooth * levels) / levels

    found = range_for_probability(probability_at=at, probability=wanted)
    if at(1e-3) < wanted:
        assert found is None
    elif at(1e9) >= wanted:
        assert found == math.inf
    else:
        assert found == pytest.approx(by_bisection(at, wanted), rel=3e-13)


@pytest.mark.parametrize("where", [2e-3, 10.0, 3e8])
def test_no_number_at_some_range_is_refused_by_its_range(where):
    def at(range_m):
        return np.where(np.abs(np.log(range_m / where)) < 2.0, np.nan, range_m < 1.0)

    with pytest.raises(ParameterError, match=r"probability_at\(.*0 to 1"):
        range_for_probability(probability_at=at, probability=0.5)
