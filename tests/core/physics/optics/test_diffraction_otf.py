"""Diffraction over a band against mpmath: chords of shared areas, O'Neill's formula, quadrature."""

import sys
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from mpmath import acos, mp, mpf, pi, sqrt

from core.physics.detector.detectivity import ResponseCurve
from core.physics.optics.diffraction_otf import (
    Aperture,
    Spectrum,
    annular_defocus_otf,
    diffraction_otf,
    wavefront_factor,
    wavelengths_needed,
)
from core.physics.optics.overlap_area import annular_otf, disc_overlap_fraction


def shared_chords(v, w20, inner):
    """∫ cos(8π W20 v x)·(length shared at x) dx over the opening's area, chord by chord."""
    v, w20, inner = (mpmath.mpf(str(number)) for number in (v, w20, inner))

    def chord(x):
        outer = [max(1 - (x + sign * v) ** 2, 0) for sign in (1, -1)]
        hole = [max(inner**2 - (x + sign * v) ** 2, 0) for sign in (1, -1)]
        return 2 * max(mpmath.sqrt(min(outer)) - mpmath.sqrt(max(hole)), 0)

    ends = {mpmath.mpf(0), 1 - v}
    ends |= {abs(v - inner), v + inner}
    if v:
        ends |= {(1 - inner**2) / (4 * v)}
    places = sorted(end for end in ends if 0 <= end <= 1 - v)
    rate = 8 * mpmath.pi * w20 * v
    fine = [a + (b - a) * k / 8 for a, b in pairwise(places) for k in range(8)]
    value = mpmath.quad(lambda x: chord(x) * mpmath.cos(rate * x), [*fine, places[-1]])
    return 2 * value / (mpmath.pi * (1 - inner**2))


def o_neill(v, inner):
    """O'Neill 1956 with its erratum (JOSA 46, 1096)."""
    v, e = mpmath.mpf(str(v)), mpmath.mpf(str(inner))

    def disc(ratio):
        if ratio >= 1:
            return mpmath.mpf(0)
        return 2 / mpmath.pi * (mpmath.acos(ratio) - ratio * mpmath.sqrt(1 - ratio**2))

    if v <= (1 - e) / 2:
        common = -2 * e**2
    elif v < (1 + e) / 2:
        phi = mpmath.acos((1 + e**2 - 4 * v**2) / (2 * e))
        common = (
            -2 * e**2
            + 2 * e / mpmath.pi * mpmath.sin(phi)
            + (1 + e**2) / mpmath.pi * phi
            - 2 * (1 - e**2) / mpmath.pi * mpmath.atan((1 + e) / (1 - e) * mpmath.tan(phi / 2))
        )
    else:
        common = 0
    return (disc(v) + e**2 * disc(v / e) + common) / (1 - e**2)


@pytest.mark.parametrize("inner", [0.1, 0.3, 0.5, 0.9])
def test_in_focus_is_o_neills_annulus(inner):
    ratio = [0.01, 0.2, 0.349, 0.351, 0.5, 0.64, 0.66, 0.8, 0.949, 0.951, 0.999]
    expected = np.array([float(o_neill(v, inner)) for v in ratio])
    for found in (
        annular_defocus_otf(frequency_ratio=ratio, w20_waves=0.0, obscuration_ratio=inner),
        annular_otf(frequency_ratio=ratio, obscuration_ratio=inner),
    ):
        assert np.abs(found - expected).max() <= 3e-14 / (1 - inner**2)


@pytest.mark.parametrize(("inner", "w20"), [(0.3, 3.0), (0.9, 9)])
def test_defocus_is_the_pupils_autocorrelation(inner, w20):
    ratio = [0.02, 0.05, 0.21, 0.35, 0.5, 0.62, 0.7, 0.9, 0.98]
    expected = np.array([float(shared_chords(v, w20, inner)) for v in ratio])
    found = annular_defocus_otf(frequency_ratio=ratio, w20_waves=w20, obscuration_ratio=inner)
    assert np.abs(found - expected).max() <= 1e-13 / (1 - inner**2)


def over_band(aperture, rho, low, high, weight, bends=()):
    """By mpmath, panel by panel between the kinks; the annulus by O'Neill's formula or chords."""
    d, e = aperture.diameter_mm, aperture.obscuration_ratio

    def otf(wave):
        v = wave * rho / d
        if v >= 1:
            return mpmath.mpf(0)
        if aperture.defocus_waves:
            w20 = aperture.defocus_waves * aperture.reference_um / wave
            value = mpmath.mpf(float(annular_defocus_otf(
                frequency_ratio=float(v), w20_waves=float(w20), obscuration_ratio=e)))  # fmt: skip
        else:
            value = o_neill(v, e)
        rms = aperture.rms_waves * aperture.reference_um / wave
        return value * (1 - (rms / mpmath.mpf("0.18")) ** 2 * (1 - 4 * (v - 0.5) ** 2))

    kinks = [k * d / rho for k in (0.5 - e / 2, e, 0.5 + e / 2, 1)]
    inside = [place for place in (*kinks, *bends) if low < place < high]
    top = mpmath.quad(lambda wave: weight(wave) * otf(wave), sorted({low, high, *inside}))
    whole = sorted({low, (low + high) / 2, high, *(b for b in bends if low < b < high)})
    return float(top / mpmath.quad(weight, whole))


@pytest.mark.parametrize("weighting", ["photons", "energy", "uniform"])
@pytest.mark.parametrize("rho", [0.7, 13.0, 31.0])
def test_an_annulus_over_a_band(weighting, rho):
    aperture = Aperture(100.0, 0.35, rms_waves=0.07, reference_um=4.0)

    def weight(wave):
        if weighting == "uniform":
            return mpmath.mpf(1)
        planck = 1 / (mpmath.exp(mpmath.mpf("14387.768775039337") / (wave * 290)) - 1)
        return planck / wave ** (4 if weighting == "photons" else 5)

    found = diffraction_otf(
        rho=rho, aperture=aperture, cut_on_um=3.0, cut_off_um=5.0, weighting=weighting,
        temperature_K=290.0,
    )  # fmt: skip
    assert float(found) == pytest.approx(over_band(aperture, rho, 3.0, 5.0, weight), abs=3e-13)


def planck_photons(wave, kelvin=290):
    x = mpmath.mpf("14387.768775039337") / (wave * kelvin)
    return 1 / wave**4 / (mpmath.exp(x) - 1)


CURVES = {
    "file": (
        ResponseCurve("file", points=((2.5, 0.1), (3.4, 0.5), (4.1, 0.9), (4.6, 0.2))),
        lambda wave: mpmath.mpf(0) if wave > 4.6 else next(
            first[1] + (mpmath.mpf(wave) - first[0]) * (last[1] - first[1]) / (last[0] - first[0])
            for first, last in pairwise(((2.5, 0.1), (3.4, 0.5), (4.1, 0.9), (4.6, 0.2)))
            if wave <= last[0]
        ),
        (3.4, 4.1, 4.6),
    ),
    "rectangle": (
        ResponseCurve("rectangle", 4.0, 0.6, 0.5),
        lambda wave: mpmath.mpf(int(abs(wave - 4) <= mpmath.mpf("0.3") + 1e-15)),
        (3.7, 4.3),
    ),
    "gaussian": (
        ResponseCurve("gaussian", 3.8, 0.5),
        lambda wave: mpmath.mpf(2) ** (-(((wave - mpmath.mpf("3.8")) / mpmath.mpf("0.25")) ** 2)),
        (3.4, 3.8, 4.2),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("rho", [13.0])
def test_a_source_behind_a_response(name, rho):
    curve, value, bends = CURVES[name]
    aperture = Aperture(100.0, 0.35)

    def weight(wave):
        return planck_photons(wave) * value(wave)

    found = diffraction_otf(
        rho=rho, aperture=aperture, cut_on_um=3.0, cut_off_um=5.0, weighting="photons",
        temperature_K=290.0, responses=(curve,),
    )  # fmt: skip
    expected = over_band(aperture, rho, 3.0, 5.0, weight, bends)
    assert float(found) == pytest.approx(expected, abs=3e-13)


@pytest.mark.parametrize(("count", "tolerance"), [(60, 1e-9), (700, 1e-6)])
def test_a_measured_response_of_many_points(count, tolerance):
    """By the trapezium rule over half a million wavelengths."""
    rng = np.random.default_rng(count)
    known = np.linspace(2.9, 5.1, count)
    values = np.clip(0.7 + 0.1 * rng.standard_normal(count), 0.0, 1.0)
    curve = ResponseCurve("file", points=tuple(zip(known.tolist(), values.tolist(), strict=True)))
    aperture, rho = Aperture(100.0, 0.3), np.array([1.0, 9.0, 17.0, 25.0, 30.0])
    found = diffraction_otf(
        rho=rho, aperture=aperture, cut_on_um=3.0, cut_off_um=5.0, weighting="uniform",
        temperature_K=290.0, responses=(curve,), tolerance=tolerance,
    )  # fmt: skip
    waves = np.linspace(3.0, 5.0, 500_001)
    weight = np.interp(waves, known, values)
    expected = [
        np.trapezoid(weight * aperture.otf(np.full(1, each), waves)) / np.trapezoid(weight)
        for each in rho
    ]
    assert np.abs(found - expected).max() <= 2 * tolerance


@pytest.mark.parametrize("defocus", [2.0])
def test_a_defocused_annulus_over_a_band(defocus):
    aperture = Aperture(50.0, 0.3, defocus_waves=defocus, reference_um=10.0)
    rho = np.array([0.3, 2.9, 6.0])
    found = diffraction_otf(
        rho=rho, aperture=aperture, cut_on_um=8.0, cut_off_um=12.0, weighting="uniform",
        temperature_K=300.0,
    )  # fmt: skip
    expected = [over_band(aperture, float(r), 8.0, 12.0, lambda _: mpmath.mpf(1)) for r in rho]
    assert np.abs(found - expected).max() <= 1e-12


def test_tolerance_is_kept():
    aperture, spectrum = Aperture(100.0, 0.35, 1.5, 0.0, 4.0), Spectrum(3.0, 5.0, "photons", 290.0)
    how = {"aperture": aperture, "cut_on_um": 3.0, "cut_off_um": 5.0, "weighting": "photons",
           "temperature_K": 290.0}  # fmt: skip
    rho = np.linspace(0, 35, 701)
    finest = diffraction_otf(rho=rho, **how)
    for tolerance in (1e-4, 1e-9):
        _, error = wavelengths_needed(aperture, spectrum, tolerance)
        assert error <= tolerance
        found = diffraction_otf(rho=rho, tolerance=tolerance, **how)
        assert np.abs(found - finest).max() <= 2 * tolerance
    assert finest[0] == 1.0
    assert np.all(finest[rho >= 100 / 3] == 0.0)
    # Many fixed wavelengths come to the same, slowly: their kinks lie anywhere.
    fixed = diffraction_otf(rho=rho, wavelengths=64, **how)
    assert 1e-9 < np.abs(fixed - finest).max() <= 3e-5


def test_shannons_factor():
    """At half the cutoff 1 − (W/0.18)²; nothing at zero and at the cutoff."""
    found = wavefront_factor(frequency_ratio=[0.0, 0.5, 1.0], rms_waves=0.0714)
    assert found == pytest.approx([1.0, 1 - (0.0714 / 0.18) ** 2, 1.0], rel=1e-15)


# Overlaps of discs against fifty digits.


def test_near_tangency_no_digit_is_lost():
    """2/π·(arccos v − v·√(1 − v²)); the area is a cube of the angle, right to a few roundings."""
    ratio = np.concatenate([np.linspace(0.9, 0.999, 500), 1.0 - np.geomspace(1e-12, 1e-3, 100)])
    fractions = disc_overlap_fraction(distance_ratio=ratio)
    with mp.workdps(50):
        for v, fraction in zip(map(mpf, ratio.tolist()), fractions.tolist(), strict=True):
            true = 2 / pi * (acos(v) - v * sqrt(1 - v * v))
            assert abs(fraction / true - 1) <= 8 * sys.float_info.epsilon
