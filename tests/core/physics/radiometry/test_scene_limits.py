"""The brightest surfaces of the Earth, by quadrature of Planck's law and the solar constant."""

import math

import pytest

from core.physics.radiometry.spectra import brightest_surface_radiance, coldest_for_radiance
from planck_truth import band_radiance

SOLAR_CONSTANT_W_M2 = 1361.0  # nominal; Kopp and Lean 2011 measured 1360.8


@pytest.mark.parametrize("band", [(8.0, 14.0), (3.0, 5.0), (0.4, 0.7), (1.0, 1.7)])
def test_a_band(band):
    sunlight = band_radiance(*band, 5772.0) * (6.957e8 / 1.495978707e11) ** 2
    expected = band_radiance(*band, 273.15 + 80.8) + sunlight
    assert brightest_surface_radiance(band_um=band) == pytest.approx(expected, rel=1e-9)


def test_all_wavelengths_are_the_hottest_surface_and_the_solar_constant():
    hot = 5.670374419e-8 * 353.95**4 / math.pi
    expected = hot + SOLAR_CONSTANT_W_M2 / math.pi
    assert brightest_surface_radiance(band_um=None) == pytest.approx(expected, rel=2e-4)
    assert brightest_surface_radiance(band_um=(0.05, 1000.0)) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("temperature", [250.0, 300.0, 1000.0])
def test_no_band_has_the_radiance_of_all_below_that_temperature(temperature):
    whole = band_radiance(0.01, 1e5, temperature)
    assert coldest_for_radiance(radiance=whole) == pytest.approx(temperature, rel=1e-4)
    part = band_radiance(8.0, 14.0, temperature)
    assert coldest_for_radiance(radiance=part) < temperature
