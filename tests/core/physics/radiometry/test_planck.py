"""Planck's law against the closed sum of incomplete gamma functions in 50 digits."""

import math

import numpy as np
import pytest
import scipy.constants as sc
from mpmath import exp, expm1, factorial, mp, mpf

from core.errors import DataError
from core.physics.noise import noise_equivalent as ne
from core.physics.radiometry import planck as constants
from core.physics.radiometry.planck import (
    band_photon_radiance,
    band_radiance,
    band_radiance_derivative,
    brightness_temperature,
    spectral_radiance,
)
from core.physics.radiometry.spectra import brightest_surface_radiance, coldest_for_radiance
from planck_truth import band_radiance as true_band
from reference_cases import reference_cases

BANDS = [(8, 12), (3, 5), (0.4, 0.7), (0.3, 30), (10, 10.0001), (8, 8 * (1 + 1e-9)), (14, 30)]
TEMPERATURES = [20.0, 77.0, 150.0, 285.0, 303.0, 1000.0, 2856.0, 6000.0]
CASES = [(a, b, T) for a, b in BANDS for T in TEMPERATURES if 14388 / (b * T) < 700]

with mp.workdps(50):
    H, C, K = mpf("6.62607015e-34"), mpf(299792458), mpf("1.380649e-23")


@pytest.fixture(autouse=True)
def _fifty_digits():
    with mp.workdps(50):
        yield


def tail(x, power):
    """Integral of t^power/(e^t - 1) from x to infinity."""
    total, decay, ratio = mpf(0), mpf(1), exp(-x)
    terms = [factorial(power) / factorial(power - j) * x ** (power - j) for j in range(power + 1)]
    for n in range(1, 1_000_000):
        decay *= ratio
        term = decay * sum(t / mpf(n) ** (j + 1) for j, t in enumerate(terms))
        total += term
        if term < total * mpf(10) ** -40:
            return total
    raise AssertionError(f"the sum from {x} does not end")


def limits(cut_on, cut_off, temperature):
    c2_um = H * C / K * 10**6
    return c2_um / (mpf(cut_off) * temperature), c2_um / (mpf(cut_on) * temperature)


def true_radiance(cut_on, cut_off, temperature):
    low, high = limits(cut_on, cut_off, temperature)
    scale = 2 * K**4 * mpf(temperature) ** 4 / (H**3 * C**2)
    return scale * (tail(low, 3) - tail(high, 3))


def true_slope(cut_on, cut_off, temperature):
    low, high = limits(cut_on, cut_off, temperature)
    edge = [x**4 / expm1(x) for x in (low, high)]
    scale = 2 * K**4 * mpf(temperature) ** 3 / (H**3 * C**2)
    return scale * (4 * (tail(low, 3) - tail(high, 3)) + edge[0] - edge[1])


def true_photons(cut_on, cut_off, temperature):
    low, high = limits(cut_on, cut_off, temperature)
    scale = 2 * K**3 * mpf(temperature) ** 3 / (H**3 * C**2)
    return scale * (tail(low, 2) - tail(high, 2))


def relative_error(got, truth):
    return float(abs(mpf(float(got)) / truth - 1))


@pytest.mark.thorough(but=59)
@pytest.mark.parametrize(
    ("function", "truth"),
    [
        (band_radiance, true_radiance),
        (band_radiance_derivative, true_slope),
        (band_photon_radiance, true_photons),
    ],
)
@pytest.mark.parametrize(("cut_on", "cut_off", "temperature"), CASES)
def test_band_quantities_reach_twelve_digits(function, truth, cut_on, cut_off, temperature):
    expected = truth(cut_on, cut_off, temperature)
    got = function(cut_on_um=cut_on, cut_off_um=cut_off, temperature_K=temperature)
    assert isinstance(got, float)
    assert relative_error(got, expected) <= 1e-12
    # a large array takes the way by Chebyshev fits
    many = np.linspace(temperature, 1.9 * temperature, 3000).reshape(30, 100)
    fitted = function(cut_on_um=cut_on, cut_off_um=cut_off, temperature_K=many)
    assert fitted.shape == many.shape
    assert relative_error(fitted[0, 0], expected) <= 1e-12


@pytest.mark.parametrize(("cut_on", "cut_off", "temperature"), CASES)
def test_brightness_temperature_reaches_twelve_digits(cut_on, cut_off, temperature):
    radiance = float(true_radiance(cut_on, cut_off, temperature))
    got = brightness_temperature(radiance=radiance, cut_on_um=cut_on, cut_off_um=cut_off)
    assert got == pytest.approx(temperature, rel=1e-12)
    many = np.linspace(radiance, 3 * radiance, 3000)
    fitted = brightness_temperature(radiance=many, cut_on_um=cut_on, cut_off_um=cut_off)
    assert fitted[0] == pytest.approx(temperature, rel=1e-12)


def test_all_wavelengths_together_give_stefan_boltzmann():
    got = band_radiance(cut_on_um=1e-3, cut_off_um=1e8, temperature_K=300.0)
    assert np.pi * got == pytest.approx(sc.sigma * 300.0**4, rel=1e-12)
    assert pytest.approx(sc.sigma, rel=1e-9) == constants.STEFAN_BOLTZMANN_W_M2_K4


@pytest.mark.parametrize(("wavelength", "temperature"), [(10, 300), (0.5, 6000), (4, 20), (1e6, 3)])
def test_spectral_radiance(wavelength, temperature):
    x = H * C / (mpf(wavelength) * mpf("1e-6") * K * temperature)
    truth = 2 * H * C**2 / (mpf(wavelength) * mpf("1e-6")) ** 5 / expm1(x) * mpf("1e-6")
    assert relative_error(spectral_radiance(wavelength, temperature), truth) <= 1e-12


@pytest.mark.parametrize("temperature", [0.0, 1e-300, 1e-9, 1.0])
def test_cold_bodies_emit_nothing(temperature):
    band = {"cut_on_um": 8.0, "cut_off_um": 12.0}
    assert band_radiance(**band, temperature_K=temperature) == 0.0
    assert band_radiance_derivative(**band, temperature_K=temperature) == 0.0
    assert spectral_radiance(10.0, temperature) == 0.0
    many = np.full(5000, temperature)
    assert not band_radiance(**band, temperature_K=many).any()


def test_dark_samples_are_at_zero_kelvin():
    radiance = np.array([[0.0, 30.0], [5e-324, 0.0]])
    temperature = brightness_temperature(radiance=radiance, cut_on_um=8, cut_off_um=12)
    assert temperature[0, 0] == temperature[1, 1] == 0.0
    assert np.all(temperature[[0, 1], [1, 0]] > 1.0)
    assert brightness_temperature(radiance=0.0, cut_on_um=8, cut_off_um=12) == 0.0
    assert brightness_temperature(radiance=np.empty(0), cut_on_um=8, cut_off_um=12).size == 0


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf, 1e300])
def test_radiance_without_a_temperature_is_refused(bad):
    with pytest.raises(DataError, match="1 of 2 samples"):
        brightness_temperature(radiance=np.array([1.0, bad]), cut_on_um=8, cut_off_um=12)


# Radiometry against the reference values of 20 digits, and the rules between the noise figures.


def inputs(case):
    return {name: float(value) for name, value in case["inputs"].items()}


def assert_equal(got, expected):
    expected = float(expected)
    assert abs(got - expected) <= 1e-12 * abs(expected) + 1e-15


@pytest.mark.parametrize("case", reference_cases("band_radiance"))
def test_band_radiance(case):
    expected = case["expected"]
    assert_equal(band_radiance(**inputs(case)), expected["radiance_W_m2_sr"])
    assert_equal(band_radiance_derivative(**inputs(case)), expected["dL_dT_W_m2_sr_K"])


@pytest.mark.parametrize("case", reference_cases("optical_throughput_number"))
def test_throughput_number(case):
    assert_equal(ne.g_number(**inputs(case)), case["expected"]["g_number_per_sr"])


@pytest.mark.parametrize("case", reference_cases("noise_equivalent_radiance"))
def test_noise_equivalents(case):
    given, expected = inputs(case), case["expected"]
    area = ne.detector_area_cm2(
        pitch_x_um=given["pitch_um"],
        pitch_y_um=given["pitch_um"],
        fill_x=given["fill_factor_x"],
        fill_y=given["fill_factor_y"],
    )
    throughput = ne.g_number(
        f_number=given["f_number"],
        filter_transmission=given["filter_transmission"],
        optics_transmission=given["optics_transmission"],
    )
    nep = ne.nep_W(
        area_cm2=area, bandwidth_Hz=given["bandwidth_Hz"], d_star=given["d_star_cm_sqrtHz_per_W"]
    )
    ner = ne.ner_W_m2_sr(nep_W=nep, area_cm2=area, g_number=throughput)
    netd = ne.netd_K(
        noise_radiance=ner,
        cut_on_um=given["cut_on_um"],
        cut_off_um=given["cut_off_um"],
        background_K=given["background_K"],
    )
    # the power is 1e-14: only its relative error says something
    assert nep == pytest.approx(float(expected["nep_W"]), rel=1e-12, abs=0.0)
    assert_equal(ner, expected["ner_W_m2_sr"])
    assert_equal(netd, expected["netd_K"])


# The brightest surfaces of the Earth, by quadrature of Planck's law and the solar constant.

SOLAR_CONSTANT_W_M2 = 1361.0  # nominal; Kopp and Lean 2011 measured 1360.8


@pytest.mark.parametrize("band", [(8.0, 14.0), (3.0, 5.0), (0.4, 0.7), (1.0, 1.7)])
def test_a_band(band):
    sunlight = true_band(*band, 5772.0) * (6.957e8 / 1.495978707e11) ** 2
    expected = true_band(*band, 273.15 + 80.8) + sunlight
    assert brightest_surface_radiance(band_um=band) == pytest.approx(expected, rel=1e-9)


def test_all_wavelengths_are_the_hottest_surface_and_the_solar_constant():
    hot = 5.670374419e-8 * 353.95**4 / math.pi
    expected = hot + SOLAR_CONSTANT_W_M2 / math.pi
    assert brightest_surface_radiance(band_um=None) == pytest.approx(expected, rel=2e-4)
    assert brightest_surface_radiance(band_um=(0.05, 1000.0)) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("temperature", [250.0, 300.0, 1000.0])
def test_no_band_has_the_radiance_of_all_below_that_temperature(temperature):
    whole = true_band(0.01, 1e5, temperature)
    assert coldest_for_radiance(radiance=whole) == pytest.approx(temperature, rel=1e-4)
    part = true_band(8.0, 14.0, temperature)
    assert coldest_for_radiance(radiance=part) < temperature
