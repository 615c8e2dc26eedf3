"""Zernike polynomials, the defocused disc and the wavelengths of a band."""

import math

import mpmath
import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.optics.diffraction_otf import annular_defocus_otf, band_wavelengths
from core.physics.optics.overlap_area import annular_otf
from core.physics.optics.pupil_otf import geometric_otf
from core.physics.optics.pupil_shapes import PupilShape, edge_offset_samples, sample_pupil
from core.physics.optics.wavefront import (
    autocorrelation,
    complex_pupil,
    known_wavefront,
    noll_order,
    sampled_otf,
    wavefront_waves,
    zernike,
)
from core.physics.sampling.detector_sampling import error_estimate
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


# Where a wavefront map is known, and its units.

Y, X = np.mgrid[-1:1:41j, -1:1:41j]
INSIDE = X**2 + Y**2 <= 0.81


@pytest.mark.parametrize(
    "waves", [X, Y, X * Y + 0.1 * X, Y * (3 * (X**2 + Y**2) - 2)], ids=["x", "y", "xy", "coma"]
)
def test_zeros_from_the_border_on_are_outside_and_lines_of_zeros_within_are_not(waves):
    """The map of a disc is 0 along a whole row or column where the wavefront changes its sign."""
    known = np.isfinite(known_wavefront(np.where(INSIDE, waves, 0.0)))
    assert (known & ~INSIDE).sum() == 0
    lost = INSIDE & ~known
    assert lost.sum() <= 2  # the ends of the line, which look like the outside


def test_nan_is_outside_and_zeros_then_are_not():
    values = np.where(INSIDE, 0.0, np.nan)
    np.testing.assert_array_equal(np.isfinite(known_wavefront(values)), INSIDE)


def test_without_an_empty_border_all_is_known():
    assert np.isfinite(known_wavefront(X * Y + 1.5)).all()


# Sampled pupils: the raw autocorrelation, interpolation between lags, and the error estimate.

SIZE = 512
SHAPES = [
    PupilShape("clear", 256.0),
    PupilShape("half_moon", 256.0),
    PupilShape("cassegrain", 256.0, 80.0),
    PupilShape("hinged", 256.0, slit_width=30.0),
    PupilShape("cassegrain_slit", 256.0, 80.0, 30.0),
    PupilShape("spider", 256.0, 80.0, vanes=4, vane_width=16.0),
    PupilShape("spider", 256.0, 80.0, vanes=3, vane_width=16.0),
    PupilShape("hinged", 250.0, slit_width=25.3),
    PupilShape("spider", 250.0, 75.0, vanes=4, vane_width=15.0),
]


def test_autocorrelation_scales_and_refuses():
    pupil = sample_pupil(PupilShape("clear", 3.0), rows=8, columns=8)
    plain = autocorrelation(pupil)
    for scale in (1e200, 1e-200):
        np.testing.assert_allclose(autocorrelation(scale * pupil), plain, rtol=0, atol=1e-15)
    for bad in (np.zeros((4, 4)), np.full((2, 2), math.nan), np.ones(4), np.ones((0, 3))):
        with pytest.raises(DataError):
            autocorrelation(bad)


def test_a_tilt_gives_a_linear_phase():
    x = (np.arange(32) - 15.5) / 15.5
    flat = sample_pupil(PupilShape("clear", 15.5), rows=32, columns=32)
    tilted = complex_pupil(transmission=flat, wavefront_waves=np.tile(0.8 * x, (32, 1)))
    lags = np.arange(-31, 32)
    expected = autocorrelation(flat) * np.exp(2j * np.pi * 0.8 * lags / 15.5)
    np.testing.assert_allclose(autocorrelation(tilted), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("interpolation", ["linear", "bilinear"])
def test_interpolation_keeps_nodes_symmetry_and_linear_fields(interpolation):
    rng = np.random.default_rng(4)
    table = autocorrelation(rng.normal(size=(6, 9)) + 1j * rng.normal(size=(6, 9)))
    y, x = np.mgrid[-5:6, -8:9]
    nodes = sampled_otf(table, lag_x=x, lag_y=y, interpolation=interpolation)
    np.testing.assert_array_equal(nodes, table)
    x, y = rng.uniform(-10, 10, 400), rng.uniform(-7, 7, 400)
    ahead = sampled_otf(table, lag_x=x, lag_y=y, interpolation=interpolation)
    behind = sampled_otf(table, lag_x=-x, lag_y=-y, interpolation=interpolation)
    np.testing.assert_array_equal(ahead, np.conj(behind))
    assert np.all(ahead[(np.abs(x) >= 9) | (np.abs(y) >= 6)] == 0)
    row, column = np.mgrid[-5:6, -8:9]
    plane = (1 + 2.0 * column - 3.0 * row).astype(complex)
    x, y = rng.uniform(-8, 8, 200), rng.uniform(-5, 5, 200)
    got = sampled_otf(plane, lag_x=x, lag_y=y, interpolation=interpolation)
    np.testing.assert_allclose(got, 1 + 2 * x - 3 * y, rtol=0, atol=1e-13)


@pytest.mark.parametrize("interpolation", ["linear", "bilinear"])
def test_a_row_and_a_column_of_lags_have_the_bits_of_their_pairs(interpolation):
    """On them, beyond the array on either side, and with rows in no order."""
    rng = np.random.default_rng(6)
    table = autocorrelation(rng.normal(size=(6, 9)) + 1j * rng.normal(size=(6, 9)))
    x = np.concatenate([rng.uniform(-11, 11, 40), [-8.0, 0.0, 8.0]])[np.newaxis, :]
    y = np.concatenate([rng.uniform(-8, 8, 30), [5.0, 0.0, -5.0, 1e300]])[:, np.newaxis]
    plane = sampled_otf(table, lag_x=x, lag_y=y, interpolation=interpolation)
    x, y = np.broadcast_arrays(x, y)
    pairs = sampled_otf(table, lag_x=x.ravel(), lag_y=y.ravel(), interpolation=interpolation)
    np.testing.assert_array_equal(plane, pairs.reshape(x.shape))
    real = sampled_otf(table.real, lag_x=x[:1], lag_y=y[:, :1], interpolation=interpolation)
    assert real.dtype == np.float64
    np.testing.assert_array_equal(real, plane.real)


def test_interpolation_refuses():
    table = autocorrelation(np.ones((3, 3)))
    with pytest.raises(ParameterError, match="interpolation"):
        sampled_otf(table, lag_x=0.0, lag_y=0.0, interpolation="cubic")
    with pytest.raises(DataError):
        sampled_otf(table, lag_x=math.nan, lag_y=0.0)
    assert sampled_otf(table, lag_x=1e300, lag_y=0.0) == 0


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: f"{s.shape}-{s.vanes}-{s.radius:g}")
def test_estimate_covers_the_error_at_512(shape):
    pupil = sample_pupil(shape, rows=SIZE, columns=SIZE)
    correlation = autocorrelation(pupil)
    lags = np.concatenate([np.arange(0.0, 60.0, 5.3), np.arange(60.0, 511.0, 17.4)])
    x, y = np.meshgrid(lags, lags)
    exact = geometric_otf(shape, lag_x=x, lag_y=y)
    offset = edge_offset_samples(shape, rows=SIZE, columns=SIZE)
    known = error_estimate(pupil, correlation=correlation, edge_uncertainty_samples=offset)
    blind = error_estimate(pupil, correlation=correlation)
    for interpolation in ("linear", "bilinear"):
        got = sampled_otf(correlation, lag_x=x, lag_y=y, interpolation=interpolation)
        error = np.max(np.abs(got - exact))
        assert error < known <= blind
        if offset == 0.0:
            assert error < 5e-4
            assert known < 2e-3
    if shape.shape in ("clear", "half_moon"):
        x, y = np.meshgrid(lags.round(), lags.round())
        exact = geometric_otf(shape, lag_x=x, lag_y=y)
        assert np.max(np.abs(sampled_otf(correlation, lag_x=x, lag_y=y) - exact)) < 1e-4


@pytest.mark.parametrize("size", [24, 61, 130])
def test_estimate_covers_small_pupils(size):
    rng = np.random.default_rng(size)
    for _ in range(8):
        radius = size * rng.uniform(0.25, 0.5)
        hole = radius * rng.uniform(0.1, 0.5)
        width = max(1.5, radius * rng.uniform(0.05, 0.2))  # narrower bars may leave no trace
        for shape in (
            PupilShape("clear", radius),
            PupilShape("half_moon", radius),
            PupilShape("cassegrain", radius, hole),
            PupilShape("hinged", radius, slit_width=width),
            PupilShape("cassegrain_slit", radius, hole, width),
            PupilShape("spider", radius, hole, vanes=int(rng.integers(1, 6)), vane_width=width),
        ):
            pupil = sample_pupil(shape, rows=size, columns=size)
            correlation = autocorrelation(pupil)
            y, x = np.mgrid[0:size, 0:size][:, :: max(1, size // 24), :: max(1, size // 24)]
            exact = geometric_otf(shape, lag_x=x, lag_y=y)
            error = np.max(np.abs(sampled_otf(correlation, lag_x=x, lag_y=y) - exact))
            assert error < error_estimate(pupil, correlation=correlation)


def defocused(radius, w20, fine):
    """Error and estimate of a defocused disc sampled with SIZE * fine samples."""
    count = SIZE * fine
    place = (np.arange(count) - (count - 1) / 2) / (radius * fine)
    waves = wavefront_waves(x=place, y=place[:, np.newaxis], defocus_waves=w20)
    flat = sample_pupil(PupilShape("clear", radius), rows=SIZE, columns=SIZE, oversampling=fine)
    pupil = complex_pupil(transmission=flat, wavefront_waves=waves)
    correlation = autocorrelation(pupil)
    x, y = np.meshgrid(np.arange(0, 511, 9), np.arange(0, 511, 9))
    exact = annular_defocus_otf(frequency_ratio=np.hypot(x, y) / (2 * radius), w20_waves=w20)
    got = sampled_otf(correlation, lag_x=x * fine, lag_y=y * fine)
    estimate = error_estimate(pupil, correlation=correlation)
    return np.max(np.abs(got - exact)), estimate


@pytest.mark.parametrize(("radius", "w20"), [(256.0, 1.0), (254.0, 2.0), (255.3, 4.0)])
def test_oversampling_twice_brings_defocus_below_1e_4(radius, w20):
    error, estimate = defocused(radius, w20, 2)
    assert error < 1e-4
    assert error < estimate


def test_estimate_says_so_when_the_wavefront_is_not_resolved():
    place = (np.arange(64) - 31.5) / 32.0
    waves = wavefront_waves(x=place, y=place[:, np.newaxis], defocus_waves=40.0)
    flat = sample_pupil(PupilShape("clear", 32.0), rows=64, columns=64)
    pupil = complex_pupil(transmission=flat, wavefront_waves=waves)
    assert error_estimate(pupil, correlation=autocorrelation(pupil)) > 0.1


@pytest.mark.parametrize("case", reference_cases("defocus_otf"))
def test_reference_defocus(case):
    given, expected = case["inputs"], float(case["expected"]["otf"])
    got = annular_defocus_otf(
        frequency_ratio=float(given["xi_over_cutoff"]), w20_waves=float(given["w20_waves"])
    )
    assert abs(got - expected) <= 1e-12 * abs(expected) + 1e-15
