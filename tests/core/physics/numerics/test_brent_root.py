"""Zeros by Brent's method against scipy's, and where they are known."""

import math

import pytest
import scipy.optimize

from core.errors import ParameterError
from core.physics.numerics import brent_root

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
    assert found == pytest.approx(
        scipy.optimize.brentq(function, low, high, xtol=1e-14, maxiter=999), abs=1e-12
    )
    assert abs(function(found)) <= abs(function(low))
    assert low <= found <= high
    assert len(calls) <= 202  # a triple zero is slow, as it is for scipy


def test_it_is_faster_than_halving():
    calls = []

    def counted(x):
        calls.append(x)
        return math.log(x) + 7

    assert brent_root(counted, low=1e-9, high=1.0) == pytest.approx(math.exp(-7), rel=1e-12)
    assert len(calls) < 30


def test_without_a_change_of_sign_it_is_refused():
    with pytest.raises(ParameterError, match="zero between"):
        brent_root(lambda x: x * x + 1, low=-1.0, high=1.0)
