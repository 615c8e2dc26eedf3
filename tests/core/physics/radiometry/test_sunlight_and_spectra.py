"""Sunlight against Stefan and Boltzmann; means over a band against quadrature."""

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.radiometry.spectra import mean_by_planck, white_surface_radiance

EDGE = ((0.5, 0.1), (0.67, 0.04), (0.75, 0.45), (0.9, 0.5), (3.0, 0.02))


def planck(wavelength_um, kelvin):
    """But for what does not depend on the wavelength."""
    return 1 / (
        wavelength_um**5 * mpmath.expm1(mpmath.mpf("14387.768775") / wavelength_um / kelvin)
    )


def test_all_sunlight_together_is_the_suns_part_of_sigma_t4():
    sigma, share = 5.670374419e-8, (6.957e8 / 1.495978707e11) ** 2
    whole = white_surface_radiance(cut_on_um=0.01, cut_off_um=1e4, sun_elevation_deg=90.0)
    assert whole == pytest.approx(share * sigma * 5800**4 / math.pi, rel=1e-6)
    assert math.pi * whole == pytest.approx(1361, rel=0.03)  # measured: Kopp and Lean 2011
    low = white_surface_radiance(cut_on_um=0.01, cut_off_um=1e4, sun_elevation_deg=30.0)
    assert low == pytest.approx(whole / 2, rel=1e-14)


def test_no_sun_on_the_horizon_and_none_below():
    ends = {"cut_on_um": 0.4, "cut_off_um": 0.7}
    assert white_surface_radiance(**ends, sun_elevation_deg=0.0) == 0.0
    with pytest.raises(ParameterError, match="0 to 90"):
        white_surface_radiance(**ends, sun_elevation_deg=-1.0)


@pytest.mark.parametrize(("low", "high"), [(0.4, 0.8), (0.68, 0.7), (0.6, 2.5), (3.1, 3.2)])
@pytest.mark.parametrize("kelvin", [800, 5800])
def test_mean_by_a_black_bodys_light(low, high, kelvin):
    knots = [low, *(w for w, _ in EDGE if low < w < high), high]

    def value(wavelength):
        return float(np.interp(float(wavelength), *zip(*EDGE, strict=True)))

    light = mpmath.quad(lambda w: planck(w, kelvin), knots)
    exact = mpmath.quad(lambda w: value(w) * planck(w, kelvin), knots) / light
    made = mean_by_planck(EDGE, cut_on_um=low, cut_off_um=high, temperature_K=[kelvin])
    assert made[0] == pytest.approx(float(exact), rel=1e-9)
