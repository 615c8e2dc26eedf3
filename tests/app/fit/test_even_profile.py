"""Errors beside a parameter whose effect is even, where a straight line is no model of it."""

import numpy as np
import pytest

from app.fit.parameter_search import profiled_spread, refit_beside

ERROR = 0.01


def spread(seen, start):
    """Of a and b, where a + b² is seen with that error, and b² with ten times as much."""

    def residual(v):
        return np.array([(v[0] + v[1] ** 2 - 1.0) / ERROR, (v[1] ** 2 - seen) / (10 * ERROR)])

    def jacobian(v):
        return np.array([[1 / ERROR, 2 * v[1] / ERROR], [0.0, 2 * v[1] / (10 * ERROR)]])

    b = np.sqrt(seen)
    refit = refit_beside(
        residual=residual, jacobian=jacobian, values=np.array([1.0 - seen, b]),
        lows=np.array([-9.0, 0.0]), highs=np.array([9.0, 5.0]),
    )  # fmt: skip
    return profiled_spread(
        refit=refit, index=1, values=np.array([1.0 - seen, b]), least=0.0, unit=1.0,
        first=start, high=5.0,
    )  # fmt: skip


@pytest.mark.parametrize("start", [0.01, 3.0])
def test_the_others_go_as_far_as_its_square_may(start):
    """At b = 0 a straight line has a known to 0.01; b² is 0 ± 0.1, and a goes with it."""
    a, b = spread(0.0, start)
    assert a == pytest.approx(0.1, rel=0.01)
    assert b == pytest.approx(np.sqrt(0.1), rel=0.01)


def test_what_differs_from_0_needs_no_profile():
    assert spread(0.3, 0.1) is None  # b² is three of its errors from 0
