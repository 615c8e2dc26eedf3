"""A threshold between samples that lie unevenly."""

import numpy as np
import pytest

from core.physics.acquisition.ttp import interpolated

FREQUENCY = np.array([0.5, 0.7, 1.4, 1.7, 3.0, 3.2])
BETWEEN = np.array([0.5, 0.6, 1.0, 1.55, 2.0, 2.9, 3.1, 3.2])


def level(frequency):
    return -2.0 + 0.8 * frequency + 0.3 * frequency**2


def test_a_quadratic_logarithm_is_met_at_uneven_samples():
    """A parabola through three of its points is the curve itself, and so is Hermite's cubic."""
    threshold = interpolated(frequency=FREQUENCY, ctf=np.exp(level(FREQUENCY)))
    assert threshold(BETWEEN) == pytest.approx(np.exp(level(BETWEEN)), rel=1e-13)


@pytest.mark.parametrize(("at_zero", "power"), [(0.0, 1.0), (np.inf, -1.0)])
def test_the_power_towards_zero_is_put_back(at_zero, power):
    """Rising as the frequency (MRTD) or falling as its inverse (eye), times that curve."""
    ctf = np.exp(level(FREQUENCY)) * FREQUENCY**power
    threshold = interpolated(frequency=np.append(0.0, FREQUENCY), ctf=np.append(at_zero, ctf))
    places = np.append(0.2, BETWEEN)
    assert threshold(places) == pytest.approx(np.exp(level(places)) * places**power, rel=1e-13)
