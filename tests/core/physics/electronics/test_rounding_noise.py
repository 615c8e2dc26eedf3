"""Rounding errors stirred by noise, against integrals over what is rounded and the noise."""

import math

import numpy as np
import pytest
from scipy import special

from core.errors import ParameterError
from core.physics.detector.quantization import rounding_variances


def fixed_by_integration(step, sigma):
    """Mean square of the mean error of s + noise over s in one step, by normal integrals.

    The mean of round(s + n) − n over normal n is Σ of levels × the chance to fall in each cell.
    """

    s = step * (np.arange(20_000) / 20_000 - 0.5)  # periodic and smooth: equal steps sum exactly
    reach = int(10 * sigma / step) + 2
    levels = step * np.arange(-reach, reach + 1)[:, np.newaxis]
    low, high = levels - 0.5 * step - s, levels + 0.5 * step - s
    mean = (levels * (special.ndtr(high / sigma) - special.ndtr(low / sigma))).sum(axis=0)
    return np.mean((mean - s) ** 2)


@pytest.mark.parametrize("sigma", [0.02, 0.05, 0.079, 0.08, 0.1, 0.2, 0.3, 0.5])
def test_against_integration(sigma):
    step = 1.7
    temporal, fixed = rounding_variances(step=step, noise_variance=(sigma * step) ** 2)
    expected = fixed_by_integration(step, sigma * step)
    assert fixed == pytest.approx(expected, rel=1e-6, abs=1e-12)
    assert temporal + fixed == pytest.approx(step**2 / 12, rel=1e-15)


def test_limits():
    assert rounding_variances(step=2.0, noise_variance=0.0) == (0.0, pytest.approx(1 / 3))
    assert rounding_variances(step=2.0, noise_variance=1e6) == (pytest.approx(1 / 3), 0.0)


def test_both_forms_meet():
    step = 1.0
    edge = 0.25 / (4 * math.pi**2)
    below, above = (
        rounding_variances(step=step, noise_variance=edge * (1 + sign * 1e-12))[1]
        for sign in (-1, 1)
    )
    assert below == pytest.approx(above, rel=1e-10)


def test_against_draws():
    rng = np.random.default_rng(5)
    s = rng.uniform(0, 1, 4000)
    frames = np.round(s + 0.25 * rng.standard_normal((400, 4000)))
    temporal, fixed = rounding_variances(step=1.0, noise_variance=0.0625)
    changing = frames.var(axis=0, ddof=1).mean()
    assert changing == pytest.approx(0.0625 + temporal, rel=0.01)
    still = (frames.mean(axis=0) - s).var() - changing / 400
    assert still == pytest.approx(fixed, rel=0.1)


@pytest.mark.parametrize(("step", "variance"), [(0.0, 1.0), (1.0, -1.0), (1.0, math.inf)])
def test_refused(step, variance):
    with pytest.raises(ParameterError):
        rounding_variances(step=step, noise_variance=variance)
