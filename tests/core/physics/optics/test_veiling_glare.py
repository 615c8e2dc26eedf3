"""Veiling glare against the Hankel transform of its spread, and the light within a radius."""

import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad

from core.errors import ParameterError
from core.physics.optics.veiling_glare import veiling_glare_mtf


@pytest.mark.thorough(but=2)
@pytest.mark.parametrize("length", [0.3, 4.0])
@pytest.mark.parametrize("rho", [0.02, 0.3, 1.1])
def test_it_is_the_hankel_transform_of_the_spread(length, rho):
    """2π∫ r·J0(2πρr)·ℓ/(2π(r² + ℓ²)^1.5) dr, over the zeros of the Bessel function."""
    with mpmath.workdps(20):
        spread = mpmath.quadosc(
            lambda r: r * mpmath.besselj(0, 2 * mpmath.pi * rho * r)
            * length / (r * r + length**2) ** 1.5,
            [0, mpmath.inf], zeros=lambda n: mpmath.besseljzero(0, n) / (2 * mpmath.pi * rho),
        )  # fmt: skip
    found = veiling_glare_mtf(rho=rho, share=0.2, length_mrad=length)
    assert float(found) == pytest.approx(0.8 + 0.2 * float(spread), rel=1e-9)


def test_half_of_it_falls_within_the_named_radius():
    inside = quad(lambda r: r * 2.0 / (r * r + 4.0) ** 1.5, 0, math.sqrt(3) * 2.0)[0]
    assert inside == pytest.approx(0.5, rel=1e-12)


def test_its_ends():
    found = veiling_glare_mtf(rho=[0.0, 1e9], share=0.1, length_mrad=5.0)
    np.testing.assert_array_equal(found, [1.0, 0.9])
    assert veiling_glare_mtf(rho=0.3, share=0.0, length_mrad=5.0) == 1.0


@pytest.mark.parametrize(
    ("wrong", "name"),
    [({"share": 1.1}, "share"), ({"share": -0.1}, "share"), ({"length_mrad": 0.0}, "length_mrad"),
     ({"rho": math.nan}, "rho")],
)  # fmt: skip
def test_what_is_refused(wrong, name):
    with pytest.raises(ParameterError, match=name):
        veiling_glare_mtf(**{"rho": 1.0, "share": 0.1, "length_mrad": 2.0, **wrong})
