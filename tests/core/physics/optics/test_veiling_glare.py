"""Veiling glare against the Hankel transform of its spread, and the light within a radius."""

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.optics.blur import harvey_mtf, harvey_scatter, veiling_glare_mtf


@pytest.mark.parametrize(("length", "rho"), [(0.3, 0.3)])
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


def test_its_ends():
    found = veiling_glare_mtf(rho=[0.0, 1e9], share=0.1, length_mrad=5.0)
    np.testing.assert_array_equal(found, [1.0, 0.9])
    assert veiling_glare_mtf(rho=0.3, share=0.0, length_mrad=5.0) == 1.0


@pytest.mark.parametrize(("s", "l_mrad"), [(-1.5, 2.0), (-2.0, 500.0)])
def test_harvey_is_the_transform_of_its_bsdf(s, l_mrad):
    """2π∫ b·[1 + (β/l)²]^(s/2)·J0(2πρβ)·β dβ up to the horizon, and its total."""
    length, b, surfaces = l_mrad / 1000, 1e-2, 3

    def bsdf(beta):
        return b * (1 + (beta / length) ** 2) ** (s / 2) * beta

    with mpmath.workdps(16):
        ends = sorted({0.0, 1.0, *(x for x in (length / 2, 2 * length, 9 * length) if x < 1)})
        total = 2 * mpmath.pi * mpmath.quad(bsdf, ends)
        found = harvey_scatter(b_per_sr=b, s=s, l_mrad=l_mrad)
        assert found == pytest.approx(float(total), rel=1e-12)
        for rho in (0.004, 0.049):  # of sums, and of the series
            k = 2 * mpmath.pi * 1000 * rho
            cuts = sorted({*ends, *np.arange(1, float(k) / math.pi) * math.pi / float(k)})
            spread = 2 * mpmath.pi * mpmath.quad(lambda x: bsdf(x) * mpmath.besselj(0, k * x),  # noqa: B023
                                                 cuts)  # fmt: skip
            mtf = harvey_mtf(rho=rho, b_per_sr=b, s=s, l_mrad=l_mrad, surfaces=surfaces)
            assert float(mtf) == pytest.approx(float((1 - total + spread) ** surfaces), abs=1e-11)


def test_harvey_ends_and_joins():
    how = {"b_per_sr": 0.1, "s": -1.5, "l_mrad": 10.0}
    share = harvey_scatter(**how)
    found = harvey_mtf(rho=[[0.0, 1e9]], surfaces=2, **how)
    np.testing.assert_allclose(found, [[1.0, (1 - share) ** 2]], rtol=1e-6)
    assert found[0, 0] == 1.0
    edge = 300 / (2000 * math.pi)
    below, above = harvey_mtf(rho=[edge * (1 - 1e-12), edge * (1 + 1e-12)], **how)
    assert below == pytest.approx(above, abs=1e-11)
    with pytest.raises(ParameterError, match=r"b_per_sr = 50000.*total integrated scatter"):
        harvey_scatter(b_per_sr=5e4, s=-1.5, l_mrad=10.0)
