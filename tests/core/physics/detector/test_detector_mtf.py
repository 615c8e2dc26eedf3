"""TDI: the closed form against a clocked exposure followed step by step."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad, solve_bvp

from core.errors import ParameterError
from core.physics.detector.detector_mtf import (
    band_diffusion_mtf,
    diffusion_mtf,
    silicon_absorption_per_um,
    smear_mrad,
    tdi_mtf,
)
from reference_cases import CAMERA, reference_cases


def followed(frequency, pitch, stages, phases, mismatch, instants=2000):
    """Mean of exp(−2πi·f·(image − charge)) over an exposure, step by step, about its middle."""
    image, charge = [], []
    step_time = 1.0 / phases  # of a stage's
    for step in range(stages * phases):
        time = (step + (np.arange(instants) + 0.5) / instants) * step_time
        image.append((1 + mismatch) * time * pitch)
        charge.append(np.full(instants, step * pitch / phases))
    apart = np.concatenate(image) - np.concatenate(charge)
    apart -= 0.5 * (apart[0] + apart[-1])  # symmetric about its middle
    return np.array([np.exp(-2j * np.pi * f * apart).mean() for f in frequency])


@pytest.mark.parametrize("mismatch", [0.0, 0.01, -0.03, 0.2, -0.9])
@pytest.mark.parametrize(("stages", "phases"), [(1, 1), (1, 3), (8, 1), (16, 4), (5, 2)])
def test_it_is_the_mean_over_a_clocked_exposure(stages, phases, mismatch):
    frequency, pitch = np.linspace(0.0, 12.0, 25), 0.31
    expected = followed(frequency, pitch, stages, phases, mismatch)
    found = tdi_mtf(
        frequency=frequency, pitch_mrad=pitch, stages=stages, phases=phases,
        velocity_mismatch=mismatch,
    )  # fmt: skip
    assert np.abs(expected.imag).max() < 1e-9
    np.testing.assert_allclose(found, expected.real, atol=3e-6)


def test_published_forms():
    """Without mismatch sinc(pitch·f/phases); of many phases Holst's sin(πNdf)/(N·sin(πdf))."""
    nyquist = 0.5
    values = [tdi_mtf(frequency=nyquist, pitch_mrad=1.0, stages=64, phases=phases,
                      velocity_mismatch=0.0) for phases in (1, 2, 3, 4)]  # fmt: skip
    # sinc(1/2), sinc(1/4), sinc(1/6), sinc(1/8), the losses of clocks of 1 to 4 phases.
    np.testing.assert_allclose(values, [0.63662, 0.900316, 0.95493, 0.974495], atol=5e-6)
    drift = tdi_mtf(frequency=nyquist, pitch_mrad=1.0, stages=32, phases=0, velocity_mismatch=0.02)
    assert drift == pytest.approx(np.sin(np.pi * 0.32) / (np.pi * 0.32), rel=1e-12)
    holst = np.sin(np.pi * 32 * 0.02 * 0.5) / (32 * np.sin(np.pi * 0.02 * 0.5))
    clocked = tdi_mtf(
        frequency=nyquist, pitch_mrad=1.0, stages=32, phases=1, velocity_mismatch=0.02
    )
    assert clocked == pytest.approx(np.sinc(1.02 * 0.5) * holst, rel=1e-12)


def test_the_sum_over_shifts_at_its_poles():
    """Where sin(πmsf) is 0 all exposures are whole waves apart: the sum is 1 or changes sign."""
    near = np.array([1.0, 1.0 + 1e-9])
    found = tdi_mtf(frequency=near / 0.5, pitch_mrad=1.0, stages=6, phases=1, velocity_mismatch=0.5)
    np.testing.assert_allclose(found, -np.sinc(1.5 * near / 0.5), atol=1e-8)


def test_smears():
    step, drift = smear_mrad(pitch_mrad=0.2, stages=10, phases=4, velocity_mismatch=-0.1)
    assert (step, drift) == (pytest.approx(0.045), pytest.approx(-0.2))


# Charge diffusion against the reference, and against the diffusion equation solved by mpmath.


@pytest.mark.parametrize("case", reference_cases("diffusion_mtf", file=CAMERA))
def test_the_reference(case):
    given = {name: float(value) for name, value in case["inputs"].items()}
    found = float(diffusion_mtf(**given))
    assert found == pytest.approx(float(case["expected"]["mtf"]), rel=1e-12)


def current_of_a_wave(*, alpha, bulk, k, sign):
    """Carriers that diffuse out at x = bulk of those born as αe^(−αx): p'' = k²p − αe^(−αx).

    No flux at x = 0 (sign 0), or all of it collected at x = 0 of a deep substrate (sign −1).
    """

    def slope(x, y):
        return np.vstack([y[1], k**2 * y[0] - alpha * np.exp(-alpha * x)])

    def ends(first, last):
        return np.array([first[1] if sign == 0 else first[0], last[0]])

    x = np.linspace(0, bulk, 400)
    solved = solve_bvp(slope, ends, x, np.zeros((2, 400)), tol=1e-9, max_nodes=200000)
    assert solved.success
    return -solved.y[1][-1] if sign == 0 else solved.y[1][0]


@pytest.mark.thorough(but=4)
@pytest.mark.parametrize("frequency", [0.0, 10.0, 40.0, 90.0])
@pytest.mark.parametrize("alpha", [0.02, 0.3, 2.0])
def test_the_back_side_by_the_diffusion_equation(alpha, frequency):
    """The current at the depletion region, from the boundary value problem, without Green's."""
    depletion, thickness, length = 4.0, 16.0, 30.0
    bulk = thickness - depletion

    def collected(f):
        k = math.hypot(1 / length, 2 * math.pi * f / 1000)
        there = math.exp(-alpha * bulk) * (1 - math.exp(-alpha * depletion))
        return there + current_of_a_wave(alpha=alpha, bulk=bulk, k=k, sign=0)

    found = diffusion_mtf(
        cycles_per_mm=frequency, absorption_per_um=alpha, depletion_um=depletion,
        diffusion_length_um=length, side="back", thickness_um=thickness,
    )  # fmt: skip
    assert found == pytest.approx(collected(frequency) / collected(0.0), rel=1e-6)


@pytest.mark.parametrize("frequency", [20.0, 60.0])
def test_the_front_side_by_the_diffusion_equation(frequency):
    """A substrate of twenty diffusion lengths below the depletion region."""
    alpha, depletion, length = 0.05, 6.0, 25.0

    def collected(f):
        k = math.hypot(1 / length, 2 * math.pi * f / 1000)
        below = current_of_a_wave(alpha=alpha, bulk=20 * length, k=k, sign=-1)
        return 1 - math.exp(-alpha * depletion) + math.exp(-alpha * depletion) * below

    found = diffusion_mtf(
        cycles_per_mm=frequency,
        absorption_per_um=alpha,
        depletion_um=depletion,
        diffusion_length_um=length,
    )
    assert found == pytest.approx(collected(frequency) / collected(0.0), rel=1e-6)


@pytest.mark.thorough(but=4)
@pytest.mark.parametrize("alpha", [1e-4, 0.0333333, 1 / 30, 5.0, 400.0])
@pytest.mark.parametrize("length", [30.0, 1e6])
def test_the_back_side_keeps_its_digits(alpha, length):
    """Where absorption and diffusion length meet, and far from it, against 40 digits."""
    depletion, thickness = 4.0, 300.0

    def collected(f):
        with mpmath.workdps(40):
            a, b = mpmath.mpf(alpha), mpmath.mpf(thickness - depletion)
            k = mpmath.sqrt(1 / mpmath.mpf(length) ** 2 + (2 * mpmath.pi * f / 1000) ** 2)
            born = mpmath.quad(
                lambda x: a * mpmath.exp(-a * x) * mpmath.cosh(k * x) / mpmath.cosh(k * b),
                [0, b / 300, b / 30, b / 3, 0.9 * b, b],
            )
            return born + mpmath.exp(-a * b) * (1 - mpmath.exp(-a * depletion))

    for f in (0.0, 7.0, 55.0):
        found = diffusion_mtf(
            cycles_per_mm=f, absorption_per_um=alpha, depletion_um=depletion,
            diffusion_length_um=length, side="back", thickness_um=thickness,
        )  # fmt: skip
        assert float(found) == pytest.approx(float(collected(f) / collected(0)), rel=1e-11)


def test_silicon():
    """Within 7 % of another published table, Green and Keevers 1995, at 300 K."""
    for wavelength, per_cm in ((0.45, 2.55e4), (0.6, 4.14e3), (0.7, 1.9e3), (0.8, 850), (1.0, 64)):
        found = silicon_absorption_per_um(wavelength_um=wavelength)
        assert found == pytest.approx(per_cm * 1e-4, rel=0.07)
    assert silicon_absorption_per_um(wavelength_um=1.0) == pytest.approx(
        4 * math.pi * 4.902e-4, rel=1e-12
    )
    with pytest.raises(ParameterError, match=r"wavelength_um = 1.3 µm.*0.25 to 1.2"):
        silicon_absorption_per_um(wavelength_um=[0.9, 1.3])


def test_a_band_is_weighted_by_the_carriers_of_each_wavelength():
    how = {"depletion_um": 5.0, "diffusion_length_um": 50.0}

    def share(um):
        alpha = float(silicon_absorption_per_um(wavelength_um=um))
        return 1 - math.exp(-alpha * 5) / (1 + alpha * 50)

    def product(um):
        alpha = float(silicon_absorption_per_um(wavelength_um=um))
        return share(um) * float(diffusion_mtf(cycles_per_mm=30.0, absorption_per_um=alpha, **how))

    wavelength, weight = np.polynomial.legendre.leggauss(200)
    wavelength = 0.8 + 0.1 * wavelength
    alphas = silicon_absorption_per_um(wavelength_um=wavelength)
    found = band_diffusion_mtf(
        rho=3.0, focal_length_mm=100.0, absorptions_per_um=tuple(alphas),
        weights=tuple(weight), **how,
    )  # fmt: skip
    bends = np.linspace(0.7, 0.9, 21)  # of the table
    both = [sum(quad(f, a, b)[0] for a, b in pairwise(bends)) for f in (product, share)]
    assert found == pytest.approx(both[0] / both[1], rel=1e-5)
