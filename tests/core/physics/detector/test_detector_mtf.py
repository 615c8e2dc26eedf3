"""TDI: the closed form against a clocked exposure followed step by step."""

import numpy as np
import pytest

from core.physics.detector.detector_mtf import smear_mrad, tdi_mtf


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
