"""Roots and ranges of probabilities, against closed forms."""

import math

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given
from hypothesis import strategies as st

from core.errors import ParameterError
from core.physics.numerics import brent_root, range_for_probability

CASES = [
    (lambda x: x**3 - 2, 0.0, 3.0, 2 ** (1 / 3)),
    (math.cos, 1.0, 2.0, math.pi / 2),
    (lambda x: math.exp(x) - 1e-6, -40.0, 3.0, math.log(1e-6)),
    (lambda x: (x - 0.1) ** 3, -1.0, 1.0, 0.1),
    (lambda x: math.copysign(1.0, x - 0.3), -1.0, 1.0, 0.3),
    (lambda x: 1 / x - 1e3, 1e-9, 1.0, 1e-3),
    (lambda x: x, -2.0, 0.0, 0.0),
    (lambda x: x - 5, 5.0, 9.0, 5.0),
]


@pytest.mark.parametrize(("function", "low", "high", "zero"), CASES)
def test_a_zero(function, low, high, zero):
    calls = []

    def counted(x):
        calls.append(x)
        return function(x)

    found = brent_root(counted, low=low, high=high)
    assert found == pytest.approx(zero, rel=1e-12, abs=1e-13)
    known, there = scipy.optimize.brentq(
        function, low, high, xtol=1e-14, maxiter=999, full_output=True
    )
    assert found == pytest.approx(known, abs=1e-12)
    assert abs(function(found)) <= abs(function(low))
    assert low <= found <= high
    assert len(calls) <= there.function_calls + 2


def test_without_a_change_of_sign_it_is_refused():
    with pytest.raises(ParameterError, match="must change sign"):
        brent_root(lambda x: x * x + 1, low=-1.0, high=1.0)


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
