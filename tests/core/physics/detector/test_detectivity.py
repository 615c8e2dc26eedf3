"""Detector materials against closed forms, quadrature in mpmath and published typical numbers."""

import mpmath
import numpy as np
import pytest
import scipy.constants as sc

from core.errors import DataError, ParameterError
from core.physics.detector.detectivity import (
    ResponseCurve,
    band_d_star,
    cold_shield_half_angle_deg,
    d_star,
    quantum_efficiency,
)
from core.physics.radiometry import spectra
from core.physics.radiometry.spectra import Material, find_material

ALL = [m for choices in spectra.MATERIALS_BY_REGION.values() for m in choices]
IDEAL = Material("ideal", 12.0, 77.0, 2, quantum_efficiency=1.0)


def photons(cut_off_um, temperature, efficiency=lambda _: 1.0):
    """Hemispherical photon exitance up to a wavelength, weighted, m⁻² s⁻¹."""

    def integrand(wavelength_um):
        m = wavelength_um * 1e-6
        flux = 2 * mpmath.pi * sc.c / m**4 / mpmath.expm1(sc.h * sc.c / (m * sc.k * temperature))
        return efficiency(wavelength_um) * flux * 1e-6

    return mpmath.quad(integrand, [cut_off_um / 40, cut_off_um / 4, cut_off_um / 2, cut_off_um])


@pytest.mark.parametrize("half_angle", [5.0, 30.0, 90.0])
def test_ideal_detector_has_the_background_limit(half_angle):
    flux = photons(12.0, 300.0) * np.sin(np.radians(half_angle)) ** 2
    expected = 100 * 10e-6 / (sc.h * sc.c) / mpmath.sqrt(2 * flux)
    got = d_star(10.0, material=IDEAL, background_K=300.0, half_angle_deg=half_angle)
    assert got == pytest.approx(float(expected), rel=1e-10)


def test_photoconductor_is_root_two_below_a_junction():
    pair = [Material("m", 12.0, 77.0, kind, quantum_efficiency=1.0) for kind in (2, 4)]
    junction, conductor = (d_star(10.0, material=material) for material in pair)
    assert junction / conductor == pytest.approx(np.sqrt(2.0), rel=1e-14)


def test_resistance_and_dark_current_add_their_noise():
    leaky = Material(
        "leaky",
        12.0,
        77.0,
        2,
        quantum_efficiency=1.0,
        resistance_area_ohm_cm2=1.0,
        dark_current_A_per_cm2=0.1,
    )
    noise = float(2 * photons(12.0, 300.0)) * 0.25 + 2 * 0.1e4 / sc.e
    noise += 4 * sc.k * 77.0 / 1e-4 / sc.e**2
    expected = 100 * 10e-6 / (sc.h * sc.c) / np.sqrt(noise)
    assert d_star(10.0, material=leaky) == pytest.approx(expected, rel=1e-10)


def test_schottky_barrier_follows_fowler():
    wavelength = np.array([1.0, 3.0, 4.0, 5.0, 5.59])
    photon_eV = sc.h * sc.c / (wavelength * 1e-6) / sc.e
    barrier_eV = sc.h * sc.c / 5.6e-6 / sc.e
    expected = 0.25 * (photon_eV - barrier_eV) ** 2 / photon_eV
    got = quantum_efficiency(wavelength, material=spectra.PTSI)
    np.testing.assert_allclose(got, expected, rtol=1e-9)
    assert 0.003 < got[2] < 0.015
    fowler = lambda um: mpmath.mpf(0.25) * (1.2398419843320026 / um) * (1 - um / 5.6) ** 2  # noqa: E731
    events = 2 * (float(photons(5.6, 300.0, fowler)) * 0.25 + 1e-9 * 1e4 / sc.e)
    d = d_star(4.0, material=spectra.PTSI)
    assert d == pytest.approx(100 * got[2] * 4e-6 / (sc.h * sc.c) / np.sqrt(events), rel=1e-8)


@pytest.mark.parametrize("material", ALL, ids=lambda m: f"{m.name}-{m.cut_off_um}")
def test_every_material_ends_at_its_cut_off(material):
    edge = material.cut_off_um
    wavelength = np.array([0.5, 0.999, 1.001, 2.0]) * edge
    assert np.all((d_star(wavelength, material=material) > 0) == [True, True, False, False])
    efficiency = quantum_efficiency(wavelength, material=material)
    assert np.all((efficiency >= 0.0) & (efficiency <= 1.0))


@pytest.mark.parametrize(
    ("material", "wavelength", "low", "high"),
    [
        (spectra.INSB, 5.0, 0.7e11, 3e11),
        (spectra.HGCDTE_LWIR, 12.0, 3e10, 8e10),
        (spectra.SILICON, 0.9, 3e12, 5e13),
        (spectra.PTSI, 4.0, 5e9, 5e10),
    ],
)
def test_catalogue_values_at_60_degrees_are_met_in_size(material, wavelength, low, high):
    assert low < d_star(wavelength, material=material) < high


def test_band_gap_of_the_alloys_gives_their_cut_offs():
    # Hansen, Schmit and Casselman 1982
    for material, x in ((spectra.HGCDTE_MWIR, 0.30), (spectra.HGCDTE_LWIR, 0.21)):
        gap = -0.302 + 1.93 * x - 0.81 * x**2 + 0.832 * x**3 + 5.35e-4 * 77.0 * (1 - 2 * x)
        assert sc.h * sc.c / sc.e / gap * 1e6 == pytest.approx(material.cut_off_um, abs=0.05)


def weighted_mean(curve, cut_on, cut_off, end, temperature):
    def weight(um):
        return 1 / um**5 / mpmath.expm1(mpmath.mpf(sc.h * sc.c / sc.k * 1e6) / (um * temperature))

    scale = weight(cut_off)
    top = mpmath.quad(lambda um: curve(um) * weight(um) / scale, mpmath.linspace(cut_on, end, 9))
    return top / mpmath.quad(lambda um: weight(um) / scale, mpmath.linspace(cut_on, cut_off, 9))


@pytest.mark.parametrize(
    ("cut_on", "cut_off", "temperature"),
    [(8, 12, 303.0), (3, 5, 285.0), (3, 5, 77.0), (0.4, 0.7, 3000.0), (1, 20, 1000.0)],
)
def test_band_value_is_the_planck_weighted_mean(cut_on, cut_off, temperature):
    got = band_d_star(
        material=lambda um: 1e10 * um**2 / (1 + um),
        cut_on_um=cut_on,
        cut_off_um=cut_off,
        background_K=temperature,
    )
    truth = weighted_mean(lambda um: 1e10 * um**2 / (1 + um), cut_on, cut_off, cut_off, temperature)
    assert got == pytest.approx(float(truth), rel=1e-12)


def test_a_band_one_rounding_wide_has_the_curve_there():
    got = band_d_star(
        material=lambda um: 1e10 * um,
        cut_on_um=8,
        cut_off_um=float(np.nextafter(8, 9)),
        background_K=300.0,
    )
    assert got == pytest.approx(8e10, rel=1e-13)


def test_part_of_a_band_beyond_the_cut_off_counts_as_zero():
    peak = float(d_star(5.0, material=spectra.INSB, background_K=300.0))
    truth = weighted_mean(lambda um: peak * um / 5.0, 4.0, 8.0, 5.5, 300.0)
    got = band_d_star(material=spectra.INSB, cut_on_um=4, cut_off_um=8, background_K=300.0)
    assert got == pytest.approx(float(truth), rel=1e-11)
    beyond = band_d_star(material=spectra.INSB, cut_on_um=8, cut_off_um=12, background_K=300.0)
    assert beyond == 0.0


def test_cold_shield_has_the_cone_of_the_throughput_number():
    angle = np.radians(cold_shield_half_angle_deg(f_number=1.75))
    assert np.sin(angle) ** 2 == pytest.approx(1 / (1 + 4 * 1.75**2), rel=1e-14)


def test_a_material_of_another_region_is_found_by_the_band():
    def found(material, cut_off_um):
        return find_material(region="VIS", material=material, cut_off_um=cut_off_um)

    assert found("HgCdTe", 12.0) is spectra.HGCDTE_LWIR
    assert found("HgCdTe", 5.0) is spectra.HGCDTE_MWIR
    assert found("HgCdTe", 14.0) is spectra.HGCDTE_LWIR
    assert found("InSb", 5.0).name == "InSb"


# Responses over wavelength: points, a rectangle, a Gaussian; peaks, and where they bend or end.

POINTS = ((3.2, 0.2), (3.9, 0.8), (4.4, 0.6))
SLOPES = ((0.2, 0.6 / 0.7), (0.8, -0.2 / 0.5))  # value at the left point, rise per µm
CURVES = {
    "file": (
        ResponseCurve("file", points=POINTS),
        lambda um: (
            SLOPES[0][0] + SLOPES[0][1] * (um - 3.2)
            if 3.2 <= um < 3.9
            else SLOPES[1][0] + SLOPES[1][1] * (um - 3.9)
            if 3.9 <= um <= 4.4
            else 0.0
        ),
        (3.2, 3.9, 4.4),
    ),
    "rectangle": (
        ResponseCurve("rectangle", 4.0, 0.5, 0.7),
        lambda um: 0.7 if 3.75 <= um <= 4.25 else 0.0,
        (3.75, 4.25),
    ),
    "gaussian": (
        ResponseCurve("gaussian", 4.0, 0.5, 0.7),
        lambda um: 0.7 * 2.0 ** -(((um - 4.0) / 0.25) ** 2),
        (3.5, 3.8, 4.0, 4.2, 4.5),
    ),
}


@pytest.mark.parametrize("shape", CURVES)
@pytest.mark.parametrize(("low", "high"), [(3.0, 5.0), (3.3, 4.1), (3.95, 4.2), (1.0, 2.0)])
def test_integrals_and_means_of_a_response_are_those_of_its_form(shape, low, high):
    curve, form, bends = CURVES[shape]
    places = np.linspace(low, high, 81) + 1e-6
    assert curve.at(places) == pytest.approx([form(um) for um in places], abs=1e-15)
    cuts = [low, *(end for end in bends if low < end < high), high]
    whole = float(mpmath.quad(form, cuts))
    assert curve.integral(low, high) == pytest.approx(whole, rel=1e-9, abs=1e-12)
    assert curve.integral(high, low) == 0.0
    assert curve.mean(low, high) == pytest.approx(whole / (high - low), rel=1e-9, abs=1e-12)
    for source_K in (40.0, 300.0, 5800.0):

        def weight(um, source_K=source_K):
            x = mpmath.mpf(sc.h * sc.c / sc.k * 1e6) / (um * source_K)
            return 1e70 / um**5 / mpmath.expm1(x)

        seen = mpmath.quad(lambda um, weight=weight: form(um) * weight(um), cuts)
        truth = float(seen / mpmath.quad(weight, cuts))
        found = curve.mean_of_body(low, high, source_K=source_K)
        assert found == pytest.approx(truth, rel=1e-6, abs=1e-12)


def test_a_response_is_one_all_over_a_band_or_refused():
    flat = ResponseCurve("file", points=((3.0, 1.0), (4.0, 1.0), (5.0, 1.0)))
    for curve in (flat, ResponseCurve("rectangle", 4.0, 2.0)):
        assert curve.is_one_over(3.0, 5.0)
        assert curve.is_one_over(3.0 * (1.0 - 1e-13), 5.0 * (1.0 + 1e-13))
        assert not curve.is_one_over(2.999, 5.0)
        assert not curve.is_one_over(3.0, 5.001)
    dip = ResponseCurve("file", points=((3.0, 1.0), (4.0, 0.99), (5.0, 1.0)))
    for curve in (dip, ResponseCurve("rectangle", 4.0, 2.0, 0.99), ResponseCurve("gaussian", 4.0)):
        assert not curve.is_one_over(3.5, 4.5)
    with pytest.raises(DataError, match="emits nothing"):
        flat.mean_of_body(3.0, 5.0, source_K=1.0)
    for bad in ({"centre_um": 0.0}, {"width_um": 0.0}, {"peak": -0.1}, {"peak": 1.1}):
        for shape in ("rectangle", "gaussian"):
            with pytest.raises(ParameterError, match=next(iter(bad))):
                ResponseCurve(shape, **bad)
    with pytest.raises(ParameterError, match="1 point"):
        ResponseCurve("file", points=POINTS[:1])
