"""TTP values and ranges, by hand, in closed form and against quadrature in 30 digits."""

import math

import numpy as np
import pytest
from mpmath import mp, mpf

from core.errors import ParameterError
from core.physics.acquisition.target_acquisition import TtpThreshold, interpolated

mp.dps = 30
UNIT = {"target_area_m2": 1.0, "range_m": 1000.0}  # 1 mrad: V is the sum itself


def ttp_value(*, frequency, ctf, contrast, target_area_m2, range_m):
    return TtpThreshold(frequency, ctf).value(contrast, target_area_m2, range_m)


# Line scanner, 8 to 12 µm: Nyquist at 130 mm/(2·600 µm) = 0.1083 cyc/mrad; MRTD = 50·f K there.
# A wall of 20 m by 20 m, 5 K warmer, at 402 m through 0.5/km: apparent 4.0895622 K (e^−0.201).
#   C = CTF at f = 4.0895622/50 = 0.08179124; ∫√(C/(50·f)) df from 0 = 2·√(C·f/50) = 2·0.08179124
#   20 m/402 m = 49.7512438 mrad; V = 49.7512438·0.16358249 = 8.1384323
# Staring array, 3 to 5 µm: Nyquist at 200 mm/(2·25 µm) = 4 cyc/mrad; MRTD = 0.16·f K.
# A vehicle of 2.3 m by 2.3 m, 2 K warmer, at 2 km through 0.3/km: apparent 1.0976233 K.
#   C = CTF at 6.8601454, beyond 4: 2·√(1.0976233·4/0.16) = 2·√27.4405818 = 2·5.2383759
#   1.15 mrad·10.4767518 = 12.0482646
@pytest.mark.parametrize("count", [2, 5, 64])
def test_two_sensors_by_hand(count):
    scanner = np.linspace(0, 130 / 1200, count)
    value = ttp_value(
        frequency=scanner, ctf=50 * scanner, contrast=4.0895622, target_area_m2=400, range_m=402
    )
    assert value == pytest.approx(8.1384323, rel=2e-8)
    staring = np.linspace(0, 4, count)
    value = ttp_value(
        frequency=staring, ctf=0.16 * staring, contrast=1.0976233, target_area_m2=5.29, range_m=2000
    )
    assert value == pytest.approx(12.0482646, rel=2e-8)


def exponential(frequency):
    return 0.02 * np.exp(6 * frequency)


@pytest.mark.parametrize("count", [2, 7, 65])
@pytest.mark.parametrize("contrast", [0.0200001, 0.03, 0.4, 5.0])
def test_exponential_threshold_in_closed_form(count, contrast):
    """∫√(C/CTF) df from 0 to where C = CTF is 2/6·(√(C/0.02) − 1)."""
    frequency = np.linspace(0, 1, count)
    exact = 2 / mpf(6) * (mp.sqrt(mpf(contrast) / mpf("0.02")) - 1)
    ctf = exponential(frequency)
    value = ttp_value(frequency=frequency, ctf=ctf, contrast=contrast, **UNIT)
    assert value == pytest.approx(float(exact), rel=2e-13, abs=1e-13)


def test_sum_ends_with_the_curve():
    """No crossing up to 0.25 cyc/mrad: 2/6·√(C/0.02)·(1 − e^(−6·0.25/2))."""
    exact = 2 / 6 * math.sqrt(5.0 / 0.02) * -math.expm1(-0.75)
    frequency = np.array([0.0, 0.1, 0.25])
    value = ttp_value(frequency=frequency, ctf=exponential(frequency), contrast=5.0, **UNIT)
    assert value == pytest.approx(exact, rel=1e-13)


def hollow(frequency):
    """A threshold that is seen only between two frequencies: 0.01·(f/0.3 + 0.3/f)·e^(3f)."""
    return 0.01 * (frequency / 0.3 + 0.3 / frequency) * np.exp(3 * frequency)


@pytest.mark.parametrize("contrast", [0.05, 0.3, 3.0])
def test_threshold_crossed_twice(contrast):
    def exact_threshold(f):
        return mpf("0.01") * (f / mpf("0.3") + mpf("0.3") / f) * mp.exp(3 * f)

    level = mpf(contrast)
    low = mp.findroot(lambda f: exact_threshold(f) - level, (mpf("1e-6"), mpf("0.2")), "anderson")
    high = mp.findroot(lambda f: exact_threshold(f) - level, (mpf("0.2"), mpf(3)), "anderson")
    exact = mp.quad(lambda f: mp.sqrt(level / exact_threshold(f)), mp.linspace(low, high, 9))
    frequency = np.linspace(0, 3, 301)
    with np.errstate(divide="ignore"):
        samples = hollow(frequency)
    assert np.isinf(samples[0])
    value = ttp_value(frequency=frequency, ctf=samples, contrast=contrast, **UNIT)
    assert value == pytest.approx(float(exact), rel=2e-5)


def mrtd(frequency):
    """As the static models have it: the frequency over an MTF, of a Gaussian and a detector."""
    return 0.05 * frequency * np.exp(8 * frequency**2) / np.sinc(frequency)


def test_samples_of_an_mrtd_and_their_error():
    """From zero as f, to infinity where the MTF is zero; the error falls as the step's cube."""

    def exact_threshold(f):
        return mpf("0.05") * f * mp.exp(8 * f**2) / (mp.sinc(mp.pi * f))

    end = mp.findroot(lambda f: exact_threshold(f) - 2, (mpf("0.1"), mpf("0.9")), "anderson")
    exact = mp.quad(lambda u: mp.sqrt(2 / exact_threshold(u * u)) * 2 * u, [0, mp.sqrt(end)])
    errors = []
    for count in (17, 33, 65):
        frequency = np.linspace(0, 1, count)
        samples = mrtd(frequency)
        samples[-1] = np.inf
        value = ttp_value(frequency=frequency, ctf=samples, contrast=2.0, **UNIT)
        errors.append(abs(value / float(exact) - 1))
    assert errors[0] < 1e-4
    assert errors[2] < errors[0] / 30


def test_what_is_infinite_is_not_seen():
    frequency = np.linspace(0, 4, 9)
    ctf = np.where((frequency >= 1) & (frequency <= 2), 0.25, np.inf)
    value = ttp_value(frequency=frequency, ctf=ctf, contrast=1.0, **UNIT)
    assert value == pytest.approx(2.0, rel=1e-14)  # √4·(2 − 1)
    assert ttp_value(frequency=frequency, ctf=np.full(9, np.inf), contrast=1.0, **UNIT) == 0.0
    assert ttp_value(frequency=frequency, ctf=np.full(9, 0.5), contrast=0.5, **UNIT) == 0.0


GOOD = {"frequency": [0.0, 1.0, 2.0], "ctf": [0.1, 0.2, 0.4], "contrast": 1.0, **UNIT}


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"frequency": [0.0, 2.0, 1.0]}, r"frequency\[2\]"),
        ({"frequency": [0.0]}, "frequency"),
        ({"ctf": [0.1, 0.2]}, "ctf"),
        ({"ctf": [0.1, 0.0, 0.4]}, r"ctf\[1\]"),
        ({"contrast": -1.0}, "contrast"),
        ({"target_area_m2": 0.0}, "target_area_m2"),
        ({"contrast": np.ones(2), "range_m": np.ones(3)}, r"\(2,\)"),
    ],
)
def test_what_is_out_of_range_is_refused_by_name(wrong, named):
    with pytest.raises(ParameterError, match=named):
        ttp_value(**{**GOOD, **wrong})


# A threshold between samples that lie unevenly.


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
