"""Zernike polynomials, the defocused disc and the wavelengths of a band."""

import math

import mpmath
import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.optics.diffraction_otf import annular_defocus_otf
from core.physics.optics.overlap_area import annular_otf
from core.physics.optics.polychromatic import band_wavelengths
from core.physics.optics.wavefront import noll_order, wavefront_waves, zernike
from reference_cases import reference_cases


def test_zernikes_are_orthonormal_over_the_disc():
    nodes, weights = np.polynomial.legendre.leggauss(20)
    square, weights = (nodes + 1) / 2, weights / 2  # rho² is uniform over the disc
    angle = 2 * np.pi * np.arange(48) / 48
    rho = np.sqrt(square)[:, np.newaxis]
    x, y = rho * np.cos(angle), rho * np.sin(angle)
    values = np.array([zernike(noll_index=j, x=x, y=y) for j in range(1, 67)])
    gram = np.einsum("iab,jab,a->ij", values, values, weights) / 48
    np.testing.assert_allclose(gram, np.eye(66), rtol=0, atol=1e-13)


def test_first_zernikes_as_noll_prints_them():
    x, y = np.random.default_rng(1).uniform(-0.7, 0.7, (2, 50))
    rho, theta = np.hypot(x, y), np.arctan2(y, x)
    table = {
        1: np.ones(50),
        2: 2 * rho * np.cos(theta),
        3: 2 * rho * np.sin(theta),
        4: math.sqrt(3) * (2 * rho**2 - 1),
        5: math.sqrt(6) * rho**2 * np.sin(2 * theta),
        6: math.sqrt(6) * rho**2 * np.cos(2 * theta),
        7: math.sqrt(8) * (3 * rho**3 - 2 * rho) * np.sin(theta),
        8: math.sqrt(8) * (3 * rho**3 - 2 * rho) * np.cos(theta),
        9: math.sqrt(8) * rho**3 * np.sin(3 * theta),
        10: math.sqrt(8) * rho**3 * np.cos(3 * theta),
        11: math.sqrt(5) * (6 * rho**4 - 6 * rho**2 + 1),
        12: math.sqrt(10) * (4 * rho**4 - 3 * rho**2) * np.cos(2 * theta),
        13: math.sqrt(10) * (4 * rho**4 - 3 * rho**2) * np.sin(2 * theta),
        14: math.sqrt(10) * rho**4 * np.cos(4 * theta),
        15: math.sqrt(10) * rho**4 * np.sin(4 * theta),
        22: math.sqrt(7) * (20 * rho**6 - 30 * rho**4 + 12 * rho**2 - 1),
    }
    for index, expected in table.items():
        got = zernike(noll_index=index, x=x, y=y)
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-14)


def test_high_orders_do_not_cancel():
    assert noll_order(noll_index=861) == (40, -40)
    n, m = noll_order(noll_index=821)
    assert (n, m) == (40, 0)
    value = zernike(noll_index=821, x=0.93, y=0.0)
    with mpmath.workdps(60):
        expected = mpmath.sqrt(41) * mpmath.legendre(20, 2 * mpmath.mpf(0.93) ** 2 - 1)
    assert float(value) == pytest.approx(float(expected), rel=1e-12)


def test_wavefront_adds_its_terms():
    x = np.linspace(-1, 1, 7)
    y = np.linspace(-1, 1, 5)[:, np.newaxis]
    got = wavefront_waves(
        x=x, y=y, coefficients_waves=(0, 0.1, 0, 0, 0, 0, 0, -0.2), defocus_waves=1.5
    )
    expected = 0.1 * 2 * x + 1.5 * (x * x + y * y)
    expected = expected - 0.2 * math.sqrt(8) * (3 * (x * x + y * y) - 2) * x
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-14)
    # Noll's defocus is W20 / (2 sqrt 3) apart from piston.
    noll = wavefront_waves(x=x, y=y, coefficients_waves=(0.5, 0, 0, 1 / math.sqrt(12)))
    np.testing.assert_allclose(noll, x * x + y * y, rtol=0, atol=1e-15)


def test_wavefront_refuses():
    for bad in ({"coefficients_waves": (0.0, math.nan)}, {"defocus_waves": math.inf}):
        with pytest.raises(ParameterError):
            wavefront_waves(x=0.0, y=0.0, **bad)
    for index in (0, 862):
        with pytest.raises(ParameterError, match="noll_index"):
            zernike(noll_index=index, x=0.0, y=0.0)


def mp_defocus(v, w20):
    """Hopkins' overlap integral over x, by tanh-sinh with 30 digits."""
    with mpmath.workdps(30):
        v, w20 = mpmath.mpf(v), mpmath.mpf(w20)
        rate = 8 * mpmath.pi * w20 * v
        pieces = mpmath.linspace(0, 1 - v, 2 + int(rate * (1 - v) / 6))
        integrand = lambda x: mpmath.sqrt(1 - (x + v) ** 2) * mpmath.cos(rate * x)  # noqa: E731
        return float(4 / mpmath.pi * mpmath.quad(integrand, pieces))


@pytest.mark.parametrize("w20", [1e-6, 0.3, 1.0, 7.3, 60.0])
def test_defocus_is_the_overlap_integral(w20):
    v = np.array([1e-6, 0.013, 0.2, 0.5, 0.81, 0.99, 0.999999])
    expected = [mp_defocus(one, w20) for one in v]
    got = annular_defocus_otf(frequency_ratio=v, w20_waves=w20)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(annular_defocus_otf(frequency_ratio=-v, w20_waves=-w20), got)


def test_defocus_at_its_ends():
    v = np.linspace(0, 1.2, 25)
    flat = annular_defocus_otf(frequency_ratio=v, w20_waves=0.0)
    np.testing.assert_allclose(flat, annular_otf(frequency_ratio=v), rtol=0, atol=2e-15)
    got = annular_defocus_otf(frequency_ratio=[0.0, 1.0, 1.5], w20_waves=3.0)
    np.testing.assert_array_equal(got, [1.0, 0.0, 0.0])
    huge = annular_defocus_otf(frequency_ratio=[0.0, 0.25, 0.5], w20_waves=1e4)
    assert huge[0] == 1.0
    assert np.all(np.abs(huge[1:]) < 1e-4)
    for bad in (math.nan, math.inf, 2e4):
        with pytest.raises(ParameterError, match="defocus_waves"):
            annular_defocus_otf(frequency_ratio=0.1, w20_waves=bad)
    with pytest.raises(DataError):
        annular_defocus_otf(frequency_ratio=math.nan, w20_waves=1.0)


@pytest.mark.parametrize("case", reference_cases("defocus_otf"))
def test_reference_defocus(case):
    given, expected = case["inputs"], float(case["expected"]["otf"])
    got = annular_defocus_otf(
        frequency_ratio=float(given["xi_over_cutoff"]), w20_waves=float(given["w20_waves"])
    )
    assert abs(got - expected) <= 1e-12 * abs(expected) + 1e-15


def test_one_wavelength_is_the_bands_mean():
    wavelengths, weights = band_wavelengths(cut_on_um=8.0, cut_off_um=12.0, count=1)
    np.testing.assert_array_equal(wavelengths, [10.0])
    np.testing.assert_array_equal(weights, [1.0])


@pytest.mark.parametrize("count", [2, 3, 8, 64])
def test_band_wavelengths_integrate_polynomials(count):
    wavelengths, weights = band_wavelengths(cut_on_um=3.0, cut_off_um=5.0, count=count)
    assert np.all(np.diff(wavelengths) > 0)
    assert np.sum(weights) == pytest.approx(1.0, abs=1e-15)
    for power in range(min(2 * count, 9)):
        mean = (5.0 ** (power + 1) - 3.0 ** (power + 1)) / (power + 1) / 2.0
        assert np.dot(weights, wavelengths**power) == pytest.approx(mean, rel=1e-13)


def test_band_wavelengths_refuse():
    for on, off, count, named in (
        (0.0, 5.0, 1, "cut_on_um"),
        (5.0, 3.0, 1, "cut_off_um"),
        (3.0, math.inf, 1, "cut_off_um"),
        (3.0, 5.0, 0, "wavelengths"),
        (3.0, 5.0, 300, "wavelengths"),
    ):
        with pytest.raises(ParameterError) as caught:
            band_wavelengths(cut_on_um=on, cut_off_um=off, count=count)
        assert caught.value.parameter == named
