"""Filtering along lines against sums written out."""

import numpy as np
import pytest

from core.evaluation.store import Store
from core.evaluation.work import Policy, Work
from core.transfer.factors import Grid, Law, Separable
from core.transfer.scan_lines import filter_lines
from slow_reference.filtering import filtered_lines

TOLERANCE = {"double": 1e-12, "single": 2e-6}


def modulus(frequency, tau):
    return 1 / np.hypot(1, 2 * np.pi * frequency * tau)


def angle(frequency, tau):
    return -np.arctan(2 * np.pi * frequency * tau)


POLE = (
    Separable(Law.of(modulus, tau=0.7), None),
    Separable(Law.of(angle, tau=0.7), None, part="ptf"),
)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("shape", [(1, 1), (3, 2), (4, 9), (2, 16)])
def test_equals_the_sum_written_out(shape, edges, precision):
    work = Work(Policy(precision=precision), Store())
    image = np.random.default_rng(5).uniform(30, 50, shape).astype(work.policy.dtype)
    grid = Grid(*shape, 0.9, 0.9)
    got = filter_lines(work, image, factors=POLE, grid=grid, edges=edges)
    expected = filtered_lines(
        image.astype(float), lambda xi: 1 / (1 + 2j * np.pi * 0.7 * xi), np.float64(0.9), edges
    )
    assert got.dtype == work.policy.dtype
    assert np.abs(got - expected).max() <= TOLERANCE[precision] * 50


def test_a_scan_towards_plus_x_delays_towards_plus_x():
    work = Work(Policy(precision="double"), Store())
    line = np.zeros((1, 65))
    line[0, 20] = 1.0
    got = filter_lines(work, line, factors=POLE, grid=Grid(1, 65, 0.9, 0.9), edges="reflect")[0]
    assert got[21:30].sum() > 3 * got[11:20].sum()
