"""Losses of transfer functions and their shares, worked out by hand."""

import math

import pytest

from core.physics.noise.noise_equivalent import loss, shares_of_losses

LN2 = 0.6931471805599453


@pytest.mark.parametrize(
    ("mtf", "expected"),
    [(1.0, 0.0), (0.5, LN2), (-0.5, LN2), (0.125, 3 * LN2), (4.0, -2 * LN2), (0.0, math.inf)],
)
def test_loss_is_the_logarithm_of_the_modulus(mtf, expected):
    assert loss(mtf=mtf) == pytest.approx(expected, rel=1e-15)


def test_no_loss_has_no_sign():
    assert math.copysign(1.0, loss(mtf=1.0)) == 1.0
    assert [math.copysign(1.0, each) for each in shares_of_losses(losses=[0.0, 1.0])] == [1.0, 1.0]


@pytest.mark.parametrize(
    ("losses", "expected"),
    [
        ([], []),
        ([0.0, 0.0], [0.0, 0.0]),
        ([3.0, 1.0], [0.75, 0.25]),
        ([3.0, 1.0, -1.0], [0.75, 0.25, -0.25]),  # a quarter of the loss is made up for
        ([3.0, -6.0], [1.0, -2.0]),  # more is amplified than was lost
        ([-3.0, -1.0], [-0.75, -0.25]),
        ([1.0, math.inf, -1.0], [0.0, 1.0, 0.0]),
        ([math.inf, 5.0, math.inf], [0.5, 0.0, 0.5]),
    ],
)
def test_shares(losses, expected):
    assert shares_of_losses(losses=losses) == pytest.approx(expected, rel=1e-15)
